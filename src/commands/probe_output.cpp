// Options and writing of made probes.
#include "commands/probe_output.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "commands/probe_options.h"
#include "core/error.h"
#include "core/version.h"
#include "lighting/probe_file.h"
#include "lighting/resample.h"

namespace matchlight {

using nlohmann::json;

void add_probe_file_options(CLI::App& command, ProbeOutput& output) {
    command.add_option("-o,--output", output.path, "Where to write: .exr or .hdr")->required();
    command.add_option("--to", output.to, "latlong (default), angular, mirrorball or cube")
        ->transform(CLI::CheckedTransformer(mappings_by_name()).description(""))
        ->type_name("MAPPING");
    command
        .add_option("--size", output.size_px,
                    "Width of the result in pixels; of a cube, the side of a face (default: what the pictures hold, at "
                    "most 4096 as lat-long)")
        ->check(CLI::Range(4, 16384).description(""))
        ->type_name("PIXELS");
    command
        .add_option("--cube-layout", output.cube,
                    "vertical-cross (default), horizontal-cross, strip (OpenGL's order), column (OpenEXR's)")
        ->transform(CLI::CheckedTransformer(cubes_by_name()).description(""))
        ->type_name("LAYOUT");
    command.add_flag("--overwrite", output.overwrite, "Replace a file that exists");
}

void add_probe_output_options(CLI::App& command, ProbeOutput& output) {
    add_probe_file_options(command, output);
    command
        .add_option(
            "--up", output.up,
            "The world's up in the picture's own axes, x right, y forward, z up (default: 0,0,1; 0,1,0 where the "
            "lens looked straight up)")
        ->delimiter(',')
        ->expected(3)
        ->type_name("X,Y,Z");
    command.add_option("--rotation-deg", output.rotation_deg, "Turn the light counter-clockwise seen from above")
        ->check(within(3600))
        ->type_name("DEGREES");
}

int wanted_latlong_height(const ProbeOutput& output, int natural) {
    if (output.to == ProbeMapping::latlong && output.size_px > 0) return std::max(2, output.size_px / 2);
    constexpr int largest = 2048;  // 4096 × 2048 is more than light needs, and 134 MB
    return std::clamp(natural, 2, largest);
}

Eigen::Matrix3d world_from_picture(const ProbeOutput& output) {
    const Eigen::Vector3d up(output.up[0], output.up[1], output.up[2]);
    if (!up.allFinite() || !(up.norm() > 1e-6))
        throw InputError({}, "--up is no direction", "say X,Y,Z, such as 0,1,0");
    const Eigen::Matrix3d raised = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const double angle = output.rotation_deg * std::numbers::pi / 180;
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix() * raised;
}

json write_sphere(const ProbeOutput& output, const StitchedSphere& sphere, ImageMetadata metadata, Warnings& warnings) {
    const int height = sphere.latlong.height();
    const ProbeLayout made = layout_of_size(ProbeMapping::latlong, height);
    ProbeLayout to = made;
    if (output.to != ProbeMapping::latlong) {
        const int size = output.size_px > 0 ? output.size_px : size_for_latlong(output.to, height);
        to = layout_of_size(output.to, size, output.cube);
    }
    metadata["software"] = std::string("matchlight ") + version;
    metadata["up"] = fmt::format("{:.6g} {:.6g} {:.6g}", output.up[0], output.up[1], output.up[2]);
    metadata["rotation_deg"] = fmt::format("{}", output.rotation_deg);
    metadata["seen_share"] = fmt::format("{:.4f}", sphere.seen_share);
    const ImageF all = resampled(sphere, made, to);
    RecordedChannels known{{"seen"}, channels_of(all, 3, all.channels() - 3)};
    if (known.image.channels() == 2) known.names = {"seen", "clipped"};
    if (known.image.channels() == 3) known.names = {"sigma", "seen", "clipped"};
    write_probe_image(output.path, channels_of(all, 0, 3), to, metadata, known);
    constexpr double rounding = 1e-4;
    if (sphere.seen_share < 1 - rounding) {
        warnings.add(
            fmt::format("{}: {:.1f} % of the sphere were not seen; they are black, and the channel seen "
                        "says where",
                        output.path.string(), 100 * (1 - sphere.seen_share)));
    }
    return {{"file", output.path.string()},
            {"width", to.width},
            {"height", to.height},
            {"mapping", name_of(to.mapping)},
            {"seen_share", sphere.seen_share}};
}

std::string sphere_text(const json& result) {
    return fmt::format("{}: {} × {} pixels, {}; {:.1f} % of the sphere seen\n", result["file"].get<std::string>(),
                       result["width"].get<int>(), result["height"].get<int>(), result["mapping"].get<std::string>(),
                       100 * result["seen_share"].get<double>());
}

}  // namespace matchlight
