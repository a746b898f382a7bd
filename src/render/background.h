// What stands behind the objects of a scene without footage, in place of a plate: the probe as skydome, a colour, or a
// picture.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "core/transforms.h"
#include "core/warnings.h"
#include "gl/objects.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "render/effects/background_defocus.h"
#include "render/graph.h"
#include "scene/virtual_camera.h"

namespace matchlight {

/// How the background is seen in a frame; the camera has no distortion.
struct BackgroundView {
    int width = 0, height = 0;
    double fx = 1, fy = 1, cx = 0, cy = 0;  // pixels, centres at whole numbers
    RigidTransform camera_from_world = RigidTransform::Identity();
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // plate-linear light of unit scene-linear light
    std::optional<EvenDisc> defocus = {};            // of the skydome; a picture is as its camera saw it
};

/// The skydome is drawn from the lat-long image itself, at its full resolution: interpolated where it is coarser than
/// the picture, averaged over the pixel where it is finer. It is infinitely far away.
class Background {
public:
    /// `probe` is placed already; only read where the settings ask for it. Throws InputError: an image that cannot be
    /// read or is not width × height, a probe larger than the driver takes.
    Background(const BackgroundSettings& settings, const Probe& probe, int width, int height, Warnings& warnings);

    /// Whether a lens blurs it.
    bool can_blur() const { return static_cast<bool>(sky_); }
    /// Scene-linear RGB over the whole frame, or one pixel where all are alike; nullopt for the skydome.
    std::optional<ImageF> picture() const;
    /// Plate-linear RGB over the whole frame.
    GraphTexture add(RenderGraph& graph, ShaderLibrary& shaders, const BackgroundView& view) const;

private:
    GraphTexture add_part(RenderGraph& graph, ShaderLibrary& shaders, const BackgroundView& view, const Region& texels,
                          int texel_px) const;

    Eigen::Vector3d color_ = Eigen::Vector3d::Zero();  // scene-linear
    Texture2D sky_;                                    // lat-long, with mip levels; empty unless shown
    Texture2D image_;                                  // scene-linear; empty unless shown
};

}  // namespace matchlight
