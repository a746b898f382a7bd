// From photographs of a mirror ball, already merged, to a probe: outline, rig, place of the ball, unwrapping.
#include "lighting/ball_build.h"

#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "lighting/ball_register.h"
#include "lighting/ball_rig.h"
#include "lighting/clipped_lights.h"

namespace matchlight {
namespace {

void find_outlines(std::vector<BallView>& views, const BallBuildOptions& options) {
    if (!options.circles.empty() && options.circles.size() != views.size()) {
        throw InputError({}, fmt::format("{} circles for {} views", options.circles.size(), views.size()),
                         "give one --circle for each --view, or none");
    }
    for (std::size_t v = 0; v < views.size(); ++v) {
        std::optional<OutlineCircle> circle;
        if (!options.circles.empty()) circle = options.circles[v];
        views[v].outline = find_ball(views[v].radiance, views[v].camera, circle, views[v].name);
    }
}

/// The ball by its outlines or, where a plane is seen in it, by that.
void place_ball(BallBuild& build, const BallRig& rig, const RigPlane& plane, Warnings& warnings) {
    build.fit = fit_ball_to_rig(build.views, rig, plane, build.ball);
    // What the rim hides is some per cent of the radius; a fit that goes farther has met something else.
    const double farthest_m = 0.3 * build.ball.radius_m;
    if (build.fit && (build.fit->ball.centre_m - build.ball.centre_m).norm() > farthest_m) {
        warnings.add(
            fmt::format("{}: what the ball reflects of the tags' plane does not fit its outline: is the radius "
                        "right? the outline is taken",
                        build.views.front().name.string()));
        build.fit.reset();
    }
    if (build.fit) build.ball = build.fit->ball;
}

/// Outline and pose of the diffuse ball.
BallView placed_diffuse_view(const BallBuildOptions& options, const BallView& first, Warnings& warnings) {
    std::vector<BallView> view = {options.diffuse_ball->view};
    view[0].outline = find_ball(view[0].radiance, view[0].camera, options.diffuse_ball->circle, view[0].name);
    // Tags are the world's frame in each picture by itself. The ball's radius would count only where no tag is whole.
    if (options.tags) {
        find_rig(view, *options.tags, options.ball_radius_m, warnings);
    } else {
        view[0].camera_from_world = first.camera_from_world;
    }
    return std::move(view[0]);
}

void solve_clipped(BallBuild& build, const BallScene& scene, const BallBuildOptions& options, Warnings& warnings) {
    if (options.diffuse_ball) {
        build.diffuse_view = placed_diffuse_view(options, build.views.front(), warnings);
        build.clipped_lights = solve_clipped_lights(build.probe, {*build.diffuse_view, options.diffuse_ball->albedo});
        build.clipped_lights_by = "the diffuse ball";
        if (build.clipped_lights.empty()) {
            warnings.add(fmt::format("{}: the diffuse ball is not needed: no light of the probe is clipped",
                                     build.diffuse_view->name.string()));
        }
    } else if (scene.plane && options.sun_from_tags) {
        build.clipped_lights = solve_clipped_lights(build.probe, scene, options.tags->white_albedo);
        build.clipped_lights_by = "the tags' paper";
    }
}

}  // namespace

BallBuild build_ball_probe(std::vector<BallView> views, const BallBuildOptions& options, Warnings& warnings) {
    find_outlines(views, options);
    BallBuild build;
    BallRig rig;
    std::optional<RigPlane> plane;
    if (options.tags) {
        rig = find_rig(views, *options.tags, options.ball_radius_m, warnings);
        for (const PlacedSheet& sheet : rig.sheets) build.tags.push_back(sheet.id);
        plane = plane_of_rig(rig);
    } else {
        register_views(views, options.ball_radius_m, warnings);
    }
    build.views = std::move(views);
    build.ball = ball_from_outlines(build.views, options.ball_radius_m);
    if (plane) place_ball(build, rig, *plane, warnings);

    build.reflectance_by = "taken as 1";
    if (options.reflectance) {
        build.reflectance = *options.reflectance;
        build.reflectance_by = "given";
    } else if (build.fit && build.fit->reflectance) {
        build.reflectance = *build.fit->reflectance;
        build.reflectance_by = "measured by the plane and its mirror image";
    } else if (options.tags) {
        warnings.add(
            fmt::format("{}: too little of the tags' plane is seen in the ball to tell its reflectance: taken "
                        "as 1; --reflectance says better",
                        build.views.front().name.string()));
    }
    BallScene scene{build.views, build.ball, build.reflectance, std::nullopt, nullptr};
    if (plane && options.plane) {
        scene.plane = plane;
        scene.rig = &rig;
        build.plane_used = true;
    }
    BallProbeOptions unwrap;
    unwrap.height = options.height;
    unwrap.camera_deg = options.camera_deg;
    unwrap.parallax = options.parallax;
    unwrap.samples_a_side = options.samples_a_side;
    unwrap.place_m = options.place_m.value_or(build.ball.centre_m);
    build.place_m = unwrap.place_m;
    build.probe = probe_from_balls(scene, unwrap);
    solve_clipped(build, scene, options, warnings);
    return build;
}

}  // namespace matchlight
