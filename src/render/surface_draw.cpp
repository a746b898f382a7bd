// Draws objects in order, resolves their edges, draws the layers.
#include <algorithm>
#include <cassert>

#include "gl/context.h"
#include "render/blending_state.h"
#include "render/surface_object.h"
#include "render/surface_targets.h"
#include "render/virtual_layer.h"

namespace matchlight {

namespace {

/// That draws of light write.
int colors_of(const SurfaceView& view) {
    return 1 + (view.lens ? 1 : 0) + (view.parts_coverage ? 1 : 0);
}

void set_opaque_state() {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

void set_blended_state() {
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // premultiplied
    glDepthMask(GL_FALSE);
}

/// Whether the eye, or the near plane before it, may lie within the box.
bool enters(const SurfaceView& view, const Eigen::AlignedBox3d& box_m) {
    // Reversed z with the far plane at infinity has the near distance in this place; the corners of a wide view's near
    // plane lie a few times farther.
    const double margin_m = 4 * view.clip_from_world(2, 3);
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(margin_m);
    return Eigen::AlignedBox3d(box_m.min() - margin, box_m.max() + margin).contains(view.eye_world_m);
}

void set_lens(Program& program, const SurfaceLens& lens) {
    program.set("coc_scale_px_m", lens.focus.coc_scale_px_m);
    program.set("focus_per_m", 1 / lens.focus.focus_distance_m);
    program.set("near_m", near_plane_m);
    program.set("lens_right_world_m", Eigen::Vector3f(lens.right_world_m.cast<float>()));
    program.set("lens_down_world_m", Eigen::Vector3f(lens.down_world_m.cast<float>()));
    program.set("coc_range_px",
                Eigen::Vector2f(static_cast<float>(lens.range.nearest_px), static_cast<float>(lens.range.farthest_px)));
    program.set("layer_density", lens.layer_density);
    program.set("focuses_reflections", lens.focuses_reflections);
}

void set_focus(Program& program, const SurfaceLens& lens, std::size_t object) {
    const auto own = std::ranges::find(lens.apart, object, &ObjectFocus::object);
    const bool is_apart = own != lens.apart.end();
    program.set("object_is_sharp", is_apart && !own->distance_m);
    const double distance_m = is_apart && own->distance_m ? *own->distance_m : lens.focus.focus_distance_m;
    program.set("object_focus_per_m", 1 / distance_m);
}

void leave_state() {
    end_blending_before_depth();
    glDisable(GL_CULL_FACE);
    glFrontFace(GL_CCW);
}

}  // namespace

ObjectView view_of_object(const SurfaceView& view, std::size_t object) {
    const auto apart = std::ranges::find(view.apart, object, &ObjectView::object);
    return apart != view.apart.end() ? *apart : ObjectView{object, view.clip_from_world, view.eye_world_m};
}

void SurfaceRenderer::draw_mesh(Program& program, const SurfaceView& view, const Object& object,
                                const Mesh& mesh) const {
    const SurfaceMaterial& material = object.material_of(mesh);
    const bool hides_back =
        !material.factors.double_sided || (material.factors.alpha_mode == AlphaMode::opaque &&
                                           mesh.geometry.is_closed() && !enters(view, object.bounds_of(mesh)));
    material.bind(program);
    program.set("material_index", static_cast<double>(mesh.material));
    program.set("first_vertex", mesh.first_vertex);
    // A mirroring placement turns the triangles' winding round.
    glFrontFace(object.world_from_model.topLeftCorner<3, 3>().determinant() < 0 ? GL_CW : GL_CCW);
    if (hides_back) {
        glEnable(GL_CULL_FACE);
        glCullFace(GL_BACK);
        mesh.geometry.draw();
        return;
    }
    if (!material.blends()) {
        glDisable(GL_CULL_FACE);
        mesh.geometry.draw();
        return;
    }
    // Both sides of a blended mesh, the far one first.
    glEnable(GL_CULL_FACE);
    for (const GLenum hidden : {GL_FRONT, GL_BACK}) {
        glCullFace(hidden);
        mesh.geometry.draw();
    }
}

void SurfaceRenderer::place(Program& program, const SurfaceView& view, const Object& object,
                            const PlaceMore& place_more) const {
    const auto index = static_cast<std::size_t>(&object - objects_.data());
    if (view.lens) set_focus(program, *view.lens, index);
    const Eigen::Matrix3d linear = object.world_from_model.topLeftCorner<3, 3>();
    const ObjectView seen = view_of_object(view, index);
    program.set("clip_from_model", Eigen::Matrix4f((seen.clip_from_world * object.world_from_model).cast<float>()));
    program.set("eye_world", Eigen::Vector3f(seen.eye_world_m.cast<float>()));
    program.set("world_from_model", Eigen::Matrix4f(object.world_from_model.cast<float>()));
    program.set("normal_from_model", Eigen::Matrix3f(linear.inverse().transpose().cast<float>()));
    program.set("reflects_sphere_map", object.reflection == ReflectionForm::sphere_map);
    program.set("object_id", static_cast<unsigned>(object.id));
    if (place_more) place_more(program, index);
}

void SurfaceRenderer::draw_objects(const Programs& programs, const SurfaceView& view, Drawn drawn,
                                   const PlaceMore& place_more) const {
    Program& program = programs.meshes;
    program.use();
    Program* used = &program;
    // Another program, where the mesh needs one, has to know the object, too.
    const auto draw_with_own = [&](const Object& object, const Mesh& mesh, const Object*& placed) {
        const SurfaceMaterial& material = object.material_of(mesh);
        Program& own = material.defines.empty() || !programs.of_material ? program : programs.of_material(material);
        if (&own != used || placed != &object) {
            own.use();
            place(own, view, object, place_more);
        }
        used = &own;
        placed = &object;
        draw_mesh(own, view, object, mesh);
    };
    struct Transmitting {
        const Object* object;
        const Mesh* mesh;
    };
    std::vector<Transmitting> transmitting;
    struct Blended {
        const Object* object;
        const Mesh* mesh;
        double distance_m;
    };
    std::vector<Blended> blended;
    if (drawn == Drawn::holdouts || drawn == Drawn::holdout_ways) {
        set_opaque_state();
        draw_real(program, view, drawn, place_more);
        return leave_state();
    }
    const bool is_geometry = drawn == Drawn::layers || drawn == Drawn::ways;
    const bool of_blended = drawn == Drawn::transparent_light || drawn == Drawn::listed_light;
    const bool shows_blended = drawn == Drawn::light || of_blended || is_geometry;
    set_opaque_state();
    if (drawn == Drawn::hidden_light) {
        glDepthFunc(GL_EQUAL);
        glDepthMask(GL_FALSE);
    }
    draw_real(program, view, drawn, place_more);
    if (programs.spheres != nullptr) {
        draw_seen_spheres(*programs.spheres, view, place_more);
        program.use();
    }
    for (const Object& object : objects_) {
        if (object.is_holdout || object.is_spheres()) continue;
        const Object* placed = nullptr;
        for (const Mesh& mesh : object.meshes) {
            const bool blends = object.material_of(mesh).blends();
            if (blends ? !shows_blended : of_blended) continue;
            if (blends && !is_geometry) {
                const double distance_m = (object.bounds_of(mesh).center() - view.eye_world_m).norm();
                blended.push_back({&object, &mesh, distance_m});
            } else if (programs.make_backdrop && object.material_of(mesh).transmits()) {
                transmitting.push_back({&object, &mesh});
            } else {
                draw_with_own(object, mesh, placed);
            }
        }
    }
    if (!transmitting.empty()) programs.make_backdrop();
    for (const Transmitting& next : transmitting) {
        Program& own = programs.of_material(next.object->material_of(*next.mesh));
        own.use();
        own.set("backdrop_present", true);
        own.bind_texture("backdrop", backdrop_unit, targets_->backdrop);
        own.set("backdrop_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
        own.set("backdrop_size_px", Eigen::Vector2f(static_cast<float>(view.width), static_cast<float>(view.height)));
        const Object* placed = nullptr;
        draw_with_own(*next.object, *next.mesh, placed);
    }
    std::ranges::stable_sort(blended, std::greater<>(), &Blended::distance_m);
    if (!blended.empty()) set_blended_state();
    // What shows through blurs as what it is.
    if (drawn == Drawn::light && view.lens) glColorMaski(1, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    for (const Blended& next : blended) {
        const Object* placed = nullptr;
        draw_with_own(*next.object, *next.mesh, placed);
    }
    if (drawn == Drawn::light && view.lens) glColorMaski(1, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    leave_state();
}

SurfaceRenderer::Programs SurfaceRenderer::programs(const std::string& fragment, ShaderDefines defines,
                                                    const std::function<void(Program&)>& set_up) const {
    Program& meshes =
        shaders_.program({{GL_VERTEX_SHADER, "surface/surface.vert"}, {GL_FRAGMENT_SHADER, fragment}}, defines);
    meshes.use();
    if (set_up) set_up(meshes);
    if (!any_spheres()) return {meshes};
    defines["SPHERES"] = "1";
    if (any_halos()) defines["HALOS"] = "1";
    Program& spheres = shaders_.full_screen(fragment, defines);
    spheres.use();
    if (set_up) set_up(spheres);
    return {meshes, &spheres};
}

SurfaceRenderer::Programs SurfaceRenderer::with_relief(Programs drawn, const std::string& fragment,
                                                       const std::function<void(Program&)>& set_up) const {
    drawn.of_material = [this, plain = &drawn.meshes, fragment, set_up](const SurfaceMaterial& material) -> Program& {
        const ShaderDefines defines = geometry_defines(material.defines);
        if (defines.empty()) return *plain;
        Program& program =
            shaders_.program({{GL_VERTEX_SHADER, "surface/surface.vert"}, {GL_FRAGMENT_SHADER, fragment}}, defines);
        program.use();
        if (set_up) set_up(program);
        return program;
    };
    return drawn;
}

ShaderDefines SurfaceRenderer::light_defines(const SurfaceView& view, const SurfaceShading& shading) {
    ShaderDefines defines = view_defines(view);
    if (shading.shows_surface) defines["PLANE"] = "1";
    if (shading.traces_rays) defines["RAYS"] = "1";
    if (shading.pairs_maps) defines["PAIRED_MAPS"] = "1";
    if (shading.has_lamps) defines["LAMPS"] = "1";
    if (shading.fades_with_depth) defines["DEPTH_CUE"] = "1";
    return defines;
}

void SurfaceRenderer::set_light(Program& program, const Environment& environment, const SurfaceView& view,
                                const SurfaceShading& shading) {
    if (view.lens) set_lens(program, *view.lens);
    program.set("eye_world", Eigen::Vector3f(view.eye_world_m.cast<float>()));
    environment.bind(program);
    program.set("surface_shadow_present", 0);
    program.set("surface_is_near", 0);
    // Samplers of different kinds must not share a unit, even those that are not read.
    program.set("object_shadow_depth", static_cast<int>(SurfaceShading::object_shadow_unit));
    program.set("real_shadow_depth", static_cast<int>(SurfaceShading::object_shadow_unit + 1));
    program.set("objects_shade", false);
    program.set("backdrop_present", false);
    program.set("backdrop", static_cast<int>(backdrop_unit));
    program.set("plate_behind_present", false);
    if (shading.bind) shading.bind(program);
}

SurfaceRenderer::Programs SurfaceRenderer::light_programs(const Environment& environment, const SurfaceView& view,
                                                          const SurfaceShading& shading,
                                                          const ShaderDefines& more) const {
    // Meshes without baked visibility see all the light.
    glVertexAttrib4f(5, 1, 1, 1, 1);
    const std::string fragment = "surface/surface.frag";
    ShaderDefines defines = light_defines(view, shading);
    defines.insert(more.begin(), more.end());
    if (shading.traces_rays && any_spheres()) defines["RAY_SPHERES"] = "1";
    const auto set_up = [&environment, &view, &shading](Program& program) {
        set_light(program, environment, view, shading);
    };
    Programs of_light = programs(fragment, defines, set_up);
    if (of_light.spheres != nullptr && shading.has_lamps && has_classic_spheres()) {
        ShaderDefines with_classic = defines;
        for (const char* define : {"SPHERES", "CLASSIC_SHADING"}) with_classic[define] = "1";
        of_light.spheres = &shaders_.full_screen(fragment, with_classic);
        of_light.spheres->use();
        set_up(*of_light.spheres);
    }
    // Compiled and set up when the first mesh needs it.
    of_light.of_material = [this, fragment, defines, set_up, ready = std::vector<const Program*>()](
                               const SurfaceMaterial& material) mutable -> Program& {
        ShaderDefines with_material = defines;
        with_material.insert(material.defines.begin(), material.defines.end());
        if (!with_material.contains("LAMPS")) with_material.erase("CLASSIC_SHADING");  // it has nothing to shade by
        Program& program = shaders_.program(
            {{GL_VERTEX_SHADER, "surface/surface.vert"}, {GL_FRAGMENT_SHADER, fragment}}, with_material);
        if (std::ranges::find(ready, &program) == ready.end()) {
            program.use();
            set_up(program);
            ready.push_back(&program);
        }
        return program;
    };
    return of_light;
}

SurfacePicture SurfaceRenderer::draw(const Environment& environment, const SurfaceView& view,
                                     const SurfaceShading& shading) {
    assert(view.width > 0 && view.height > 0 && view.samples > 0);
    // Layers are peeled off one depth a pixel.
    const bool lists = lists_meshes(view);
    const int most_samples = any_spheres_blend() || lists ? 1 : current_gl_context()->info().max_samples;
    const int samples = std::min(view.samples, most_samples);
    targets_->fit_color(view, samples);
    assert(!view.lens || samples == 1);
    see_spheres(view, SphereKind::opaque);
    Programs programs = light_programs(environment, view, shading);
    if (view.lens) Targets::fit(targets_->focused, targets_->color, targets_->depth);
    const Region region{0, 0, view.width, view.height};
    const Framebuffer* target = view.lens     ? &targets_->focused.target
                                : samples > 1 ? &targets_->multisampled
                                              : &targets_->resolved;
    if (view.parts_coverage) {
        Targets::fit(targets_->covered, targets_->color, view.lens ? &targets_->focused.focus_share : nullptr,
                     samples > 1 ? nullptr : &targets_->depth);
        target = &targets_->covered.target;
        if (samples > 1) {
            Targets::fit(targets_->multisampled_covered, targets_->multisampled_color, nullptr,
                         &targets_->multisampled_depth);
            target = &targets_->multisampled_covered.target;
        }
    }
    begin_drawing(*target, region, colors_of(view));
    if (any_transmits()) {
        programs.make_backdrop = [this, target, &view, region] {
            targets_->take_backdrop(*target, view);
            target->bind(region);
        };
    }
    const bool leaves_blended = lists || (view.lens && view.lens->parts_transparent);
    draw_objects(programs, view, leaves_blended ? Drawn::opaque_light : Drawn::light);
    if (samples == 1) soften_sphere_edges(view, targets_->depth);
    draw_in_order(environment, view, shading, *target);
    if (samples > 1) {
        target->resolve_color_to(targets_->resolved, region);
        if (view.parts_coverage) target->resolve_color_to(targets_->covered.target, region, 1, 1);
        if (softens_sphere_edges(view)) {
            targets_->fit_edge_depth();
            target->resolve_depth_to(targets_->edge_depth_target, region);
            soften_sphere_edges(view, targets_->edge_depth);
        }
    }
    draw_outlines(view, shading);
    return {.width = view.width,
            .height = view.height,
            .color = &targets_->color,
            .depth_share = samples > 1 ? nullptr : &targets_->depth,
            .focus_share = view.lens ? &targets_->focused.focus_share : nullptr,
            .coverage = view.parts_coverage ? &targets_->covered.coverage : nullptr};
}

SurfacePicture SurfaceRenderer::draw_transparent(const Environment& environment, const SurfaceView& view,
                                                 const SurfaceShading& shading) {
    assert(view.lens && targets_->depth && Targets::holds(targets_->color, view, 0));
    const Texture2D& before = targets_->color;
    if (!targets_->transparent_color || targets_->transparent_color.width() != before.width() ||
        targets_->transparent_color.height() != before.height()) {
        targets_->transparent_color = Texture2D(before.shape());
    }
    Targets::fit(targets_->transparent, targets_->transparent_color, targets_->depth);
    // Spheres that are seen are opaque.
    Programs programs = light_programs(environment, view, shading);
    programs.spheres = nullptr;
    const Region region{0, 0, view.width, view.height};
    const Framebuffer* target = &targets_->transparent.target;
    if (view.parts_coverage) {
        Targets::fit(targets_->transparent_covered, targets_->transparent_color, &targets_->transparent.focus_share,
                     &targets_->depth);
        target = &targets_->transparent_covered.target;
    }
    begin_drawing(*target, region, colors_of(view), false);
    draw_objects(programs, view, Drawn::transparent_light);
    return {.width = view.width,
            .height = view.height,
            .color = &targets_->transparent_color,
            .focus_share = &targets_->transparent.focus_share,
            .coverage = view.parts_coverage ? &targets_->transparent_covered.coverage : nullptr};
}

SurfacePicture SurfaceRenderer::draw_hidden(const Environment& environment, const SurfaceView& view,
                                            const SurfaceShading& shading) {
    assert(targets_->depth && Targets::holds(targets_->color, view, 0));
    Targets::fit(targets_->hidden, view, Targets::color_format);
    if (view.lens) Targets::fit(targets_->hidden_focused, targets_->hidden.color, targets_->hidden.depth);
    const Region region{0, 0, view.width, view.height};
    const Framebuffer* target = view.lens ? &targets_->hidden_focused.target : &targets_->hidden.target;
    if (view.parts_coverage) {
        Targets::fit(targets_->hidden_covered, targets_->hidden.color,
                     view.lens ? &targets_->hidden_focused.focus_share : nullptr, &targets_->hidden.depth);
        target = &targets_->hidden_covered.target;
    }
    see_spheres(view, SphereKind::opaque, &targets_->depth);
    begin_drawing(*target, region, colors_of(view));
    // First where it is, then how it looks: so that little of it is shaded in vain, for mostly little is hidden.
    const std::string hidden_depth = "surface/hidden_depth.frag";
    const auto set_up = [&](Program& program) {
        program.bind_texture("nearest_depth_share", nearest_depth_unit, targets_->depth);
    };
    const Programs depth = with_relief(programs(hidden_depth, {}, set_up), hidden_depth, set_up);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_objects(depth, view, Drawn::hidden_depth);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    draw_objects(light_programs(environment, view, shading), view, Drawn::hidden_light);
    return {.width = view.width,
            .height = view.height,
            .color = &targets_->hidden.color,
            .depth_share = &targets_->hidden.depth,
            .focus_share = view.lens ? &targets_->hidden_focused.focus_share : nullptr,
            .coverage = view.parts_coverage ? &targets_->hidden_covered.coverage : nullptr};
}

SurfacePicture SurfaceRenderer::draw_layers(const SurfaceView& view) {
    assert(view.width > 0 && view.height > 0);
    targets_->fit_layers(view);
    see_spheres(view, SphereKind::all);
    const Framebuffer& target = targets_->layers;
    const Region region{0, 0, view.width, view.height};
    target.bind(region);
    begin_clearing(region);
    target.clear_color(0, 0, 0, 0, 0);
    target.clear_color(1, 0, 0, 0, 0);
    target.clear_color_integer(2, 0);
    target.clear_depth();
    glDisable(GL_SCISSOR_TEST);
    const std::string layers = "surface/layers.frag";
    draw_objects(with_relief(programs(layers), layers), view, Drawn::layers);
    return {.width = view.width,
            .height = view.height,
            .depth_m = &targets_->layer_depth_m,
            .normal = &targets_->layer_normal,
            .object_id = &targets_->layer_id};
}

const Texture2D& SurfaceRenderer::draw_ways(const SurfaceView& view, std::span<const ObjectWay> ways,
                                            WayPicture picture) {
    return draw_ways_into(*targets_, view, ways, picture, Drawn::ways);
}

const Texture2D& SurfaceRenderer::draw_ways_into(Targets& targets, const SurfaceView& view,
                                                 std::span<const ObjectWay> ways, WayPicture picture, Drawn drawn) {
    assert(view.width > 0 && view.height > 0 && ways.size() == objects_.size());
    Targets::ColorAndDepth& target = targets.ways.at(static_cast<std::size_t>(picture));
    Targets::fit(target, view, GL_RGBA32F);
    const bool shows_spheres = drawn == Drawn::ways && any_spheres();
    if (shows_spheres) see_spheres(view, SphereKind::all);
    const std::string fragment = "effects/motion_blur/ways.frag";
    Program& meshes =
        shaders_.program({{GL_VERTEX_SHADER, "effects/motion_blur/ways.vert"}, {GL_FRAGMENT_SHADER, fragment}});
    Program* spheres = shows_spheres ? &shaders_.full_screen(fragment, {{"SPHERES", "1"}}) : nullptr;
    for (Program* program : {&meshes, spheres}) {
        if (program == nullptr) continue;
        program->use();
        program->set("near_m", near_plane_m);
    }
    const Region region{0, 0, view.width, view.height};
    begin_drawing(target.target, region, 1);
    draw_objects({meshes, spheres}, view, drawn, [&](Program& program, std::size_t index) {
        const ObjectWay& way = ways[index];
        program.set("opening_camera_from_model", Eigen::Matrix4f(way.opening_camera_from_model.cast<float>()));
        program.set("closing_camera_from_model", Eigen::Matrix4f(way.closing_camera_from_model.cast<float>()));
        program.set("deforms", way.deforms);
    });
    return target.color;
}

std::vector<SurfacePart> SurfaceRenderer::parts() const {
    std::vector<SurfacePart> parts;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
        for (const SurfaceMaterial& material : objects_[i].materials) parts.push_back({i, material.factors.name});
    }
    return parts;
}

const Texture2D& SurfaceRenderer::draw_parts(const SurfaceView& view) {
    assert(view.width > 0 && view.height > 0);
    // What lets light through is told by how many samples it takes.
    constexpr int of_opacity = 4;
    const int samples = std::min(any_blends() ? std::max(view.samples, of_opacity) : view.samples,
                                 current_gl_context()->info().max_samples);
    Targets::fit(targets_->parts, view, GL_R32F, samples);
    see_spheres(view, SphereKind::all);
    const std::string parts = "surface/parts.frag";
    const auto set_up = [&](Program& program) { program.set("sample_count", samples); };
    const Programs drawn = with_relief(programs(parts, {}, set_up), parts, set_up);
    begin_drawing(targets_->parts.target, {0, 0, view.width, view.height}, 1);
    std::size_t first_part = 1;
    std::vector<std::size_t> first_parts;
    for (const Object& object : objects_) {
        first_parts.push_back(first_part);
        first_part += object.materials.size();
    }
    draw_objects(drawn, view, Drawn::layers, [&](Program& program, std::size_t index) {
        program.set("first_part", static_cast<double>(first_parts[index]));
    });
    return targets_->parts.color;
}

}  // namespace matchlight
