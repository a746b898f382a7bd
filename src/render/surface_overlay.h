// What the scene lays on an object's surface, as shaders read it: a relief, a pattern, layers of pictures.
#pragma once

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_source.h"
#include "scene/surface_pictures.h"

namespace matchlight {

class SurfaceOverlay {
public:
    /// Uploads; `pictures` is only read here. `world_scale`: metres a unit of the model, about.
    SurfaceOverlay(const SurfacePictures& pictures, double world_scale);

    /// What surface/surface.frag is to be compiled with; empty: nothing of it shows.
    const ShaderDefines& defines() const { return defines_; }
    /// Sets the uniforms of surface/relief.glsl, patterns.glsl and picture_layers.glsl, as far as they are defined.
    void bind(Program& program) const;

    static constexpr GLuint first_unit = 50;  // three of them, beyond those of lamps

private:
    void upload_relief(const SurfacePictures& pictures, double world_scale);
    void upload_layers(const SurfacePictures& pictures);

    SurfaceDetail settings_;
    ShaderDefines defines_;
    Texture2D relief_, distances_, layers_;
    Eigen::Vector2f extent_ = Eigen::Vector2f::Ones();  // of the height map, in depths
};

/// Of those definitions the ones that move what is seen, which passes without light need, too.
ShaderDefines geometry_defines(const ShaderDefines& defines);

}  // namespace matchlight
