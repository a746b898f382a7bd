// Reflected light in every direction: what an environment shows at one roughness, drawn as a lat-long picture.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/environment.h"

namespace matchlight {

struct ReflectedPicture {
    Texture2D texture;
    Framebuffer target;
    FullScreenTriangle triangle;

    explicit ReflectedPicture(int width)
        : texture({.format = GL_RGBA32F, .width = width, .height = width / 2}), target({texture}) {}

    void draw(ShaderLibrary& shaders, const Environment& environment, double roughness, bool sphere_map) const {
        Program& program = shaders.full_screen("report/reflected_light.frag");
        target.bind();
        glDisable(GL_DEPTH_TEST);
        glDisable(GL_BLEND);
        program.use();
        environment.bind(program);
        program.set("picture_size",
                    Eigen::Vector2f(static_cast<float>(texture.width()), static_cast<float>(texture.height())));
        program.set("roughness", roughness);
        program.set("from_sphere_map", sphere_map);
        triangle.draw();
    }
    ImageF read() const { return target.read<float>(target.bounds(), 3); }
};

}  // namespace matchlight
