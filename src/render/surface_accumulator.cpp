// Sums by blending into a texture of 32-bit floats.
#include "render/surface_accumulator.h"

#include <algorithm>

namespace matchlight {

void SurfaceAccumulator::begin(int width, int height) {
    width_ = width;
    height_ = height;
    if (!sum_ || sum_.width() < width || sum_.height() < height) {
        const int held_width = sum_ ? sum_.width() : 0, held_height = sum_ ? sum_.height() : 0;
        sum_ = Texture2D(
            {.format = GL_RGBA32F, .width = std::max(width, held_width), .height = std::max(height, held_height)});
        target_ = Framebuffer({sum_});
    }
    target_.bind({0, 0, width, height});
    target_.clear_color(0, 0, 0, 0, 0);
}

void SurfaceAccumulator::add(const SurfacePicture& picture, double weight) {
    Program& program = shaders_.full_screen("surface/accumulate.frag");
    program.use();
    program.bind_texture("picture", 0, *picture.color);
    program.set("weight", weight);
    target_.bind({0, 0, width_, height_});
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    triangle_.draw();
    glDisable(GL_BLEND);
}

SurfacePicture SurfaceAccumulator::picture() const {
    return {.width = width_, .height = height_, .color = &sum_};
}

}  // namespace matchlight
