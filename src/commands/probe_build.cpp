// matchlight probe build: photographs of a mirror ball into a light probe.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "calibration/camera.h"
#include "calibration/hdr_merge.h"
#include "commands/photograph_options.h"
#include "commands/probe_commands.h"
#include "commands/probe_options.h"
#include "commands/probe_output.h"
#include "commands/result.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"
#include "lighting/ball_build.h"
#include "lighting/probe_file.h"
#include "lighting/resample.h"
#include "media/exr_file.h"
#include "media/image_io.h"
#include "scene/scene_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct ProbeBuildCall {
    std::vector<std::vector<std::string>> views;
    fs::path camera, rig;
    ProbeOutput output;
    std::string response = "srgb";
    double ball_radius_m = 0;
    std::vector<std::vector<double>> circles;
    std::vector<double> reflectance, place;
    bool no_plane = false, no_sun_from_tags = false, no_deghost = false;
    double camera_deg = 8;
};

std::string lower_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
    return extension;
}

/// The photographs of a view: files, or folders of them.
std::vector<fs::path> photographs_of(const std::vector<std::string>& given) {
    std::vector<fs::path> files;
    for (const std::string& one : given) {
        if (!fs::is_directory(one)) {
            files.emplace_back(one);
            continue;
        }
        std::vector<fs::path> inside;
        for (const auto& entry : fs::directory_iterator(one)) {
            if (entry.is_regular_file()) inside.push_back(entry.path());
        }
        if (inside.empty()) throw InputError(one, "the folder holds no photograph");
        std::ranges::sort(inside);
        files.insert(files.end(), inside.begin(), inside.end());
    }
    return files;
}

/// A view that is merged already: radiance, with `sigma.R` … and `clipped` where the file has them, as `merge` writes.
BallView radiance_view(const fs::path& file, const Camera& camera, Warnings& warnings) {
    BallView view;
    view.name = file;
    view.radiance = read_linear_rgb(file, warnings);
    const int width = view.radiance.width(), height = view.radiance.height();
    view.camera = camera_for_size(camera, width, height, file);
    if (lower_extension(file) != ".exr") return view;
    const ExrFile exr(file);
    if (exr.has_channel(0, "sigma.R")) view.sigma = exr.read(0, {"sigma.R", "sigma.G", "sigma.B"});
    if (exr.has_channel(0, "clipped")) {
        const ImageF flags = exr.read(0, {"clipped"});
        view.clipped = Image8(width, height, 1);
        std::ranges::transform(flags.samples(), view.clipped.samples().begin(),
                               [](float flag) -> std::uint8_t { return flag > 0 ? 255 : 0; });
    }
    return view;
}

/// What every view is read with.
struct ViewReading {
    Camera camera;
    Response response;
    MergeOptions merge;
};

/// One view merged, in units of `scale` times radiance.
BallView merged_view(const std::vector<fs::path>& photographs, const ViewReading& reading, std::optional<double>& scale,
                     Warnings& warnings) {
    const ExposureSeries series = read_exposure_series(photographs, {}, warnings);
    BallView view;
    view.name = photographs.front();
    view.camera = camera_for_size(reading.camera, series.width(), series.height(), photographs.front());
    MergedPhotograph merged = merge_exposures(series, reading.response, reading.merge, warnings);
    if (!scale) scale = merged.exposures[merged.reference];
    for (float& sample : merged.radiance.samples()) sample *= static_cast<float>(*scale);
    for (float& sample : merged.sigma.samples()) sample *= static_cast<float>(*scale);
    view.clipped = Image8(series.width(), series.height(), 1);
    for (int y = 0; y < series.height(); ++y) {
        for (int x = 0; x < series.width(); ++x) {
            const std::uint8_t* flags = merged.flags.pixel(x, y);
            if (((flags[0] | flags[1] | flags[2]) & merge_flag::clipped) != 0) view.clipped.at(x, y) = 255;
        }
    }
    view.radiance = std::move(merged.radiance);
    view.sigma = std::move(merged.sigma);
    return view;
}

/// sigma, seen and clipped side by side, as EXR files keep them.
ImageF known_of(const BallProbe& probe) {
    ImageF known(probe.radiance.width(), probe.radiance.height(), 3);
    for (int y = 0; y < known.height(); ++y) {
        for (int x = 0; x < known.width(); ++x) {
            known.at(x, y, 0) = probe.sigma.at(x, y);
            known.at(x, y, 1) = probe.seen.at(x, y);
            known.at(x, y, 2) = probe.clipped.at(x, y);
        }
    }
    return known;
}

std::string place_text(const Eigen::Vector3d& place_m) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", place_m.x(), place_m.y(), place_m.z());
}

json result_json(const ProbeBuildCall& call, const BallBuild& build, const ProbeLayout& layout, double scale) {
    json result{{"file", call.output.path.string()},
                {"width", layout.width},
                {"height", layout.height},
                {"mapping", name_of(layout.mapping)},
                {"place_m", rgb_json(build.place_m)},
                {"exposure_scale", scale},
                {"coverage", build.probe.coverage},
                {"clipped_share", build.probe.clipped_share},
                {"ball",
                 {{"centre_m", rgb_json(build.ball.centre_m)},
                  {"radius_m", build.ball.radius_m},
                  {"reflectance", rgb_json(build.reflectance)},
                  {"reflectance_by", build.reflectance_by}}},
                {"tags", build.tags},
                {"plane", build.plane_used},
                {"views", json::array()}};
    if (build.fit) {
        result["ball"]["residual_ev"] = build.fit->residual;
        result["ball"]["points"] = build.fit->points;
        result["ball"]["outline_off_px"] = build.fit->outline_off_px;
    }
    result["clipped_lights"] = json::array();
    for (const ClippedLight& light : build.clipped_lights) {
        result["clipped_lights"].push_back({{"direction", rgb_json(light.direction)},
                                            {"azimuth_deg", azimuth_deg(light.direction)},
                                            {"elevation_deg", elevation_deg(light.direction)},
                                            {"solid_angle_sr", light.solid_angle_sr},
                                            {"gain", rgb_json(light.gain)},
                                            {"relative_sigma", rgb_json(light.sigma)}});
    }
    for (const BallView& view : build.views) {
        const Eigen::Vector2d centre = view.camera.pixel_from_camera(view.outline.axis);
        result["views"].push_back({{"first", view.name.string()},
                                   {"eye_m", rgb_json(view.eye_m())},
                                   {"rig_correlation", view.rig_correlation},
                                   {"pose_from_ball", view.pose_from_ball},
                                   {"outline",
                                    {{"centre_px", {centre.x(), centre.y()}},
                                     {"radius_px", view.outline.radius_px(view.camera)},
                                     {"rms_px", view.outline.rms_px},
                                     {"support", view.outline.support},
                                     {"significance", view.outline.significance}}}});
    }
    return result;
}

std::string result_text(const ProbeBuildCall& call, const BallBuild& build, const ProbeLayout& layout) {
    std::string text =
        fmt::format("{}: {} x {} pixels, {}, {:.1f} % of the sphere photographed", call.output.path.string(),
                    layout.width, layout.height, name_of(layout.mapping), 100 * build.probe.coverage);
    if (build.probe.clipped_share > 0) {
        text +=
            fmt::format(", {:.3g} % of it brighter than the shortest exposure holds", 100 * build.probe.clipped_share);
    }
    text += '\n';
    for (const BallView& view : build.views) {
        const Eigen::Vector2d centre = view.camera.pixel_from_camera(view.outline.axis);
        text += fmt::format("  {}: ball at ({:.2f}, {:.2f}) px, radius {:.2f} px, edges on {:.0f} % of its outline",
                            view.name.filename().string(), centre.x(), centre.y(), view.outline.radius_px(view.camera),
                            100 * view.outline.support);
        if (!build.tags.empty()) text += fmt::format("; camera at ({}) m", place_text(view.eye_m()));
        text += '\n';
    }
    if (!build.tags.empty()) text += fmt::format("  ball at ({}) m", place_text(build.ball.centre_m));
    if (build.fit) {
        text += fmt::format(", by {} points of the tags' plane and their mirror images, within {:.2f} EV",
                            build.fit->points, build.fit->residual);
    }
    if (!build.tags.empty()) text += '\n';
    text += fmt::format("  reflectance {:.3f} {:.3f} {:.3f}, {}\n", build.reflectance.x(), build.reflectance.y(),
                        build.reflectance.z(), build.reflectance_by);
    for (const ClippedLight& light : build.clipped_lights) {
        text += fmt::format(
            "  clipped light at azimuth {:.1f}°, elevation {:.1f}°: by the tags' paper {:.2f} {:.2f} {:.2f} times what "
            "was "
            "photographed, within {:.0f} %\n",
            azimuth_deg(light.direction), elevation_deg(light.direction), light.gain.x(), light.gain.y(),
            light.gain.z(), 100 * light.sigma.maxCoeff());
    }
    return text;
}

BallBuildOptions build_options(const ProbeBuildCall& call, Warnings& warnings) {
    BallBuildOptions options;
    options.ball_radius_m = call.ball_radius_m;
    options.plane = !call.no_plane;
    options.sun_from_tags = !call.no_sun_from_tags;
    options.camera_deg = call.camera_deg;
    for (const auto& circle : call.circles) options.circles.push_back({{circle[0], circle[1]}, circle[2]});
    if (!call.reflectance.empty()) {
        const auto& r = call.reflectance;
        if (r.size() != 1 && r.size() != 3) throw InputError({}, "--reflectance takes one number or three");
        options.reflectance = r.size() == 1 ? Eigen::Vector3d::Constant(r[0]) : Eigen::Vector3d(r[0], r[1], r[2]);
        if (!(options.reflectance->minCoeff() > 0 && options.reflectance->maxCoeff() <= 1)) {
            throw InputError({}, "a reflectance is above 0 and at most 1", "0.6 is usual for chrome, 0.9 for silver");
        }
    }
    if (!call.rig.empty()) {
        const Scene scene = load_scene(call.rig, warnings);
        if (scene.tags.rig.empty()) throw InputError(call.rig, "has no [tags] rig", "list the tags beside the ball");
        options.tags = scene.tags;
        if (scene.probe) options.place_m = scene.probe->place_m;
    }
    if (!call.place.empty()) options.place_m = Eigen::Vector3d(call.place[0], call.place[1], call.place[2]);
    return options;
}

void run_build(const ProbeBuildCall& call, CommandContext& context) {
    require_probe_extension(call.output.path);
    check_output(call.output.path, call.output.overwrite);
    if (!(call.ball_radius_m > 0 && std::isfinite(call.ball_radius_m)))
        throw InputError({}, fmt::format("a ball's radius of {} m", call.ball_radius_m), "give it in metres: 0.035");
    const OutputLock lock(call.output.path);
    ViewReading reading{load_camera(call.camera), response_of(call.response), {}};
    reading.merge.deghost = !call.no_deghost;
    BallBuildOptions options = build_options(call, context.warnings);

    std::optional<double> scale;
    std::vector<BallView> views;
    std::vector<std::string> sources;
    for (const auto& given : call.views) {
        const std::vector<fs::path> files = photographs_of(given);
        check_not_an_input(call.output.path, files);
        for (const fs::path& file : files) sources.push_back(file.filename().string());
        const bool merged =
            files.size() == 1 && (lower_extension(files.front()) == ".exr" || lower_extension(files.front()) == ".hdr");
        views.push_back(merged ? radiance_view(files.front(), reading.camera, context.warnings)
                               : merged_view(files, reading, scale, context.warnings));
    }
    const BallBuild build = build_ball_probe(std::move(views), options, context.warnings);
    const double off_m = (build.place_m - build.ball.centre_m).norm();
    if (off_m > 3 * build.ball.radius_m) {
        context.warnings.add(
            fmt::format("{}: the probe's place lies {:.3f} m from the ball: only what lies on the "
                        "tags' plane is seen from there, the rest from the ball",
                        call.output.path.string(), off_m));
    }

    const ProbeLayout natural = layout_of_size(ProbeMapping::latlong, build.probe.radiance.height());
    int size = call.output.size_px;
    if (size == 0)
        size = size_for_latlong(call.output.to, natural.height);
    else if (call.output.to == ProbeMapping::latlong)
        size = std::max(1, size / 2);
    const ProbeLayout layout = layout_of_size(call.output.to, size, call.output.cube);
    const ImageF image = resample(build.probe.radiance, natural, layout);
    const ImageF known = resample(known_of(build.probe), natural, layout);
    write_probe_image(
        call.output.path, image, layout,
        {{"software", std::string("matchlight ") + version},
         {"place_m", place_text(build.place_m)},
         {"ball_centre_m", place_text(build.ball.centre_m)},
         {"ball_radius_m", fmt::format("{}", build.ball.radius_m)},
         {"orientation", build.tags.empty() ? std::string("the first photographer's: +y his forward, +z up")
                                            : fmt::format("the rig's: tags {}", fmt::join(build.tags, " "))},
         {"rotation_deg", "0"},
         {"exposure_scale", fmt::format("{}", scale.value_or(1))},
         {"coverage", fmt::format("{}", build.probe.coverage)},
         {"source", fmt::format("{}", fmt::join(sources, " "))}},
        {{"sigma", "seen", "clipped"}, known});
    print_result(context, result_json(call, build, layout, scale.value_or(1)), result_text(call, build, layout));
}

}  // namespace

void add_probe_build_command(CLI::App& probe, CommandContext& context) {
    CLI::App* command = probe.add_subcommand(
        "build", "Photographs of a mirror ball into a probe, oriented by the tags in them, without camera and rim");
    const auto call = std::make_shared<ProbeBuildCall>();
    command
        ->add_option("--view", call->views,
                     "Bracketed photographs of the ball from one camera place (files or a folder), exposures by EXIF, "
                     "or one .exr or .hdr of them merged; again for each further place")
        ->required()
        ->expected(1, 1000)
        ->type_name("PHOTOS");
    command->add_option("--camera", call->camera, "The lens they were taken with: camera.yaml")
        ->required()
        ->type_name("FILE");
    command->add_option("--ball-radius", call->ball_radius_m, "The ball's radius")->required()->type_name("METRES");
    command
        ->add_option("--rig", call->rig,
                     "A scene whose [tags] lie beside the ball: the probe takes their axes, and [light] place, if any, "
                     "is the place it is made for (default: the photographer's axes, the ball's centre)")
        ->type_name("SCENE");
    add_probe_file_options(*command, call->output);
    command
        ->add_option("--response", call->response,
                     "The camera's curve: a response.json, srgb (default), linear or gamma=2.2; raw files need none")
        ->type_name("FILE|FAMILY");
    command
        ->add_option("--circle", call->circles,
                     "The ball in the photographs, by hand, once for each --view: x,y,radius in pixels")
        ->delimiter(',')
        ->expected(3)
        ->type_name("X,Y,R");
    command
        ->add_option("--reflectance", call->reflectance,
                     "Share of light the ball reflects head on, one number or r,g,b (default: measured by the tags' "
                     "plane and its mirror image)")
        ->delimiter(',')
        ->type_name("SHARE");
    command->add_option("--place", call->place, "The place the probe is made for, world x,y,z (default: see --rig)")
        ->delimiter(',')
        ->expected(3)
        ->check(within(1e6))
        ->type_name("METRES");
    command->add_flag("--no-plane", call->no_plane,
                      "Take everything as far away, also what lies on the tags' plane, with the ball's shadow on it");
    command->add_flag("--no-sun-from-tags", call->no_sun_from_tags,
                      "Leave lights that every photograph clips as they were photographed, too dark");
    command
        ->add_option("--camera-deg", call->camera_deg,
                     "Leave out this much around a view's own camera where another view shows it (default: 8)")
        ->check(CLI::Range(0.0, 60.0).description(""))
        ->type_name("DEGREES");
    command->add_flag("--no-deghost", call->no_deghost, "Merge also what differs between the photographs of a view");
    command->callback([call, &context] { run_build(*call, context); });
}

}  // namespace matchlight
