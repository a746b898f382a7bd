// Cases of whole frames: sizes from one pixel to 8K, exposures and emitted light beyond all reason.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compositor/compositor.h"
#include "media/blank_source.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

struct FrameTrial {
    int width = 64, height = 48;
    Eigen::Vector2d at{0.5, 0.5};  // where the sphere is seen, as shares of the frame
    double radius_px = 12;
    double distance_m = 1;
    double emissive = 0;
    double exposure_ev = 0;
    EffectSettings effects = {};
};

Solve solve_of(const FrameTrial& trial) {
    Solve solve;
    solve.footage_file = "stability";
    solve.frame_count = 1;
    solve.camera.width = trial.width;
    solve.camera.height = trial.height;
    solve.camera.fx = solve.camera.fy = std::max(trial.width, trial.height);
    solve.camera.cx = (trial.width - 1) / 2.0;
    solve.camera.cy = (trial.height - 1) / 2.0;
    SolvedFrame frame;
    // The camera looks along world +y: its x is the world's, its y points down the world's z.
    RigidTransform camera_from_world = RigidTransform::Identity();
    camera_from_world.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    frame.camera_from_world = camera_from_world;
    frame.exposure_ev = trial.exposure_ev;
    solve.frames.push_back(frame);
    return solve;
}

Scene scene_of(const FrameTrial& trial, const Camera& camera) {
    Scene scene;
    scene.path = "stability";
    scene.surface.present = false;
    ObjectSettings sphere;
    sphere.shape = "sphere";
    const double px_m = trial.distance_m / camera.fx;
    const double right = (trial.at.x() * trial.width - 0.5 - camera.cx) * px_m;
    const double down = (trial.at.y() * trial.height - 0.5 - camera.cy) * px_m;
    sphere.translate_m = {right, trial.distance_m, -down};
    sphere.scale = Eigen::Vector3d::Constant(trial.radius_px * px_m);
    sphere.material.roughness = 0.2;
    if (trial.emissive > 0) sphere.material.emissive = std::array{trial.emissive, trial.emissive, trial.emissive};
    scene.objects.push_back(sphere);
    scene.effects = trial.effects;
    return scene;
}

/// Samples of the frame that are no code values, and one more where nothing virtual is seen.
double bad_samples(GlContext& context, const FrameTrial& trial) {
    const Solve solve = solve_of(trial);
    Warnings warnings;
    warnings.set_quiet(true);
    Compositor compositor(context, scene_of(trial, solve.camera), solve, {.quality = QualityLevel::draft}, warnings);
    BlankSource source({.path = "stability", .width = trial.width, .height = trial.height, .frames = 1, .fps = 25});
    const CompositedFrame frame = compositor.composite(*source.next());
    double bad = 1;
    for (const std::uint8_t touched : frame.touched.samples()) {
        if (touched != 0) bad = 0;
    }
    for (const float code : frame.code.samples()) bad += code >= -0.1F && code <= 1.1F ? 0 : 1;
    return bad;
}

StabilityCase frame_case(const std::string& name, const FrameTrial& trial) {
    return {"whole frame", name, "samples that are no code values",
            {0, 0},        {},   [trial] {
                return StabilityOutcome{bad_samples(*current_gl_context(), trial), {}}; }};
}

/// What lens, sensor and codec do, each at the end of its range.
EffectSettings all_of_the_sensor() {
    EffectSettings effects;
    effects.grain = GrainSettings{.read = 1, .shot = 1, .correlation_px = 4, .strength = 100, .seed = 1'000'000'000};
    effects.vignette = VignetteSettings{.v1 = -1, .v2 = 0};
    effects.chromatic_aberration = ChromaticAberrationSettings{.red_px = 100, .blue_px = -100};
    effects.softness = SoftnessSettings{.sigma_px = 16};
    return effects;
}

void add_sensor_cases(std::vector<StabilityCase>& cases) {
    const EffectSettings effects = all_of_the_sensor();
    const std::string what = "grain, vignette, colour and softness at their strongest, ";
    cases.push_back(frame_case(what + "1×1", {.width = 1, .height = 1, .radius_px = 0.7, .effects = effects}));
    cases.push_back(frame_case(what + "7×5", {.width = 7, .height = 5, .radius_px = 5, .effects = effects}));
    cases.push_back(frame_case(what + "a sphere at the last pixel", {.at = {0.999, 0.998}, .effects = effects}));
    for (const double emissive : {65504.0, 1e9}) {
        cases.push_back(frame_case(what + fmt::format("a sphere that sends {:g}", emissive),
                                   {.emissive = emissive, .effects = effects}));
    }
    for (const double exposure_ev : {-64.0, 64.0}) {
        cases.push_back(frame_case(what + fmt::format("an exposure of {:g} EV", exposure_ev),
                                   {.exposure_ev = exposure_ev, .effects = effects}));
    }
}

}  // namespace

std::vector<StabilityCase> frame_cases() {
    std::vector<StabilityCase> cases;
    cases.push_back(frame_case("1×1, filled by a sphere", {.width = 1, .height = 1, .radius_px = 0.7}));
    cases.push_back(frame_case("7×5, filled by a sphere", {.width = 7, .height = 5, .radius_px = 5}));
    cases.push_back(frame_case("8192×4320, a sphere at the last pixel",
                               {.width = 8192, .height = 4320, .at = {0.999, 0.998}, .radius_px = 40}));
    for (const double distance_m : {0.02, 1000.0, 1e6}) {
        cases.push_back(frame_case(fmt::format("a sphere at {:g} m", distance_m), {.distance_m = distance_m}));
    }
    for (const double emissive : {1e-8, 65504.0, 1e9}) {
        cases.push_back(frame_case(fmt::format("a sphere that sends {:g}", emissive), {.emissive = emissive}));
    }
    for (const double exposure_ev : {-64.0, 64.0}) {
        cases.push_back(frame_case(fmt::format("an exposure of {:g} EV", exposure_ev), {.exposure_ev = exposure_ev}));
    }
    add_sensor_cases(cases);
    return cases;
}

}  // namespace matchlight
