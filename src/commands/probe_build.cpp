// matchlight probe build: photographs of a mirror ball into a light probe.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
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
#include "commands/ball_photographs.h"
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
#include "lighting/probe_record.h"
#include "lighting/resample.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

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
    std::vector<std::string> diffuse_ball;
    std::vector<double> diffuse_circle, diffuse_albedo;
    bool no_plane = false, no_sun_from_tags = false, no_deghost = false;
    BallParallax parallax = BallParallax::full;
    int samples_a_side = 2;
    double camera_deg = 8;
};

/// sigma, seen, clipped and, where the probe knows any distance, nearness side by side.
ImageF known_of(const BallProbe& probe) {
    ImageF known(probe.radiance.width(), probe.radiance.height(), probe.nearness.empty() ? 3 : 4);
    for (int y = 0; y < known.height(); ++y) {
        for (int x = 0; x < known.width(); ++x) {
            known.at(x, y, 0) = probe.sigma.at(x, y);
            known.at(x, y, 1) = probe.seen.at(x, y);
            known.at(x, y, 2) = probe.clipped.at(x, y);
            if (!probe.nearness.empty()) known.at(x, y, 3) = probe.nearness.at(x, y);
        }
    }
    return known;
}

std::string place_text(const Eigen::Vector3d& place_m) {
    return fmt::format("{:.6g} {:.6g} {:.6g}", place_m.x(), place_m.y(), place_m.z());
}

json view_json(const BallView& view) {
    const Eigen::Vector2d centre = view.camera.pixel_from_camera(view.outline.axis);
    return {{"first", view.name.string()},
            {"eye_m", rgb_json(view.eye_m())},
            {"rig_correlation", view.rig_correlation},
            {"pose_from_ball", view.pose_from_ball},
            {"outline",
             {{"centre_px", {centre.x(), centre.y()}},
              {"radius_px", view.outline.radius_px(view.camera)},
              {"rms_px", view.outline.rms_px},
              {"support", view.outline.support},
              {"significance", view.outline.significance}}}};
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
    result["clipped_lights_by"] = build.clipped_lights_by;
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
        result["views"].push_back(view_json(view));
    }
    if (build.diffuse_view) result["diffuse_ball"] = view_json(*build.diffuse_view);
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
            "  clipped light at azimuth {:.1f}°, elevation {:.1f}°: by {} {:.2f} {:.2f} {:.2f} times what was "
            "photographed, within {:.0f} %\n",
            azimuth_deg(light.direction), elevation_deg(light.direction), build.clipped_lights_by, light.gain.x(),
            light.gain.y(), light.gain.z(), 100 * light.sigma.maxCoeff());
    }
    return text;
}

/// Shares of light, RGB, from one number or three; nullopt where none is given.
std::optional<Eigen::Vector3d> share_of(const std::vector<double>& given, const std::string& option,
                                        const std::string& cure) {
    if (given.empty()) return std::nullopt;
    if (given.size() != 1 && given.size() != 3) throw InputError({}, option + " takes one number or three");
    const Eigen::Vector3d share =
        given.size() == 1 ? Eigen::Vector3d::Constant(given[0]) : Eigen::Vector3d(given[0], given[1], given[2]);
    if (!(share.minCoeff() > 0 && share.maxCoeff() <= 1)) {
        throw InputError({}, option + ": a reflectance is above 0 and at most 1", cure);
    }
    return share;
}

/// All but its view; nullopt where none is given.
std::optional<DiffuseBallOptions> diffuse_options(const ProbeBuildCall& call) {
    if (call.diffuse_ball.empty()) {
        if (call.diffuse_circle.empty() && call.diffuse_albedo.empty()) return std::nullopt;
        throw InputError({}, "--diffuse-circle and --diffuse-albedo say more of --sun-from-diffuse-ball",
                         "name its photographs too");
    }
    DiffuseBallOptions options;
    options.albedo = share_of(call.diffuse_albedo, "--diffuse-albedo", "0.18 is usual for grey, 0.8 for white");
    if (!call.diffuse_circle.empty()) {
        options.circle = {{call.diffuse_circle[0], call.diffuse_circle[1]}, call.diffuse_circle[2]};
    }
    return options;
}

/// Places that the scene leaves open are those that `track` found, if it has: the probe is to turn with the same world.
void take_solved_places(const Scene& scene, TagSettings& tags) {
    const auto open = [](const RigTag& tag) { return !tag.world_from_tag; };
    if (std::ranges::none_of(tags.rig, open) || !fs::exists(scene.footage.solve)) return;
    const Solve solve = load_solve(scene.footage.solve);
    for (RigTag& tag : tags.rig) {
        const auto solved = std::ranges::find(solve.rig, tag.id, &SolvedTag::id);
        if (open(tag) && solved != solve.rig.end()) tag.world_from_tag = solved->world_from_tag;
    }
}

BallBuildOptions build_options(const ProbeBuildCall& call, Warnings& warnings) {
    BallBuildOptions options;
    options.ball_radius_m = call.ball_radius_m;
    options.plane = !call.no_plane;
    options.parallax = call.parallax;
    options.samples_a_side = call.samples_a_side;
    options.sun_from_tags = !call.no_sun_from_tags;
    options.camera_deg = call.camera_deg;
    for (const auto& circle : call.circles) options.circles.push_back({{circle[0], circle[1]}, circle[2]});
    options.reflectance = share_of(call.reflectance, "--reflectance", "0.6 is usual for chrome, 0.9 for silver");
    options.diffuse_ball = diffuse_options(call);
    if (!call.rig.empty()) {
        const Scene scene = load_scene(call.rig, warnings);
        if (scene.tags.rig.empty()) throw InputError(call.rig, "has no [tags] rig", "list the tags beside the ball");
        options.tags = scene.tags;
        take_solved_places(scene, *options.tags);
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
    BallReading reading{load_camera(call.camera), response_of(call.response), {}};
    reading.merge.deghost = !call.no_deghost;
    BallBuildOptions options = build_options(call, context.warnings);

    BallPhotographs photographs(std::move(reading), call.output.path);
    std::vector<BallView> views;
    for (const auto& given : call.views) views.push_back(photographs.read(given, context.warnings));
    if (options.diffuse_ball) options.diffuse_ball->view = photographs.read(call.diffuse_ball, context.warnings);
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
    RecordedChannels known{{"sigma", "seen", "clipped"}, resample(known_of(build.probe), natural, layout)};
    if (known.image.channels() == 4) store_distances(known, 3);
    write_probe_image(
        call.output.path, image, layout,
        {{"software", std::string("matchlight ") + version},
         {"place_m", place_text(build.place_m)},
         {"ball_centre_m", place_text(build.ball.centre_m)},
         {"ball_radius_m", fmt::format("{}", build.ball.radius_m)},
         {"orientation", build.tags.empty() ? std::string("the first photographer's: +y his forward, +z up")
                                            : fmt::format("the rig's: tags {}", fmt::join(build.tags, " "))},
         {"rotation_deg", "0"},
         {"exposure_scale", fmt::format("{}", photographs.exposure_scale())},
         {"coverage", fmt::format("{}", build.probe.coverage)},
         {"source", fmt::format("{}", fmt::join(photographs.sources(), " "))}},
        known);
    print_result(context, result_json(call, build, layout, photographs.exposure_scale()),
                 result_text(call, build, layout));
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
    const std::map<std::string, BallParallax> parallaxes{
        {"off", BallParallax::off}, {"coarse", BallParallax::coarse}, {"full", BallParallax::full}};
    command
        ->add_option("--parallax", call->parallax,
                     "How finely to look for what stands near the ball: off (all is far away, and mixed where views "
                     "differ), coarse, full (default)")
        ->transform(CLI::CheckedTransformer(parallaxes).description("{off,coarse,full}"));
    command->add_flag_callback(
        "--no-parallax", [call] { call->parallax = BallParallax::off; }, "The same as --parallax off");
    command
        ->add_option("--samples", call->samples_a_side,
                     "Directions looked up along either side of a pixel of the probe (default: 2)")
        ->check(CLI::Range(1, 16).description(""))
        ->type_name("N");
    command
        ->add_option(
            "--sun-from-diffuse-ball", call->diffuse_ball,
            "Photographs (or one .exr or .hdr, merged as the views) of a matte grey or white ball in the mirror "
            "ball's place, darker ones too: its shading tells what lights send that clip every --view. A tag is "
            "whole in them or, without --rig, the camera stands as for the first --view")
        ->expected(1, 1000)
        ->type_name("PHOTOS");
    command->add_option("--diffuse-circle", call->diffuse_circle, "The matte ball, by hand: x,y,radius in pixels")
        ->delimiter(',')
        ->expected(3)
        ->type_name("X,Y,R");
    command
        ->add_option("--diffuse-albedo", call->diffuse_albedo,
                     "Share of light the matte ball reflects, one number or r,g,b (default: told by its shaded side)")
        ->delimiter(',')
        ->type_name("SHARE");
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
