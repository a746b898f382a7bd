// matchlight probe info: what a light probe holds.
#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/transfer.h"
#include "lighting/dominant_lights.h"
#include "lighting/probe_file.h"
#include "lighting/probe_record.h"
#include "report/probe_page.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeInfoOptions {
    fs::path probe;
    std::optional<ProbeMapping> from;
    fs::path page;  // empty: none
    bool overwrite = false;
};

/// Parts that a sphere is cut into: as many as a page can tell apart.
constexpr int median_cut_parts = 16;

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

std::string light_text(const Eigen::Vector3d& direction, double solid_angle_sr, double share,
                       const Eigen::Vector3d& power) {
    return fmt::format("  {:7.2f}° {:6.2f}°  ({:6.3f}, {:6.3f}, {:6.3f})  {:8.3g} sr  {:5.1f} %{}\n",
                       azimuth_deg(direction), elevation_deg(direction), direction.x(), direction.y(), direction.z(),
                       solid_angle_sr, 100 * share, rgb_text(power));
}

void run_info(const ProbeInfoOptions& options, CommandContext& context) {
    if (!options.page.empty()) {
        if (options.page.extension() != ".html") {
            throw InputError(options.page, "the page is HTML", "give a name ending in .html");
        }
        check_output(options.page, options.overwrite);
    }
    const ProbeImage file = read_probe_image(options.probe, options.from, context.warnings);
    const Probe probe = unwrapped(file);
    const ProbeStatistics statistics = probe_statistics(probe);
    const auto lights = dominant_lights(probe);
    const SphericalHarmonics9 sh = project_to_sh(probe);
    const auto median_cut = sample_directions(probe, median_cut_parts, -1, false);
    const ProbeRecord record = read_probe_record(options.probe, file);
    const ProbeCoverage coverage = coverage_of(record, probe.latlong);
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

    result["clipped_share"] = coverage.clipped;
    text += fmt::format("clipped: {:.3g} % of the sphere", 100 * coverage.clipped);
    if (coverage.unseen) {
        result["unseen_share"] = *coverage.unseen;
        text += fmt::format("; seen by no photograph: {:.3g} %", 100 * *coverage.unseen);
    }
    if (coverage.median_sigma) {
        result["median_sigma"] = *coverage.median_sigma;
        text += fmt::format("; half of the rest known to {:.2g} %", 100 * *coverage.median_sigma);
    }
    text += "\n";
    if (const auto distances = distances_of(record)) {
        result["distances"] = {{"known_share", distances->known_share},
                               {"least_m", distances->least_m},
                               {"median_m", distances->median_m}};
        text += fmt::format("distances: of {:.1f} % of the sphere, from {:.3g} m, half of it nearer than {:.3g} m\n",
                            100 * distances->known_share, distances->least_m, distances->median_m);
    }
    result["metadata"] = record.metadata;

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
        text += light_text(light.direction, light.solid_angle_sr, light.power_share, light.power);
    }
    result["median_cut"] = json::array();
    text += median_cut.empty() ? "" : "median cut: azimuth, elevation, direction, solid angle, share of power, power\n";
    const double whole = 4 * std::numbers::pi * statistics.mean_luminance;
    for (const DirectionalSample& sample : median_cut) {
        const Eigen::Vector3d& power = sample.radiance_times_solid_angle;
        const double share = luminance_rec709(power.x(), power.y(), power.z()) / whole;
        result["median_cut"].push_back({{"direction", rgb_json(sample.direction)},
                                        {"solid_angle_sr", sample.solid_angle_sr},
                                        {"power", rgb_json(power)},
                                        {"power_share", share}});
        text += light_text(sample.direction, sample.solid_angle_sr, share, power);
    }
    if (!options.page.empty()) {
        const std::string description = fmt::format("{} × {} pixels, {}, recognised by {}", file.layout.width,
                                                    file.layout.height, mapping, file.recognised_by);
        write_text_file(options.page, probe_page({options.probe.filename().string(), description, probe, record,
                                                  statistics, coverage, lights, median_cut, repaired}));
        result["page"] = options.page.string();
        text += fmt::format("page: {}\n", options.page.string());
    }
    print_result(context, result, text);
}

}  // namespace

void add_probe_info_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "info", "Range, average, irradiance, spherical harmonics, dominant lights, clipped and unseen parts; a page");
    const auto options = std::make_shared<ProbeInfoOptions>();
    command->add_option("PROBE", options->probe, "An .exr or .hdr image of all directions")->required();
    add_from_option(*command, options->from);
    command->add_option("--page", options->page, "Also write a page with pictures, plots and tables")
        ->type_name("HTML");
    command->add_flag("--overwrite", options->overwrite, "Replace a page that exists");
    command->callback([options, &context] { run_info(*options, context); });
}

}  // namespace matchlight
