// Each effect under its own condition, summed.
#include "compositor/camera_effects.h"

#include "render/effects/spill.h"

namespace matchlight {

CameraEffects::CameraEffects(ShaderLibrary& shaders, const EffectSettings& the_settings)
    : settings(the_settings), shaders_(shaders) {}

bool CameraEffects::any() const {
    return settings.bloom || settings.glare;
}

GraphTexture CameraEffects::add(RenderGraph& graph, const FrameLight& light) {
    explain(graph);
    if (!light.after) return {};
    std::vector<SpillPart> parts;
    return add_spill_sum(graph, shaders_, parts);
}

void CameraEffects::explain(RenderGraph& graph) const {
    if (!settings.bloom) graph.leave_out("bloom", "the scene does not ask for it");
    if (!settings.glare) graph.leave_out("glare", "the scene does not ask for it");
}

}  // namespace matchlight
