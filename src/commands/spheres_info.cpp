// matchlight spheres info: what a sphere set holds.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/result.h"
#include "commands/sphere_options.h"
#include "commands/spheres_commands.h"
#include "scene/sphere_file.h"

namespace matchlight {
namespace {

using nlohmann::json;

struct SpheresInfoCall {
    std::filesystem::path file;
    SphereSettings settings;
};

void run_info(const SpheresInfoCall& call, CommandContext& context) {
    const SphereSet set = load_sphere_set(call.file, call.settings, context.warnings);
    json result{{"file", call.file.string()}, {"count", set.size()},           {"memory_bytes", set.bytes()},
                {"columns", set.columns},     {"colors", !set.colors.empty()}, {"blends", set.blends()}};
    std::string text = fmt::format("{}: {} spheres, {:.1f} MB in memory\n", call.file.string(), set.size(),
                                   static_cast<double>(set.bytes()) * 1e-6);
    if (set.size() > 0) {
        const Eigen::Vector3d from = set.bounds_m.min(), to = set.bounds_m.max();
        const auto [least, most] = std::ranges::minmax_element(
            set.spheres, [](const Sphere& a, const Sphere& b) { return a.radius_m < b.radius_m; });
        result["box"] = {{"from", {from.x(), from.y(), from.z()}}, {"to", {to.x(), to.y(), to.z()}}};
        result["radius"] = {{"least", least->radius_m}, {"greatest", most->radius_m}};
        text += fmt::format("box      ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g})\n", from.x(), from.y(),
                            from.z(), to.x(), to.y(), to.z());
        text += fmt::format("radii    {:.6g} to {:.6g}\n", least->radius_m, most->radius_m);
    }
    text += fmt::format("colours  {}\n", set.colors.empty() ? "one for all" : "one a sphere");
    text += fmt::format("opacity  {}\n",
                        set.opacities.empty() ? fmt::format("{:g} for all", set.opacity) : std::string("one a sphere"));
    if (!set.columns.empty()) text += fmt::format("columns  {}\n", fmt::join(set.columns, ", "));
    print_result(context, result, text);
}

}  // namespace

void add_spheres_info_command(CLI::App& spheres, CommandContext& context) {
    CLI::App* command = spheres.add_subcommand("info", "Count, box, radii, columns and memory of a sphere set");
    const auto call = std::make_shared<SpheresInfoCall>();
    command->add_option("FILE", call->file, "XYZ, PDB, mmCIF, GRO, CSV, VTK, VTP, PLY or bgeo")->required();
    add_sphere_options(*command, call->settings);
    command->callback([call, &context] { run_info(*call, context); });
}

}  // namespace matchlight
