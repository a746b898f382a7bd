// Casts a few rays at a run, and adds the runs up.
#include "render/effects/surface_reflection.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"

namespace matchlight {

namespace {

/// llvmpipe ends all loops of an invocation after 65,535 rounds together.
constexpr int rays_at_once = 4;

/// The tangent of a half vector that a hundredth of a GGX lobe lies beyond, over alpha: 1 / (1 + t²) is as much.
constexpr double widest_tangent = 10;

}  // namespace

void SurfaceReflectionSettings::check() const {
    const auto require = [](bool holds, const char* what, double value) {
        if (!holds) throw std::invalid_argument(fmt::format("surface reflection: {}, not {}", what, value));
    };
    require(reflectance >= 0 && reflectance <= 1, "reflectance must be 0 to 1", reflectance);
    require(roughness >= 0 && roughness <= 1, "roughness must be 0 to 1", roughness);
    constexpr int most_rays = 1024;
    require(rays >= 1 && rays <= most_rays, "rays must be 1 to 1024", rays);
}

double lobe_reach(double roughness) {
    return 2 * std::atan(widest_tangent * roughness * roughness);
}

SurfaceReflection add_surface_reflection(RenderGraph& graph, ShaderLibrary& shaders,
                                         const SurfaceReflectionSettings& settings, const MirroringSurface& surface) {
    settings.check();
    GraphPass pass{.name = "surface reflection",
                   .reads = surface.light,
                   .writes = {GL_RGBA32F, GL_RGBA32F, GL_RGBA32F},
                   .region = surface.region};
    pass.draw = [&shaders, settings, surface](PassRun& run) {
        for (const int target : {0, 1, 2}) run.target().clear_color(target, 0, 0, 0, 0);
        Program& program = shaders.full_screen("effects/surface_reflection/reflect.frag", surface.defines);
        program.use();
        surface.bind_light(program);
        surface.bind_lens(program, 1);
        const RigidTransform world_from_camera = surface.camera_from_world.inverse();
        program.set("world_from_camera", Eigen::Matrix3f(world_from_camera.linear().cast<float>()));
        program.set("eye_world_m", Eigen::Vector3f(world_from_camera.translation().cast<float>()));
        program.set("mirror_z_m", surface.z_m);
        program.set("reflectance", settings.reflectance);
        program.set("roughness", settings.roughness);
        program.set("widest_tangent", widest_tangent);
        program.set("lobe_reach", lobe_reach(settings.roughness));
        const Eigen::Vector3d middle_m = surface.objects_m.center();
        program.set("objects_middle_m", Eigen::Vector3f(middle_m.cast<float>()));
        program.set("objects_radius_m", surface.objects_m.diagonal().norm() / 2);
        program.set("pixel_rays", settings.rays);
        glEnable(GL_SCISSOR_TEST);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        for (int first = 0; first < settings.rays; first += rays_at_once) {
            program.set("first_ray", first);
            program.set("last_ray", std::min(first + rays_at_once, settings.rays) - 1);
            for (const Region& one : surface.runs) {
                const Region part = one.moved(-surface.region.x, -surface.region.y);
                glScissor(part.x, part.y, part.width, part.height);
                run.draw(program);
            }
        }
        glDisable(GL_BLEND);
        glDisable(GL_SCISSOR_TEST);
    };
    const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
    return {written[0], written[1], written[2]};
}

}  // namespace matchlight
