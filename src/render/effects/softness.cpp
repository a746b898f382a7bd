// A Gaussian sampled at whole pixels.
#include "render/effects/softness.h"

#include <vector>

#include "render/effects/gaussian_blur.h"
#include "render/effects/separable_blur.h"

namespace matchlight {

namespace {

std::vector<float> taps_of(double sigma_px, const SoftnessKnobs& knobs) {
    return gaussian_taps(sigma_px * sigma_px, knobs.cut_sigmas);
}

}  // namespace

SoftnessKnobs softness_knobs(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.cut_sigmas = 1};
        case QualityLevel::preview:
            return {.cut_sigmas = 2};
        case QualityLevel::reference:
            return {.cut_sigmas = 5};
        case QualityLevel::final_:
            break;
    }
    return {};
}

int softness_reach_px(double sigma_px, const SoftnessKnobs& knobs) {
    return sigma_px < least_softness_px ? 0 : static_cast<int>(taps_of(sigma_px, knobs).size()) - 1;
}

PlateLayer add_softness(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer, double sigma_px,
                        const SoftnessKnobs& knobs) {
    if (!layer.light || sigma_px < least_softness_px) return layer;
    return add_separable_blur(graph, shaders, layer, taps_of(sigma_px, knobs), "softness");
}

}  // namespace matchlight
