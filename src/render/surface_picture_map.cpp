// Premultiplied by knowledge, so that the coarse levels weigh light by how well it is known.
#include "render/surface_picture_map.h"

#include <algorithm>

namespace matchlight {

SurfacePictureMap::SurfacePictureMap(const std::shared_ptr<const GatheredSurface>& gathered) {
    if (!gathered || gathered->radiance.empty()) {
        texels_ = Texture2D({.format = GL_RGBA16F});
        texels_.clear(0, 0, 0, 0);
        return;
    }
    constexpr float largest_half = 65504;
    ImageF texels = gathered->radiance;
    for (std::size_t i = 0; i < texels.samples().size(); i += 4) {
        float* texel = &texels.samples()[i];
        for (int c = 0; c < 3; ++c) texel[c] = std::min(texel[c] * texel[3], largest_half);
    }
    rectangle_m_ = gathered->rectangle_m;
    texel_m_ = gathered->texel_m();
    texels_ = Texture2D({.format = GL_RGBA16F, .width = texels.width(), .height = texels.height(), .levels = 0});
    texels_.upload(texels);
    texels_.make_mipmaps();
    texels_.set_filter(Filter::trilinear);
}

void SurfacePictureMap::bind(Program& program, GLuint unit) const {
    program.bind_texture("surface_picture_texels", unit, texels_);
    program.set("surface_picture_texel_m", texel_m_);
    if (!present()) return;
    program.set("surface_picture_corner_m", Eigen::Vector2f(rectangle_m_.min().cast<float>()));
    program.set("surface_picture_size_m", Eigen::Vector2f(rectangle_m_.sizes().cast<float>()));
}

}  // namespace matchlight
