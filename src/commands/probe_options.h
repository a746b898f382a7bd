// What the probe commands share: their options, their names for layouts, and how they print light.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Validators.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "lighting/mappings.h"
#include "lighting/probe.h"

namespace matchlight {

const std::map<std::string, ProbeMapping>& mappings_by_name();
const std::map<std::string, CubeLayout>& cubes_by_name();
std::string name_of(CubeLayout cube);

/// --from: the mapping of a probe that is read.
void add_from_option(CLI::App& command, std::optional<ProbeMapping>& from);

/// A number from −limit to limit; CLI::Range lets NaN pass.
CLI::Validator within(double limit);

nlohmann::json rgb_json(const Eigen::Vector3d& rgb);
/// Three columns of ten characters, a space between.
std::string rgb_text(const Eigen::Vector3d& rgb);

/// Azimuth counter-clockwise from world +x seen from above, elevation above the horizon.
double azimuth_deg(const Eigen::Vector3d& direction);
double elevation_deg(const Eigen::Vector3d& direction);

}  // namespace matchlight
