// Options and output that the probe commands have in common.
#include "commands/probe_options.h"

#include <cmath>
#include <numbers>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace matchlight {

const std::map<std::string, ProbeMapping>& mappings_by_name() {
    static const std::map<std::string, ProbeMapping> names = {{"latlong", ProbeMapping::latlong},
                                                              {"angular", ProbeMapping::angular},
                                                              {"mirrorball", ProbeMapping::mirrorball},
                                                              {"cube", ProbeMapping::cube}};
    return names;
}

const std::map<std::string, CubeLayout>& cubes_by_name() {
    static const std::map<std::string, CubeLayout> names = {{"vertical-cross", CubeLayout::vertical_cross},
                                                            {"horizontal-cross", CubeLayout::horizontal_cross},
                                                            {"strip", CubeLayout::strip},
                                                            {"column", CubeLayout::column}};
    return names;
}

std::string name_of(CubeLayout cube) {
    for (const auto& [name, known] : cubes_by_name()) {
        if (known == cube) return name;
    }
    return {};
}

void add_from_option(CLI::App& command, std::optional<ProbeMapping>& from) {
    command
        .add_option("--from", from,
                    "The mapping of the input: latlong, angular, mirrorball, cube (default: by its metadata and shape)")
        ->transform(CLI::CheckedTransformer(mappings_by_name()).description(""))
        ->type_name("MAPPING");
}

CLI::Validator within(double limit) {
    return {[limit](const std::string& text) {
                double value = 0;
                const bool fine = CLI::detail::lexical_cast(text, value) && std::abs(value) <= limit;
                return fine ? std::string() : fmt::format("'{}' is not between {} and {}", text, -limit, limit);
            },
            ""};
}

nlohmann::json rgb_json(const Eigen::Vector3d& rgb) {
    return nlohmann::json::array({rgb.x(), rgb.y(), rgb.z()});
}

std::string rgb_text(const Eigen::Vector3d& rgb) {
    return fmt::format("{:>10.4g} {:>10.4g} {:>10.4g}", rgb.x(), rgb.y(), rgb.z());
}

double azimuth_deg(const Eigen::Vector3d& direction) {
    return std::atan2(direction.y(), direction.x()) * 180 / std::numbers::pi;
}

double elevation_deg(const Eigen::Vector3d& direction) {
    return std::atan2(direction.z(), std::hypot(direction.x(), direction.y())) * 180 / std::numbers::pi;
}

}  // namespace matchlight
