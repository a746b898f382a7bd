// Compute passes over vertices and over a grid of the surface.
#include "render/effects/bounce_light.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "core/work.h"
#include "gl/framebuffer.h"

namespace matchlight {

namespace {

constexpr int vertex_group = 64;  // as the shaders say

/// In one run: llvmpipe ends all loops of an invocation after 65,535 rounds together, and some GPUs what runs too long.
constexpr int rays_at_once = 4;

/// Runs `cast` for all rays, some at a time, each after the other's writes.
void cast_rays(Program& program, int rays, const std::function<void()>& cast) {
    program.set("gather_rays", rays);
    for (int first = 0; first < rays; first += rays_at_once) {
        stop_if_given_up();
        tell_work("light/bounced", first, rays);
        program.set("first_ray", first);
        program.set("last_ray", std::min(first + rays_at_once, rays) - 1);
        cast();
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT |
                        GL_TEXTURE_FETCH_BARRIER_BIT);
    }
}

void require(bool holds, const char* what, int value) {
    if (!holds) throw std::invalid_argument(fmt::format("bounce light: {}, not {}", what, value));
}

/// Environment, shading and rays, set for a program in use.
void bind(Program& program, const BouncingObjects& objects, const BounceLightSettings& settings) {
    objects.bind_light(program);
    objects.rays.bind(program);
    program.set("ray_bounces", settings.bounces);
}

void make_radiosity(ShaderLibrary& shaders, const BouncingObjects& objects, bool has_bounced) {
    const RayScene::VertexLight& light = objects.rays.light();
    Program& program = shaders.compute("effects/bounce_light/radiosity.comp");
    program.use();
    objects.bind_light(program);
    objects.rays.bind(program);
    light.direct.bind(GL_SHADER_STORAGE_BUFFER, 0);
    light.emission.bind(GL_SHADER_STORAGE_BUFFER, 1);
    light.radiosity.bind(GL_SHADER_STORAGE_BUFFER, 2);
    light.bounced.bind(GL_SHADER_STORAGE_BUFFER, 3);
    const auto count = static_cast<int>(objects.rays.vertex_count());
    program.set("vertex_count", count);
    program.set("has_bounced", has_bounced);
    glDispatchCompute(static_cast<GLuint>((count + vertex_group - 1) / vertex_group), 1, 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
}

Eigen::Vector4f as_vector(const Eigen::AlignedBox2d& rectangle_m) {
    const Eigen::Vector2f low = rectangle_m.min().cast<float>(), size = rectangle_m.sizes().cast<float>();
    return {low.x(), low.y(), size.x(), size.y()};
}

}  // namespace

void BounceLightSettings::check() const {
    require(rays >= 0 && rays <= 4096, "rays must be 0..4096", rays);
    require(surface_rays >= 1 && surface_rays <= 4096, "surface_rays must be 1..4096", surface_rays);
    require(most_rays >= 1, "most_rays must be 1 or more", most_rays);
    require(bounces >= 1 && bounces <= 16, "bounces must be 1..16", bounces);
    require(surface_points >= 2 && surface_points <= 1024, "surface_points must be 2..1024", surface_points);
}

void bounce_between_objects(ShaderLibrary& shaders, const BouncingObjects& objects,
                            const BounceLightSettings& settings) {
    settings.check();
    const RayScene::VertexLight& light = objects.rays.light();
    Program& direct = shaders.compute("effects/bounce_light/direct.comp", objects.defines);
    direct.use();
    objects.bind_light(direct);
    objects.rays.bind(direct);
    direct.set("has_visibility", objects.has_visibility);
    light.direct.bind(GL_SHADER_STORAGE_BUFFER, 2);
    objects.surfaces.run_over_vertices(direct);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    make_radiosity(shaders, objects, false);
    if (settings.rays == 0) return light.bounced.clear();
    Program& gather = shaders.compute("effects/bounce_light/vertices.comp", objects.defines);
    constexpr int least_rays = 4;
    const int affordable = settings.most_rays / static_cast<int>(std::max<std::size_t>(objects.rays.vertex_count(), 1));
    const int rays = std::min(settings.rays, std::max(affordable, least_rays));
    for (int bounce = 0; bounce < settings.bounces; ++bounce) {
        gather.use();
        bind(gather, objects, settings);
        light.bounced.bind(GL_SHADER_STORAGE_BUFFER, 3);
        cast_rays(gather, rays, [&] { objects.surfaces.run_over_vertices(gather); });
        make_radiosity(shaders, objects, true);
    }
}

void bounce_to_surface(ShaderLibrary& shaders, const BouncingObjects& objects, ContactShadow& shadow,
                       const Eigen::AlignedBox2d& lit_m, const Eigen::Vector3d& irradiance,
                       const BounceLightSettings& settings) {
    settings.check();
    if (settings.rays == 0 || lit_m.isEmpty()) return;
    const double point_m = lit_m.sizes().maxCoeff() / settings.surface_points;
    const auto points = [&](double side_m) { return std::max(2, static_cast<int>(std::ceil(side_m / point_m))); };
    const int width = points(lit_m.sizes().x()), height = points(lit_m.sizes().y());
    const Texture2D share({.format = GL_RGBA32F, .width = width, .height = height});
    Program& gather = shaders.compute("effects/bounce_light/surface.comp", objects.defines);
    gather.use();
    bind(gather, objects, settings);
    gather.set("rectangle_m", as_vector(lit_m));
    gather.set("surface_irradiance", Eigen::Vector3f(irradiance.cast<float>()));
    share.bind_image(0, GL_READ_WRITE);
    constexpr int group = 8;  // as surface.comp says
    cast_rays(gather, settings.surface_rays, [&] {
        glDispatchCompute(static_cast<GLuint>((width + group - 1) / group),
                          static_cast<GLuint>((height + group - 1) / group), 1);
    });

    const FullScreenTriangle triangle;
    Program& add = shaders.full_screen("effects/bounce_light/add_to_shadow.frag");
    add.use();
    add.bind_texture("share", 0, share);
    add.set("share_rectangle_m", as_vector(lit_m));
    glDisable(GL_DEPTH_TEST);
    for (const ShadowMap* map : {&shadow.far, &shadow.fine}) {
        const Framebuffer target({map->loss});
        target.bind();
        // What the shadow took the casters to send back is known better now.
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
        target.clear_color(0, 0, 0, 0, 0);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
        if (map == &shadow.far) {
            glEnable(GL_BLEND);
            glBlendFunc(GL_ONE, GL_ONE);
            add.set("rectangle_m", as_vector(map->rectangle_m));
            add.set("map_size",
                    Eigen::Vector2f(static_cast<float>(map->loss.width()), static_cast<float>(map->loss.height())));
            triangle.draw();
            glDisable(GL_BLEND);
        }
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
}

Eigen::AlignedBox2d bounce_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m) {
    Eigen::AlignedBox2d lit(caster_bounds_m.min().head<2>(), caster_bounds_m.max().head<2>());
    const double grow_m = std::max(lit.sizes().maxCoeff(), caster_bounds_m.max().z() - surface_z_m);
    lit.min().array() -= grow_m;
    lit.max().array() += grow_m;
    return lit;
}

}  // namespace matchlight
