// How the commands that make a probe write it: where, in which mapping and size, and which way up.
#pragma once

#include <filesystem>
#include <vector>

#include <CLI/App.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "lighting/mappings.h"
#include "lighting/stitched_sphere.h"
#include "media/image_io.h"

namespace matchlight {

struct ProbeOutput {
    std::filesystem::path path;
    ProbeMapping to = ProbeMapping::latlong;
    CubeLayout cube = CubeLayout::vertical_cross;
    int size_px = 0;  // 0: what the pictures hold
    std::vector<double> up = {0, 0, 1};
    double rotation_deg = 0;
    bool overwrite = false;
};
/// -o, --to, --size, --cube-layout, --overwrite.
void add_probe_file_options(CLI::App& command, ProbeOutput& output);
/// Those, --up and --rotation-deg.
void add_probe_output_options(CLI::App& command, ProbeOutput& output);

/// Rows of the lat-long map to make, where the pictures hold `natural` of them.
int wanted_latlong_height(const ProbeOutput& output, int natural);

/// From the picture's own axes (x right, y forward, z up): what --up names becomes up by the smallest turn, then
/// --rotation-deg about it. Throws InputError where --up is no direction.
Eigen::Matrix3d world_from_picture(const ProbeOutput& output);

/// Writes the sphere, warns of what was not seen, and returns what there is to print.
nlohmann::json write_sphere(const ProbeOutput& output, const StitchedSphere& sphere, ImageMetadata metadata,
                            Warnings& warnings);
/// The first line for people.
std::string sphere_text(const nlohmann::json& result);

}  // namespace matchlight
