// Stiff cases of analytic lights: in a surface, inside a body, closed, hard, far, grazing, of any strength.
#include <algorithm>
#include <cmath>
#include <limits>

#include "report/lamp_trial.h"
#include "report/stability_cases.h"

namespace matchlight {

namespace {

constexpr double largest_half = 65504;

LampSettings lamp_at(const Eigen::Vector3d& position_m) {
    return {.type = LampType::point, .intensity = 0.2, .position_m = position_m};
}

LampSettings spot(double inner_deg, double outer_deg) {
    LampSettings lamp = lamp_at({0.1, 0.05, 0.3});
    lamp.type = LampType::spot;
    lamp.direction = {-0.3, 0, -1};
    lamp.inner_cone_deg = inner_deg;
    lamp.outer_cone_deg = outer_deg;
    return lamp;
}

/// The largest light of the plane; infinite where some is not finite or negative.
double largest_light(const LampSettings& lamp) {
    ShaderLibrary shaders;
    const ImageF drawn = LampTrial(shaders, {.lamp = lamp}).drawn({.resolution = 256, .taps = 8});
    double most = 0;
    for (const float value : drawn.samples()) {
        if (!std::isfinite(value) || value < 0) return std::numeric_limits<double>::infinity();
        most = std::max<double>(most, value);
    }
    return most;
}

/// Mean difference from the reference over its largest light.
double mean_error(const LampSettings& lamp) {
    ShaderLibrary shaders;
    const LampTrial trial(shaders, {.lamp = lamp});
    const ImageF drawn = trial.drawn({}), reference = trial.reference(200);
    double sum = 0, most = 0;
    for (std::size_t i = 0; i < drawn.samples().size(); ++i) {
        sum += std::abs(static_cast<double>(drawn.samples()[i]) - reference.samples()[i]);
        most = std::max<double>(most, reference.samples()[i]);
    }
    return most > 0 ? sum / static_cast<double>(drawn.samples().size()) / most : sum;
}

}  // namespace

std::vector<StabilityCase> lamp_cases() {
    std::vector<StabilityCase> cases;
    const auto finite = [&](const char* name, const LampSettings& lamp, double most) {
        cases.push_back({"analytic lights", name, "largest light", {0, most}, {}, [lamp] {
                             return StabilityOutcome{largest_light(lamp)};
                         }});
    };
    const auto exact = [&](const char* name, const LampSettings& lamp, double most) {
        cases.push_back({"analytic lights", name, "mean error over the brightest place", {0, most}, {}, [lamp] {
                             return StabilityOutcome{mean_error(lamp)};
                         }});
    };
    LampSettings strong = lamp_at({0.1, 0.05, 0.3}), low = lamp_at({0.15, 0, 1e-4}),
                 low_ball = lamp_at({0.15, 0, 0.001});
    strong.intensity = 1e9;
    low_ball.radius_m = 0.01;
    finite("a point in the surface, where a pixel looks", lamp_at({0.15, 0.15, 0}), largest_half);
    finite("a point a tenth of a millimetre above the surface", low, largest_half);
    finite("a ball that reaches into the surface", low_ball, largest_half);
    finite("a point inside a ball: none of its light leaves", lamp_at({0, 0, 0.08}), 0);
    finite("an intensity of 1e9", strong, largest_half);
    finite("a spot of 0°", spot(0, 0), 0);
    finite("a spot of 90°", spot(90, 90), largest_half);
    LampSettings far = lamp_at({6e5, 0, 8e5});
    far.intensity = 1e12;
    far.radius_m = 5e3;
    LampSettings grazing{.type = LampType::directional, .direction = {1, 0, -0.01}};
    grazing.angle_deg = 0.5;
    // Half floats have 11 bits; of shadows the pixels of their edges differ.
    exact("a spot whose cone has no soft edge", spot(20, 20), 0.005);
    exact("a ball a thousand kilometres away", far, 0.005);
    exact("a sun 0.6° above the plane", grazing, 0.03);
    return cases;
}

}  // namespace matchlight
