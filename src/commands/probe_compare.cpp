// matchlight probe compare: how far a probe is from the true one.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands/probe_ball_row.h"
#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "gl/context.h"
#include "lighting/probe_comparison.h"
#include "lighting/probe_file.h"
#include "media/image_io.h"
#include "report/flip.h"
#include "report/flip_colors.h"
#include "report/scratch_probe.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeCompareOptions {
    fs::path truth, test;
    std::optional<ProbeMapping> from;
    ProbeComparisonOptions comparison;
    bool render = false;
    fs::path picture;  // empty: none
    bool overwrite = false;
};

/// FLIP of balls that one probe lights against those that the other lights.
struct BallDifference {
    double on_balls = 0;  // mean
    double whole = 0;     // with the background, ground and shadows
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

void put_below(const Image8& part, int top, Image8& whole) {
    for (int y = 0; y < part.height(); ++y) {
        std::copy_n(part.pixel(0, y), part.width() * part.channels(), whole.pixel(0, top + y));
    }
}

BallDifference compare_balls(const ProbeCompareOptions& options, Probe test, const Eigen::Vector3d& gain) {
    for (int y = 0; y < test.latlong.height(); ++y) {
        for (int x = 0; x < test.latlong.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                test.latlong.at(x, y, c) = static_cast<float>(test.latlong.at(x, y, c) * gain[c]);
            }
        }
    }
    const ScratchProbe scaled(test.latlong);
    Warnings said_already;
    said_already.set_quiet(true);
    const auto gl = create_offscreen_context();
    BallRowOptions row;
    row.probe = options.truth;
    row.mapping = options.from;
    const BallRow expected = draw_ball_row(*gl, row, said_already);
    row.probe = scaled.path();
    row.mapping = ProbeMapping::latlong;
    row.exposure_ev = expected.exposure_ev;
    const BallRow found = draw_ball_row(*gl, row, said_already);

    const ImageF error = flip_error_map(expected.picture, found.picture);
    BallDifference difference;
    std::int64_t pixels = 0;
    for (int y = 0; y < error.height(); ++y) {
        for (int x = 0; x < error.width(); ++x) {
            const double here = error.at(x, y, 0);
            difference.whole += here / (static_cast<double>(error.width()) * error.height());
            if (expected.on_balls.at(x, y) == 0) continue;
            difference.on_balls += here;
            ++pixels;
        }
    }
    if (pixels > 0) difference.on_balls /= static_cast<double>(pixels);
    if (!options.picture.empty()) {
        const int height = expected.picture.height();
        Image8 picture(expected.picture.width(), 3 * height, 3);
        put_below(expected.picture, 0, picture);
        put_below(found.picture, height, picture);
        put_below(flip_colors(error), 2 * height, picture);
        write_png8(options.picture, picture);
    }
    return difference;
}

void run_compare(const ProbeCompareOptions& options, CommandContext& context) {
    if (!options.picture.empty()) {
        if (options.picture.extension() != ".png") {
            throw InputError(options.picture, "the picture is written as PNG", "give a name ending in .png");
        }
        check_output(options.picture, options.overwrite);
    }
    const Probe truth = load_probe(options.truth, options.from, context.warnings);
    const Probe test = load_probe(options.test, options.from, context.warnings);
    const ProbeComparison comparison = compare_probes(truth, test, options.comparison);
    json result = comparison_json(comparison);
    result["truth"] = options.truth.string();
    result["test"] = options.test.string();
    std::string text = comparison_text(comparison);
    if (options.render || !options.picture.empty()) {
        const BallDifference difference = compare_balls(options, test, comparison.gain);
        result["balls"] = {{"flip", difference.on_balls}, {"flip_whole", difference.whole}};
        text += fmt::format("five balls lit by each: FLIP {:.4f} on the balls, {:.4f} of the whole picture\n",
                            difference.on_balls, difference.whole);
    }
    print_result(context, result, text);
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
    command->add_flag("--render", options->render,
                      "Also FLIP of the balls of `probe view`, lit by one and by the other");
    command
        ->add_option("--picture", options->picture,
                     "Write these balls to a .png: lit by TRUTH, by TEST, and their difference")
        ->type_name("PNG");
    command->add_flag("--overwrite", options->overwrite, "Replace a picture that exists");
    command->callback([options, &context] { run_compare(*options, context); });
}

}  // namespace matchlight
