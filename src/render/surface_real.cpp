// Draws what stands for real things: shapes and depths that hide what is virtual behind them, and catch its shadow.
#include <algorithm>
#include <cassert>

#include "gl/context.h"
#include "render/surface_object.h"
#include "render/surface_targets.h"
#include "render/virtual_layer.h"

namespace matchlight {

bool SurfaceRenderer::is_holdout(std::size_t index) const {
    return objects_.at(index).is_holdout;
}

bool SurfaceRenderer::any_holdout() const {
    return std::ranges::any_of(objects_, &Object::is_holdout);
}

Eigen::AlignedBox3d SurfaceRenderer::virtual_bounds_m() const {
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        if (!objects_[i].is_holdout) box.extend(object_bounds_m(i));
    }
    return box;
}

Eigen::AlignedBox3d SurfaceRenderer::caster_bounds_m(bool real) const {
    Eigen::AlignedBox3d box;
    for (const Object& object : objects_) {
        if (object.is_holdout != real) continue;
        for (const Mesh& mesh : object.meshes) {
            if (object.casts(mesh)) box.extend(object.bounds_of(mesh));
        }
        if (casts_spheres(object)) box.extend(sphere_bounds_m(object));
    }
    return box;
}

Eigen::AlignedBox3d SurfaceRenderer::shadow_caster_bounds_m() const {
    return caster_bounds_m(false);
}

Eigen::AlignedBox3d SurfaceRenderer::real_caster_bounds_m() const {
    return caster_bounds_m(true);
}

bool SurfaceRenderer::rays_meet_all_casters() const {
    return std::ranges::all_of(objects_, [](const Object& object) {
        return object.is_holdout || std::ranges::all_of(object.meshes, [&](const Mesh& mesh) {
                   constexpr float clear = 0.5F;  // as RayScene has it
                   const SurfaceMaterial& material = object.material_of(mesh);
                   const bool lets_light_through =
                       material.blends() || (material.transmits() && material.factors.transmission->strength > clear);
                   return object.casts(mesh) == !lets_light_through;
               });
    });
}

void SurfaceRenderer::draw_casters(Program& program, bool real) const {
    program.use();
    for (const Object& object : objects_) {
        if (object.is_holdout != real) continue;
        program.set("world_from_model", Eigen::Matrix4f(object.world_from_model.cast<float>()));
        for (const Mesh& mesh : object.meshes) {
            if (!object.casts(mesh)) continue;
            program.set("caster_reflectance", object.material_of(mesh).reflectance());
            mesh.geometry.draw();
        }
    }
}

void SurfaceRenderer::draw_shadow_casters(Program& program) const {
    draw_casters(program, false);
}

void SurfaceRenderer::draw_real_casters(Program& program) const {
    draw_casters(program, true);
}

ShaderDefines SurfaceRenderer::view_defines(const SurfaceView& view) {
    ShaderDefines defines;
    if (view.lens) defines["LENS"] = "1";
    if (view.parts_coverage) defines["COVERAGE"] = view.lens ? "2" : "1";
    return defines;
}

void SurfaceRenderer::draw_real(Program& program, const SurfaceView& view, Drawn drawn,
                                const PlaceMore& place_more) const {
    // Transparent meshes come before what draw() left in the depth buffer.
    if (drawn == Drawn::transparent_light || drawn == Drawn::listed_light ||
        (!any_holdout() && view.real_depth == nullptr))
        return;
    const bool is_light = drawn == Drawn::light || drawn == Drawn::opaque_light || drawn == Drawn::hidden_light;
    // Of how real things move it is known what they hide when; else, mostly, only their depth counts.
    if (drawn == Drawn::layers) glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    if (is_light && !view.parts_coverage) glColorMaski(0, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    if (view.real_depth != nullptr) draw_real_depth(view, drawn);
    Program& used = is_light ? shaders_.program({{GL_VERTEX_SHADER, "surface/surface.vert"},
                                                 {GL_FRAGMENT_SHADER, "surface/holdout.frag"}},
                                                view_defines(view))
                             : program;
    used.use();
    draw_holdout_meshes(used, view, drawn, place_more);
    // Where only depth is drawn the caller has masked the colour already.
    if (drawn != Drawn::hidden_depth) glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    program.use();
}

void SurfaceRenderer::draw_holdout_meshes(Program& program, const SurfaceView& view, Drawn drawn,
                                          const PlaceMore& place_more) const {
    // Both sides hide. Each catches its own shadow: open shapes have a mesh for either (scene_objects.cpp).
    if (drawn == Drawn::holdouts) {
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
    } else {
        glDisable(GL_CULL_FACE);
    }
    for (const Object& object : objects_) {
        if (!object.is_holdout) continue;
        place(program, view, object, place_more);
        // A mirroring placement turns the triangles' winding round.
        glFrontFace(object.world_from_model.topLeftCorner<3, 3>().determinant() < 0 ? GL_CW : GL_CCW);
        for (const Mesh& mesh : object.meshes) {
            object.material_of(mesh).bind(program);
            mesh.geometry.draw();
        }
    }
}

void SurfaceRenderer::draw_real_depth(const SurfaceView& view, Drawn drawn) const {
    ShaderDefines defines = view_defines(view);
    if (drawn == Drawn::hidden_depth) defines = {{"HIDDEN", "1"}};
    if (drawn == Drawn::ways || drawn == Drawn::holdout_ways) defines = {{"WAYS", "1"}};
    if (drawn == Drawn::layers || drawn == Drawn::holdouts) defines = {{"DEPTH_ALONE", "1"}};
    Program& program = shaders_.program(
        {{GL_VERTEX_SHADER, "surface/real_depth.vert"}, {GL_FRAGMENT_SHADER, "surface/real_depth.frag"}}, defines);
    program.use();
    view.real_depth->bind(program);
    program.set("clip_from_camera", Eigen::Matrix4f(view.real_depth->clip_from_camera.cast<float>()));
    const Region& cells = view.real_depth->cells;
    program.set("first_cell", Eigen::Vector2i(cells.x, cells.y));
    program.set("cells_across", cells.width);
    program.set("near_m", near_plane_m);
    // A shape and the depth of the same thing lie at the same place, as nearly as depths are known: to show the shape's
    // shadow, what is before it has to be so by more than that.
    constexpr double depth_noise = 0.02;
    const bool is_of_holdouts = drawn == Drawn::holdouts || drawn == Drawn::holdout_ways;
    program.set("nearness", is_of_holdouts ? 1 - depth_noise : 1.0);
    if (drawn == Drawn::hidden_depth) program.bind_texture("nearest_depth_share", nearest_depth_unit, targets_->depth);
    glDisable(GL_CULL_FACE);
    if (is_of_holdouts) glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    triangle_.draw_quads(cells.width * cells.height);
    if (is_of_holdouts) glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

SurfacePicture SurfaceRenderer::draw_holdouts(const SurfaceView& view) {
    assert(view.width > 0 && view.height > 0 && view.samples > 0 && !view.lens && !view.parts_coverage);
    const int samples = std::min(view.samples, current_gl_context()->info().max_samples);
    Targets& targets = *holdout_targets_;
    targets.fit_color(view, samples);
    Program& program = shaders_.program(
        {{GL_VERTEX_SHADER, "surface/surface.vert"}, {GL_FRAGMENT_SHADER, "surface/holdout_shadow.frag"}});
    program.use();
    // Meshes without baked visibility see all the light.
    glVertexAttrib4f(5, 1, 1, 1, 1);
    const Region region{0, 0, view.width, view.height};
    const Framebuffer& target = samples > 1 ? targets.multisampled : targets.resolved;
    begin_drawing(target, region, 1);
    draw_objects({program, nullptr}, view, Drawn::holdouts);
    if (samples > 1) target.resolve_color_to(targets.resolved, region);
    return {.width = view.width,
            .height = view.height,
            .color = &targets.color,
            .depth_share = samples > 1 ? nullptr : &targets.depth};
}

const Texture2D& SurfaceRenderer::draw_holdout_ways(const SurfaceView& view, std::span<const ObjectWay> ways) {
    return draw_ways_into(*holdout_targets_, view, ways, WayPicture::shutter, Drawn::holdout_ways);
}

}  // namespace matchlight
