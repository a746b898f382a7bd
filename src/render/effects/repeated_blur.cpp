// Each pass reads what the one before wrote.
#include "render/effects/repeated_blur.h"

#include <vector>

#include "render/effects/gaussian_blur.h"
#include "render/effects/separable_blur.h"

namespace matchlight {

namespace {

/// Of one pass.
std::vector<float> taps_of(const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs) {
    if (knobs.cut_sigmas > 0) return gaussian_taps(settings.variance_px2(), knobs.cut_sigmas);
    const auto side = static_cast<std::size_t>(settings.radius_px) + 1;
    return std::vector<float>(side, 1 / static_cast<float>(2 * settings.radius_px + 1));
}

int passes_of(const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs) {
    return knobs.cut_sigmas > 0 ? 1 : settings.passes;
}

}  // namespace

RepeatedBlurKnobs repeated_blur_knobs(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.cut_sigmas = 2};
        case QualityLevel::preview:
            return {.cut_sigmas = 3};
        case QualityLevel::final_:
        case QualityLevel::reference:
            break;
    }
    return {};
}

int repeated_blur_reach_px(const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs) {
    if (settings.radius_px == 0) return 0;
    return passes_of(settings, knobs) * (static_cast<int>(taps_of(settings, knobs).size()) - 1);
}

PlateLayer add_repeated_blur(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                             const RepeatedBlurSettings& settings, const RepeatedBlurKnobs& knobs) {
    if (!layer.light || settings.radius_px == 0) return layer;
    const std::vector<float> taps = taps_of(settings, knobs);
    PlateLayer blurred = layer;
    for (int pass = 0; pass < passes_of(settings, knobs); ++pass)
        blurred = add_separable_blur(graph, shaders, blurred, taps, "repeated blur");
    return blurred;
}

}  // namespace matchlight
