// What a frame needs drawn: how the camera saw, what objects and shadow reach, and which effects do something.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compositor/compositor_impl.h"
#include "compositor/nearest_known.h"
#include "compositor/sensor.h"
#include "core/error.h"

namespace matchlight {

namespace {

/// Zero around the frame, of which nothing is known.
ImageF beyond_frame(ImageF picture, const Overscan& overscan) {
    if (!overscan.any()) return picture;
    ImageF wider(picture.width() + 2 * overscan.x, picture.height() + 2 * overscan.y, 1);
    for (int y = 0; y < picture.height(); ++y)
        std::ranges::copy(picture.row(y), wider.row(y + overscan.y).begin() + overscan.x);
    return wider;
}

}  // namespace

FrameOptics Compositor::Impl::optics_of(const SolvedFrame& frame) const {
    FrameOptics optics;
    if (frame.camera_from_world) optics.camera_from_world = *frame.camera_from_world;
    optics.frame_width = solve.camera.width;
    optics.frame_height = solve.camera.height;
    optics.corner_ratio = corner_ratio(without_overscan(solve.camera, options.overscan), options.overscan);
    optics.vignette = vignette_of(effects.settings().vignette, solve);
    const SolvedFrame* exposed = solve.exposed_near(frame);
    if (exposed == nullptr) {
        warnings.add("the solve knows no frame's exposure: the probe's light is taken as the plate's");
    } else if (exposed != &frame) {
        warnings.add("frames without a measured exposure take their nearest neighbour's");
    }
    optics.gain = gain_near(solve, frame);
    if (frame.simulated) {
        optics.plate_gain = std::exp2(frame.simulated->ev - (exposed != nullptr ? *exposed->exposure_ev : 0));
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
    if (const Eigen::AlignedBox2d shaded = holdout_bounds(camera_from_world, spread); !shaded.isEmpty())
        regions.push_back(plate_region(shaded, solve.camera, lens_map, margin_px));
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        if (surfaces.is_holdout(i)) continue;
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
    return make_reach({.object_regions = regions, .shadow = shadow, .mirror = light->mirror_reach()}, camera_from_world,
                      lens_map, solve.camera);
}

Eigen::AlignedBox2d Compositor::Impl::holdout_bounds(const RigidTransform& camera_from_world,
                                                     const LayerEffectPlan& spread) const {
    Eigen::AlignedBox2d bounds;
    if (surfaces.shadow_caster_bounds_m().isEmpty()) return bounds;
    const double beyond = spread.lens_spread_px() / solve.camera.fx;
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        if (surfaces.is_holdout(i))
            bounds.extend(normalized_bounds_of_box(surfaces.object_bounds_m(i), camera_from_world, lens_map, beyond));
    }
    return bounds;
}

ShadowReach Compositor::Impl::shadow_reach(const PlateFormat& format) {
    const std::optional<ContactShadow>& shadow = light->contact_shadow();
    if (!shadow) return {};
    if (!footprint) footprint.emplace(shadow->far, shadow->fine, half_code(format));
    const double least_share = half_code(format);
    return {.in =
                [this, shadow = &*shadow, least_share](const Eigen::AlignedBox2d& box_m) {
                    return footprint->touches(box_m) ||
                           (shadow->lamps && shadow->lamps->light(box_m, shadow->surface_z_m, least_share));
                },
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
    // A cone's edge is in no map.
    edges.in = [this, in = shadow.in](const Eigen::AlignedBox2d& box_m) {
        return shadow_detail->touches(box_m) || (light->contact_shadow()->lamps && in(box_m));
    };
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
    if (const ColorTransform* transform = effects.color_transform()) {
        if (transform->settings().is_identity() && options.leave_out) {
            plan.left_out.push_back({"color transform", "it changes no colour"});
        } else {
            const Camera frame = without_overscan(solve.camera, options.overscan);
            layer.color_transform = transform;
            layer.color_frame = {.gain = plan.optics.gain,
                                 .mask_frame = {options.overscan.x, options.overscan.y, frame.width, frame.height}};
        }
    }
    layer.repeated_blur = asked.repeated_blur;
    if (layer.repeated_blur && layer.repeated_blur->radius_px == 0) {
        layer.repeated_blur.reset();
        plan.left_out.push_back({"repeated blur", "a box of one pixel changes nothing"});
    }
    if (asked.chromatic_aberration) layer.color = lateral_color_of(*asked.chromatic_aberration, solve, warnings);
    if (layer.color && options.leave_out) {
        Eigen::AlignedBox2d bounds;
        for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
            if (surfaces.is_holdout(i)) continue;
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
    const Camera frame_camera = without_overscan(camera, options.overscan);
    if (format.width != frame_camera.width || format.height != frame_camera.height) {
        throw InputError(solve.footage_file, plate.index(),
                         fmt::format("is {}×{}, the solve is for {}×{}", format.width, format.height,
                                     frame_camera.width, frame_camera.height),
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
    if (options.exchange && plan.posed) plan.neighbours.emplace(solve, solved, 0.0, 1 / virtual_fps.value_or(25));
    if (plan.posed) {
        plan_surface_defocus(plan, format);
        plan_sensor(plan);
    }
    if (const std::optional<GrainSettings>& grain = effects.settings().grain) {
        plan.grain = grain_of_frame(*grain, solve, plate.index(), plan.optics.plate_gain, warnings);
    }
    if (plan.posed) {
        plan.holdout_bounds = holdout_bounds(*solved.camera_from_world, plan.layer_effects);
        plan.reach = reach_of(*solved.camera_from_world, format, plan.object_bounds, plan.layer_effects);
        plan.in_shadow = shadow_reach(format).in;
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
    if (plan.posed && matte) plan.matte = beyond_frame(matte->coverage(plate.index()), options.overscan);
    if (plan.posed && depth) plan.inverse_depth = beyond_frame(depth->inverse_depth(plate.index()), options.overscan);
    prepare_composite(format);
    return plan;
}

}  // namespace matchlight
