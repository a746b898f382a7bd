// `matchlight render`: composites a tracked clip into a video or a sequence of pictures.
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "commands/command.h"
#include "commands/frame_range.h"
#include "commands/result.h"
#include "compositor/compositor.h"
#include "compositor/exposure_meter.h"
#include "compositor/frame_output.h"
#include "compositor/quality.h"
#include "compositor/surface_picture.h"
#include "core/atomic_file.h"
#include "core/elapsed.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/stop.h"
#include "core/version.h"
#include "gl/context.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "render/pass_table.h"
#include "scene/footage_options.h"
#include "scene/scene_file.h"
#include "tracking/scene_solve.h"

namespace matchlight {

namespace fs = std::filesystem;

namespace {

struct RenderArguments {
    std::string scene;
    std::string output;
    std::string touched_masks;
    std::optional<QualityLevel> level;
    std::optional<double> budget_ms;
    FrameRange frames;
    std::optional<std::int64_t> explain;
    std::int64_t first_number = 0;
    std::optional<OverscanRequest> overscan;
    bool overwrite = false;
    bool strict = false;
};

/// The call's level or budget in place of the scene's.
void choose_quality(Scene& scene, const RenderArguments& arguments) {
    if (arguments.level) {
        scene.quality = *arguments.level;
        scene.budget_ms.reset();
    }
    if (arguments.budget_ms) scene.budget_ms = arguments.budget_ms;
}

void refuse_input_as_output(const fs::path& output, const Scene& scene) {
    std::vector<fs::path> inputs{scene.path, scene.footage.video, scene.footage.camera, scene.footage.solve};
    inputs.insert(inputs.end(), {scene.footage.matte, scene.footage.depth});
    if (scene.probe) inputs.push_back(scene.probe->path);
    inputs.push_back(scene.background.image);
    for (const ObjectSettings& object : scene.objects) inputs.insert(inputs.end(), {object.model, object.spheres});
    for (const fs::path& input : inputs) {
        std::error_code ignored;
        if (!input.empty() && (fs::equivalent(output, input, ignored) ||
                               fs::weakly_canonical(output, ignored) == fs::weakly_canonical(input, ignored))) {
            throw InputError(output, "is an input of this render", "name another output");
        }
    }
}

/// Pictures that exist already are found before the first frame is drawn, not in the middle.
void check_pictures(const RenderArguments& arguments, const fs::path& pattern, const FootageInfo& footage) {
    if (arguments.overwrite) return;
    const std::int64_t end = arguments.frames.last ? *arguments.frames.last + 1 : footage.frame_count;
    for (std::int64_t frame = arguments.frames.first; frame < end; ++frame) {
        check_output(numbered(pattern, frame + arguments.first_number), false);
    }
}

/// The pixels beyond the frame that the call asks for.
Overscan overscan_of(const RenderArguments& arguments, const Scene& scene, const Camera& camera) {
    if (!arguments.overscan) return {};
    if (output_kind(arguments.output) != OutputKind::exr)
        throw InputError(arguments.output, "holds nothing beyond the frame, which --overscan asks for",
                         "name it out_%04d.exr");
    if (!scene.background.image.empty())
        throw InputError(scene.background.image, "ends with the frame, and --overscan goes beyond",
                         "leave one of them out");
    return arguments.overscan->of(camera.width, camera.height);
}

void check_masks(const RenderArguments& arguments, const Scene& scene, const FootageInfo& footage) {
    const fs::path masks = arguments.touched_masks;
    if (masks.empty()) return;
    refuse_input_as_output(masks, scene);
    if (output_kind(masks) != OutputKind::png)
        throw InputError(masks, "masks are PNG pictures", "name touched_%04d.png");
    if (!is_pattern(masks)) throw InputError(masks, "names one picture for all frames", "name touched_%04d.png");
    if (masks.lexically_normal() == fs::path(arguments.output).lexically_normal()) {
        throw InputError(masks, "is the name of the output too", "name another");
    }
    check_pictures(arguments, masks, footage);
}

Image8 whole_frame_mask(const CompositedFrame& frame) {
    Image8 mask(frame.plate.format().width, frame.plate.format().height, 1);
    for (int y = 0; y < frame.reach.height; ++y) {
        std::copy_n(frame.touched.pixel(0, y), frame.reach.width, mask.pixel(frame.reach.x, frame.reach.y + y));
    }
    return mask;
}

nlohmann::json frame_json(const CompositedFrame& frame) {
    const Region& reach = frame.reach;
    std::int64_t touched = 0;
    for (const std::uint8_t pixel : frame.touched.samples()) touched += pixel != 0;
    return {{"frame", frame.plate.index()},
            {"time_s", frame.plate.time_s()},
            {"reach", {{"x", reach.x}, {"y", reach.y}, {"width", reach.width}, {"height", reach.height}}},
            {"touched_pixels", touched},
            {"clipped_under_shadow", frame.clipped_under_shadow}};
}

void render(const RenderArguments& arguments, CommandContext& context) {
    const auto start = std::chrono::steady_clock::now();
    Warnings& warnings = context.warnings;
    Scene scene = load_scene(arguments.scene, warnings);
    choose_quality(scene, arguments);
    refuse_input_as_output(arguments.output, scene);
    Solve solve = solve_of_scene(scene, warnings);
    const std::unique_ptr<FrameSource> source = open_frames(scene, arguments.strict, warnings);

    const OutputRequest request{.path = arguments.output,
                                .settings = scene.output,
                                .overwrite = arguments.overwrite,
                                .first_number = arguments.first_number,
                                .scene = scene.path,
                                .provenance = fmt::format("matchlight {}\n{}", version, scene.effective_toml)};
    const OutputLock lock(request.path);
    if (output_kind(request.path) != OutputKind::video) check_pictures(arguments, request.path, source->info());
    check_masks(arguments, scene, source->info());
    const Overscan overscan = overscan_of(arguments, scene, solve.camera);
    const std::unique_ptr<FrameOutput> output = open_frame_output(request, source->info(), warnings);
    const std::unique_ptr<GlContext> gl = create_offscreen_context();
    meter_clip(solve, scene, *gl, {.strict = arguments.strict, .quiet = context.quiet}, warnings);
    Compositor compositor(*gl, scene, solve,
                          {.quality = scene.quality,
                           .budget = budget_of_scene(scene, *gl, warnings),
                           .gathered_surface = surface_picture_of_clip(
                               scene, solve, {.strict = arguments.strict, .quiet = context.quiet}, warnings),
                           .layers = output->needs_layers(),
                           .exchange = output->needs_exchange(),
                           .overscan = overscan},
                          warnings);

    const std::int64_t declared = source->info().frame_count;
    const std::int64_t end = arguments.frames.last ? *arguments.frames.last + 1 : declared;
    if (arguments.frames.first > 0) source->seek(arguments.frames.first);
    nlohmann::json frames = nlohmann::json::array();
    std::int64_t without_pose = 0;
    {
        Progress progress("render", std::max<std::int64_t>(0, end - arguments.frames.first), context.quiet);
        while (std::optional<PlateFrame> plate = source->next()) {
            if (arguments.frames.is_past(plate->index())) break;
            const SolvedFrame* solved = solve.find(plate->index());
            if (solved == nullptr || !solved->camera_from_world) ++without_pose;
            const CompositedFrame frame = compositor.composite(std::move(*plate));
            output->write(frame, compositor);
            if (!arguments.touched_masks.empty()) {
                write_png8(numbered(arguments.touched_masks, frame.plate.index() + arguments.first_number),
                           whole_frame_mask(frame));
            }
            frames.push_back(frame_json(frame));
            progress.advance();
            if (stop_requested()) {
                throw InputError(request.path, frame.plate.index(), "stopped by a signal after this frame");
            }
        }
    }
    if (frames.empty()) {
        throw InputError(source->info().path, fmt::format("has no frame {} to render", arguments.frames.first));
    }
    output->finish();
    if (without_pose > 0) {
        warnings.add(fmt::format("{}: {} of {} frames have no pose and show the plate alone",
                                 source->info().path.string(), without_pose, frames.size()));
    }
    const double seconds = seconds_since(start);
    const std::string text = fmt::format("{}: {} frames in {:.1f} s", request.path.string(), frames.size(), seconds);
    print_result(context,
                 {{"output", request.path.string()},
                  {"seconds", seconds},
                  {"without_pose", without_pose},
                  {"frames", std::move(frames)}},
                 text);
}

/// Prints what became of every pass of one frame; writes no picture.
void explain(const RenderArguments& arguments, CommandContext& context) {
    Scene scene = load_scene(arguments.scene, context.warnings);
    choose_quality(scene, arguments);
    Solve solve = solve_of_scene(scene, context.warnings);
    const std::unique_ptr<FrameSource> source = open_frames(scene, arguments.strict, context.warnings);
    source->seek(*arguments.explain);
    std::optional<PlateFrame> plate = source->next();
    if (!plate || plate->index() != *arguments.explain) {
        throw InputError(source->info().path, fmt::format("has no frame {}", *arguments.explain));
    }
    const std::unique_ptr<GlContext> gl = create_offscreen_context();
    meter_clip(solve, scene, *gl, {.strict = arguments.strict, .quiet = context.quiet}, context.warnings);
    Compositor compositor(*gl, scene, solve,
                          {.quality = scene.quality,
                           .budget = budget_of_scene(scene, *gl, context.warnings),
                           .gathered_surface = surface_picture_of_clip(
                               scene, solve, {.strict = arguments.strict, .quiet = context.quiet}, context.warnings),
                           .timed = true},
                          context.warnings);
    // The first time compiles programs and fills the pool; the second is what a frame costs.
    compositor.composite(*plate);
    compositor.composite(std::move(*plate));
    nlohmann::json passes = nlohmann::json::array();
    const std::vector<PassReport> reports = compositor.reports();
    for (const PassReport& report : reports) {
        const Region& region = report.frame_pixels;
        passes.push_back(
            {{"pass", report.name},
             {"drawn", report.drawn},
             {"why", report.why},
             {"region", {{"x", region.x}, {"y", region.y}, {"width", region.width}, {"height", region.height}}},
             {"ms", report.ms},
             {"bytes", report.bytes},
             {"bandwidth_bounds", report.bandwidth_bounds}});
    }
    print_result(context, {{"frame", *arguments.explain}, {"passes", std::move(passes)}}, pass_table(reports));
}

}  // namespace

void add_render_command(CLI::App& app, CommandContext& context) {
    CLI::App* command = app.add_subcommand("render", "Composite the scene's objects into its footage");
    const auto arguments = std::make_shared<RenderArguments>();
    command->add_option("scene", arguments->scene, "Scene file")->required()->type_name("SCENE.toml");
    CLI::Option* output = command
                              ->add_option("-o,--output", arguments->output,
                                           "Video (.mp4, .mov, .mkv) or pictures (out_%04d.png, out_%04d.exr)")
                              ->type_name("OUT");
    CLI::Option* explained =
        command
            ->add_option("--explain", arguments->explain,
                         "Instead of rendering, print each pass of this frame: drawn or left out and why, its region, "
                         "milliseconds, bytes moved, and how often the time to move them it took")
            ->check(CLI::NonNegativeNumber)
            ->excludes(output)
            ->type_name("FRAME");
    add_frames_option(*command, arguments->frames);
    command->add_flag("--overwrite", arguments->overwrite, "Replace what exists under the output's name");
    command->add_option("--first", arguments->first_number, "Number of frame 0 in picture names (0)")
        ->check(CLI::NonNegativeNumber);
    command
        ->add_option_function<std::string>(
            "--overscan", [arguments](const std::string& text) { arguments->overscan = parse_overscan(text); },
            "Layers go on beyond the frame on each side, by a share of it or by pixels (5%, 64px; .exr only)")
        ->check([](const std::string& text) -> std::string {
            return parse_overscan(text) ? std::string() : "'" + text + "' is not 0% to 100%, or 0px to 4096px";
        })
        ->type_name("N%|PX")
        ->excludes(explained);
    CLI::Option* level = command->add_option("--level", arguments->level, "Quality, instead of the scene's")
                             ->transform(CLI::CheckedTransformer(
                                 std::map<std::string, QualityLevel>(quality_levels.begin(), quality_levels.end())));
    command
        ->add_option("--budget-ms", arguments->budget_ms,
                     "Milliseconds a frame may take, instead of a level (after `report --calibrate-machine`)")
        ->check([](const std::string& text) -> std::string {
            // CLI::Range lets NaN pass.
            double value = 0;
            const bool in_range = CLI::detail::lexical_cast(text, value) && value > 0 && value <= 1e6;
            return in_range ? std::string() : "'" + text + "' is not above 0 and up to 1000000";
        })
        ->excludes(level);
    command->add_option("--touched", arguments->touched_masks,
                        "Also write a mask a frame: white where a pixel is no longer the plate's (touched_%04d.png)");
    command->add_flag("--strict", arguments->strict, "Damaged or truncated footage is an error, not a warning");
    command->add_flag_callback(
        "--help-scene",
        [] {
            fmt::print("{}\n", scene_schema_text());
            throw CLI::Success();
        },
        "Print every key of the scene file, and exit");
    command->callback([=, &context] {
        if (explained->count() > 0) return explain(*arguments, context);
        if (output->count() == 0) throw CLI::RequiredError("--output or --explain");
        render(*arguments, context);
    });
}

}  // namespace matchlight
