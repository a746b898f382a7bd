// The camera's effects of bright light, as the scene asks for them.
#pragma once

#include "gl/condition.h"
#include "gl/shader_library.h"
#include "render/frame_light.h"
#include "render/graph.h"
#include "scene/effects.h"
#include "scene/scene_file.h"

namespace matchlight {

class CameraEffects {
public:
    CameraEffects(ShaderLibrary& shaders, const EffectSettings& settings, QualityLevel quality);

    /// Whether any of them spills light.
    bool any() const { return settings_.bloom.has_value() || settings_.glare.has_value(); }
    /// Adds their passes; returns what they add to the picture (render/effects/spill.h), empty when nothing does.
    GraphTexture add(RenderGraph& graph, const FrameLight& light);
    /// Notes in the graph the effects that the scene does without.
    void explain(RenderGraph& graph) const;

    const EffectSettings& settings() const { return settings_; }
    void set_settings(const EffectSettings& settings) { settings_ = settings; }

private:
    double object_strength() const { return settings_.dazzle ? settings_.dazzle->strength : 1; }

    ShaderLibrary& shaders_;
    EffectSettings settings_;
    QualityLevel quality_;
    GpuCondition bloom_light_{"no light is above the threshold of bloom"};
};

}  // namespace matchlight
