// A scene away from its footage: seen from anywhere, over its probe.
#pragma once

#include <memory>

#include "compositor/compositor.h"
#include "media/frame_source.h"
#include "scene/virtual_camera.h"

namespace matchlight {

/// The scene with a camera of its own in the place of the footage's, as large and as wide: what only footage tells
/// (its exposure curve, its noise, the surface that catches shadows) is gone, and the probe stands behind. A scene
/// that has a camera keeps all but its way.
Scene without_footage(const Scene& scene, const Solve& solve, const CameraView& view);

class FreeShot {
public:
    /// `scene` and `solve` are those of the shot; `context` and `warnings` must outlive this. Throws InputError.
    FreeShot(GlContext& context, const Scene& scene, const Solve& solve, const CameraView& view, Warnings& warnings);

    /// The changed scene; false where this is of no use any more.
    bool set_scene(const Scene& scene);
    bool set_dragging(bool dragging) { return compositor_->set_dragging(dragging); }

    /// What is seen from there at a frame of the clip.
    Image8 picture(std::int64_t frame, const CameraView& view);
    const Camera& camera() const { return solve_.camera; }
    ShaderReload reload_shaders() { return compositor_->reload_shaders(); }

private:
    const Solve shot_solve_;
    const CameraView first_view_;
    Scene scene_;
    Solve solve_;
    std::unique_ptr<FrameSource> frames_;  // black ones
    std::unique_ptr<Compositor> compositor_;
};

}  // namespace matchlight
