// Brings scene and solve together: what is made once for the clip, and what every frame needs.
#include "compositor/compositor.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "compositor/compositor_impl.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/transfer.h"
#include "render/effects/exposure.h"
#include "render/transparency_bound.h"

namespace matchlight {

namespace {

/// Rows R, G, B of linear light at evenly spaced codes, among them every code of the footage's own depth.
ImageF response_table(const Response& response, int bit_depth) {
    const int codes = (1 << std::clamp(bit_depth, 8, 12)) - 1;
    const int steps = codes * ((4080 + codes - 1) / codes);
    ImageF table(steps + 1, 3, 1);
    for (int channel = 0; channel < 3; ++channel) {
        const std::vector<float> samples = response.sampled_linear(steps + 1, channel);
        std::copy(samples.begin(), samples.end(), table.row(channel).begin());
    }
    return table;
}

/// A budget's table does not know what rays take: it leaves them out, unless the scene asks for them.
/// Of layers that are seen through the sRGB curve, whatever the exposure: light is counted in what makes code 1.
double peeling_residual(double tolerance_codes) {
    constexpr double brightest = 8;  // three stops above white
    const CodeOfChannel code_of = [](double light, int) { return srgb_code_from_linear(std::clamp(light, 0.0, 1.0)); };
    return residual_of_tolerance(code_of, Eigen::Vector3d::Constant(brightest), tolerance_codes);
}

Quality chosen_quality(const CompositorOptions& options, const Scene& scene, Warnings& warnings) {
    if (options.settings) return options.budget ? without_rays(*options.settings) : *options.settings;
    const Quality of_level = quality_of(options.quality);
    const Quality quality = with_choices_of(scene, options.budget ? without_rays(of_level) : of_level);
    if (scene.bounce && *scene.bounce && quality.reflection.level != ReflectionLevel::rays)
        warnings.add(scene.path.string() + ": no light bounces without rays: set [quality] reflections = \"rays\"");
    return quality;
}

}  // namespace

Compositor::Impl::Impl(GlContext& gl_context, const Scene& the_scene, const Solve& the_solve,
                       const CompositorOptions& the_options, Warnings& the_warnings)
    : context(gl_context),
      scene(the_scene),
      solve(with_overscan(the_solve, the_options.overscan)),
      options(the_options),
      quality(chosen_quality(the_options, scene, the_warnings)),
      warnings(the_warnings),
      surfaces(shaders),
      scene_focus(scene, solve.camera, surfaces),
      lens_map(make_lens_map(solve.camera)),
      effects(shaders, with_overscan(scene.effects, the_solve.camera, the_options.overscan), quality, solve.camera) {
    assert(options.layers || !options.overscan.any());
    open_side_footage();
    load_objects(warnings);
    for (const ObjectSettings& object : scene.objects) object_names.push_back(object.name);
    light.emplace(
        shaders,
        ClipLight::Lit{.objects = *scene_objects, .surfaces = surfaces, .gathered_surface = options.gathered_surface},
        scene, quality, warnings);
    if (scene.camera) {
        virtual_fps = scene.camera->fps;
        background.emplace(scene.background, light->probe(), solve.camera.width, solve.camera.height, warnings);
    }
    graph.set_leaves_out(options.leave_out);
    make_light();
    if (options.budget) keep_to_budget(*options.budget);
}

void Compositor::Impl::open_side_footage() {
    const Camera frame = without_overscan(solve.camera, options.overscan);
    const auto side = [&](const std::filesystem::path& path) {
        return SideFootage{.path = path,
                           .footage = scene.footage.video,
                           .width = frame.width,
                           .height = frame.height,
                           .frames = solve.frame_count,
                           .scale = scene.footage.depth_scale};
    };
    if (!scene.footage.matte.empty()) matte.emplace(side(scene.footage.matte), warnings);
    if (!scene.footage.depth.empty()) depth.emplace(side(scene.footage.depth), warnings);
}

ClipTime Compositor::Impl::start() const {
    return solve.frames.empty() ? ClipTime{} : time_of(solve.frames.front());
}

ObjectPreparation Compositor::Impl::object_preparation(const Scene& of_scene) const {
    const bool shade_each_other =
        quality.object_shadow.any() && std::ranges::any_of(of_scene.objects, &ObjectSettings::casts_shadow);
    const bool traced = quality.reflection.level == ReflectionLevel::rays;
    return {.fine_meshes = shade_each_other || traced, .traced = traced};
}

void Compositor::Impl::load_objects(Warnings& the_warnings) {
    scene_objects.emplace(surfaces, scene, solve, start(), object_preparation(scene), the_warnings);
    if (surfaces.any_spheres())
        surfaces.set_peeling(peeling_residual(scene.transparency_tolerance), most_peeled_layers, scene.transparency);
}

void Compositor::Impl::make_light() {
    graph.begin_frame(solve.camera.width, solve.camera.height);
    for (const PassInput& input : light->add_passes(graph)) graph.output(input.texture);
    graph.run(options.timed);
    check_no_gl_error("making the maps of the light");
    scene_objects->mark_lit();
    light_is_stale = false;
}

void Compositor::Impl::place_objects(const SolvedFrame& frame) {
    if (scene_objects->any_moves()) scene_objects->place(time_of(frame));
    const PlacementChange change = scene_objects->change_since_lit();
    if (!change.any && !light_is_stale) return;
    if (change.any) light->forget_shadows(graph, change.casters);
    if (change.casters || light_is_stale) {
        footprint.reset();
        shadow_detail.reset();
    }
    make_light();
}

bool Compositor::Impl::set_scene(const Scene& changed) {
    const SceneChange change = change_between(scene, changed);
    const ObjectPreparation before = object_preparation(scene), after = object_preparation(changed);
    spill_alone_changed = differ_in_spill_alone(scene, changed);
    if (!spill_alone_changed) drawn.reset();
    if (change.all || options.budget || options.overscan.any() || before.fine_meshes != after.fine_meshes) return false;
    if (change.materials && after.traced) return false;  // rays have the materials with the vertices
    surface_is_stale = surface_is_stale || needs_other_surface(changed, change);
    if (surface_is_stale && !dragging) return false;
    context.make_current();
    const std::vector<float> reflectances = surfaces.reflectances();
    for (std::size_t i = 0; i < changed.objects.size(); ++i) {
        const ObjectSettings& object = changed.objects[i];
        if (change.materials && !surfaces.set_material(i, object.material)) return false;
        surfaces.set_reflection(i, object.reflection);
        surfaces.set_casts_shadow(i, object.casts_shadow);
        object_names[i] = object.name;
    }
    if (change.placement || change.casting || change.light) scene_objects->set_scene(changed, solve, start());
    light->set_scene(graph, changed, change, warnings);
    const bool other_sky = change.light && changed.background.probe;
    if (changed.camera && (change.background || other_sky)) {
        background.emplace(changed.background, light->probe(), solve.camera.width, solve.camera.height, warnings);
    }
    light_is_stale = light_is_stale || change.reflection || change.shadows();
    if (surfaces.reflectances() != reflectances) {
        light->forget_shadows(graph, true);
        light_is_stale = true;
    }
    scene_focus.set_scene(changed);
    effects.set_settings(changed.effects);
    scene = changed;
    return true;
}

bool Compositor::Impl::needs_other_surface(const Scene& changed, const SceneChange& change) const {
    const bool may_have_one = options.gathered_surface || scene.surface.present != changed.surface.present;
    return change.surface_picture && may_have_one && !changed.camera;
}

bool Compositor::Impl::set_dragging(bool now) {
    context.make_current();
    dragging = now;
    const bool stale = light->set_dragging(graph, dragging, warnings);
    if (stale) drawn.reset();
    light_is_stale = light_is_stale || stale;
    return dragging || !surface_is_stale;
}

void Compositor::Impl::keep_to_budget(const FrameBudget& budget) {
    // One choice for the clip, so that nothing changes from frame to frame and no chunk differs from the whole.
    constexpr std::size_t most_frames = 32;
    const std::size_t step = std::max<std::size_t>(1, solve.frames.size() / most_frames);
    for (std::size_t i = 0; i < solve.frames.size(); i += step) {
        const SolvedFrame& frame = solve.frames[i];
        if (!frame.camera_from_world) continue;
        place_objects(frame);
        Eigen::AlignedBox2d object_bounds;
        const Reach reach = reach_of(*frame.camera_from_world, PlateFormat{}, object_bounds);
        const Region objects =
            object_bounds.isEmpty() ? Region{} : plate_region(object_bounds, solve.camera, lens_map, 0);
        constexpr double megapixel = 1e6;
        const FrameExtent extent{.object_megapixels = static_cast<double>(objects.width) * objects.height / megapixel,
                                 .reach_megapixels = static_cast<double>(reach.pixels()) / megapixel,
                                 .light = reach.bounds,
                                 .frame_width = solve.camera.width,
                                 .frame_height = solve.camera.height};
        LevelChoice choice = choose_levels(budget.table, loads_of(effects.settings(), extent), budget.ms);
        // The frame that has the least room decides.
        const bool decides =
            !level_choice || choice.within_budget < level_choice->within_budget ||
            (choice.within_budget == level_choice->within_budget &&
             choice.predicted_flip > level_choice->predicted_flip) ||
            (choice.levels == level_choice->levels && choice.predicted_ms > level_choice->predicted_ms);
        if (decides) level_choice = std::move(choice);
    }
    footprint.reset();  // it is of a plate's depth, which no frame has told yet
    if (!level_choice) return;
    if (!level_choice->within_budget) {
        warnings.add(
            fmt::format("{}: the quickest levels need about {:.3g} ms a frame, more than the budget of {:g} ms",
                        solve.footage_file, level_choice->predicted_ms, budget.ms));
    }
    quality = with_levels(quality, *level_choice);
    effects.set_quality(quality);
}

const Response& Compositor::Impl::response_of(const PlateFormat& format) const {
    if (format.transfer == Transfer::pq) return pq;
    if (format.transfer == Transfer::hlg) return hlg;
    return solve.response;
}

void Compositor::Impl::prepare_composite(const PlateFormat& format) {
    if (composite_pass) return;
    composite_pass =
        std::make_unique<CompositePass>(shaders, lens_map.nodes, LensMap::spacing,
                                        response_table(response_of(format), format.bit_depth), format.primaries);
}

FrameResources Compositor::Impl::resources() {
    return {.context = context,
            .shaders = shaders,
            .graph = graph,
            .surfaces = surfaces,
            .objects = *scene_objects,
            .grain = grain_noise,
            .light = *light,
            .composite = *composite_pass,
            .accumulator = accumulator,
            .holdout_accumulator = holdout_accumulator,
            .gather = gather,
            .surface_defocus = surface_defocus,
            .effects = effects,
            .camera = solve.camera,
            .lens_map = lens_map,
            .quality = quality,
            .drawn = drawn,
            .gathered = options.gathered_surface.get(),
            .background = background ? &*background : nullptr,
            .overscan = options.overscan,
            .timed = options.timed};
}

void Compositor::Impl::keep_objects_of(std::int64_t frame) {
    const bool same_frame = frame == std::exchange(drawn_frame, frame);
    const bool same = std::exchange(spill_alone_changed, false) && same_frame;
    if (!same || options.timed || options.layers) drawn.reset();
}

CompositedFrame Compositor::composite(PlateFrame plate) {
    CompositedFrame result{.plate = std::move(plate), .reach = {}, .code = {}, .touched = {}, .layers = std::nullopt};
    impl_->keep_objects_of(result.plate.index());
    const std::optional<FramePlan> plan = impl_->plan_of(result.plate, false);
    if (!plan) return result;
    FramePasses(impl_->resources(), *plan).composite(result, impl_->options);
    check_no_gl_error(fmt::format("compositing frame {}", result.plate.index()));
    if (!impl_->watched_pass.empty()) impl_->watched_map = impl_->light->map_of(impl_->watched_pass);
    if (result.clipped_under_shadow > 0) {
        impl_->warnings.add(
            fmt::format("{}: frames have clipped pixels under a shadow that no other frame shows unclipped: they are "
                        "known only from below, and their shadow may be too dark",
                        impl_->solve.footage_file));
    }
    return result;
}

void Compositor::set_effects(const EffectSettings& effects) {
    impl_->drawn.reset();
    impl_->effects.set_settings(effects);
}

bool Compositor::set_scene(const Scene& scene) {
    return impl_->set_scene(scene);
}

bool Compositor::set_dragging(bool dragging) {
    return impl_->set_dragging(dragging);
}

void Compositor::set_pose(std::int64_t frame, const RigidTransform& camera_from_world) {
    impl_->drawn.reset();
    for (SolvedFrame& solved : impl_->solve.frames) {
        if (solved.frame == frame) solved.camera_from_world = camera_from_world;
    }
}

void Compositor::watch(const std::string& pass) {
    impl_->graph.watch(pass);
    impl_->watched_pass = pass;
    impl_->watched_map.reset();
}

const std::optional<WatchedTexture>& Compositor::watched() const {
    return impl_->watched_map ? impl_->watched_map : impl_->graph.watched();
}

void Compositor::set_timed(bool timed) {
    impl_->options.timed = timed;
}

ShaderReload Compositor::reload_shaders() {
    impl_->context.make_current();
    ShaderReload reload = impl_->shaders.reload_changed();
    if (!reload.reloaded.empty()) {
        impl_->graph.forget_kept();
        impl_->drawn.reset();
    }
    return reload;
}

ImageF Compositor::meter_map(const PlateFrame& plate) {
    impl_->drawn.reset();
    const std::optional<FramePlan> plan = impl_->plan_of(plate, true);
    ImageF map = FramePasses(impl_->resources(), *plan).meter_map(plate);
    check_no_gl_error(fmt::format("metering frame {}", plate.index()));
    return map;
}

std::vector<PassReport> Compositor::reports() const {
    impl_->context.make_current();
    return impl_->graph.reports();
}

std::vector<NamedPart> Compositor::parts() const {
    // Objects of one name are told apart by their place in the scene.
    std::vector<std::string> names;
    for (const std::string& name : impl_->object_names) {
        std::string own = name;
        for (int next = 2; std::ranges::find(names, own) != names.end(); ++next) own = fmt::format("{} {}", name, next);
        names.push_back(std::move(own));
    }
    std::vector<NamedPart> parts;
    for (const SurfacePart& part : impl_->surfaces.parts()) {
        const std::string& object = names.at(part.object);
        parts.push_back({object, part.material.empty() ? object : part.material});
    }
    return parts;
}

ImageF Compositor::virtual_layer_code(const CompositedFrame& frame) const {
    const PlateFormat& format = frame.plate.format();
    ImageF picture(format.width, format.height, 4);
    if (!frame.layers) return picture;
    const Response& response = impl_->response_of(format);
    const Eigen::Matrix3d& footage_from_light = from_rec709(format.primaries);
    const Region& region = frame.layers->region;
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const float* light = frame.layers->virtual_rgba.pixel(x, y);
            const float alpha = light[3];
            if (!(alpha > 0)) continue;
            float* out = picture.pixel(region.x + x, region.y + y);
            // The curves belong to the light of the covered part: undo the coverage, code, and cover again.
            const double luminance = luminance_rec709(light[0], light[1], light[2]) / alpha;
            const double tone = tone_factor(luminance, frame.layers->light.white_light);
            const Eigen::Vector3d shown =
                footage_from_light * (tone / alpha * Eigen::Vector3d(light[0], light[1], light[2]));
            for (int c = 0; c < 3; ++c) {
                const double code = std::clamp(response.code_from_linear(shown[c], c), 0.0, 1.0);
                out[c] = static_cast<float>(code) * alpha;
            }
            out[3] = alpha;
        }
    });
    return picture;
}

const Overscan& Compositor::overscan() const {
    return impl_->options.overscan;
}

const Response& Compositor::response_of(const PlateFrame& plate) const {
    return impl_->response_of(plate.format());
}

ImageF Compositor::plate_linear(const PlateFrame& plate) const {
    const Response& response = impl_->response_of(plate.format());
    const Eigen::Matrix3d& light_from_footage = rec709_from(plate.format().primaries);
    ImageF image = plate.rgb_code({0, 0, plate.format().width, plate.format().height});
    parallel_for(image.height(), [&](int y) {
        for (int x = 0; x < image.width(); ++x) {
            float* pixel = image.pixel(x, y);
            Eigen::Vector3d footage_linear;
            for (int c = 0; c < 3; ++c) footage_linear[c] = response.linear_from_code(pixel[c], c);
            Eigen::Map<Eigen::Vector3f> light(pixel);
            light = (light_from_footage * footage_linear).cast<float>();
        }
    });
    return image;
}

}  // namespace matchlight
