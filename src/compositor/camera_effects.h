// The camera's effects of bright light, as the scene asks for them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibration/camera.h"
#include "compositor/quality.h"
#include "gl/condition.h"
#include "gl/shader_library.h"
#include "render/effects/color_transform.h"
#include "render/effects/spill.h"
#include "render/effects/streaks.h"
#include "render/effects/wave_glare.h"
#include "render/frame_light.h"
#include "render/graph.h"
#include "scene/effects.h"
#include "scene/scene_file.h"

namespace matchlight {

class CameraEffects {
public:
    /// Throws InputError where an aperture's image, or a file of the colour transform, is bad.
    CameraEffects(ShaderLibrary& shaders, const EffectSettings& settings, const Quality& quality, const Camera& camera);

    /// Whether any of them spills light.
    bool any() const { return settings_.bloom.has_value() || !glares_.empty(); }
    /// Adds their passes; returns what they add to the picture (render/effects/spill.h), empty when nothing does.
    GraphTexture add(RenderGraph& graph, const FrameLight& light);
    /// Notes in the graph the effects that the scene does without.
    void explain(RenderGraph& graph) const;

    const EffectSettings& settings() const { return settings_; }
    /// Null where the scene asks for none; it lasts until the settings or the quality change.
    const ColorTransform* color_transform() const { return color_transform_ ? &*color_transform_ : nullptr; }
    /// What another setting or quality of glare needs is made with the next frame.
    void set_settings(const EffectSettings& settings);
    void set_quality(const Quality& quality);

private:
    /// The scene's glare, or that of dazzling reflection alone.
    struct Glare {
        GlareSettings settings;
        StreakSource source;
        std::string name;  // of its passes
        std::unique_ptr<GpuCondition> streak_light, wave_light;
        std::unique_ptr<WaveGlare> wave;
    };
    void add_glare_of(const GlareSettings& settings, const StreakSource& source, const std::string& name);
    void add_glare(RenderGraph& graph, const FrameLight& light, Glare& glare, std::vector<SpillPart>& parts);
    void make_color_transform();
    double object_strength() const { return settings_.dazzle ? settings_.dazzle->strength : 1; }

    ShaderLibrary& shaders_;
    EffectSettings settings_;
    Quality quality_;
    Camera camera_;
    GpuCondition bloom_light_{"no light is above the threshold of bloom"};
    std::vector<Glare> glares_;
    std::optional<ColorTransform> color_transform_;
};

}  // namespace matchlight
