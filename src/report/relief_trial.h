// A carved square that fills the picture: drawn by every method of relief, and truly displaced.
#pragma once

#include <memory>

#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "render/environment.h"
#include "render/surface.h"
#include "scene/lamp.h"
#include "scene/surface_pictures.h"

namespace matchlight {

class ReliefTrial {
public:
    /// `shaders` outlives this.
    ReliefTrial(ShaderLibrary& shaders, const Probe& probe, double tilt_deg = 50);
    ~ReliefTrial();

    /// A renderer of the square, by one way; `steps` 0: flat.
    std::shared_ptr<SurfaceRenderer> renderer(ReliefMethod method, int steps) const;
    std::shared_ptr<SurfaceRenderer> displaced() const;
    void draw(SurfaceRenderer& renderer) const;
    /// What draw() draws: RGB light.
    ImageF picture(SurfaceRenderer& renderer) const;
    /// The same under a lamp besides, which shows what casts by maps.
    ImageF picture(SurfaceRenderer& renderer, const LampSettings& lamp) const;
    /// Metres along the camera's z.
    ImageF depth_m(SurfaceRenderer& renderer) const;

    static constexpr int width = 384, height = 288;
    static constexpr double square_m = 1, carved_m = 0.05;

private:
    ShaderLibrary& shaders_;
    Environment environment_;
    SurfaceView view_;
    Model square_;
    ImageF heights_;
};

}  // namespace matchlight
