// The last pass: real light, dimmed by the shadow, under the virtual layer, back in the camera's code values.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "core/transforms.h"
#include "gl/framebuffer.h"
#include "gl/objects.h"
#include "gl/shader_library.h"
#include "render/effects/contact_shadow.h"
#include "render/surface.h"

namespace matchlight {

/// The virtual layer as drawn: a pinhole picture without distortion, finer than the plate.
struct VirtualLayer {
    SurfacePicture picture;                 // colour null where nothing is in view
    double fx = 0, fy = 0, cx = 0, cy = 0;  // of its own pixels, centres at whole numbers
};

/// How the camera saw in this frame.
struct FrameOptics {
    RigidTransform camera_from_world = RigidTransform::Identity();
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // plate light of unit probe light: 2^ev · white balance
    std::array<double, 2> vignette{};                // gain = 1 + v0 r² + v1 r⁴, r = 1 at the corner
    int frame_width = 0, frame_height = 0;
};

struct CompositeInput {
    const ImageF* plate_code = nullptr;  // RGB code values over `region`
    Region region;                       // what the images cover
    std::vector<Region> runs;            // the parts of it to draw, in plate pixels
    VirtualLayer layer;
    const ContactShadow* shadow = nullptr;  // null: no shadow, which is a ratio of 1
    FrameOptics optics;
    double least_visible_loss = 0;  // a shadow that takes less leaves the pixel the plate's
    bool layers = false;            // also return linear light and the ratio
};

/// All over the input's region; what lies outside its runs is not written.
struct CompositeOutput {
    ImageF code;          // RGB; a = 1 where the pixel was touched
    ImageF linear;        // plate-linear RGB and the virtual layer's alpha; empty unless asked for
    ImageF shadow;        // RGB ratio; empty unless asked for
    ImageF virtual_rgba;  // premultiplied plate-linear light and alpha; empty unless asked for
    ImageF geometry;      // world normal and depth in metres; empty unless asked for
    ImageF object_id;     // 0 = nothing; empty unless asked for
};

/// Holds what no frame changes: the lens as a grid and the response as a table.
class CompositePass {
public:
    /// `lens_nodes` as LensMap has it, one node every `lens_spacing` pixels; `response` holds one row a channel.
    CompositePass(ShaderLibrary& shaders, const ImageF& lens_nodes, int lens_spacing, const ImageF& response);

    CompositeOutput draw(const CompositeInput& input);

private:
    /// Makes the textures large enough for the region; those of the layers only when they are asked for.
    void hold(const Region& region, bool layers);

    ShaderLibrary& shaders_;
    Texture2D lens_nodes_;
    Texture2D response_;
    int lens_spacing_;
    FullScreenTriangle triangle_;
    // Kept between frames; made anew when a frame needs larger ones.
    int width_ = 0, height_ = 0;
    Texture2D plate_, code_, linear_, shadow_, virtual_, geometry_, object_;
    Texture2D empty_, empty_id_;  // stand in for inputs that a frame does not have
};

}  // namespace matchlight
