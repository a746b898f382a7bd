// matchlight spheres convert: a sphere set as another file, with its radii, colours and opacities as they were mapped.
#include <filesystem>
#include <memory>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/result.h"
#include "commands/sphere_options.h"
#include "commands/spheres_commands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "scene/sphere_file.h"
#include "scene/sphere_write.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct SpheresConvertCall {
    fs::path input, output;
    SphereSettings settings;
    bool overwrite = false;
};

void run_convert(const SpheresConvertCall& call, CommandContext& context) {
    std::error_code error;
    if (call.input == call.output || fs::equivalent(call.input, call.output, error)) {
        throw InputError(call.output, "the output is the input", "give another name");
    }
    check_output(call.output, call.overwrite);
    check_sphere_extension(call.output);
    const OutputLock lock(call.output);
    const SphereSet set = load_sphere_set(call.input, call.settings, context.warnings);
    write_sphere_set(call.output, set);
    print_result(context, json{{"file", call.output.string()}, {"count", set.size()}},
                 fmt::format("{}: {} spheres from {}\n", call.output.string(), set.size(), call.input.string()));
}

}  // namespace

void add_spheres_convert_command(CLI::App& spheres, CommandContext& context) {
    CLI::App* command = spheres.add_subcommand("convert", "Write a sphere set as PLY, XYZ or CSV");
    const auto call = std::make_shared<SpheresConvertCall>();
    command->add_option("IN", call->input, "XYZ, PDB, mmCIF, GRO, CSV, VTK, VTP, PLY or bgeo")->required();
    command->add_option("-o,--output", call->output, "Where to write: .ply, .xyz or .csv")->required();
    add_sphere_options(*command, call->settings);
    command->add_flag("--overwrite", call->overwrite, "Replace a file that exists");
    command->callback([call, &context] { run_convert(*call, context); });
}

}  // namespace matchlight
