// Sets of spheres among the objects: seen first, then lit once a pixel by the shaders that light meshes.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "render/surface_object.h"
#include "render/surface_targets.h"

namespace matchlight {

namespace {

/// Of shaders/spheres/seen.glsl: after those of rays, before those of the geometry.
constexpr GLuint seen_unit = 25;

/// One material for all; what spheres have of their own multiplies it.
Model material_model(const SphereSet& set) {
    Model model;
    model.name = set.name;
    ModelMaterial& material = model.materials.emplace_back();
    if (set.colors.empty()) material.base_color = {set.color[0], set.color[1], set.color[2], 1};
    if (set.opacities.empty()) material.base_color[3] = set.opacity;
    if (set.blends()) material.alpha_mode = AlphaMode::blend;
    return model;
}

/// The directions of clip x, y and w.
Eigen::Matrix3d picture_axes(const Eigen::Matrix4d& clip_from_any) {
    Eigen::Matrix3d axes;
    axes << clip_from_any.row(0).head<3>(), clip_from_any.row(1).head<3>(), clip_from_any.row(3).head<3>();
    return axes;
}

}  // namespace

std::size_t SurfaceRenderer::add_spheres(const SurfaceObject& object, const SphereSet& set) {
    assert(!object.model && !object.is_holdout);
    if (!spheres_) spheres_ = std::make_unique<SphereSets>(shaders_);
    const Model model = material_model(set);
    SurfaceObject without_mesh = object;
    without_mesh.model = &model;
    const std::size_t index = add_object(without_mesh);
    if (!set.spheres.empty()) objects_[index].spheres = spheres_->add(set);
    objects_[index].halo = object.halo;
    return index;
}

void SurfaceRenderer::set_halo(std::size_t index, const SphereHalo& halo) {
    objects_.at(index).halo = halo;
}

bool SurfaceRenderer::any_halos() const {
    return std::ranges::any_of(objects_, [](const Object& object) {
        return object.is_spheres() && !object.has_blending_spheres() && object.halo.strength > 0;
    });
}

bool SurfaceRenderer::any_spheres() const {
    return std::ranges::any_of(objects_, &Object::is_spheres);
}

bool SurfaceRenderer::casts_spheres(const Object& object) const {
    constexpr float solid = 0.5F;  // as of meshes
    return object.is_spheres() && object.casts_shadow && object.materials.front().factors.base_color[3] >= solid;
}

Eigen::AlignedBox3d SurfaceRenderer::sphere_bounds_m(const Object& object) const {
    return object.placed(spheres_->geometry(*object.spheres).bounds_m());
}

bool SurfaceRenderer::any_spheres_blend() const {
    return std::ranges::any_of(objects_, &Object::has_blending_spheres);
}

std::vector<PlacedSpheres> SurfaceRenderer::placed_spheres(const SurfaceView& view,
                                                           const std::function<bool(const Object&)>& of) const {
    std::vector<PlacedSpheres> placed;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        const Object& object = objects_[i];
        if (!object.is_spheres() || !of(object)) continue;
        placed.push_back({.set = *object.spheres,
                          .world_from_model = object.world_from_model,
                          .clip_from_world = view_of_object(view, i).clip_from_world,
                          .detail = {object.has_blending_spheres() ? 0 : view.sphere_detail_px}});
    }
    return placed;
}

void SurfaceRenderer::see_spheres(const SurfaceView& view, SphereKind kind, const Texture2D* nearer_share) {
    if (!any_spheres()) return;
    const auto placed = placed_spheres(
        view, [&](const Object& object) { return kind == SphereKind::all || !object.has_blending_spheres(); });
    seen_spheres_ = spheres_->see(placed, view.width, view.height, nearer_share);
}

void SurfaceRenderer::set_peeling(double residual, int most_layers, TransparencyMethod method) {
    peeling_residual_ = residual;
    most_peeled_layers_ = most_layers;
    transparency_ = method;
}

SurfaceRenderer::SphereLayer SurfaceRenderer::peel_spheres(const Environment& environment, const SurfaceView& view,
                                                           const SurfaceShading& shading) {
    const auto placed = placed_spheres(view, &Object::has_blending_spheres);
    Program* const light = light_programs(environment, view, shading).spheres;
    if (!spheres_) spheres_ = std::make_unique<SphereSets>(shaders_);  // none
    peeled_layers_ = peeling_.peel({.sets = *spheres_,
                                    .placed = placed,
                                    .width = view.width,
                                    .height = view.height,
                                    .opaque_depth = targets_->depth,
                                    .residual = peeling_residual_,
                                    .most_layers = most_peeled_layers_,
                                    .method = transparency_,
                                    .light =
                                        [&](const SeenSpheres& layer) {
                                            if (light == nullptr) return;
                                            seen_spheres_ = layer;
                                            draw_seen_spheres(*light, view, {});
                                        },
                                    .draw_others = listing(environment, view, shading)});
    return {peeling_.light(), peeling_.first_depth_share()};
}

SurfaceRenderer::SphereLayer SurfaceRenderer::blend_spheres(const Environment& environment, const SurfaceView& view,
                                                            const SurfaceShading& shading) {
    // Along the camera's z: of the corners of boxes, behind the near plane.
    double nearest_m = std::numeric_limits<double>::max(), farthest_m = 0;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        if (!objects_[i].has_blending_spheres()) continue;
        const Eigen::AlignedBox3d box = sphere_bounds_m(objects_[i]);
        for (int corner = 0; corner < 8; ++corner) {
            const Eigen::Vector3d at = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
            const double z_m = view_of_object(view, i).clip_from_world.row(3) * at.homogeneous();
            nearest_m = std::min(nearest_m, z_m);
            farthest_m = std::max(farthest_m, z_m);
        }
    }
    nearest_m = std::max(nearest_m, view.clip_from_world(2, 3));
    farthest_m = std::max(farthest_m, 1.001 * nearest_m);
    const auto draw = [&](const ShaderDefines& form, const std::function<void(Program&)>& set_up) {
        ShaderDefines defines = light_defines(view, shading);
        defines.insert(form.begin(), form.end());
        for (const char* define : {"SPHERES", "DRAWN", "BLENDED"}) defines[define] = "1";
        for (std::size_t i = 0; i < objects_.size(); ++i) {
            const Object& object = objects_[i];
            if (!object.has_blending_spheres()) continue;
            const PlacedSpheres placed{*object.spheres, object.world_from_model,
                                       view_of_object(view, i).clip_from_world};
            spheres_->draw_each({.placed = std::span(&placed, 1),
                                 .width = view.width,
                                 .height = view.height,
                                 .fragment = "surface/surface.frag",
                                 .defines = defines,
                                 .set_up =
                                     [&](Program& program) {
                                         set_light(program, environment, view, shading);
                                         place_spheres(program, view, object, {});
                                         set_up(program);
                                     },
                                 .depth = &targets_->depth,
                                 .peeled = nullptr});
        }
    };
    peeled_layers_ = 0;
    blending_.blend({.method = transparency_,
                     .width = view.width,
                     .height = view.height,
                     .opaque_depth = targets_->depth,
                     .nearest_m = nearest_m,
                     .farthest_m = farthest_m,
                     .draw = draw});
    const auto placed = placed_spheres(view, &Object::has_blending_spheres);
    return {blending_.light(), *spheres_->see(placed, view.width, view.height).depth_share};
}

bool SurfaceRenderer::lists_meshes(const SurfaceView& view) const {
    if (transparency_ != TransparencyMethod::lists || (view.lens && view.lens->parts_transparent)) return false;
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const Object& object : objects_) {
        if (object.is_holdout || object.is_spheres()) continue;
        for (const Mesh& mesh : object.meshes) {
            if (object.material_of(mesh).blends()) boxes.push_back(object.bounds_of(mesh));
        }
    }
    if (any_spheres_blend()) return !boxes.empty();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (boxes[i].intersects(boxes[j])) return true;
        }
    }
    return false;
}

std::function<void(bool)> SurfaceRenderer::listing(const Environment& environment, const SurfaceView& view,
                                                   const SurfaceShading& shading) const {
    if (!lists_meshes(view)) return {};
    return [this, &environment, &view, &shading](bool counts) {
        Programs programs = light_programs(environment, view, shading, {{"LISTED", "1"}});
        programs.spheres = nullptr;
        draw_objects(programs, view, Drawn::listed_light,
                     [counts](Program& program, std::size_t) { program.set("counts_only", counts); });
    };
}

void SurfaceRenderer::draw_in_order(const Environment& environment, const SurfaceView& view,
                                    const SurfaceShading& shading, const Framebuffer& target) {
    const bool lists = lists_meshes(view);
    if (!any_spheres_blend() && !lists) return;
    // How the lens blurs it, and what of it is virtual, is told of all layers at once.
    SurfaceView of_light = view;
    of_light.lens.reset();
    of_light.parts_coverage = false;
    const bool keeps_order = transparency_ == TransparencyMethod::lists ||
                             transparency_ == TransparencyMethod::peeling ||
                             transparency_ == TransparencyMethod::dual_peeling;
    const SphereLayer layer =
        keeps_order ? peel_spheres(environment, of_light, shading) : blend_spheres(environment, of_light, shading);
    Program& over = shaders_.full_screen("surface/peeled.frag", view_defines(view));
    target.bind({0, 0, view.width, view.height});
    over.use();
    over.bind_texture("peeled_light", seen_unit, layer.light);
    over.bind_texture("first_depth", seen_unit + 1, layer.first_depth_share);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // premultiplied
    triangle_.draw();
    glDisable(GL_BLEND);
    if (!lists || peeling_.unlisted_rows().empty()) return;
    Programs programs = light_programs(environment, view, shading);
    programs.spheres = nullptr;
    glEnable(GL_SCISSOR_TEST);
    for (const Region& rows : peeling_.unlisted_rows()) {
        glScissor(rows.x, rows.y, rows.width, rows.height);
        draw_objects(programs, view, Drawn::transparent_light);
    }
    glDisable(GL_SCISSOR_TEST);
}

void SurfaceRenderer::place_spheres(Program& program, const SurfaceView& view, const Object& object,
                                    const PlaceMore& place_more) const {
    const auto index = static_cast<std::size_t>(&object - objects_.data());
    place(program, view, object, place_more);
    SphereRays(
        {.clip_from_world = view_of_object(view, index).clip_from_world, .width = view.width, .height = view.height},
        object.world_from_model)
        .set(program);
    const SphereGeometry& geometry = spheres_->geometry(*object.spheres);
    geometry.bind(program);
    const std::uint32_t first_id = spheres_->first_id(*object.spheres);
    program.set("first_id", first_id);
    program.set("some_stand_for_others", view.sphere_detail_px > 0);
    program.set("end_id", first_id + geometry.size());
    object.materials.front().bind(program);
    program.set("material_index", 0.0);
    if (!any_halos()) return;
    const double focal_px = view_of_object(view, index).clip_from_world.row(0).head<3>().norm() * view.width / 2;
    program.set("halo_strength", object.has_blending_spheres() ? 0 : object.halo.strength);
    program.set("halo_radius_px", focal_px * std::tan(object.halo.width_deg * std::numbers::pi / 180));
    program.set("halo_depth_m", object.halo.depth_m);
    program.set("halo_step_px", view.halo_step_px);
}

void SurfaceRenderer::draw_seen_spheres(Program& program, const SurfaceView& view, const PlaceMore& place_more) const {
    program.use();
    program.bind_texture("seen_spheres", seen_unit, *seen_spheres_.id);
    program.bind_texture("seen_depth", seen_unit + 1, *seen_spheres_.depth_share);
    glDisable(GL_CULL_FACE);
    for (const Object& object : objects_) {
        if (!object.is_spheres()) continue;
        place_spheres(program, view, object, place_more);
        triangle_.draw();
    }
}

bool SurfaceRenderer::has_classic_spheres() const {
    return std::ranges::any_of(objects_, [](const Object& object) {
        return object.is_spheres() && object.materials.front().shading.model != ShadingModel::physical;
    });
}

bool SurfaceRenderer::softens_sphere_edges(const SurfaceView& view) const {
    return view.sphere_edge_places > 1 && std::ranges::any_of(objects_, [](const Object& object) {
               return object.is_spheres() && !object.has_blending_spheres();
           });
}

void SurfaceRenderer::soften_sphere_edges(const SurfaceView& view, const Texture2D& depth) {
    if (!softens_sphere_edges(view)) return;
    const Eigen::Matrix3d rays = camera_from_ndc(picture_axes(view.clip_from_world));
    // A lens that is sampled shears the views of objects that are focused apart: each has other rays.
    constexpr double same = 1e-6;
    for (const ObjectView& apart : view.apart) {
        if (!camera_from_ndc(picture_axes(apart.clip_from_world)).isApprox(rays, same)) return;
    }
    std::vector<const Texture2D*> drawn{&targets_->color};
    if (view.lens) drawn.push_back(&targets_->focused.focus_share);
    if (view.parts_coverage) drawn.push_back(&targets_->covered.coverage);
    sphere_edges_.soften(
        {.seen = seen_spheres_,
         .depth = &depth,
         .drawn = drawn,
         .width = view.width,
         .height = view.height,
         .near_m = view.clip_from_world(2, 3),
         .side = std::min(view.sphere_edge_places, most_edge_places),
         .camera_from_ndc = rays},
        [&](Program& outline) {
            draw_seen_spheres(outline, view, [&](Program& program, std::size_t index) {
                const Eigen::Matrix3d axes =
                    picture_axes(view_of_object(view, index).clip_from_world * objects_[index].world_from_model);
                const Eigen::Matrix3d exact = rays * axes;
                const Eigen::Matrix3f rounded = exact.cast<float>();
                program.set("camera_from_model", rounded);
                program.set("camera_from_model_low", Eigen::Matrix3f((exact - rounded.cast<double>()).cast<float>()));
            });
        });
}

void SurfaceRenderer::cast_shadow_spheres(const SphereCast& cast) const {
    for (const Object& object : objects_) {
        if (!casts_spheres(object)) continue;
        SphereCast of_object = cast;
        of_object.set_up = [&](Program& program) {
            if (cast.set_up) cast.set_up(program);
            program.set("caster_reflectance", object.materials.front().reflectance());
        };
        spheres_->cast(*object.spheres, object.world_from_model, of_object);
    }
}

}  // namespace matchlight
