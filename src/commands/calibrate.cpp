// matchlight calibrate: a lens from pictures of a board, and camera files from one format to another.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "calibration/board_search.h"
#include "calibration/camera_formats.h"
#include "calibration/lens_calibration.h"
#include "calibration/lens_comparison.h"
#include "calibration/lens_page.h"
#include "commands/command.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

enum class ModelChoice { any, radtan2, radtan3, radtan4, radtan5, radtan6, fisheye };

struct CalibrateCall {
    std::vector<fs::path> inputs;
    std::string board;
    fs::path output;
    std::optional<fs::path> from, report;
    ModelChoice model = ModelChoice::any;
    CameraFormat format = CameraFormat::opencv;
    std::optional<std::size_t> views;
    bool no_report = false, against_opencv = false, overwrite = false, strict = false;
};

LensOptions lens_options(const CalibrateCall& call) {
    LensOptions options;
    const int terms = static_cast<int>(call.model) - static_cast<int>(ModelChoice::radtan2) + 2;
    if (call.model == ModelChoice::fisheye) {
        options.lens = LensModel::fisheye;
    } else if (call.model != ModelChoice::any) {
        options.lens = LensModel::radtan;
        options.least_radial_terms = options.most_radial_terms = terms;
    }
    if (call.format == CameraFormat::kalibr) {
        if (options.lens == LensModel::radtan && terms > 2) {
            throw InputError(call.output, "Kalibr's camera file holds two radial terms only",
                             "use --model radtan2, fisheye or auto, or another --format");
        }
        options.most_radial_terms = 2;
    }
    return options;
}

/// Where the page goes: beside the camera file, in a folder, or to a name of its own.
std::optional<fs::path> page_of(const CalibrateCall& call) {
    if (call.no_report) return std::nullopt;
    if (!call.report) return fs::path(call.output).replace_extension(".html");
    const std::string extension = call.report->extension().string();
    if (extension == ".html" || extension == ".htm") return call.report;
    return *call.report / "index.html";
}

json camera_json(const Camera& camera) {
    return {{"width", camera.width},
            {"height", camera.height},
            {"fx", camera.fx},
            {"fy", camera.fy},
            {"cx", camera.cx},
            {"cy", camera.cy},
            {"lens", camera.lens == LensModel::fisheye ? "fisheye" : "radtan"},
            {"distortion", camera.distortion}};
}

json result_json(const CalibrateCall& call, const BoardSearch& search, const LensCalibration& calibration,
                 const std::vector<ComparedCalibration>& compared) {
    json result{{"camera", call.output.string()},
                {"model", calibration.fit.candidate.lens_name()},
                {"board", board_spec_text(calibration.data.board)},
                {"looked_at", search.looked_at},
                {"with_board", search.with_board},
                {"rms_px", calibration.fit.rms_px},
                {"held_out_rms_px", calibration.held_out_px},
                {"pixel_sigma_px", {{"mean", calibration.pixels.rms_px}, {"worst", calibration.pixels.worst_px}}},
                {"coverage", calibration.coverage},
                {"distinct_views", calibration.distinct_views},
                {"dropped_corners", calibration.dropped_corners},
                {"dropped_views", calibration.dropped_views},
                {"parameters", json::object()},
                {"views", json::array()},
                {"candidates", json::array()}};
    result.update(camera_json(calibration.camera));
    for (const ParameterEstimate& p : calibration.parameters) {
        result["parameters"][p.name] = {{"value", p.value},
                                        {"sigma", p.sigma},
                                        {"sigma_of_noise", p.sigma_of_noise},
                                        {"sigma_of_views", p.sigma_of_views}};
    }
    if (!calibration.bend_sigma_m.empty()) {
        result["board_bend_m"] = calibration.fit.bend_m;
        result["board_bend_sigma_m"] = calibration.bend_sigma_m;
    }
    for (std::size_t v = 0; v < calibration.data.views.size(); ++v) {
        const LensView& view = calibration.data.views[v];
        result["views"].push_back({{"name", view.name},
                                   {"number", view.number},
                                   {"corners", view.corners.size()},
                                   {"rms_px", calibration.view_rms_px[v]},
                                   {"tilt_deg", calibration.view_tilt_deg[v]}});
    }
    for (const CandidateScore& score : calibration.candidates) {
        result["candidates"].push_back({{"model", score.candidate.lens_name()},
                                        {"bent_board", score.candidate.bent_board},
                                        {"parameters", score.candidate.parameter_count()},
                                        {"rms_px", score.fit.rms_px},
                                        {"held_out_rms_px", score.held_out_px},
                                        {"excess_px2", score.excess_px2},
                                        {"excess_error_px2", score.excess_error_px2},
                                        {"folds", !score.reaches_corners},
                                        {"chosen", score.chosen}});
    }
    for (const ComparedCalibration& other : compared) {
        result["compared"].push_back({{"name", other.name},
                                      {"rms_px", other.rms_px},
                                      {"held_out_rms_px", other.held_out_px},
                                      {"camera", camera_json(other.camera)}});
    }
    return result;
}

std::string result_text(const CalibrateCall& call, const BoardSearch& search, const LensCalibration& calibration,
                        const std::vector<ComparedCalibration>& compared) {
    std::string text = fmt::format("{}: {}, {}×{} pixels, from {} views of {} {} ({} show the board)\n",
                                   call.output.string(), calibration.fit.candidate.name(), calibration.data.width,
                                   calibration.data.height, calibration.data.views.size(), search.looked_at,
                                   search.is_video ? "frames" : "photographs", search.with_board);
    text += fmt::format(
        "corners lie {:.3f} px from where the lens has them, {:.3f} px in views left out; a pixel is known to {:.2g} "
        "px, "
        "at worst {:.2g}\n",
        calibration.fit.rms_px, calibration.held_out_px, calibration.pixels.rms_px, calibration.pixels.worst_px);
    for (const ParameterEstimate& p : calibration.parameters) {
        text += p.sigma > 0 ? fmt::format("  {:<3} {:>12.6g} ± {:.2g}\n", p.name, p.value, p.sigma)
                            : fmt::format("  {:<3} {:>12.6g}\n", p.name, p.value);
    }
    if (search.is_video) {
        std::vector<std::string> frames;
        for (const LensView& view : calibration.data.views) frames.push_back(fmt::format("{}", view.number));
        text += fmt::format("frames: {}\n", fmt::join(frames, " "));
    }
    for (const ComparedCalibration& other : compared) {
        text +=
            fmt::format("  {:<26} rms {:.4f} px, held out {:.4f} px\n", other.name, other.rms_px, other.held_out_px);
    }
    if (!compared.empty()) {
        text += fmt::format("  {:<26} rms {:.4f} px, held out {:.4f} px\n", "Matchlight", calibration.fit.rms_px,
                            calibration.held_out_px);
    }
    return text;
}

void warn_of_losses(const CalibrateCall& call, const Camera& camera, CommandContext& context) {
    for (const std::string& lost : lost_in(call.format, camera)) {
        context.warnings.add(fmt::format("{}: this format cannot hold {}", call.output.string(), lost));
    }
}

void run_conversion(const CalibrateCall& call, CommandContext& context) {
    std::error_code error;
    if (fs::equivalent(*call.from, call.output, error)) {
        throw InputError(call.output, "the output is the input", "give another name");
    }
    const Camera camera = load_camera(*call.from);
    check_output(call.output, call.overwrite);
    const OutputLock lock(call.output);
    write_text_file(call.output, camera_text(camera, call.format, call.output));
    warn_of_losses(call, camera, context);
    json result = camera_json(camera);
    result["camera"] = call.output.string();
    print_result(context, result,
                 fmt::format("{}: {}×{} pixels, fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g}", call.output.string(),
                             camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy));
}

LensCalibration calibrate_views(const CalibrateCall& call, const LensData& data, const LensOptions& options,
                                CommandContext& context) {
    try {
        return calibrate_lens(data, options, context.warnings);
    } catch (const InputError& error) {
        InputErrorParts parts = error.parts();
        if (parts.file.empty()) parts.file = call.inputs.front();  // the views know nothing of files
        throw InputError(parts);
    }
}

void run_calibration(const CalibrateCall& call, CommandContext& context) {
    const BoardSpec board = read_board(call.board);
    const LensOptions options = lens_options(call);
    check_output(call.output, call.overwrite);
    const OutputLock lock(call.output);
    const std::optional<fs::path> page = page_of(call);
    if (page) {
        if (call.report && page->filename() == "index.html") {
            std::error_code error;
            fs::create_directories(*call.report, error);
            if (error) throw InputError(*call.report, "cannot be made (" + error.message() + ")");
        }
        check_output(*page, call.overwrite);
    }

    BoardSearchOptions searching;
    searching.inputs = call.inputs;
    searching.most_views = call.views;
    searching.strict = call.strict;
    searching.quiet = context.quiet;
    searching.as_opencv = call.against_opencv;
    const BoardSearch search = find_boards(board, searching, context.warnings);
    const LensCalibration calibration = calibrate_views(call, search.data, options, context);
    std::vector<ComparedCalibration> compared;
    if (call.against_opencv) compared = compare_with_opencv(calibration);

    CalibrationNotes notes;
    notes.model = calibration.fit.candidate.lens_name();
    notes.board = board_spec_text(board);
    notes.views = static_cast<int>(calibration.data.views.size());
    for (const LensView& view : calibration.data.views) notes.corners += static_cast<int>(view.corners.size());
    notes.rms_px = calibration.fit.rms_px;
    notes.held_out_rms_px = calibration.held_out_px;
    notes.pixel_sigma_px = calibration.pixels.rms_px;
    const std::string text = camera_text(calibration.camera, call.format, call.output, notes);
    if (page) {
        LensPageContext about;
        about.source = search.is_video
                           ? fmt::format("{}, {} frames", call.inputs.front().filename().string(), search.looked_at)
                           : fmt::format("{} photographs", search.looked_at);
        about.compared = compared;
        write_text_file(*page, lens_page(calibration, about));
    }
    write_text_file(call.output, text);
    warn_of_losses(call, calibration.camera, context);
    json result = result_json(call, search, calibration, compared);
    if (page) result["report"] = page->string();
    print_result(context, result, result_text(call, search, calibration, compared));
}

void run_calibrate(const CalibrateCall& call, CommandContext& context) {
    if (call.from) {
        if (!call.inputs.empty() || !call.board.empty()) {
            throw CLI::ValidationError("--from", "converts a camera file and takes neither pictures nor --board");
        }
        run_conversion(call, context);
        return;
    }
    if (call.inputs.empty()) throw CLI::RequiredError("PICTURES");
    if (call.board.empty()) throw CLI::RequiredError("--board");
    run_calibration(call, context);
}

}  // namespace

void add_calibrate_command(CLI::App& app, CommandContext& context) {
    CLI::App* command =
        app.add_subcommand("calibrate", "The lens, from photographs or a video of a board; camera files converted");
    const auto call = std::make_shared<CalibrateCall>();
    command->add_option("PICTURES", call->inputs,
                        "Photographs, a folder of them, a pattern (\"photo_*.jpg\", photo_%04d.png), or one video");
    command->add_option("--board", call->board, std::string("What was photographed: ") + board_spec_forms)
        ->type_name("SPEC");
    command->add_option("-o,--output", call->output, "Camera file (.yaml)")->required();
    const std::map<std::string, ModelChoice> models{
        {"auto", ModelChoice::any},        {"radtan2", ModelChoice::radtan2}, {"radtan3", ModelChoice::radtan3},
        {"radtan4", ModelChoice::radtan4}, {"radtan5", ModelChoice::radtan5}, {"radtan6", ModelChoice::radtan6},
        {"fisheye", ModelChoice::fisheye}, {"radtan", ModelChoice::radtan3}};
    command
        ->add_option(
            "--model", call->model,
            "The lens: radial terms with tangential ones, or fisheye; auto (default) chooses by views left out")
        ->transform(
            CLI::CheckedTransformer(models).description("{auto,radtan2,radtan3,radtan4,radtan5,radtan6,fisheye}"));
    const std::map<std::string, CameraFormat> formats{
        {"opencv", CameraFormat::opencv}, {"kalibr", CameraFormat::kalibr}, {"ros", CameraFormat::ros}};
    command->add_option("--format", call->format, "Whose camera file to write (default: opencv)")
        ->transform(CLI::CheckedTransformer(formats).description("{opencv,kalibr,ros}"));
    command
        ->add_option("--from", call->from,
                     "Convert this camera file (OpenCV's, Kalibr's or ROS') and calibrate nothing")
        ->type_name("FILE");
    command
        ->add_option("--views", call->views,
                     "At most so many views are used, well spread (default: all photographs, 40 frames of a video)")
        ->check(CLI::Range(4, 1000));
    command
        ->add_option("--report", call->report,
                     "Folder or .html file for the page (default: beside the camera file, under its name)")
        ->type_name("DIR");
    command->add_flag("--no-report", call->no_report, "No page");
    command->add_flag("--against-opencv", call->against_opencv,
                      "Also calibrate with OpenCV's own function, and compare on views left out");
    command->add_flag("--overwrite", call->overwrite, "Replace files that exist");
    command->add_flag("--strict", call->strict, "A damaged or truncated video is an error");
    command->callback([call, &context] { run_calibrate(*call, context); });
}

}  // namespace matchlight
