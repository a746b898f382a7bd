// One depth map a direction, all of the same size around the casters' bounding sphere.
#include "render/effects/object_shadow.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"

namespace matchlight {

void ObjectShadowSettings::check() const {
    if (directions < 0 || directions > 1024) {
        throw std::invalid_argument(fmt::format("object shadow: directions must be 0..1024, not {}", directions));
    }
    if (resolution < 16 || resolution > 2048) {
        throw std::invalid_argument(fmt::format("object shadow: resolution must be 16..2048, not {}", resolution));
    }
}

ObjectShadow::ObjectShadow(ShaderLibrary& shaders, const ShadowCasters& casters,
                           const std::vector<DirectionalSample>& samples, const ObjectShadowSettings& settings)
    : centre_m_(casters.bounds_m.center()),
      radius_m_(casters.bounds_m.diagonal().norm() / 2),
      directions_(static_cast<int>(samples.size())),
      resolution_(settings.resolution) {
    settings.check();
    depth_ = Texture2D(
        {.format = GL_DEPTH_COMPONENT32F, .width = resolution_, .height = resolution_, .layers = directions_});
    ImageF lights(directions_, 4, 4);
    Program& program = shaders.program({{GL_VERTEX_SHADER, "effects/object_shadow/depth.vert"},
                                        {GL_FRAGMENT_SHADER, "effects/object_shadow/depth.frag"}});
    program.use();
    program.set("centre_m", Eigen::Vector3f(centre_m_.cast<float>()));
    program.set("radius_m", radius_m_);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    for (int i = 0; i < directions_; ++i) {
        const Eigen::Vector3d& to_light = samples[i].direction;
        const Eigen::Vector3d axis_u = to_light.unitOrthogonal();
        const Eigen::Vector3d axis_v = to_light.cross(axis_u);
        const Framebuffer target({}, Attachment(depth_, 0, i));
        target.bind();
        target.clear_depth(0);
        program.set("direction_to_light", Eigen::Vector3f(to_light.cast<float>()));
        program.set("axis_u", Eigen::Vector3f(axis_u.cast<float>()));
        program.set("axis_v", Eigen::Vector3f(axis_v.cast<float>()));
        casters.draw(program);
        for (int c = 0; c < 3; ++c) {
            lights.at(i, 0, c) = static_cast<float>(to_light[c]);
            lights.at(i, 1, c) = static_cast<float>(samples[i].radiance_times_solid_angle[c]);
            lights.at(i, 2, c) = static_cast<float>(axis_u[c]);
            lights.at(i, 3, c) = static_cast<float>(axis_v[c]);
        }
    }
    glDisable(GL_DEPTH_TEST);
    lights_ = Texture2D({.format = GL_RGBA32F, .width = directions_, .height = 4});
    lights_.upload(lights);
}

void ObjectShadow::bind(Program& program, GLuint first_unit) const {
    program.bind_texture("object_shadow_depth", first_unit, depth_);
    program.bind_texture("object_shadow_lights", first_unit + 1, lights_);
    program.set("object_shadow_centre_m", Eigen::Vector3f(centre_m_.cast<float>()));
    program.set("object_shadow_radius_m", radius_m_);
}

}  // namespace matchlight
