// One effect after the other on plate pixels.
#include "compositor/layer_effects.h"

#include <cmath>

namespace matchlight {

double LayerEffectPlan::spread_px() const {
    return defocus ? defocus->objects.widest_px() / 2 : 0;
}

bool LayerEffectPlan::samples_lens() const {
    return defocus && defocus->settings.level == DepthOfFieldLevel::lens_samples;
}

PlateLayer add_layer_effects(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    PlateLayer layer;
    if (!plan.any()) return layer;
    if (plan.defocus && !plan.samples_lens() && input.input.layer_drawn) {
        const ResolvedLayer resolved = input.composite.add_resolved_layer(graph, input.input, input.objects);
        layer.light = resolved.light;
    }
    return layer;
}

}  // namespace matchlight
