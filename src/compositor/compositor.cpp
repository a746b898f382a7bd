// Brings scene and solve together: what is made once for the clip, and what every frame needs.
#include "compositor/compositor.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "compositor/camera_effects.h"
#include "compositor/clip_light.h"
#include "compositor/frame_passes.h"
#include "compositor/lens_map.h"
#include "compositor/quality.h"
#include "compositor/reach.h"
#include "compositor/scene_focus.h"
#include "compositor/scene_objects.h"
#include "compositor/sensor.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/transfer.h"
#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/effects/exposure.h"
#include "render/surface.h"

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

}  // namespace

struct Compositor::Impl {
    Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve, const CompositorOptions& the_options,
         Warnings& the_warnings);

    void load_objects(const Scene& scene, Warnings& warnings);
    /// Makes the light's maps, those that are there already excepted.
    void make_light();
    /// Puts objects where they are in the frame, and their shadows with them.
    void place_objects(const SolvedFrame& frame);
    void prepare_composite(const PlateFormat& format);
    const Response& response_of(const PlateFormat& format) const;
    FrameOptics optics_of(const SolvedFrame& frame) const;
    /// What a frame needs drawn; nullopt where it stays as it came.
    std::optional<FramePlan> plan_of(const PlateFrame& plate, bool whole_frame);
    FrameResources resources();
    /// Sets the levels that the largest of some frames over the clip has time for.
    void keep_to_budget(const FrameBudget& budget);
    /// Also extends `object_bounds` (normalised coordinates) by every object in view.
    Reach reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                   Eigen::AlignedBox2d& object_bounds, const LayerEffectPlan& spread = {});
    /// Where the shadow on the real surface can be seen; nowhere where there is none.
    ShadowReach shadow_reach(const PlateFormat& format);
    /// Sets how the shadow is out of focus, or why it is not.
    void plan_surface_defocus(FramePlan& plan, const PlateFormat& format);
    /// Also sets how the lens is focused.
    LayerEffectPlan layer_effects_of(const SolvedFrame& frame, FrameOptics& optics);
    std::optional<FrameDefocus> defocus_of(const SolvedFrame& frame, FrameOptics& optics);
    /// `left_out` says why there is none where the scene asks for it.
    std::optional<FrameMotion> motion_of(const SolvedFrame& frame, std::string& left_out);
    /// What is done to the layer on plate pixels.
    void plan_sensor(FramePlan& plan);

    GlContext& context;
    Solve solve;
    CompositorOptions options;
    Quality quality;
    Warnings& warnings;
    std::optional<double> virtual_fps;  // of a scene without footage
    ShaderLibrary shaders;
    SurfaceRenderer surfaces;
    std::optional<SceneObjects> scene_objects;
    RenderGraph graph;
    std::optional<ClipLight> light;
    std::optional<LevelChoice> level_choice;    // by the budget
    std::optional<Background> background;       // of a scene without footage
    std::optional<ShadowDetail> shadow_detail;  // made with the first frame that is out of focus
    std::optional<ShadowFootprint> footprint;   // made with the first frame, whose depth sets the limit
    SceneFocus scene_focus;
    LensMap lens_map;
    std::unique_ptr<CompositePass> composite_pass;
    SurfaceAccumulator accumulator{shaders};
    GatherDefocus gather{shaders};
    SurfaceDefocus surface_defocus{shaders};
    GrainNoise grain_noise{shaders};
    CameraEffects effects;
    Response pq = Response::pq();
    Response hlg = Response::hlg();
};

Compositor::Impl::Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve,
                       const CompositorOptions& the_options, Warnings& the_warnings)
    : context(gl_context),
      solve(the_solve),
      options(the_options),
      quality(the_options.settings.value_or(quality_of(the_options.quality))),
      warnings(the_warnings),
      surfaces(shaders),
      scene_focus(scene, solve.camera, surfaces),
      lens_map(make_lens_map(solve.camera)),
      effects(shaders, scene.effects, quality, solve.camera) {
    load_objects(scene, warnings);
    light.emplace(shaders, surfaces, scene, quality, warnings);
    if (scene.camera) {
        virtual_fps = scene.camera->fps;
        background.emplace(scene.background, light->probe(), solve.camera.width, solve.camera.height, warnings);
    }
    graph.set_leaves_out(options.leave_out);
    make_light();
    if (options.budget) keep_to_budget(*options.budget);
}

void Compositor::Impl::load_objects(const Scene& scene, Warnings& the_warnings) {
    const bool shade_each_other =
        quality.object_shadow.directions > 0 && std::ranges::any_of(scene.objects, &ObjectSettings::casts_shadow);
    const ClipTime start = solve.frames.empty() ? ClipTime{} : time_of(solve.frames.front());
    scene_objects.emplace(surfaces, scene, solve, start, shade_each_other, the_warnings);
}

void Compositor::Impl::make_light() {
    graph.begin_frame(solve.camera.width, solve.camera.height);
    for (const PassInput& input : light->add_passes(graph)) graph.output(input.texture);
    graph.run(options.timed);
    check_no_gl_error("making the maps of the light");
    scene_objects->mark_lit();
}

void Compositor::Impl::place_objects(const SolvedFrame& frame) {
    if (!scene_objects->any_moves()) return;
    scene_objects->place(time_of(frame));
    const PlacementChange change = scene_objects->change_since_lit();
    if (!change.any) return;
    light->forget_shadows(graph, change.casters);
    if (change.casters) {
        footprint.reset();
        shadow_detail.reset();
    }
    make_light();
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
    composite_pass = std::make_unique<CompositePass>(shaders, lens_map.nodes, LensMap::spacing,
                                                     response_table(response_of(format), format.bit_depth));
}

FrameOptics Compositor::Impl::optics_of(const SolvedFrame& frame) const {
    FrameOptics optics;
    if (frame.camera_from_world) optics.camera_from_world = *frame.camera_from_world;
    optics.frame_width = solve.camera.width;
    optics.frame_height = solve.camera.height;
    optics.vignette = vignette_of(effects.settings().vignette, solve);
    const SolvedFrame* exposed = solve.exposed_near(frame);
    if (exposed == nullptr) {
        warnings.add("the solve knows no frame's exposure: the probe's light is taken as the plate's");
    } else if (exposed != &frame) {
        warnings.add("frames without a measured exposure take their nearest neighbour's");
    }
    const double exposure_ev = exposed != nullptr ? *exposed->exposure_ev : 0;
    optics.gain.setConstant(std::exp2(exposure_ev));
    if (exposed != nullptr && exposed->white_balance) {
        const auto& balance = *exposed->white_balance;
        optics.gain = optics.gain.cwiseProduct(Eigen::Vector3d(balance[0], balance[1], balance[2]));
    }
    if (frame.simulated) {
        optics.plate_gain = std::exp2(frame.simulated->ev - exposure_ev);
        optics.gain *= optics.plate_gain;
        optics.white_light = frame.simulated->white;
    }
    return optics;
}

Compositor::Compositor(GlContext& context, const Scene& scene, const Solve& solve, const CompositorOptions& options,
                       Warnings& warnings)
    : impl_(std::make_unique<Impl>(context, scene, solve, options, warnings)) {}

Compositor::~Compositor() = default;

const std::optional<LevelChoice>& Compositor::level_choice() const {
    return impl_->level_choice;
}

SurfaceRenderer& Compositor::surfaces() {
    return impl_->surfaces;
}

Reach Compositor::Impl::reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                                 Eigen::AlignedBox2d& object_bounds, const LayerEffectPlan& spread) {
    constexpr int edge_px = 2;  // footprints and antialiased edges
    const int margin_px = edge_px + static_cast<int>(std::ceil(spread.spread_px()));
    // Lens and shutter bring in what lies beside the frame.
    const double beyond = spread.lens_spread_px() / solve.camera.fx;
    std::vector<Region> regions;
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        const Eigen::AlignedBox2d bounds =
            normalized_bounds_of_box(surfaces.object_bounds_m(i), camera_from_world, lens_map, beyond);
        if (bounds.isEmpty()) continue;
        object_bounds.extend(bounds);
        regions.push_back(plate_region(bounds, solve.camera, lens_map, margin_px));
    }
    ShadowReach shadow = shadow_reach(format);
    const int smear_px = spread.motion && spread.motion->smears_shadow
                             ? edge_px + static_cast<int>(std::ceil(spread.motion->surface.spread_px))
                             : 0;
    const std::optional<FrameSurfaceDefocus>& blur = spread.surface_defocus;
    shadow.beyond_frame = blur.has_value();
    shadow.spread_px = [&blur, smear_px](const Region& tile) {
        return smear_px + (blur ? blur->reach_px(tile, smear_px) : 0);
    };
    return make_reach(regions, shadow, camera_from_world, lens_map, solve.camera);
}

ShadowReach Compositor::Impl::shadow_reach(const PlateFormat& format) {
    const std::optional<ContactShadow>& shadow = light->contact_shadow();
    if (!shadow) return {};
    if (!footprint) footprint.emplace(shadow->far, shadow->fine, half_code(format));
    return {.in = [this](const Eigen::AlignedBox2d& box_m) { return footprint->touches(box_m); },
            .surface_z_m = shadow->surface_z_m};
}

void Compositor::Impl::plan_surface_defocus(FramePlan& plan, const PlateFormat& format) {
    const std::optional<DepthOfFieldSettings>& defocus = effects.settings().depth_of_field;
    if (!defocus || plan.optics.focus.coc_scale_px_m == 0) return;
    const auto leave_out = [&](const char* why) { plan.left_out.push_back({"surface defocus", why}); };
    ShadowReach shadow = shadow_reach(format);
    if (!shadow.in) return leave_out("there is no shadow on the real surface");
    const RigidTransform& camera_from_world = plan.optics.camera_from_world;
    const SurfaceFocus focus(plan.optics.focus, shadow.surface_z_m, camera_from_world, lens_map, solve.camera);
    if (!focus.is_seen()) return leave_out("the lens lies in the surface");
    // Points of the lens see the shadow each from its place: their mean is this, in its finest form.
    const bool exact = defocus->level == DepthOfFieldLevel::lens_samples;
    FrameSurfaceDefocus blur{.focus = focus,
                             .bokeh = defocus->bokeh,
                             .tiles = {},
                             .knobs = surface_defocus_knobs(exact ? QualityLevel::reference : quality.depth_of_field)};
    shadow.beyond_frame = true;
    shadow.spread_px = [&blur](const Region& tile) { return blur.reach_px(tile); };
    const RigidTransform world_from_camera = camera_from_world.inverse();
    bool blurred = false;
    if (blur.knobs.smooth_bend > 0) {
        const ContactShadow& maps = *light->contact_shadow();
        if (!shadow_detail) shadow_detail.emplace(maps.far, maps.fine, blur.knobs.smooth_bend);
        blur.smooth_over_m = shadow_detail->smooth_over_m();
    }
    ShadowReach edges = shadow;
    edges.spread_px = [&blur](const Region& tile) { return blur.focus.reach_px(tile, 0, blur.knobs); };
    edges.in = [this](const Eigen::AlignedBox2d& box_m) { return shadow_detail->touches(box_m); };
    for (const Region& tile : frame_tiles(solve.camera)) {
        if (options.leave_out && !sees_shadow(tile, shadow, world_from_camera, lens_map, solve.camera)) continue;
        blur.tiles.push_back(focus.over(tile));
        if (blur.smooth_over_m > 0 && !sees_shadow(tile, edges, world_from_camera, lens_map, solve.camera))
            blur.tiles.back().least_class = blur.smooth_class_of(tile);
        blurred = blurred || blur.tiles.back().widest_px >= least_coc_px;
    }
    if (!blurred && options.leave_out) return leave_out("where its shadow is seen no circle is a quarter pixel wide");
    plan.layer_effects.surface_defocus = std::move(blur);
}

LayerEffectPlan Compositor::Impl::layer_effects_of(const SolvedFrame& frame, FrameOptics& optics) {
    LayerEffectPlan plan;
    if (!frame.camera_from_world) return plan;
    plan.defocus = defocus_of(frame, optics);
    plan.motion = motion_of(frame, plan.motion_left_out);
    if (plan.motion && plan.blurs_focus() && plan.motion->settings.level != MotionBlurLevel::gather) {
        warnings.add(
            "motion blur is gathered, as depth of field blurs one picture; with depth_of_field at lens_samples the "
            "scene is drawn at many times");
        plan.motion->settings.level = MotionBlurLevel::gather;
    }
    return plan;
}

std::optional<FrameMotion> Compositor::Impl::motion_of(const SolvedFrame& frame, std::string& left_out) {
    const std::optional<MotionBlurSettings>& settings = effects.settings().motion_blur;
    if (!settings) return std::nullopt;
    const auto otherwise = virtual_fps ? std::optional(usual_shutter) : std::nullopt;
    const std::optional<double> share = shutter_share(*settings, solve, frame, otherwise, warnings);
    if (!share) {
        left_out = "how long the shutter is open is not known";
        return std::nullopt;
    }
    FrameMotion motion{.settings = *settings,
                       .shutter = {solve, frame, *share, 1 / virtual_fps.value_or(25)},
                       .objects = {},
                       .surface = {}};
    if (!motion.shutter.knows_motion() && solve.frame_count > 1) {
        warnings.add("frames whose neighbours have no pose get no motion blur by the camera");
    }
    motion.objects = object_motion_extent(surfaces, *scene_objects, motion.shutter, solve.camera);
    if (const std::optional<ContactShadow>& shadow = light->contact_shadow()) {
        motion.surface = surface_motion_extent(shadow->surface_z_m, motion.shutter, lens_map, solve.camera);
    }
    // One picture is blurred pixel by pixel, which leaves still ones alone; pictures at many times are not drawn of
    // what stands still.
    const bool drawn_all_the_same = !options.leave_out && settings->level == MotionBlurLevel::gather;
    motion.smears_shadow = motion.surface.way_px >= least_motion_px || drawn_all_the_same;
    motion.smears_objects = motion.objects.way_px >= least_motion_px || drawn_all_the_same;
    if (!motion.smears_objects && !motion.smears_shadow) {
        left_out = "nothing moves by a quarter of a pixel";
        return std::nullopt;
    }
    return motion;
}

std::optional<FrameDefocus> Compositor::Impl::defocus_of(const SolvedFrame& frame, FrameOptics& optics) {
    const std::optional<DepthOfFieldSettings>& defocus = effects.settings().depth_of_field;
    if (!defocus) return std::nullopt;
    const std::optional<double> autofocus_m = scene_focus.depth_m(*defocus, *frame.camera_from_world, warnings);
    optics.focus = focus_of_frame(*defocus, solve, frame, autofocus_m, warnings);
    const FrameView view{*frame.camera_from_world, lens_map.normalized_bounds, solve.camera.fx};
    const std::vector<ObjectFocus>& apart = scene_focus.apart();
    CocRange range;
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        const Eigen::AlignedBox3d box_m = surfaces.object_bounds_m(i);
        Focus focus = optics.focus;
        if (const auto own = std::ranges::find(apart, i, &ObjectFocus::object); own != apart.end()) {
            if (!own->distance_m) continue;
            focus.focus_distance_m = *own->distance_m;
        }
        const CocRange own_range = coc_range_of_box(focus, box_m, view);
        const double beyond = own_range.is_sharp() ? 0 : own_range.widest_px() / 2 / solve.camera.fx;
        if (normalized_bounds_of_box(box_m, *frame.camera_from_world, lens_map, beyond).isEmpty()) continue;
        range.extend(own_range);
    }
    if (range.is_sharp() && options.leave_out) return std::nullopt;
    return FrameDefocus{*defocus, range, apart, quality.depth_of_field};
}

void Compositor::Impl::plan_sensor(FramePlan& plan) {
    const EffectSettings& asked = effects.settings();
    LayerEffectPlan& layer = plan.layer_effects;
    layer.sensor_quality = quality.sensor;
    if (asked.chromatic_aberration) layer.color = lateral_color_of(*asked.chromatic_aberration, solve, warnings);
    if (layer.color && options.leave_out) {
        Eigen::AlignedBox2d bounds;
        for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
            bounds.extend(
                normalized_bounds_of_box(surfaces.object_bounds_m(i), plan.optics.camera_from_world, lens_map));
        }
        const int margin_px = static_cast<int>(std::ceil(layer.spread_px()));
        if (bounds.isEmpty() || layer.color->is_none(plate_region(bounds, solve.camera, lens_map, margin_px))) {
            layer.color.reset();
            plan.left_out.push_back({"chromatic aberration", "it displaces nothing in view by a quarter pixel"});
        }
    }
    if (asked.softness) layer.softness_px = softness_px_of(*asked.softness, solve, warnings);
    if (layer.softness_px > 0 && layer.softness_px < least_softness_px && options.leave_out) {
        layer.softness_px = 0;
        plan.left_out.push_back({"softness", "a Gaussian this narrow is none"});
    }
}

std::optional<FramePlan> Compositor::Impl::plan_of(const PlateFrame& plate, bool whole_frame) {
    const PlateFormat& format = plate.format();
    const Camera& camera = solve.camera;
    if (format.width != camera.width || format.height != camera.height) {
        throw InputError(
            solve.footage_file, plate.index(),
            fmt::format("is {}×{}, the solve is for {}×{}", format.width, format.height, camera.width, camera.height),
            "track this footage again");
    }
    static const SolvedFrame unknown;
    const SolvedFrame* found = solve.find(plate.index());
    const SolvedFrame& solved = found != nullptr ? *found : unknown;
    FramePlan plan;
    plan.posed = solved.camera_from_world.has_value();
    whole_frame = whole_frame || solved.simulated;
    if (!plan.posed && !whole_frame) return std::nullopt;
    whole_frame = whole_frame || background || !options.leave_out;
    context.make_current();
    if (plan.posed) place_objects(solved);
    plan.optics = optics_of(solved);
    plan.layer_effects = layer_effects_of(solved, plan.optics);
    if (plan.posed) {
        plan_surface_defocus(plan, format);
        plan_sensor(plan);
    }
    if (const std::optional<GrainSettings>& grain = effects.settings().grain) {
        plan.grain = grain_of_frame(*grain, solve, plate.index(), plan.optics.plate_gain, warnings);
    }
    if (plan.posed) {
        plan.reach = reach_of(*solved.camera_from_world, format, plan.object_bounds, plan.layer_effects);
    }
    if (whole_frame)
        plan.reach = {.runs = {{0, 0, camera.width, camera.height}}, .bounds = {0, 0, camera.width, camera.height}};
    if (!options.leave_out && plan.posed && plan.object_bounds.isEmpty())
        plan.object_bounds = lens_map.normalized_bounds;
    if (plan.reach.bounds.empty()) {
        graph.begin_frame(camera.width, camera.height);
        graph.leave_out("surface", "no object is in view, and none of its shadow");
        return std::nullopt;
    }
    prepare_composite(format);
    return plan;
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
            .gather = gather,
            .surface_defocus = surface_defocus,
            .effects = effects,
            .camera = solve.camera,
            .lens_map = lens_map,
            .quality = quality,
            .background = background ? &*background : nullptr,
            .timed = options.timed};
}

CompositedFrame Compositor::composite(PlateFrame plate) {
    CompositedFrame result{std::move(plate), {}, {}, {}, std::nullopt};
    const std::optional<FramePlan> plan = impl_->plan_of(result.plate, false);
    if (!plan) return result;
    FramePasses(impl_->resources(), *plan).composite(result, impl_->options);
    check_no_gl_error(fmt::format("compositing frame {}", result.plate.index()));
    return result;
}

void Compositor::set_effects(const EffectSettings& effects) {
    impl_->effects.set_settings(effects);
}

void Compositor::set_timed(bool timed) {
    impl_->options.timed = timed;
}

ShaderReload Compositor::reload_shaders() {
    impl_->context.make_current();
    ShaderReload reload = impl_->shaders.reload_changed();
    if (!reload.reloaded.empty()) impl_->graph.forget_kept();
    return reload;
}

ImageF Compositor::meter_map(const PlateFrame& plate) {
    const std::optional<FramePlan> plan = impl_->plan_of(plate, true);
    ImageF map = FramePasses(impl_->resources(), *plan).meter_map(plate);
    check_no_gl_error(fmt::format("metering frame {}", plate.index()));
    return map;
}

std::vector<PassReport> Compositor::reports() const {
    impl_->context.make_current();
    return impl_->graph.reports();
}

ImageF Compositor::virtual_layer_code(const CompositedFrame& frame) const {
    const PlateFormat& format = frame.plate.format();
    ImageF picture(format.width, format.height, 4);
    if (!frame.layers) return picture;
    const Response& response = impl_->response_of(format);
    const Region& region = frame.layers->region;
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const float* light = frame.layers->virtual_rgba.pixel(x, y);
            const float alpha = light[3];
            if (!(alpha > 0)) continue;
            float* out = picture.pixel(region.x + x, region.y + y);
            // The curves belong to the light of the covered part: undo the coverage, code, and cover again.
            const double luminance = luminance_rec709(light[0], light[1], light[2]) / alpha;
            const double tone = tone_factor(luminance, frame.layers->white_light);
            for (int c = 0; c < 3; ++c) {
                const double code = std::clamp(response.code_from_linear(tone * light[c] / alpha, c), 0.0, 1.0);
                out[c] = static_cast<float>(code) * alpha;
            }
            out[3] = alpha;
        }
    });
    return picture;
}

ImageF Compositor::plate_linear(const PlateFrame& plate) const {
    const Response& response = impl_->response_of(plate.format());
    ImageF image = plate.rgb_code({0, 0, plate.format().width, plate.format().height});
    parallel_for(image.height(), [&](int y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                float& value = image.at(x, y, c);
                value = static_cast<float>(response.linear_from_code(value, c));
            }
        }
    });
    return image;
}

}  // namespace matchlight
