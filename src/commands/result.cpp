// Standard output carries results and nothing else.
#include "commands/result.h"

#include <cstdio>

namespace matchlight {

void print_result(const CommandContext& context, const nlohmann::json& json, const std::string& text) {
    const std::string output = context.json ? json.dump(2) : text;
    std::fwrite(output.data(), 1, output.size(), stdout);
    if (output.empty() || output.back() != '\n') std::fputc('\n', stdout);
}

}  // namespace matchlight
