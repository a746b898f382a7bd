// matchlight merge: bracketed photographs into one EXR of radiance.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "calibration/exposure_series.h"
#include "calibration/hdr_merge.h"
#include "calibration/response.h"
#include "commands/command.h"
#include "commands/photograph_options.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct MergeCall {
    PhotographOptions photographs;
    fs::path output;
    std::string response = "srgb";
    MergeOptions merge;
    bool no_deghost = false, overwrite = false;
};

/// Radiance in units of the reference photograph, with all that is known of each pixel, in one part that any reader
/// opens as RGB.
ImageF exr_channels(const MergedPhotograph& merged, double scale) {
    ImageF image(merged.radiance.width(), merged.radiance.height(), 9);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            float* out = image.pixel(x, y);
            std::uint8_t flags = 0;
            for (int c = 0; c < 3; ++c) {
                out[c] = static_cast<float>(merged.radiance.at(x, y, c) * scale);
                out[3 + c] = static_cast<float>(merged.sigma.at(x, y, c) * scale);
                flags |= merged.flags.at(x, y, c);
            }
            out[6] = (flags & merge_flag::clipped) != 0 ? 1 : 0;
            out[7] = (flags & merge_flag::under_noise) != 0 ? 1 : 0;
            out[8] = (flags & merge_flag::ghost) != 0 ? 1 : 0;
        }
    }
    return image;
}
const std::vector<std::string> exr_channel_names = {"R",       "G",       "B",           "sigma.R", "sigma.G",
                                                    "sigma.B", "clipped", "under_noise", "ghost"};

ImageMetadata exr_metadata(const ExposureSeries& series, const MergedPhotograph& merged, const Response& response,
                           double scale) {
    std::vector<std::string> photographs;
    for (const Photograph& shot : series.shots)
        photographs.push_back(fmt::format("{}: {}", shot.path.filename().string(), record_text(shot.record)));
    return {{"software", std::string("matchlight ") + version},
            {"photographs", fmt::format("{}", fmt::join(photographs, "; "))},
            {"reference", series.shots[merged.reference].path.filename().string()},
            {"exposure_scale", fmt::format("{}", scale)},
            {"response", series.shots.front().linear ? std::string("linear") : response.to_json().dump()},
            {"noise", fmt::format("read {:.6g}, shot {:.6g}, gain {:.6g}, code {:.6g}", merged.noise.read,
                                  merged.noise.shot, merged.noise.gain, merged.noise.code)}};
}

json result_json(const MergeCall& call, const ExposureSeries& series, const MergedPhotograph& merged, double scale) {
    json result{{"file", call.output.string()},
                {"width", series.width()},
                {"height", series.height()},
                {"reference", series.shots[merged.reference].path.string()},
                {"exposure_scale", scale},
                {"noise",
                 {{"read", merged.noise.read},
                  {"shot", merged.noise.shot},
                  {"gain", merged.noise.gain},
                  {"code", merged.noise.code}}},
                {"full_code", merged.full},
                {"clipped_pixels", merged.clipped_pixels},
                {"under_noise_pixels", merged.under_noise_pixels},
                {"ghost_pixels", merged.ghost_pixels},
                {"photographs", json::array()},
                {"pairs", json::array()}};
    for (std::size_t i = 0; i < series.shots.size(); ++i) {
        json shot = record_json(series.shots[i]);
        shot["relative_ev"] = std::log2(merged.exposures[i] / merged.exposures[merged.reference]);
        if (const auto& motion = merged.motions[i]) {
            shot["moved"] = {
                {"right_px", motion->right_px}, {"down_px", motion->down_px}, {"angle_rad", motion->angle_rad}};
        }
        result["photographs"].push_back(shot);
    }
    for (const PairAgreement& pair : merged.agreements) {
        json entry{{"recorded_ev", pair.recorded_ev}, {"samples", pair.samples}};
        if (pair.samples > 0) {
            entry["measured_ev"] = pair.measured_ev;
            entry["measured_sigma_ev"] = pair.measured_sigma_ev;
        }
        result["pairs"].push_back(entry);
    }
    return result;
}

std::string result_text(const MergeCall& call, const ExposureSeries& series, const MergedPhotograph& merged) {
    std::string text =
        fmt::format("{}: {} × {} pixels from {} photographs, in units of {}\n", call.output.string(), series.width(),
                    series.height(), series.shots.size(), series.shots[merged.reference].path.filename().string());
    for (std::size_t i = 0; i < series.shots.size(); ++i) {
        const Photograph& shot = series.shots[i];
        text += fmt::format("  {:<24} {:<24} {:+7.2f} EV", shot.path.filename().string(), record_text(shot.record),
                            std::log2(merged.exposures[i] / merged.exposures[merged.reference]));
        if (i > 0 && merged.agreements[i - 1].samples > 0) {
            const PairAgreement& pair = merged.agreements[i - 1];
            text += fmt::format(", by the pixels {:+.3f} ± {:.3f} EV off the step before it",
                                pair.recorded_ev - pair.measured_ev, pair.measured_sigma_ev);
        }
        if (const auto& motion = merged.motions[i]) {
            text += fmt::format(", moved by ({:.2f}, {:.2f}) px, {:.3f}°", motion->right_px, motion->down_px,
                                motion->angle_rad * 180 / std::numbers::pi);
        }
        text += '\n';
    }
    return text + fmt::format("clipped in every photograph: {} pixels; under the noise: {}; ghosts left out: {}\n",
                              merged.clipped_pixels, merged.under_noise_pixels, merged.ghost_pixels);
}

void run_merge(MergeCall& call, CommandContext& context) {
    check_not_an_input(call.output, call.photographs.photographs);
    if (call.output.extension() != ".exr") throw InputError(call.output, "merged photographs are written as .exr");
    check_output(call.output, call.overwrite);
    const OutputLock lock(call.output);
    const Response response = response_of(call.response);
    call.merge.deghost = !call.no_deghost;
    const ExposureSeries series = read_photographs(call.photographs, context.warnings);
    const MergedPhotograph merged = merge_exposures(series, response, call.merge, context.warnings);
    // 1 in the file is the light that gives code 1 in the photograph that exposes most of the picture well.
    const double scale = merged.exposures[merged.reference];
    const ImageF image = exr_channels(merged, scale);
    const ExrPart part{"radiance", exr_channel_names, &image, false, {}};
    write_exr(call.output, image.width(), image.height(), {part}, exr_metadata(series, merged, response, scale));
    print_result(context, result_json(call, series, merged, scale), result_text(call, series, merged));
}

}  // namespace

void add_merge_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("merge", "Bracketed photographs merged into one EXR of radiance");
    const auto call = std::make_shared<MergeCall>();
    add_photograph_options(*command, call->photographs);
    command->add_option("-o,--output", call->output, "Where to write: .exr")->required();
    command
        ->add_option("--response", call->response,
                     "The camera's curve: a response.json, srgb (default), linear or gamma=2.2; raw files need none")
        ->type_name("FILE|FAMILY");
    const std::map<std::string, Alignment> alignments{
        {"auto", Alignment::automatic}, {"on", Alignment::on}, {"off", Alignment::off}};
    command
        ->add_option("--align", call->merge.align,
                     "Move photographs onto one another: auto (default: where one is seen to have moved), on, off")
        ->transform(CLI::CheckedTransformer(alignments).description("{auto,on,off}"));
    command->add_flag("--no-deghost", call->no_deghost, "Merge also what differs between the photographs");
    command->add_flag("--refine-exposures", call->merge.refine_exposures,
                      "Take the steps between exposures that the pixels tell, in place of those recorded");
    command->add_flag("--overwrite", call->overwrite, "Replace a file that exists");
    command->callback([call, &context] { run_merge(*call, context); });
}

}  // namespace matchlight
