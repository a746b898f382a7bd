// The same names and ranges as the scene file's table.
#include "commands/sphere_options.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/error.h"
#include "scene/color_map.h"

namespace matchlight {

void add_sphere_options(CLI::App& command, SphereSettings& settings) {
    command.add_option("--radius", settings.radius, "Radius of all spheres, in the file's units");
    command.add_option("--radius-column", settings.radius_column, "Which column is the radius")->type_name("NAME");
    command.add_option("--radius-scale", settings.radius_scale, "Multiplies all radii");
    command.add_option("--color-column", settings.color_column, "Which column becomes colours, or element")
        ->type_name("NAME");
    std::map<std::string, std::size_t> maps;
    for (const std::string_view name : color_map_names()) maps.emplace(name, maps.size());
    std::string names;
    for (const std::string_view name : color_map_names()) names += (names.empty() ? "" : ", ") + std::string(name);
    command.add_option("--color-map", settings.color_map, names + " (default: viridis)")
        ->transform(CLI::CheckedTransformer(maps).description(""))
        ->type_name("NAME");
    command
        .add_option_function<std::vector<double>>(
            "--color-range",
            [&settings](const std::vector<double>& ends) {
                if (!(ends[0] < ends[1])) throw InputError({}, "--color-range does not ascend");
                settings.color_range = {ends[0], ends[1]};
            },
            "Values of the column at the map's two ends")
        ->expected(2)
        ->type_name("FROM TO");
    command.add_option("--opacity", settings.opacity, "Opacity of all spheres")
        ->check(CLI::Range(0.0, 1.0).description(""));
    command.add_option("--opacity-column", settings.opacity_column, "Which column is the opacity")->type_name("NAME");
    command.add_option("--up", settings.up, "Which of the file's axes is up: z (default) or y")
        ->transform(
            CLI::CheckedTransformer(std::map<std::string, SphereAxes>{{"z", SphereAxes::z}, {"y", SphereAxes::y}})
                .description(""))
        ->type_name("AXIS");
    command.add_option("--frame", settings.frame, "Which frame of a trajectory, counted from 0")
        ->check(CLI::NonNegativeNumber.description(""));
}

}  // namespace matchlight
