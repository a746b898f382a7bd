// `matchlight lens`: what a lens has in focus, from its own data or from what a solve found.
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "calibration/thin_lens.h"
#include "commands/command.h"
#include "commands/result.h"
#include "core/error.h"
#include "scene/scene_file.h"
#include "tracking/scene_solve.h"
#include "tracking/solve_file.h"

namespace matchlight {
namespace {

using nlohmann::json;

struct LensCall {
    std::string file;  // a solve or a scene; empty: the lens' own data
    std::optional<std::int64_t> frame;
    double focal_length_mm = 0, f_number = 0;
    double focus_distance_m = std::numeric_limits<double>::infinity();
    double sensor_width_mm = 36;
    int image_width_px = 1920;
    double acceptable_px = 1;
    std::vector<double> depths_m;
};

/// What is printed of a lens, wherever it came from.
struct LensFindings {
    Focus focus;
    double focal_px = 0;
    int image_width_px = 0;
    double hyperfocal_m = 0;
    std::optional<ThinLens> lens;
    std::optional<std::int64_t> frame;
};

[[noreturn]] void refuse(const std::string& cause, const std::string& cure) {
    throw InputError({}, cause, cure);
}

bool is_positive(double value) {
    return value > 0 && std::isfinite(value);
}

LensFindings from_lens_data(const LensCall& call) {
    if (!is_positive(call.focal_length_mm) || !is_positive(call.f_number)) {
        refuse("a lens needs a focal length and an f-number, both above zero",
               "give --focal-mm and --f-number, or a solve or scene that knows them");
    }
    if (!is_positive(call.sensor_width_mm)) refuse("the sensor's width is not above zero", "give --sensor-mm");
    if (call.image_width_px < 1) refuse("the picture's width is not above zero", "give --width in pixels");
    ThinLens lens;
    lens.focal_length_m = call.focal_length_mm / 1000;
    lens.f_number = call.f_number;
    lens.focus_distance_m = call.focus_distance_m;
    lens.sensor_width_m = call.sensor_width_mm / 1000;
    lens.image_width_px = call.image_width_px;
    if (!(lens.focus_distance_m > lens.focal_length_m)) {
        refuse(fmt::format("a lens of {} mm has no picture of what is {} m away", call.focal_length_mm,
                           call.focus_distance_m),
               "focus beyond the focal length; inf is infinity");
    }
    return {focus_of(lens), focal_px(lens), lens.image_width_px, hyperfocal_m(lens, call.acceptable_px), lens, {}};
}

/// The frame that was asked for, or the first that knows its focus.
const SolvedFrame& focused_frame(const Solve& solve, const LensCall& call) {
    for (const SolvedFrame& frame : solve.frames) {
        const bool known = frame.focus_distance_m && frame.coc_scale_px_m;
        if (call.frame ? frame.frame == *call.frame && known : known) return frame;
    }
    if (call.frame) {
        throw InputError(call.file, *call.frame, "the focus of this frame is not known", "leave --frame out");
    }
    throw InputError(call.file, "the focus of no frame is known: the footage shows no difference of sharpness",
                     "give the lens by --focal-mm, --f-number and --focus-m");
}

LensFindings from_file(const LensCall& call, Warnings& warnings) {
    const bool is_scene = std::filesystem::path(call.file).extension() == ".toml";
    const Solve solve = is_scene ? solve_of_scene(load_scene(call.file, warnings), warnings) : load_solve(call.file);
    const SolvedFrame& frame = focused_frame(solve, call);
    const Focus focus{*frame.coc_scale_px_m, *frame.focus_distance_m};
    return {focus, solve.camera.fx, solve.camera.width, hyperfocal_m(focus, call.acceptable_px), {}, frame.frame};
}

/// JSON has no infinity: absent there.
void put_distance(json& object, const char* key, double distance_m) {
    if (std::isfinite(distance_m)) object[key] = distance_m;
}

std::string distance_text(double distance_m) {
    return std::isfinite(distance_m) ? fmt::format("{:.4g} m", distance_m) : "infinity";
}

void print_lens(const LensCall& call, const LensFindings& found, const CommandContext& context) {
    const DepthOfField sharp = depth_of_field(found.focus, call.acceptable_px);
    const double view_deg = 2 * std::atan(found.image_width_px / 2.0 / found.focal_px) * 180 / std::numbers::pi;
    json result{{"focal_px", found.focal_px},
                {"horizontal_fov_deg", view_deg},
                {"coc_scale_px_m", found.focus.coc_scale_px_m},
                {"acceptable_coc_px", call.acceptable_px}};
    put_distance(result, "focus_distance_m", found.focus.focus_distance_m);
    put_distance(result, "hyperfocal_m", found.hyperfocal_m);
    put_distance(result, "near_m", sharp.near_m);
    put_distance(result, "far_m", sharp.far_m);
    std::string text;
    if (found.frame) {
        result["frame"] = *found.frame;
        text += fmt::format("frame        {}\n", *found.frame);
    }
    if (found.lens) {
        text += fmt::format("lens         {:g} mm f/{:g}, {} px over {:g} mm\n", call.focal_length_mm, call.f_number,
                            found.image_width_px, call.sensor_width_mm);
    }
    text += fmt::format("view         {:.4g} degrees across, focal length {:.5g} px\n", view_deg, found.focal_px);
    text += fmt::format("focus        {}\n", distance_text(found.focus.focus_distance_m));
    text += fmt::format("blur         {:.4g} px m · |1/focus - 1/depth|\n", found.focus.coc_scale_px_m);
    text += fmt::format("sharp        {} to {} (blur up to {:g} px)\n", distance_text(sharp.near_m),
                        distance_text(sharp.far_m), call.acceptable_px);
    text += fmt::format("hyperfocal   {}\n", distance_text(found.hyperfocal_m));
    for (const double depth_m : call.depths_m) {
        const double coc_px = signed_coc_px(found.focus, depth_m);
        json entry{{"coc_px", std::abs(coc_px)}};
        put_distance(entry, "depth_m", depth_m);
        result["at"].push_back(entry);
        text += fmt::format("at {:<10}{:.4g} px\n", distance_text(depth_m), std::abs(coc_px));
    }
    print_result(context, result, text);
}

void run_lens(const LensCall& call, CommandContext& context) {
    if (!is_positive(call.acceptable_px)) refuse("the blur that counts as sharp is not above zero", "give --coc-px");
    for (const double depth_m : call.depths_m) {
        if (!(depth_m > 0)) refuse("a depth is not above zero", "give --at in metres before the lens");
    }
    print_lens(call, call.file.empty() ? from_lens_data(call) : from_file(call, context.warnings), context);
}

}  // namespace

void add_lens_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("lens", "What a lens has in focus: limits, hyperfocal distance, blur");
    const auto call = std::make_shared<LensCall>();
    CLI::Option* file = command->add_option("FILE", call->file, "Solve (.solve.json) or scene (.toml)");
    command->add_option("--frame", call->frame, "Which frame of it (the first whose focus is known)")->needs(file);
    const auto own = [&](CLI::Option* option) { option->excludes(file); };
    own(command->add_option("--focal-mm", call->focal_length_mm, "Focal length, instead of a file"));
    own(command->add_option("--f-number", call->f_number, "Focal length over the opening's width"));
    own(command->add_option("--focus-m", call->focus_distance_m, "Focus distance; inf unless given"));
    own(command->add_option("--sensor-mm", call->sensor_width_mm, "Width of the sensor (36)"));
    own(command->add_option("--width", call->image_width_px, "Width of the picture in pixels (1920)"));
    command->add_option("--coc-px", call->acceptable_px, "Blur that counts as sharp, diameter in pixels (1)");
    command->add_option("--at", call->depths_m, "Depths in metres whose blur is wanted");
    command->callback([call, &context] { run_lens(*call, context); });
}

}  // namespace matchlight
