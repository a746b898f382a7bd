// matchlight probe compare: how far a probe is from the true one.
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "lighting/probe_comparison.h"
#include "lighting/probe_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeCompareOptions {
    fs::path truth, test;
    std::optional<ProbeMapping> from;
    ProbeComparisonOptions comparison;
};

const std::map<std::string, FreeGain>& gains_by_name() {
    static const std::map<std::string, FreeGain> names = {
        {"none", FreeGain::none}, {"common", FreeGain::common}, {"channel", FreeGain::channel}};
    return names;
}

json comparison_json(const ProbeComparison& comparison) {
    json result{{"gain", rgb_json(comparison.gain)},
                {"irradiance_rmse", comparison.irradiance_rmse},
                {"worst_irradiance", comparison.worst_irradiance},
                {"brightest_angle_deg", comparison.brightest_angle_deg},
                {"median_abs_ev", comparison.median_abs_ev},
                {"percentile_95_abs_ev", comparison.percentile_95_abs_ev},
                {"mean_ev", comparison.mean_ev},
                {"black_share", comparison.black_share},
                {"mirror_ball",
                 {{"size_px", comparison.ball_px},
                  {"rms_ev", comparison.ball_rms_ev},
                  {"median_abs_ev", comparison.ball_median_abs_ev}}},
                {"lights", json::array()}};
    for (const ComparedLight& light : comparison.lights) {
        result["lights"].push_back({{"direction", rgb_json(light.direction)},
                                    {"angle_deg", light.angle_deg},
                                    {"power_ev", light.power_ev},
                                    {"power_share", light.power_share},
                                    {"solid_angle_sr", light.solid_angle_sr}});
    }
    return result;
}

std::string comparison_text(const ProbeComparison& comparison) {
    std::string text = fmt::format("gain on TEST (r g b){}\n", rgb_text(comparison.gain));
    text += fmt::format("irradiance from any direction: RMS {:.4f}, worst {:.4f} of its mean\n",
                        comparison.irradiance_rmse, comparison.worst_irradiance);
    text += fmt::format("brightest light: {:.3f}° apart\n", comparison.brightest_angle_deg);
    text += fmt::format("luminance: median |EV| {:.4f}, 95 % within {:.3f}, mean {:+.4f} EV; black in TEST: {:.2f} %\n",
                        comparison.median_abs_ev, comparison.percentile_95_abs_ev, comparison.mean_ev,
                        100 * comparison.black_share);
    text += fmt::format("mirror ball of {} px: RMS {:.4f} EV, median |EV| {:.4f}\n", comparison.ball_px,
                        comparison.ball_rms_ev, comparison.ball_median_abs_ev);
    text +=
        comparison.lights.empty()
            ? "no dominant light\n"
            : "dominant lights of TRUTH: azimuth from +x, elevation, share of light; in TEST: degrees apart, power\n";
    for (const ComparedLight& light : comparison.lights) {
        text += fmt::format("  {:7.2f}° {:6.2f}°  {:5.1f} %  {:8.3f}°  {:+.3f} EV\n", azimuth_deg(light.direction),
                            elevation_deg(light.direction), 100 * light.power_share, light.angle_deg, light.power_ev);
    }
    return text;
}

void run_compare(const ProbeCompareOptions& options, CommandContext& context) {
    const Probe truth = load_probe(options.truth, options.from, context.warnings);
    const Probe test = load_probe(options.test, options.from, context.warnings);
    const ProbeComparison comparison = compare_probes(truth, test, options.comparison);
    json result = comparison_json(comparison);
    result["truth"] = options.truth.string();
    result["test"] = options.test.string();
    print_result(context, result, comparison_text(comparison));
}

}  // namespace

void add_probe_compare_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "compare", "How far a probe is from the true one: irradiance, lamps, luminance, the mirror ball they give");
    const auto options = std::make_shared<ProbeCompareOptions>();
    command->add_option("TRUTH", options->truth, "The probe to trust: .exr or .hdr, any mapping")->required();
    command->add_option("TEST", options->test, "The probe to hold against it")->required();
    add_from_option(*command, options->from);
    command
        ->add_option("--gain", options->comparison.free_gain,
                     "What is left free on TEST: channel (default: exposure and white balance), common, none")
        ->transform(CLI::CheckedTransformer(gains_by_name()).description(""))
        ->type_name("GAIN");
    command
        ->add_option("--ball-size", options->comparison.ball_px,
                     "Side of the mirror balls compared (default: what the smaller probe holds, at most 512)")
        ->check(CLI::Range(8, 4096).description(""))
        ->type_name("PIXELS");
    command->callback([options, &context] { run_compare(*options, context); });
}

}  // namespace matchlight
