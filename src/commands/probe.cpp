// matchlight probe: what a light probe holds, and its conversion between mappings.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/command.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "lighting/dominant_lights.h"
#include "lighting/probe_file.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeInfoOptions {
    fs::path probe;
    std::optional<ProbeMapping> from;
};

struct ProbeConvertOptions {
    fs::path input, output;
    std::optional<ProbeMapping> from;
    ProbeMapping to = ProbeMapping::latlong;
    CubeLayout cube = CubeLayout::vertical_cross;
    int size_px = 0;  // 0: what the input holds
    ProbePlacement placement;
    bool overwrite = false;
};

const std::map<std::string, ProbeMapping> mappings_by_name = {{"latlong", ProbeMapping::latlong},
                                                              {"angular", ProbeMapping::angular},
                                                              {"mirrorball", ProbeMapping::mirrorball},
                                                              {"cube", ProbeMapping::cube}};
const std::map<std::string, CubeLayout> cubes_by_name = {{"vertical-cross", CubeLayout::vertical_cross},
                                                         {"horizontal-cross", CubeLayout::horizontal_cross},
                                                         {"strip", CubeLayout::strip},
                                                         {"column", CubeLayout::column}};

std::string name_of(CubeLayout cube) {
    for (const auto& [name, known] : cubes_by_name) {
        if (known == cube) return name;
    }
    return {};
}

json rgb_json(const Eigen::Vector3d& rgb) {
    return json::array({rgb.x(), rgb.y(), rgb.z()});
}

std::string rgb_text(const Eigen::Vector3d& rgb) {
    return fmt::format("{:>10.4g} {:>10.4g} {:>10.4g}", rgb.x(), rgb.y(), rgb.z());
}

/// Azimuth counter-clockwise from world +x seen from above, elevation above the horizon.
double azimuth_deg(const Eigen::Vector3d& direction) {
    return std::atan2(direction.y(), direction.x()) * 180 / std::numbers::pi;
}
double elevation_deg(const Eigen::Vector3d& direction) {
    return std::atan2(direction.z(), std::hypot(direction.x(), direction.y())) * 180 / std::numbers::pi;
}

struct NamedDirection {
    const char* name;
    Eigen::Vector3d direction;
};
const std::array<NamedDirection, 6> six_directions = {{{"+x", {1, 0, 0}},
                                                       {"-x", {-1, 0, 0}},
                                                       {"+y", {0, 1, 0}},
                                                       {"-y", {0, -1, 0}},
                                                       {"+z", {0, 0, 1}},
                                                       {"-z", {0, 0, -1}}}};
const std::array<const char*, 9> sh_names = {"0, 0", "1,-1", "1, 0", "1, 1", "2,-2", "2,-1", "2, 0", "2, 1", "2, 2"};

void run_info(const ProbeInfoOptions& options, CommandContext& context) {
    const ProbeImage file = read_probe_image(options.probe, options.from, context.warnings);
    const Probe probe = unwrapped(file);
    const ProbeStatistics statistics = probe_statistics(probe);
    const auto lights = dominant_lights(probe);
    const SphericalHarmonics9 sh = project_to_sh(probe);
    const std::int64_t clipped = clipped_pixels(file.image);
    const std::int64_t repaired = file.repairs.not_a_number + file.repairs.infinite + file.negative_samples;

    std::string mapping = name_of(file.layout.mapping);
    json result{{"file", options.probe.string()},
                {"width", file.layout.width},
                {"height", file.layout.height},
                {"mapping", mapping},
                {"recognised_by", file.recognised_by}};
    if (file.layout.mapping == ProbeMapping::cube) {
        result["cube_layout"] = name_of(file.layout.cube);
        result["face_size"] = file.layout.face_size();
        mapping += " (" + name_of(file.layout.cube) + ")";
    }
    if (file.layout.edge_centred) mapping += ", pixel centres on the edges (OpenEXR envmap)";
    result["edge_centred"] = file.layout.edge_centred;
    result["latlong"] = {{"width", probe.latlong.width()}, {"height", probe.latlong.height()}};
    result["luminance"] = {{"mean", statistics.mean_luminance},
                           {"median", statistics.median_luminance},
                           {"largest", statistics.largest_luminance},
                           {"least_positive", statistics.least_positive_luminance},
                           {"dynamic_range_ev", statistics.dynamic_range_ev()}};
    result["mean_radiance"] = rgb_json(statistics.mean_radiance);
    result["black_share"] = statistics.black_share;
    result["clipped_pixels"] = clipped;
    result["repaired_samples"] = {{"nan", file.repairs.not_a_number},
                                  {"infinite", file.repairs.infinite},
                                  {"negative", file.negative_samples},
                                  {"beyond_half", file.repairs.beyond_half}};

    std::string text = fmt::format("{}: {} x {} pixels, {}, recognised by {}\n", options.probe.string(),
                                   file.layout.width, file.layout.height, mapping, file.recognised_by);
    text += fmt::format("luminance: mean {:.4g}, median {:.4g}, largest {:.4g}, least above black {:.4g}: {:.1f} EV\n",
                        statistics.mean_luminance, statistics.median_luminance, statistics.largest_luminance,
                        statistics.least_positive_luminance, statistics.dynamic_range_ev());
    text += fmt::format("mean radiance{}\n", rgb_text(statistics.mean_radiance));
    text += fmt::format("clipped pixels: {}; repaired samples: {}; black: {:.1f} % of the sphere\n", clipped, repaired,
                        100 * statistics.black_share);

    text += "irradiance of a surface that faces        r          g          b\n";
    for (const auto& [name, direction] : six_directions) {
        const Eigen::Vector3d e = irradiance(probe, direction);
        result["irradiance"][name] = rgb_json(e);
        text += fmt::format("  {:<30}{}\n", name, rgb_text(e));
    }
    text += "spherical harmonics of radiance (l, m)\n";
    for (std::size_t i = 0; i < sh.size(); ++i) {
        result["spherical_harmonics"].push_back(rgb_json(sh[i]));
        text += fmt::format("  {:<30}{}\n", sh_names[i], rgb_text(sh[i]));
    }
    result["dominant_lights"] = json::array();
    text += lights.empty() ? "no dominant light\n"
                           : "dominant lights: azimuth from +x, elevation, direction, solid angle, share of power, "
                             "power (radiance x sr)\n";
    for (const DominantLight& light : lights) {
        result["dominant_lights"].push_back({{"direction", rgb_json(light.direction)},
                                             {"azimuth_deg", azimuth_deg(light.direction)},
                                             {"elevation_deg", elevation_deg(light.direction)},
                                             {"solid_angle_sr", light.solid_angle_sr},
                                             {"power", rgb_json(light.power)},
                                             {"power_share", light.power_share},
                                             {"peak_luminance", light.peak_luminance}});
        text += fmt::format("  {:7.2f}° {:6.2f}°  ({:6.3f}, {:6.3f}, {:6.3f})  {:8.3g} sr  {:5.1f} %{}\n",
                            azimuth_deg(light.direction), elevation_deg(light.direction), light.direction.x(),
                            light.direction.y(), light.direction.z(), light.solid_angle_sr, 100 * light.power_share,
                            rgb_text(light.power));
    }
    print_result(context, result, text);
}

void check_conversion(const ProbeConvertOptions& options) {
    std::error_code error;
    if (options.input == options.output || fs::equivalent(options.input, options.output, error)) {
        throw InputError(options.output, "the output is the input", "give another name");
    }
    check_output(options.output, options.overwrite);
    require_probe_extension(options.output);
}

/// The layout to write: `size_px` is the image's width, for a cube the side of a face.
ProbeLayout wanted_layout(const ProbeConvertOptions& options, const ProbeLayout& from) {
    int size = size_for_latlong(options.to, latlong_height_for(from));
    if (options.size_px > 0) {
        size = options.to == ProbeMapping::latlong ? std::max(1, options.size_px / 2) : options.size_px;
    } else if (options.to == from.mapping) {
        size = from.mapping == ProbeMapping::cube      ? from.face_size()
               : from.mapping == ProbeMapping::latlong ? from.height
                                                       : from.width;
    }
    return layout_of_size(options.to, size, options.cube);
}

void run_convert(const ProbeConvertOptions& options, CommandContext& context) {
    check_conversion(options);
    const OutputLock lock(options.output);
    ProbeImage file = read_probe_image(options.input, options.from, context.warnings);
    const ProbeLayout to = wanted_layout(options, file.layout);

    ImageMetadata metadata = {{"software", std::string("matchlight ") + version},
                              {"source", options.input.filename().string()}};
    ImageF image;
    if (options.placement.rotation_deg != 0 || options.placement.exposure_ev != 0) {
        metadata["rotation_deg"] = fmt::format("{}", options.placement.rotation_deg);
        metadata["exposure_ev"] = fmt::format("{}", options.placement.exposure_ev);
        image = image_from_probe(placed(unwrapped(file), options.placement), to);
    } else {
        image = resample(file.image, file.layout, to);
    }
    write_probe_image(options.output, image, to, metadata);

    json result{{"file", options.output.string()},
                {"width", to.width},
                {"height", to.height},
                {"mapping", name_of(to.mapping)},
                {"from", name_of(file.layout.mapping)}};
    std::string mapping = name_of(to.mapping);
    if (to.mapping == ProbeMapping::cube) {
        result["cube_layout"] = name_of(to.cube);
        mapping += " (" + name_of(to.cube) + ")";
    }
    print_result(context, result,
                 fmt::format("{}: {} x {} pixels, {}, from {} {}", options.output.string(), to.width, to.height,
                             mapping, name_of(file.layout.mapping), options.input.string()));
}

void add_from_option(CLI::App& command, std::optional<ProbeMapping>& from) {
    command
        .add_option("--from", from,
                    "The mapping of the input: latlong, angular, mirrorball, cube (default: by its metadata and shape)")
        ->transform(CLI::CheckedTransformer(mappings_by_name).description(""))
        ->type_name("MAPPING");
}

/// CLI::Range lets NaN pass.
CLI::Validator within(double limit) {
    return {[limit](const std::string& text) {
                double value = 0;
                const bool fine = CLI::detail::lexical_cast(text, value) && std::abs(value) <= limit;
                return fine ? std::string() : fmt::format("'{}' is not between {} and {}", text, -limit, limit);
            },
            ""};
}

void add_info_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "info", "Range, average, irradiance, spherical harmonics, dominant lights, clipped pixels");
    const auto options = std::make_shared<ProbeInfoOptions>();
    command->add_option("PROBE", options->probe, "An .exr or .hdr image of all directions")->required();
    add_from_option(*command, options->from);
    command->callback([options, &context] { run_info(*options, context); });
}

void add_convert_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command =
        probe.add_subcommand("convert", "Write a probe in another mapping or size, every lamp keeping its energy");
    const auto options = std::make_shared<ProbeConvertOptions>();
    command->add_option("IN", options->input, "An .exr or .hdr image of all directions")->required();
    command->add_option("-o,--output", options->output, "Where to write: .exr or .hdr")->required();
    command->add_option("--to", options->to, "latlong, angular, mirrorball or cube")
        ->required()
        ->transform(CLI::CheckedTransformer(mappings_by_name).description(""))
        ->type_name("MAPPING");
    add_from_option(*command, options->from);
    command
        ->add_option("--size", options->size_px,
                     "Width of the result in pixels; of a cube, the side of a face (default: what the input holds)")
        ->check(CLI::Range(4, 16384).description(""))
        ->type_name("PIXELS");
    command
        ->add_option("--cube-layout", options->cube,
                     "vertical-cross (default), horizontal-cross, strip (OpenGL's order), column (OpenEXR's)")
        ->transform(CLI::CheckedTransformer(cubes_by_name).description(""))
        ->type_name("LAYOUT");
    command
        ->add_option("--rotation-deg", options->placement.rotation_deg,
                     "Turn the light counter-clockwise seen from above")
        ->check(within(3600))
        ->type_name("DEGREES");
    command->add_option("--exposure-ev", options->placement.exposure_ev, "Multiply the light by 2^EV")
        ->check(within(64))
        ->type_name("EV");
    command->add_flag("--overwrite", options->overwrite, "Replace a file that exists");
    command->callback([options, &context] { run_convert(*options, context); });
}

}  // namespace

void add_probe_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("probe", "Light probes: what they hold, and conversion between mappings");
    command->require_subcommand(1);
    add_info_command(*command, context);
    add_convert_command(*command, context);
}

}  // namespace matchlight
