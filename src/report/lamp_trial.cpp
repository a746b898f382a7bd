// The same lens, plane and ball for the GPU and for double precision.
#include "report/lamp_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "render/surface.h"
#include "report/classic_reference.h"
#include "report/lamp_reference.h"

namespace matchlight {

namespace {

constexpr double eye_m = 5;
constexpr double pixel_m = 0.004;  // on the plane
constexpr double albedo = 0.8;
constexpr double highlight = 0.5;

Eigen::Vector3d ball_centre() {
    return {0, 0, 0.08};
}

SurfaceObject dull(const Model& model) {
    SurfaceObject object{.model = &model, .reflection = ReflectionForm::sphere_map};
    object.material.diffuse = {1, 1, 1};
    object.material.specular = {0, 0, 0};
    return object;
}

/// Straight down; row 0 shows the largest y.
SurfaceView view_from_above() {
    constexpr int size = LampTrial::size_px;
    SurfaceView view;
    view.width = view.height = size;
    view.samples = 1;
    RigidTransform camera_from_world = RigidTransform::Identity();
    camera_from_world.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera_from_world.translation() = Eigen::Vector3d(0, 0, eye_m);
    PinholeView pinhole;
    pinhole.fx = pinhole.fy = eye_m / pixel_m;
    pinhole.cx = pinhole.cy = (size - 1) / 2.0;
    pinhole.width = pinhole.height = size;
    view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
    view.eye_world_m = Eigen::Vector3d(0, 0, eye_m);
    return view;
}

/// How far along a unit direction the ball is met; nullopt where the ray passes by.
std::optional<double> way_to_ball(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction, double radius_m) {
    const Eigen::Vector3d to_centre = ball_centre() - from_m;
    const double along = to_centre.dot(direction);
    const double left = radius_m * radius_m - (to_centre - along * direction).squaredNorm();
    if (left < 0 || along < 0) return std::nullopt;
    return along - std::sqrt(left);
}

}  // namespace

LampTrial::LampTrial(ShaderLibrary& shaders, const LampTrialSetup& setup)
    : shaders_(shaders), setup_(setup), plane_(make_shape("plane", "plane")), ball_(make_shape("sphere", "sphere")) {}

std::optional<LampTrial::Seen> LampTrial::seen_by(int x, int y) const {
    const Eigen::Vector3d eye(0, 0, eye_m);
    const Eigen::Vector3d on_plane((x - (size_px - 1) / 2.0) * pixel_m, ((size_px - 1) / 2.0 - y) * pixel_m, 0);
    const Eigen::Vector3d direction = (on_plane - eye).normalized();
    const double radius = setup_.ball_radius_m;
    const auto way = way_to_ball(eye, direction, radius);
    const double aside = (ball_centre() - eye - (ball_centre() - eye).dot(direction) * direction).norm();
    if (!setup_.measures_ball) {
        if (aside < 1.1 * radius) return std::nullopt;
        return Seen{on_plane, Eigen::Vector3d::UnitZ(), -direction};
    }
    // At the rim a pixel is covered in part.
    if (!way || aside > 0.9 * radius) return std::nullopt;
    const Eigen::Vector3d at = eye + *way * direction;
    return Seen{at, (at - ball_centre()).normalized(), -direction};
}

Eigen::Vector3d LampTrial::light_at(const Seen& seen, int rays) const {
    Eigen::Vector3d light;
    const Eigen::Vector3d ambient = Eigen::Vector3d::Constant(setup_.ambient);
    const Blocked blocked = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        return way_to_ball(from, (to - from).normalized(), setup_.ball_radius_m).has_value();
    };
    if (setup_.measures_ball) {
        const Blocked open = [](const Eigen::Vector3d&, const Eigen::Vector3d&) { return false; };
        const Eigen::Vector3d to_lamp = setup_.lamp.type == LampType::directional
                                            ? Eigen::Vector3d(-setup_.lamp.direction.normalized())
                                            : Eigen::Vector3d((setup_.lamp.position_m - seen.at_m).normalized());
        const ClassicLamp lamp{to_lamp, reference_lamp_irradiance(setup_.lamp, seen.at_m, to_lamp, open, rays)};
        light = classic_reference(setup_.shading,
                                  {.normal = seen.normal,
                                   .to_eye = seen.to_eye,
                                   .diffuse = Eigen::Vector3d::Constant(albedo),
                                   .specular = Eigen::Vector3d::Constant(highlight),
                                   .ambient = ambient},
                                  std::span(&lamp, 1));
    } else {
        light =
            ambient + reference_lamp_irradiance(setup_.lamp, seen.at_m, seen.normal, blocked, rays) / std::numbers::pi;
    }
    if (!setup_.depth_cue) return light;
    const DepthCueSettings& cue = *setup_.depth_cue;
    const double z_m = eye_m - seen.at_m.z();
    const double share = cue.strength * std::clamp((z_m - cue.near_m) / (cue.far_m - cue.near_m), 0.0, 1.0);
    return (1 - share) * light + share * Eigen::Vector3d(cue.color.data());
}

ImageF LampTrial::reference(int rays) const {
    ImageF picture(size_px, size_px, 3);
    for (int y = 0; y < size_px; ++y) {
        for (int x = 0; x < size_px; ++x) {
            const std::optional<Seen> seen = seen_by(x, y);
            if (!seen) continue;
            Eigen::Map<Eigen::Vector3f>(picture.pixel(x, y)) = light_at(*seen, rays).cast<float>();
        }
    }
    return picture;
}

ImageF LampTrial::drawn(const LampQuality& quality) const {
    SurfaceRenderer surfaces(shaders_);
    SurfaceObject plane = dull(plane_), ball = dull(ball_);
    plane.world_from_model.topLeftCorner<3, 3>() *= size_px * pixel_m;
    plane.casts_shadow = false;
    ball.world_from_model.topLeftCorner<3, 3>() *= 2 * setup_.ball_radius_m;  // the shape is one metre wide
    ball.world_from_model.topRightCorner<3, 1>() = ball_centre();
    ball.material.shading = setup_.shading;
    if (setup_.measures_ball) {
        ball.material.diffuse = {albedo, albedo, albedo};
        ball.material.specular = {highlight, highlight, highlight};
    }
    surfaces.add_object(plane);
    surfaces.add_object(ball);
    Probe probe;
    probe.latlong = ImageF(16, 8, 3, static_cast<float>(setup_.ambient));
    const Environment environment(shaders_, probe, {.face_size = 16, .sphere_map_size = 16});
    Lamps lamps(std::span(&setup_.lamp, 1));
    lamps.draw_maps(
        shaders_, {surfaces.shadow_caster_bounds_m(), [&](Program& program) { surfaces.draw_shadow_casters(program); }},
        quality, true);
    SurfaceShading shading;
    shading.has_lamps = true;
    shading.fades_with_depth = setup_.depth_cue.has_value();
    shading.bind = [&](Program& program) {
        lamps.bind(program);
        if (!setup_.depth_cue) return;
        const DepthCueSettings& cue = *setup_.depth_cue;
        program.set("depth_cue_color", Eigen::Vector3f(Eigen::Vector3d(cue.color.data()).cast<float>()));
        program.set("depth_cue_range_m", Eigen::Vector2f(Eigen::Vector2d(cue.near_m, cue.far_m).cast<float>()));
        program.set("depth_cue_strength", cue.strength);
    };
    ImageF rgb = surfaces.draw(environment, view_from_above(), shading).color->read<float>({0, 0, size_px, size_px}, 3);
    for (int y = 0; y < size_px; ++y) {
        for (int x = 0; x < size_px; ++x) {
            if (!seen_by(x, y)) std::fill_n(rgb.pixel(x, y), 3, 0.0F);
        }
    }
    return rgb;
}

}  // namespace matchlight
