// Each effect under its own condition, summed.
#include "compositor/camera_effects.h"

#include "render/effects/bloom.h"
#include "render/effects/spill.h"

namespace matchlight {

CameraEffects::CameraEffects(ShaderLibrary& shaders, const EffectSettings& settings, QualityLevel quality)
    : shaders_(shaders), settings_(settings), quality_(quality) {}

GraphTexture CameraEffects::add(RenderGraph& graph, const FrameLight& light) {
    explain(graph);
    if (!light.after) return {};
    std::vector<SpillPart> parts;
    if (settings_.bloom) {
        parts.push_back({add_bloom(graph, shaders_, light, *settings_.bloom, bloom_knobs(*settings_.bloom, quality_),
                                   object_strength(), bloom_light_),
                         &bloom_light_});
    }
    return add_spill_sum(graph, shaders_, parts);
}

void CameraEffects::explain(RenderGraph& graph) const {
    if (!settings_.bloom) graph.leave_out("bloom", "the scene does not ask for it");
    if (!settings_.glare) graph.leave_out("glare", "the scene does not ask for it");
}

}  // namespace matchlight
