// The study's table: what each effect costs a frame of samples/study, alone and together, and reflection by sphere map
// against cube map. Every round draws each variant once, so that a machine that slows down slows them all.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "compositor/compositor.h"
#include "compositor/exposure_meter.h"
#include "gl/context.h"
#include "scene/footage_options.h"
#include "tracking/scene_solve.h"

namespace matchlight {
namespace {

constexpr int rounds = 15;
constexpr std::int64_t frame = 20;  // the sun is in the picture and on the head

Scene study_scene(const char* name, Warnings& warnings) {
    return load_scene(std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/study" / name, warnings);
}

PlateFrame blank_plate(const Scene& scene, Warnings& warnings) {
    const auto source = open_frames(scene, false, warnings);
    source->seek(std::min(frame, scene.camera->frames - 1));
    return *source->next();
}

/// A way to draw the frame.
struct Variant {
    std::string name;
    Compositor* compositor = nullptr;
    EffectSettings effects;
    std::vector<double> ms;
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

/// The first variant is what the others are compared with, round by round.
void time_variants(std::vector<Variant>& variants, const PlateFrame& plate) {
    for (int round = -1; round < rounds; ++round) {
        for (Variant& variant : variants) {
            variant.compositor->set_effects(variant.effects);
            const auto start = std::chrono::steady_clock::now();
            const CompositedFrame drawn = variant.compositor->composite(plate);
            const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
            if (round >= 0) variant.ms.push_back(taken.count());  // before, programs compile
        }
    }
    fmt::print("{:<28} {:>9} {:>9} {:>12}\n", "", "ms", "frames/s", "more by ms");
    for (const Variant& variant : variants) {
        std::vector<double> more;
        for (std::size_t i = 0; i < variant.ms.size(); ++i) more.push_back(variant.ms[i] - variants[0].ms[i]);
        fmt::print("{:<28} {:9.1f} {:9.2f} {:12.1f}\n", variant.name, median(variant.ms), 1000 / median(variant.ms),
                   median(more));
    }
    fmt::print("\n");
}

void print_effects(GlContext& context, const Scene& all, Warnings& warnings) {
    Scene none = all;
    none.effects = {};
    Scene by_sphere_map = none;
    for (ObjectSettings& object : by_sphere_map.objects) object.reflection = ReflectionForm::sphere_map;
    const Solve solve = solve_of_scene(none, warnings);
    Solve metered = solve;
    meter_clip(metered, all, context, {.strict = false, .quiet = true}, warnings);
    const auto compositor_of = [&](const Scene& scene, const Solve& its_solve) {
        return std::make_unique<Compositor>(context, scene, its_solve, CompositorOptions{}, warnings);
    };
    const auto plain = compositor_of(none, solve);
    const auto exposed = compositor_of(none, metered);
    const auto sphere_map = compositor_of(by_sphere_map, solve);

    std::vector<Variant> variants{{"no effect", plain.get(), {}, {}}};
    const auto add = [&](std::string name, Compositor& compositor, const std::function<void(EffectSettings&)>& change) {
        variants.push_back({std::move(name), &compositor, {}, {}});
        change(variants.back().effects);
    };
    const EffectSettings& asked = all.effects;
    add("bloom", *plain, [&](EffectSettings& e) { e.bloom = asked.bloom; });
    add("glare", *plain, [&](EffectSettings& e) { e.glare = asked.glare; });
    add("dazzling reflection, bloom", *plain, [&](EffectSettings& e) {
        e.bloom = asked.bloom;
        e.dazzle = asked.dazzle;
    });
    add("exposure control", *exposed, [&](EffectSettings&) {});
    add("all", *exposed, [&](EffectSettings& e) { e = asked; });
    add("bloom, classic", *plain, [&](EffectSettings& e) {
        e.bloom = asked.bloom;
        e.bloom->level = BloomLevel::classic;
    });
    for (const int directions : {2, 4, 6, 8}) {
        add(fmt::format("glare, {} directions", directions), *plain, [&](EffectSettings& e) {
            e.glare = asked.glare;
            e.glare->directions = directions;
        });
    }
    add("sphere map instead of cube", *sphere_map, [](EffectSettings&) {});
    time_variants(variants, blank_plate(none, warnings));
}

/// A mirror ball in a room, seen from where a sphere map's pole is in the middle of the ball.
Scene mirror_ball(const Scene& room, ReflectionForm form) {
    Scene scene = room;
    scene.effects = {};
    scene.camera->width = scene.camera->height = 600;
    scene.camera->frames = 1;
    scene.camera->exposure_ev = 0;
    scene.camera->vertical_fov_deg = 5;
    scene.camera->orbit =
        OrbitSettings{.target_m = {0, 0, 0}, .radius_m = 10, .elevation_deg = 0, .from_deg = -90, .to_deg = -90};
    ObjectSettings ball;
    ball.shape = "sphere";
    ball.name = "ball";
    ball.scale.setConstant(0.8);
    ball.reflection = form;
    ball.material.diffuse = {0, 0, 0};
    ball.material.specular = {1, 1, 1};
    scene.objects = {ball};
    scene.background = {};
    return scene;
}

/// Mean absolute difference of reflected light to the probe's own in the mirrored direction, as a share of the mean, by
/// the angle between that direction and the pole.
void print_pole_error(GlContext& context, const Scene& room, Warnings& warnings) {
    const Probe probe = placed(load_probe(room.probe->path, room.probe->mapping, warnings), room.probe->placement);
    const std::array<double, 7> edges_deg{0, 1, 2, 5, 15, 45, 150};
    fmt::print("{:<28}", "error, degrees from the pole");
    for (std::size_t i = 0; i + 1 < edges_deg.size(); ++i)
        fmt::print(" {:>7}", fmt::format("{}–{}", edges_deg[i], edges_deg[i + 1]));
    for (const ReflectionForm form : {ReflectionForm::sphere_map, ReflectionForm::cube}) {
        const Scene scene = mirror_ball(room, form);
        const Solve solve = virtual_solve(scene);
        const CompositedFrame drawn =
            Compositor(context, scene, solve, {.quality = QualityLevel::final_, .layers = true}, warnings)
                .composite(blank_plate(scene, warnings));
        const RigidTransform world_from_camera = solve.frames[0].camera_from_world->inverse();
        std::array<double, edges_deg.size()> error{}, sum{};
        for (int y = 0; y < 600; ++y) {
            for (int x = 0; x < 600; ++x) {
                const FrameLayers& layers = *drawn.layers;
                if (layers.alpha.at(x, y) < 0.999F) continue;
                const Eigen::Vector3d ray =
                    (world_from_camera.linear() * Eigen::Vector3d((x - solve.camera.cx) / solve.camera.fx,
                                                                  (y - solve.camera.cy) / solve.camera.fy, 1))
                        .normalized();
                const Eigen::Vector3d eye = world_from_camera.translation();
                const double along = -ray.dot(eye), radius_m = 0.4;
                const double inside = radius_m * radius_m - (eye.squaredNorm() - along * along);
                if (!(inside > 0)) continue;
                const Eigen::Vector3d n = (eye + (along - std::sqrt(inside)) * ray).normalized();
                const Eigen::Vector3d mirrored = ray - 2 * ray.dot(n) * n;
                const double angle_deg = std::acos(std::clamp(-mirrored.y(), -1.0, 1.0)) * 180 / std::numbers::pi;
                const auto bin =
                    std::upper_bound(edges_deg.begin(), edges_deg.end(), angle_deg) - edges_deg.begin() - 1;
                const Eigen::Vector3d light = probe.radiance(mirrored);
                for (int c = 0; c < 3; ++c) {
                    error[static_cast<std::size_t>(bin)] += std::abs(layers.beauty.at(x, y, c) - light[c]);
                    sum[static_cast<std::size_t>(bin)] += light[c];
                }
            }
        }
        fmt::print("\n{:<28}", form == ReflectionForm::cube ? "cube map" : "sphere map");
        for (std::size_t i = 0; i + 1 < edges_deg.size(); ++i) fmt::print(" {:6.2f}%", 100 * error[i] / sum[i]);
    }
    fmt::print("\n");
}

}  // namespace
}  // namespace matchlight

int main() {
    using namespace matchlight;
    Warnings warnings;
    const auto context = create_offscreen_context();
    print_effects(*context, study_scene("all.toml", warnings), warnings);
    print_pole_error(*context, study_scene("glare.toml", warnings), warnings);
}
