// One depth map a direction, all of the same size around the casters' bounding sphere.
#include "render/effects/object_shadow.h"

#include <array>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"

namespace matchlight {

namespace {

/// As std140 lays out the block of object_shadow.glsl.
struct DirectionOfLight {
    std::array<float, 4> to_light, light, axis_u, axis_v;
};

/// The binding point that object_shadow.glsl names.
constexpr GLuint uniform_block = 0;
/// As many as the smallest uniform block that OpenGL 4.5 promises (16 KiB) holds.
constexpr int most_directions = 16384 / sizeof(DirectionOfLight);

std::array<float, 4> four(const Eigen::Vector3d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0.0f};
}

}  // namespace

void ObjectShadowSettings::check() const {
    if (directions < 0 || directions > most_directions) {
        throw std::invalid_argument(fmt::format("object shadow: directions must be 0..256, not {}", directions));
    }
    if (resolution < 16 || resolution > 2048) {
        throw std::invalid_argument(fmt::format("object shadow: resolution must be 16..2048, not {}", resolution));
    }
}

ObjectShadow::ObjectShadow(ShaderLibrary& shaders, const ShadowCasters& casters,
                           const std::vector<DirectionalSample>& samples, const ObjectShadowSettings& settings)
    : directions_(static_cast<int>(samples.size())), resolution_(settings.resolution) {
    settings.check();
    if (!casters.bounds_m.isEmpty()) {
        centre_m_ = casters.bounds_m.center();
        radius_m_ = casters.bounds_m.diagonal().norm() / 2;
    }
    depth_ = Texture2D(
        {.format = GL_DEPTH_COMPONENT32F, .width = resolution_, .height = resolution_, .layers = directions_});
    std::vector<DirectionOfLight> lights;
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
    // Which spheres are hidden is found in a map that is no array.
    const bool seeks_hidden = radius_m_ > 0 && casters.cast_spheres;
    Texture2D one;
    if (seeks_hidden) one = Texture2D({.format = GL_DEPTH_COMPONENT32F, .width = resolution_, .height = resolution_});
    for (int i = 0; i < directions_; ++i) {
        const Eigen::Vector3d& to_light = samples[i].direction;
        const Eigen::Vector3d axis_u = to_light.unitOrthogonal();
        const Eigen::Vector3d axis_v = to_light.cross(axis_u);
        const Framebuffer target =
            seeks_hidden ? Framebuffer({}, Attachment(one)) : Framebuffer({}, Attachment(depth_, 0, i));
        target.bind();
        target.clear_depth(0);
        program.use();
        program.set("direction_to_light", Eigen::Vector3f(to_light.cast<float>()));
        program.set("axis_u", Eigen::Vector3f(axis_u.cast<float>()));
        program.set("axis_v", Eigen::Vector3f(axis_v.cast<float>()));
        if (radius_m_ > 0) casters.draw(program);
        if (seeks_hidden) {
            casters.cast_spheres({.view = map_view(to_light, axis_u, axis_v),
                                  .fragment = "spheres/depth.frag",
                                  .set_up = {},
                                  .depth = &one});
            glCopyImageSubData(one.name(), GL_TEXTURE_2D, 0, 0, 0, 0, depth_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, i,
                               resolution_, resolution_, 1);
        }
        lights.push_back({four(to_light), four(samples[i].radiance_times_solid_angle), four(axis_u), four(axis_v)});
    }
    glDisable(GL_DEPTH_TEST);
    lights_ = Buffer(std::span<const DirectionOfLight>(lights));
}

/// As depth.vert has it.
SphereProjection ObjectShadow::map_view(const Eigen::Vector3d& to_light, const Eigen::Vector3d& axis_u,
                                        const Eigen::Vector3d& axis_v) const {
    SphereProjection view{.width = resolution_, .height = resolution_, .is_parallel = true};
    view.clip_from_world.setIdentity();
    const auto set_row = [&](int row, const Eigen::Vector3d& axis, double offset) {
        view.clip_from_world.row(row).head<3>() = axis.transpose() / radius_m_;
        view.clip_from_world(row, 3) = offset - axis.dot(centre_m_) / radius_m_;
    };
    set_row(0, axis_u, 0);
    set_row(1, -axis_v, 0);
    set_row(2, to_light / 2, 0.5);
    return view;
}

void ObjectShadow::bind(Program& program, GLuint unit) const {
    program.bind_texture("object_shadow_depth", unit, depth_);
    lights_.bind(GL_UNIFORM_BUFFER, uniform_block);
    program.set("object_shadow_count", directions_);
    program.set("object_shadow_centre_m", Eigen::Vector3f(centre_m_.cast<float>()));
    program.set("object_shadow_radius_m", radius_m_);
    program.bind_texture("real_shadow_depth", unit, depth_);
    program.set("real_shadow_radius_m", 0.0);
}

void ObjectShadow::bind_as_real(Program& program, GLuint unit) const {
    program.bind_texture("real_shadow_depth", unit, depth_);
    program.set("real_shadow_centre_m", Eigen::Vector3f(centre_m_.cast<float>()));
    program.set("real_shadow_radius_m", radius_m_);
}

}  // namespace matchlight
