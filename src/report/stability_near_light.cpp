// Stiff cases of light between things: rays, bounced light, mirroring tables and holdouts.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compositor/compositor.h"
#include "media/blank_source.h"
#include "report/near_light_trial.h"
#include "report/scratch_probe.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

constexpr double furnace_light = 0.5;
constexpr double infinite_error = std::numeric_limits<double>::infinity();

ObjectSettings shape_of(const char* shape, const Eigen::Vector3d& at_m, double size_m) {
    ObjectSettings object;
    object.shape = shape;
    object.translate_m = at_m;
    object.scale.setConstant(size_m);
    object.material.base_color = {1, 1, 1};
    return object;
}

/// All that is near at the level final, of fewer rays and directions: what is stable does not hang on their number.
Quality few_rays() {
    Quality quality = quality_of(QualityLevel::preview);
    quality.reflection = {.level = ReflectionLevel::rays};
    quality.bounce = {.rays = 16, .surface_rays = 64, .surface_points = 24};
    return quality;
}

/// A few things on a table, in the light of a probe.
struct NearFrame {
    std::vector<ObjectSettings> objects;
    SurfaceSettings surface = {};
    ImageF light{64, 32, 3, static_cast<float>(furnace_light)};
    double down_deg = 35;  // the camera looks at the origin, half a metre away
    Quality quality = few_rays();

    FrameLayers layers() const {
        Solve solve;
        solve.footage_file = "stability";
        solve.frame_count = 1;
        solve.camera = {.width = 96, .height = 64, .fx = 110, .fy = 110, .cx = 47.5, .cy = 31.5, .distortion = {}};
        constexpr double distance_m = 0.5;
        const double down = down_deg * EIGEN_PI / 180;
        const Eigen::Vector3d ahead(0, std::cos(down), -std::sin(down));
        SolvedFrame frame;
        frame.camera_from_world = camera_looking_along(-distance_m * ahead, ahead);
        frame.exposure_ev = 0;
        solve.frames.push_back(frame);
        const ScratchProbe probe(light);
        Scene scene;
        scene.path = "stability";
        scene.probe.emplace();
        scene.probe->path = probe.path();
        scene.objects = objects;
        scene.surface = surface;
        Warnings warnings;
        warnings.set_quiet(true);
        Compositor compositor(*current_gl_context(), scene, solve, {.settings = quality, .layers = true}, warnings);
        BlankSource source({.path = "stability", .width = 96, .height = 64, .frames = 1, .fps = 25});
        CompositedFrame composited = compositor.composite(*source.next());
        if (!composited.layers) throw std::runtime_error("nothing virtual is in view");
        return std::move(*composited.layers);
    }
};

/// Largest relative error of what objects send, where they fill the pixel.
StabilityOutcome furnace_error(const FrameLayers& layers) {
    double worst = 0;
    int pixels = 0;
    for (int y = 0; y < layers.region.height; ++y) {
        for (int x = 0; x < layers.region.width; ++x) {
            if (layers.virtual_rgba.at(x, y, 3) != 1) continue;
            ++pixels;
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(layers.virtual_rgba.at(x, y, c) / furnace_light - 1));
        }
    }
    return {pixels > 0 ? worst : infinite_error};
}

/// Samples of all layers of light that are no light; one more where nothing virtual is seen.
StabilityOutcome bad_samples(const FrameLayers& layers) {
    double bad = 0, largest = 0;
    // Half floats end there, and the table adds what it mirrors to what it has.
    constexpr double most = 4 * 65504.0;
    const auto look_at = [&](const ImageF& image, double least) {
        for (const float value : image.samples()) {
            if (!(value >= least && value <= most)) bad += 1;
            largest = std::max<double>(largest, std::abs(value));
        }
    };
    look_at(layers.beauty, 0);
    look_at(layers.virtual_rgba, 0);
    look_at(layers.shadow, 0);
    look_at(layers.reflection, -most);
    if (std::ranges::max(layers.beauty.samples()) <= 0) bad += 1;
    return {.value = bad, .beside = {{"largest light", largest}}};
}

StabilityCase frame_case(const char* effect, const std::string& name, const NearFrame& frame) {
    return {effect, name, "samples that are no light", {0, 0}, {}, [frame] { return bad_samples(frame.layers()); }};
}

ImageF sun_over_walls(double sun) {
    ImageF light(256, 128, 3, 0.1F);
    for (int c = 0; c < 3; ++c) light.at(100, 30, c) = static_cast<float>(sun);
    return light;
}

void add_furnaces(std::vector<StabilityCase>& cases) {
    for (const double metallic : {1.0, 0.0}) {
        for (const double roughness : {0.0, 0.1, 0.25, 0.5, 0.75, 1.0}) {
            cases.push_back({"rays",
                             fmt::format("white furnace, a {} ball of roughness {:g}",
                                         metallic > 0 ? "metal" : "varnished", roughness),
                             "largest relative error",
                             {0, 0.005},
                             {},
                             [metallic, roughness] {
                                 NearFrame frame{.objects = {shape_of("sphere", {0, 0, 0}, 0.2)}};
                                 frame.objects[0].material.metallic = metallic;
                                 frame.objects[0].material.roughness = roughness;
                                 frame.surface.present = false;
                                 return furnace_error(frame.layers());
                             }});
        }
    }
}

/// Error of a lamp's light against double precision, as a share of the lamp's own.
StabilityCase trial_case(const char* effect, const std::string& name, const NearLightSetup& setup, double most) {
    return {effect, name, "RMS error over the lamp's light", {0, most}, {}, [setup] {
                const NearLightTrial trial(*current_gl_context(), setup);
                Quality quality = few_rays();
                quality.supersampling = 2;
                quality.reflection.lobe_rays = 8;
                quality.reflection.surface_rays = 16;
                quality.bounce.surface_rays = 256;
                quality.bounce.surface_points = 96;
                if (setup.kind != NearLightKind::bounced_to_surface) quality.bounce.rays = 0;
                if (setup.kind == NearLightKind::shadow_on_holdout)
                    quality.object_shadow = quality_of(QualityLevel::final_).object_shadow;
                const ImageF drawn = trial.drawn(quality);
                constexpr int strata = 32;
                const ImageF reference = trial.reference(strata);
                double square = 0, light = 0, measured = 0;
                for (std::size_t i = 0; i < drawn.samples().size(); ++i) {
                    const double error = drawn.samples()[i] - reference.samples()[i];
                    square += std::isfinite(error) ? error * error : infinite_error;
                    light += reference.samples()[i];
                    measured += reference.samples()[i] != 0 || drawn.samples()[i] != 0 ? 1 : 0;
                }
                return StabilityOutcome{.value = std::sqrt(square / std::max(measured, 1.0)),
                                        .beside = {{"mean light", light / std::max(measured, 1.0)}}};
            }};
}

void add_trials(std::vector<StabilityCase>& cases) {
    struct Lamp {
        const char* name;
        NearLightSetup setup;
        double mirror_error;     // where nearly all pixels hold an edge more: rays there meet the lamp or do not
        bool is_compact = true;  // bounced light has a grid as long as what it comes from
    };
    constexpr double some_edges = 0.1, all_edges = 0.3;
    const std::vector<Lamp> lamps{{"a box", {}, some_edges},
                                  {"a box mirrored in x", {.lamp_m = {-0.08, 0.05, 0.06}}, some_edges},
                                  {"a sheared box", {.shear = 1.5}, some_edges},
                                  {"a bar 20 m long", {.lamp_m = {20, 0.05, 0.06}}, some_edges, false},
                                  {"a sheet seen edge-on", {.lamp_m = {1e-7, 0.1, 0.1}}, all_edges}};
    // Of a wide lobe each pixel has 8 or 16 rays.
    constexpr double lobe_noise = 0.06;
    for (const Lamp& lamp : lamps) {
        for (const double roughness : {0.0, 1.0}) {
            NearLightSetup setup = lamp.setup;
            setup.roughness = roughness;
            const double most = roughness > 0 ? lobe_noise : lamp.mirror_error;
            setup.kind = NearLightKind::mirrored_by_object;
            cases.push_back(
                trial_case("rays", fmt::format("{} in metal of roughness {:g}", lamp.name, roughness), setup, most));
            setup.kind = NearLightKind::mirrored_by_surface;
            cases.push_back(trial_case(
                "table reflection", fmt::format("{} in a table of roughness {:g}", lamp.name, roughness), setup, most));
        }
        // A grid of 96 points; directions and maps of the level final.
        constexpr double grid_error = 0.04, map_error = 0.03;
        NearLightSetup setup = lamp.setup;
        setup.kind = NearLightKind::bounced_to_surface;
        if (lamp.is_compact)
            cases.push_back(trial_case("bounced light", fmt::format("{} on a table", lamp.name), setup, grid_error));
        setup.kind = NearLightKind::shadow_on_holdout;
        cases.push_back(trial_case("holdouts", fmt::format("shadow of {} on a slab", lamp.name), setup, map_error));
    }
}

void add_frames(std::vector<StabilityCase>& cases) {
    for (const double roughness : {0.0, 1.0}) {
        NearFrame frame{.objects = {shape_of("sphere", {-0.05, 0, 0.05}, 0.1), shape_of("box", {0.07, 0, 0.04}, 0.08)},
                        .light = sun_over_walls(1e6)};
        frame.objects[0].material.metallic = 1;
        for (ObjectSettings& object : frame.objects) object.material.roughness = roughness;
        frame.surface.reflection = 0.5;
        frame.surface.reflection_roughness = roughness;
        const std::string rough = fmt::format("roughness {:g}", roughness);
        cases.push_back(frame_case("rays", "a one-pixel sun of 1e6, everything of " + rough, frame));
        NearFrame held = frame;
        held.objects[1].holdout = true;
        cases.push_back(frame_case("holdouts", "a one-pixel sun of 1e6, everything of " + rough, held));
        for (const double down_deg : {1.0, 0.06}) {
            NearFrame grazing = frame;
            grazing.light = sun_over_walls(1);
            grazing.surface.reflection = 0.04;
            grazing.down_deg = down_deg;
            cases.push_back(frame_case("table reflection",
                                       fmt::format("a camera {:g}° above the table, {}", down_deg, rough), grazing));
        }
    }
    NearFrame edges{.objects = {shape_of("plane", {0, 0, 0.1}, 0.2), shape_of("plane", {0, 0.1, 0.05}, 0.1)}};
    edges.objects[0].rotate_deg = {0, 90, 0};  // its plane holds the eye
    edges.surface.reflection = 1;
    edges.surface.reflection_roughness = 0;
    cases.push_back(frame_case("table reflection", "triangles seen edge-on by the eye and by rays", edges));
    edges.objects[0].scale = {-1e-4, 1e3, 1e-4};
    cases.push_back(frame_case("table reflection", "a mirrored model, scaled by 1e-4 and 1e3", edges));
    edges.objects[0].holdout = true;
    cases.push_back(frame_case("holdouts", "a mirrored one, scaled by 1e-4 and 1e3", edges));
}

}  // namespace

std::vector<StabilityCase> near_light_cases() {
    std::vector<StabilityCase> cases;
    add_furnaces(cases);
    add_trials(cases);
    add_frames(cases);
    return cases;
}

}  // namespace matchlight
