// The command table.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "commands/command.h"
#include "core/error.h"
#include "core/stop.h"
#include "core/version.h"

namespace {

using matchlight::CommandContext;

using AddCommand = void (*)(CLI::App&, CommandContext&);
const std::vector<AddCommand> command_table = {
    // One line a command, in the order the help shows them.
};

int report_failure(const char* what) {
    std::fprintf(stderr, "error: %s\n", what);
    return 1;
}

void repeat_warnings(const CommandContext& context) {
    if (context.warnings.empty() || context.quiet) return;
    std::fprintf(stderr, "%lld warnings:\n", static_cast<long long>(context.warnings.total()));
    for (const auto& entry : context.warnings.entries()) {
        std::fprintf(stderr, "  %lld× %s\n", static_cast<long long>(entry.count), entry.text.c_str());
    }
}

}  // namespace

int main(int argc, char** argv) {
    matchlight::install_stop_handlers();
    CLI::App app{"Composites 3D models onto recorded video so that they look as if the camera had filmed them."};
    app.set_version_flag("--version", std::string("matchlight ") + matchlight::version);
    app.require_subcommand(1);
    app.fallthrough();

    CommandContext context;
    app.add_flag("--json", context.json, "Print the result as JSON, for programs");
    app.add_flag("-q,--quiet", context.quiet, "No progress, no warnings on the terminal");
    app.add_flag("-v,--verbose", context.verbosity, "Say more (repeat for more)");
    app.parse_complete_callback([&] { context.warnings.set_quiet(context.quiet); });
    for (const auto add_command : command_table) add_command(app, context);

    int status = 0;
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;  // help and version end with 0, a wrong call with 2
    } catch (const std::exception& error) {
        status = report_failure(error.what());
    }
    repeat_warnings(context);
    return status;
}
