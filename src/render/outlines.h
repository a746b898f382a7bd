// Edges of objects, drawn over their picture where depth or normal jumps (Saito & Takahashi 1990, "Comprehensible
// Rendering of 3-D Shapes").
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"

namespace matchlight {

/// Of one object, by its id in the layers.
struct ObjectOutline {
    int id = 0;
    double width_px = 1;  // of the picture's own pixels, inside the object's silhouette
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
};

class ObjectOutlines {
public:
    explicit ObjectOutlines(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Input {
        std::span<const ObjectOutline> objects;
        const Texture2D& depth_m;  // layers of the picture, one sample a pixel
        const Texture2D& normal;
        const Texture2D& object_id;
        int width = 0, height = 0;
        Eigen::Matrix4d clip_from_world = Eigen::Matrix4d::Identity();
        const Framebuffer& target;  // premultiplied colour
        /// The uniforms of surface/depth_cue.glsl; empty: lines keep their colour however far they are.
        std::function<void(Program&)> bind_depth_cue = {};
    };
    /// How much of a pixel is covered stays as it is.
    void draw(const Input& input);

private:
    ShaderLibrary& shaders_;
    FullScreenTriangle triangle_;
    Texture2D edges_;
    Framebuffer edge_target_;
};

}  // namespace matchlight
