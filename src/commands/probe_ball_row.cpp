// Two scenes without footage, made in memory and put one above the other.
#include "commands/probe_ball_row.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "compositor/compositor.h"
#include "compositor/quality.h"
#include "core/transfer.h"
#include "lighting/probe_comparison.h"
#include "media/frame_source.h"
#include "scene/footage_options.h"
#include "tracking/scene_solve.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;
constexpr double grey = 0.5;
constexpr double diameter_m = 0.1;
constexpr double spacing_m = 0.115;
/// Far enough that the outer balls look round.
constexpr double distance_m = 1.5;

struct BallMaterial {
    const char* name;
    double color, metallic, roughness;
};
constexpr std::array<BallMaterial, balls_in_row> ball_materials = {{{"grey", grey, 0, 1},
                                                                    {"chrome", 0.95, 1, 0},
                                                                    {"metal of roughness 0.2", 0.9, 1, 0.2},
                                                                    {"metal of roughness 0.5", 0.9, 1, 0.5},
                                                                    {"white plastic", 0.8, 0, 0.15}}};

/// Shows the brightest side of the grey ball at 60 % of white.
double exposure_for_balls(const Probe& probe) {
    double brightest = 0;
    for (const Vector3d& normal : even_directions(200)) {
        const Vector3d radiance = irradiance(probe, normal) * grey / std::numbers::pi;
        brightest = std::max(brightest, luminance_rec709(radiance.x(), radiance.y(), radiance.z()));
    }
    return brightest > 0 ? std::log2(0.6 / brightest) : 0;
}

ObjectSettings object(const BallMaterial& material, const char* shape) {
    ObjectSettings settings;
    settings.shape = shape;
    settings.name = material.name;
    settings.material.base_color = {material.color, material.color, material.color};
    settings.material.metallic = material.metallic;
    settings.material.roughness = material.roughness;
    return settings;
}

/// `ground` is the light that the ground sends, and where its shadow falls; without it the probe stands behind.
Scene row_scene(const BallRowOptions& options, const std::optional<Vector3d>& ground) {
    const double azimuth = options.azimuth_deg * degree;
    const double elevation = options.elevation_deg * degree;
    const Vector3d level(std::cos(azimuth), std::sin(azimuth), 0);
    const Vector3d right(level.y(), -level.x(), 0);

    Scene scene;
    scene.path = options.probe;
    CameraSettings camera;
    camera.width = 2 * static_cast<int>(std::lround(options.ball_px * 6.0 / 2));
    camera.height = 2 * static_cast<int>(std::lround(options.ball_px * 1.4 / 2));
    const double focal_px = options.ball_px * distance_m / diameter_m;
    camera.vertical_fov_deg = 2 * std::atan(camera.height / 2.0 / focal_px) / degree;
    camera.exposure_ev = *options.exposure_ev;
    CameraKey key;
    key.eye_m = distance_m * (-std::cos(elevation) * level + std::sin(elevation) * Vector3d::UnitZ());
    camera.keys = {key};
    scene.camera = camera;
    scene.probe = ProbeSettings{options.probe, options.mapping, {}, std::nullopt};
    scene.quality = options.quality;
    for (int i = 0; i < balls_in_row; ++i) {
        ObjectSettings ball = object(ball_materials.at(static_cast<std::size_t>(i)), "sphere");
        ball.translate_m = (i - (balls_in_row - 1) / 2.0) * spacing_m * right;
        ball.scale = Vector3d::Constant(diameter_m);
        scene.objects.push_back(std::move(ball));
    }
    scene.surface.present = ground.has_value();
    scene.surface.z_m = -diameter_m / 2;
    scene.background.probe = !ground;
    if (ground) scene.background.color = {ground->x(), ground->y(), ground->z()};
    return scene;
}

CompositedFrame draw(GlContext& gl, const Scene& scene, Warnings& warnings) {
    const Solve solve = virtual_solve(scene);
    CompositorOptions options;
    // Each ball for itself: what is compared is the probe's light.
    options.settings = without_rays(quality_of(scene.quality));
    options.layers = true;
    Compositor compositor(gl, scene, solve, options, warnings);
    const auto source = open_frames(scene, false, warnings);
    return compositor.composite(*source->next());
}

void put_below(const CompositedFrame& frame, int top, BallRow& row) {
    const Image8 picture = frame.rgb8();
    for (int y = 0; y < picture.height(); ++y) {
        std::copy_n(picture.pixel(0, y), 3 * picture.width(), row.picture.pixel(0, top + y));
    }
    if (!frame.layers) return;  // nothing is seen
    const FrameLayers& layers = *frame.layers;
    if (!layers.background.empty()) {
        for (int y = 0; y < picture.height(); ++y) {
            std::copy_n(layers.background.pixel(0, y), 3 * picture.width(), row.light.pixel(0, top + y));
        }
    }
    const Region& region = layers.region;
    for (int y = 0; y < region.height; ++y) {
        std::copy_n(layers.beauty.pixel(0, y), 3 * region.width, row.light.pixel(region.x, top + region.y + y));
        for (int x = 0; x < region.width; ++x) {
            const float id = layers.object_id.at(x, y, 0);
            if (id > 0 && id <= balls_in_row) row.on_balls.at(region.x + x, top + region.y + y) = 255;
        }
    }
}

}  // namespace

BallRow draw_ball_row(GlContext& gl, const BallRowOptions& asked, Warnings& warnings) {
    const Probe probe = load_probe(asked.probe, asked.mapping, warnings);
    BallRowOptions options = asked;
    if (!options.exposure_ev) options.exposure_ev = exposure_for_balls(probe);
    // What is to be said of the file has been said.
    Warnings said_already;
    said_already.set_quiet(true);

    BallRow row;
    row.exposure_ev = *options.exposure_ev;
    const Vector3d ground = irradiance(probe, Vector3d::UnitZ()) * grey / std::numbers::pi;
    int top = 0;
    for (const bool on_ground : {false, true}) {
        const Scene scene = row_scene(options, on_ground ? std::optional(ground) : std::nullopt);
        const int width = scene.camera->width;
        const int height = scene.camera->height;
        if (row.picture.empty()) {
            row.picture = Image8(width, 2 * height, 3);
            row.light = ImageF(width, 2 * height, 3);
            row.on_balls = Image8(width, 2 * height, 1);
        }
        put_below(draw(gl, scene, said_already), top, row);
        top += height;
    }
    return row;
}

}  // namespace matchlight
