// One depth map a direction, or two, all of the same size around the casters' bounding sphere.
#include "render/effects/object_shadow.h"

#include <array>
#include <cassert>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"
#include "lighting/octahedral_directions.h"

namespace matchlight {

namespace {

/// As std140 lays out the block of object_shadow.glsl.
struct DirectionOfLight {
    std::array<float, 4> to_light, light, axis_u, axis_v;
};

/// The binding points that object_shadow.glsl names.
constexpr GLuint uniform_block = 0, storage_block = 4;
/// As many as the smallest uniform block that OpenGL 4.5 promises (16 KiB) holds.
constexpr int most_directions = 16384 / sizeof(DirectionOfLight);

std::array<float, 4> four(const Eigen::Vector3d& v, double w = 0) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), static_cast<float>(w)};
}

}  // namespace

void ObjectShadowSettings::check() const {
    if (directions < 0 || directions > most_directions) {
        throw std::invalid_argument(fmt::format("object shadow: directions must be 0..256, not {}", directions));
    }
    const int divisions = octahedron_divisions.value_or(0);
    if (divisions < 0 || divisions > most_octahedral_divisions) {
        throw std::invalid_argument(
            fmt::format("object shadow: an octahedron is divided 0..4 times, not {}", divisions));
    }
    if (resolution < 16 || resolution > 2048) {
        throw std::invalid_argument(fmt::format("object shadow: resolution must be 16..2048, not {}", resolution));
    }
}

ObjectShadow::ObjectShadow(ShaderLibrary& shaders, const ShadowCasters& casters,
                           const std::vector<DirectionalSample>& samples, const ObjectShadowSettings& settings)
    : is_paired_(settings.octahedron_divisions.has_value()),
      directions_(static_cast<int>(samples.size())),
      resolution_(settings.resolution) {
    settings.check();
    assert(!is_paired_ || directions_ % 2 == 0);
    if (!casters.bounds_m.isEmpty()) {
        centre_m_ = casters.bounds_m.center();
        radius_m_ = casters.bounds_m.diagonal().norm() / 2;
    }
    const int directions_a_map = is_paired_ ? 2 : 1;
    depth_ = Texture2D({.format = static_cast<GLenum>(is_paired_ ? GL_RG32F : GL_DEPTH_COMPONENT32F),
                        .width = resolution_,
                        .height = resolution_,
                        .layers = directions_ / directions_a_map});
    if (radius_m_ > 0 && casters.cast_spheres && !is_paired_)
        one_ = Texture2D({.format = GL_DEPTH_COMPONENT32F, .width = resolution_, .height = resolution_});
    std::vector<DirectionOfLight> lights;
    for (int i = 0; i < directions_; ++i) {
        const DirectionalSample& sample = samples[static_cast<std::size_t>(i)];
        const bool shares = is_paired_ && i % 2 == 1;  // the map, seen from its other side
        const Eigen::Vector3d of_map = shares ? Eigen::Vector3d(-sample.direction) : sample.direction;
        assert(!shares || of_map == samples[static_cast<std::size_t>(i - 1)].direction);
        const Eigen::Vector3d axis_u = of_map.unitOrthogonal();
        if (!shares) draw_map(shaders, casters, of_map, i / directions_a_map);
        lights.push_back({four(sample.direction, sample.solid_angle_sr), four(sample.radiance_times_solid_angle),
                          four(axis_u), four(of_map.cross(axis_u))});
    }
    one_ = {};
    lights_ = Buffer(std::span<const DirectionOfLight>(lights));
}

void ObjectShadow::draw_map(ShaderLibrary& shaders, const ShadowCasters& casters, const Eigen::Vector3d& to_light,
                            int layer) {
    const Eigen::Vector3d axis_u = to_light.unitOrthogonal(), axis_v = to_light.cross(axis_u);
    const Framebuffer target = is_paired_ ? Framebuffer({Attachment(depth_, 0, layer)})
                               : one_     ? Framebuffer({}, Attachment(one_))
                                          : Framebuffer({}, Attachment(depth_, 0, layer));
    target.bind();
    glDisable(GL_CULL_FACE);
    if (is_paired_) {
        // Nearest to either side at once: the greatest of both heights.
        target.clear_color(0, 0, 0, 0, 0);
        glDisable(GL_DEPTH_TEST);
        glEnable(GL_BLEND);
        glBlendEquation(GL_MAX);
    } else {
        target.clear_depth(0);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GREATER);
        glDepthMask(GL_TRUE);
        glDisable(GL_BLEND);
    }
    Program& program = shaders.program(
        {{GL_VERTEX_SHADER, "effects/object_shadow/depth.vert"},
         {GL_FRAGMENT_SHADER, is_paired_ ? "effects/object_shadow/heights.frag" : "effects/object_shadow/depth.frag"}});
    program.use();
    program.set("centre_m", Eigen::Vector3f(centre_m_.cast<float>()));
    program.set("radius_m", radius_m_);
    program.set("direction_to_light", Eigen::Vector3f(to_light.cast<float>()));
    program.set("axis_u", Eigen::Vector3f(axis_u.cast<float>()));
    program.set("axis_v", Eigen::Vector3f(axis_v.cast<float>()));
    if (radius_m_ > 0) casters.draw(program);
    if (radius_m_ > 0 && casters.cast_spheres) {
        // What is hidden from one side may be nearest to the other.
        casters.cast_spheres({.view = map_view(to_light, axis_u, axis_v),
                              .fragment = is_paired_ ? "spheres/heights.frag" : "spheres/depth.frag",
                              .set_up = {},
                              .depth = is_paired_ ? nullptr : &one_});
    }
    if (one_) {
        glCopyImageSubData(one_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, depth_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, layer,
                           resolution_, resolution_, 1);
    }
    glBlendEquation(GL_FUNC_ADD);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
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
    if (is_paired_) {
        lights_.bind(GL_SHADER_STORAGE_BUFFER, storage_block);
    } else {
        lights_.bind(GL_UNIFORM_BUFFER, uniform_block);
    }
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
