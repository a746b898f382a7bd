// matchlight spheres generate: the sets that renderers are compared on.
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/result.h"
#include "commands/spheres_commands.h"
#include "core/atomic_file.h"
#include "scene/sphere_generate.h"
#include "scene/sphere_write.h"

namespace matchlight {
namespace {

using nlohmann::json;

struct SpheresGenerateCall {
    std::string name;
    std::filesystem::path output;
    GenerateOptions options;
    bool overwrite = false;
};

void run_generate(SpheresGenerateCall& call, CommandContext& context) {
    call.options.name = call.name;
    const std::uint64_t count = generated_count(call.options);
    check_output(call.output, call.overwrite);
    check_sphere_extension(call.output);
    const OutputLock lock(call.output);
    SphereWriter writer(call.output, count, {});
    generate_spheres(call.options, [&](const Sphere& sphere) { writer.add(sphere); });
    writer.finish();
    print_result(
        context,
        json{{"file", call.output.string()}, {"set", call.name}, {"count", count}, {"seed", call.options.seed}},
        fmt::format("{}: {} spheres of {}, seed {}\n", call.output.string(), count, call.name, call.options.seed));
}

}  // namespace

void add_spheres_generate_command(CLI::App& spheres, CommandContext& context) {
    CLI::App* command = spheres.add_subcommand("generate", "Write a set of spheres made by rule, for comparison");
    const auto call = std::make_shared<SpheresGenerateCall>();
    std::string sets;
    for (const GeneratedSet& set : generated_sets()) {
        sets += fmt::format("{}{} ({} spheres: {})", sets.empty() ? "" : ", ", set.name, set.count, set.help);
    }
    command->add_option("SET", call->name, sets)->required();
    command->add_option("-o,--output", call->output, "Where to write: .ply, .xyz or .csv")->required();
    command->add_option("--seed", call->options.seed, "The same seed, the same bytes (1)");
    command->add_option("--count", call->options.count, "Another number of spheres");
    command->add_flag("--overwrite", call->overwrite, "Replace a file that exists");
    command->callback([call, &context] { run_generate(*call, context); });
}

}  // namespace matchlight
