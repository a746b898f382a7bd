// matchlight export: the solved camera, and the lens, in other programs' files.
#include <algorithm>
#include <array>
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
#include <nlohmann/json.hpp>

#include "calibration/camera.h"
#include "commands/command.h"
#include "commands/frame_range.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/lowercase.h"
#include "core/output_folder.h"
#include "core/version.h"
#include "exchange/camera_table.h"
#include "exchange/camera_track.h"
#include "exchange/colmap_text.h"
#include "exchange/gltf_camera.h"
#include "exchange/nuke_chan.h"
#include "exchange/stmap.h"
#include "exchange/usd_camera.h"
#include "media/image_io.h"
#include "tracking/solve_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

enum class Format { chan, gltf, glb, usd, csv, colmap };
enum class StmapWay { undistort, redistort };

const std::map<std::string, Format> formats_by_name{{"chan", Format::chan}, {"gltf", Format::gltf},
                                                    {"glb", Format::glb},   {"usd", Format::usd},
                                                    {"csv", Format::csv},   {"colmap", Format::colmap}};

struct ExportCall {
    fs::path input, output;
    std::optional<Format> format;
    std::optional<StmapWay> stmap;
    std::string overscan = "auto";
    std::string image_names;
    FrameRange frames;
    CameraTrackOptions track;
    bool overwrite = false;

    std::optional<double> overscan_factor() const {
        if (overscan == "auto") return std::nullopt;
        return std::stod(overscan);
    }
};

Format format_of(const ExportCall& call) {
    if (call.format) return *call.format;
    const std::string extension = lowercase_extension(call.output);
    static const std::map<std::string, Format> by_extension{
        {".chan", Format::chan}, {".gltf", Format::gltf}, {".glb", Format::glb}, {".usda", Format::usd},
        {".usd", Format::usd},   {".csv", Format::csv},   {"", Format::colmap}};
    const auto found = by_extension.find(extension);
    if (found != by_extension.end()) return found->second;
    std::string cure = "give .chan, .gltf, .glb, .usda, .csv, or a folder for COLMAP's text files; or --format";
    if (extension == ".exr") cure = "an STMap of the lens is asked for by --stmap undistort or --stmap redistort";
    if (extension == ".abc" || extension == ".fbx" || extension == ".dae") {
        cure = "Debian has no library that writes animated cameras so: the programs that read it read .usda or .gltf";
    }
    throw InputError(call.output, fmt::format("no camera file has the extension \"{}\"", printable(extension)), cure);
}

/// Whether the file is a calibration: OpenCV's YAML or XML.
bool is_camera_file(const fs::path& path) {
    const std::string extension = lowercase_extension(path);
    return extension == ".yaml" || extension == ".yml" || extension == ".xml";
}

/// Throws InputError where the output would replace what it is made from.
void check_not_the_input(const ExportCall& call) {
    std::error_code error;
    if (fs::equivalent(call.input, call.output, error)) {
        throw InputError(call.output, "the output is the input", "give another name");
    }
}

void write_stmap(const ExportCall& call, CommandContext& context) {
    if (lowercase_extension(call.output) != ".exr") {
        throw InputError(call.output, "an STMap is an .exr file", "give a name that ends in .exr");
    }
    check_output(call.output, call.overwrite);
    const OutputLock lock(call.output);
    const Camera camera = is_camera_file(call.input) ? load_camera(call.input) : load_solve(call.input).camera;
    // 32 bits for each of three channels: 3 GiB.
    constexpr double most_pixels = 256 * 1024.0 * 1024.0;
    const double factor = call.overscan_factor().value_or(1);
    const auto check_size = [&](double width, double height) {
        if (width * height <= most_pixels) return;
        throw InputError(call.output, fmt::format("a map of {:.0f} x {:.0f} pixels is too large", width, height),
                         "give a smaller --overscan");
    };
    check_size(camera.width * factor, camera.height * factor);
    const UndistortedPicture picture = undistorted_picture(camera, call.overscan_factor(), call.track.centred);
    const PinholePicture& pinhole = picture.pinhole;
    check_size(pinhole.width, pinhole.height);

    const bool undistort = *call.stmap == StmapWay::undistort;
    const Stmap stmap = undistort ? undistort_map(camera, picture) : redistort_map(camera, picture);
    if (picture.uncovered > 0) {
        context.warnings.add(
            fmt::format("{}: the undistorted picture of {} x {} pixels leaves out {} pixels of the plate{}",
                        call.input.string(), pinhole.width, pinhole.height, picture.uncovered,
                        call.overscan_factor() ? ": --overscan auto holds all that the lens model reaches" : ""));
    }
    const std::string picture_text = fmt::format(
        "{} x {} pixels, focal length {:.9g} {:.9g} px, principal point {:.9g} {:.9g} px (centres at whole "
        "numbers, from the top left), the plate's frame {} {} px from the left and the top",
        pinhole.width, pinhole.height, pinhole.fx, pinhole.fy, pinhole.cx, pinhole.cy, picture.margin_x,
        picture.margin_y);
    write_exr(call.output, stmap.map.width(), stmap.map.height(), {{"stmap", {"R", "G", "B"}, &stmap.map, false, {}}},
              {{"software", std::string("matchlight ") + version},
               {"source", call.input.filename().string()},
               {"stmap", undistort ? "undistort" : "redistort"},
               {"undistorted_picture", picture_text}});
    const json result{{"file", call.output.string()},
                      {"stmap", undistort ? "undistort" : "redistort"},
                      {"width", stmap.map.width()},
                      {"height", stmap.map.height()},
                      {"unreachable_pixels", stmap.unreachable},
                      {"undistorted",
                       {{"width", pinhole.width},
                        {"height", pinhole.height},
                        {"fx", pinhole.fx},
                        {"fy", pinhole.fy},
                        {"cx", pinhole.cx},
                        {"cy", pinhole.cy},
                        {"margin_px", {picture.margin_x, picture.margin_y}},
                        {"overscan", picture.overscan},
                        {"uncovered_plate_pixels", picture.uncovered}}}};
    print_result(
        context, result,
        fmt::format("{}: {} x {} pixels, {} of them unreachable\n  the undistorted picture: {}\n", call.output.string(),
                    stmap.map.width(), stmap.map.height(), stmap.unreachable, picture_text));
}

/// What a format leaves out of the camera.
CameraLimits limits_of(Format format) {
    switch (format) {
        case Format::chan:
            return {.offset = false, .pixel_aspect = false, .distortion = false};
        case Format::gltf:
        case Format::glb:
            return {.offset = false, .pixel_aspect = true, .distortion = false};
        case Format::usd:
            return {.offset = true, .pixel_aspect = true, .distortion = false};
        case Format::csv:
        case Format::colmap:
            break;
    }
    return {.offset = true, .pixel_aspect = true, .distortion = true};
}

std::string camera_file_text(Format format, const CameraTrack& track) {
    switch (format) {
        case Format::chan:
            return nuke_chan_text(track);
        case Format::gltf:
            return gltf_camera_text(track);
        case Format::glb:
            return glb_camera_bytes(track);
        case Format::usd:
            return usd_camera_text(track);
        case Format::csv:
        case Format::colmap:
            break;
    }
    return camera_table_csv(track);
}

/// "clip_%06d.png" for "clip.mp4"; an image sequence's own names.
std::string default_image_names(const std::string& footage) {
    const fs::path path(footage);
    if (is_pattern(path)) return path.filename().string();
    std::string stem = path.stem().string();
    // A space would end the name in COLMAP's file, a percent sign start another number.
    std::ranges::replace_if(
        stem, [](char c) { return c == ' ' || c == '%' || c == '\n' || c == '\r' || c == '\t'; }, '_');
    return (stem.empty() ? "frame" : stem) + "_%06d.png";
}

void write_camera(const ExportCall& call, CommandContext& context) {
    const Format format = format_of(call);
    if (is_camera_file(call.input)) {
        throw InputError(call.input, "a calibration holds no poses", "give a solve; of a lens alone: --stmap");
    }
    std::optional<OutputFolder> folder;
    std::optional<OutputLock> lock;
    if (format == Format::colmap) {
        folder.emplace(call.output, colmap_file_names(), call.overwrite);
    } else {
        check_output(call.output, call.overwrite);
        lock.emplace(call.output);
    }
    const Solve solve = load_solve(call.input);
    CameraTrackOptions options = call.track;
    options.first_frame = call.frames.first;
    options.last_frame = call.frames.last;
    const CameraTrack track = camera_track(solve, options, call.input, context.warnings);
    const std::vector<std::string> lost = what_is_lost(track, limits_of(format));
    if (folder) {
        const std::string names = call.image_names.empty() ? default_image_names(solve.footage_file) : call.image_names;
        folder->write(colmap_texts(track, names, call.input));
    } else {
        write_text_file(call.output, camera_file_text(format, track));
    }
    for (const std::string& text : lost) context.warnings.add(call.output.string() + ": " + text);

    const auto name = std::ranges::find_if(formats_by_name, [&](const auto& entry) { return entry.second == format; });
    const json result{{"file", call.output.string()}, {"format", name->first}, {"frames", track.frames.size()},
                      {"posed", track.posed()},       {"fps", track.fps},      {"left_out", lost}};
    print_result(context, result,
                 fmt::format("{}: {} frames with a pose of {}, {:.6g} frames a second\n", call.output.string(),
                             track.posed(), track.frames.size(), track.fps));
}

/// CLI::Range lets NaN pass.
CLI::Validator number_within(double low, double high) {
    return {[low, high](const std::string& text) {
                double value = 0;
                const bool fine = CLI::detail::lexical_cast(text, value) && value >= low && value <= high;
                return fine ? std::string() : fmt::format("'{}' is not a number from {} to {}", text, low, high);
            },
            ""};
}

CLI::Validator overscan_value() {
    return {[](const std::string& text) {
                return text == "auto" ? std::string() : number_within(1, largest_overscan)(std::string(text));
            },
            ""};
}

void add_output_options(CLI::App& command, ExportCall& call) {
    command.add_option("SOLVE", call.input, "Solve file (.solve.json); for --stmap also a camera file (.yaml)")
        ->required();
    command
        .add_option("-o,--output", call.output,
                    ".chan (Nuke), .gltf or .glb, .usda, .csv, .exr (with --stmap), or a folder (COLMAP's text files)")
        ->required();
    command
        .add_option("--format", call.format,
                    "Instead of what the output's extension says: chan, gltf, glb, usd, csv, colmap")
        ->transform(CLI::CheckedTransformer(formats_by_name).description(""))
        ->type_name("FORMAT");
    command.add_flag("--overwrite", call.overwrite, "Replace files that exist");
}

void add_camera_options(CLI::App& command, ExportCall& call) {
    add_frames_option(command, call.frames);
    command.add_option("--first", call.track.first_number, "Number of frame 0 in the other program (0)")
        ->check(CLI::Range(std::int64_t{-1000000000}, std::int64_t{1000000000}).description(""));
    command.add_option("--fps", call.track.fps, "Frames a second, instead of the footage's time stamps")
        ->check(number_within(0.001, 100000));
    command
        .add_option("--sensor-width-mm", call.track.sensor_width_mm,
                    "Sensor's width that focal length and f-number are written for (36)")
        ->check(number_within(0.001, 10000));
    command.add_flag("--centred", call.track.centred,
                     "A camera with its principal point in the middle and square pixels, for programs that hold no "
                     "other; it fits plates undistorted by an STMap made with --centred");
    command
        .add_option("--image-names", call.image_names,
                    "Names of the pictures in COLMAP's files (the footage's name and _%06d.png)")
        ->type_name("PATTERN");
}

void add_stmap_options(CLI::App& command, ExportCall& call) {
    static const std::map<std::string, StmapWay> ways{{"undistort", StmapWay::undistort},
                                                      {"redistort", StmapWay::redistort}};
    command
        .add_option(
            "--stmap", call.stmap,
            "Write an STMap of the lens instead of the camera: undistort makes a straight picture of the plate, "
            "redistort a plate of the straight picture")
        ->transform(CLI::CheckedTransformer(ways).description(""))
        ->type_name("undistort|redistort");
    command
        .add_option("--overscan", call.overscan,
                    fmt::format("Size of the straight picture over the plate's, 1 to {:g}; auto: all of the plate fits "
                                "in (default)",
                                largest_overscan))
        ->check(overscan_value())
        ->type_name("FACTOR|auto");
}

}  // namespace

void add_export_command(CLI::App& app, CommandContext& context) {
    CLI::App* command =
        app.add_subcommand("export", "The camera and its lens for other programs: Nuke, glTF, USD, COLMAP, STMaps");
    const auto call = std::make_shared<ExportCall>();
    add_output_options(*command, *call);
    add_camera_options(*command, *call);
    add_stmap_options(*command, *call);
    command->callback([call, &context] {
        check_not_the_input(*call);
        if (call->stmap && call->format) throw CLI::ExcludesError("--stmap", "--format");
        if (call->stmap) {
            write_stmap(*call, context);
        } else {
            write_camera(*call, context);
        }
    });
}

}  // namespace matchlight
