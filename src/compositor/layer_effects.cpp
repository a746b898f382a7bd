// One effect after the other on plate pixels.
#include "compositor/layer_effects.h"

#include <algorithm>
#include <cmath>

#include "render/effects/defocus_diffusion.h"
#include "render/effects/defocus_layers.h"
#include "render/effects/defocus_mipmap.h"
#include "render/effects/defocus_one_pass.h"
#include "render/effects/defocus_two_pass.h"
#include "render/effects/motion_blur.h"

namespace matchlight {

namespace {

/// Of a picture through a lens that bends, more in one place than in another.
constexpr double most_magnification = 1.25;

GraphTexture add_gather(RenderGraph& graph, const LayerEffectInput& input, const FrameDefocus& defocus) {
    const bool is_straight = input.input.layer != nullptr && input.input.layer->whole_density > 0;
    GatherKnobs knobs = gather_knobs(defocus.quality);
    GatherInput gathered{.layer_drawn = input.input.layer_drawn,
                         .bind_layer = [&composite = input.composite,
                                        layer = input.input](Program& program) { composite.set_layer(program, layer); },
                         .layer_defines = CompositePass::layer_defines(input.input),
                         .region = input.objects,
                         .layer_density = input.layer_density,
                         .magnification = is_straight ? 1 : most_magnification,
                         .focus = input.input.optics.focus,
                         .range = defocus.objects,
                         .bokeh = defocus.settings.bokeh};
    const GraphTexture opaque = input.gather.add(graph, gathered, knobs);
    if (!input.parts_transparent) return opaque;
    gathered.bind_layer = [&composite = input.composite, layer = input.input](Program& program) {
        VirtualLayer before = *layer.layer;
        before.picture = before.transparent;
        before.hidden = {};
        CompositeInput of_before = layer;
        of_before.layer = &before;
        composite.set_layer(program, of_before);
    };
    gathered.is_transparent = true;
    knobs.hidden = false;
    const GraphTexture transparent = input.gather.add(graph, gathered, knobs);
    return add_slice_over(graph, input.shaders, {.before = transparent, .behind = opaque, .region_of = opaque});
}

/// By the methods that work on one picture of the layer.
GraphTexture add_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input, DepthOfFieldLevel level,
                         QualityLevel quality) {
    switch (level) {
        case DepthOfFieldLevel::two_pass:
            return add_two_pass_defocus(graph, shaders, input, two_pass_knobs(quality));
        case DepthOfFieldLevel::one_pass:
            return add_one_pass_defocus(graph, shaders, input, one_pass_knobs(quality));
        case DepthOfFieldLevel::diffusion:
            return add_diffusion_defocus(graph, shaders, input, diffusion_knobs(quality));
        case DepthOfFieldLevel::layers:
            return add_layers_defocus(graph, shaders, input, layers_knobs(quality));
        case DepthOfFieldLevel::mipmap:
            return add_mipmap_defocus(graph, shaders, input, mipmap_knobs(quality));
        case DepthOfFieldLevel::gather:
        case DepthOfFieldLevel::lens_samples:
            break;
    }
    return input.light;
}

}  // namespace

int FrameSurfaceDefocus::reach_px(const Region& tile, int around_px) const {
    // Tiles beside it may be drawn on coarser texels.
    const int least_class = around_px > 0 && smooth_over_m > 0 ? coarsest_smooth_class : smooth_class_of(tile);
    return focus.reach_px(tile.grown(around_px), least_class, knobs);
}

double LayerEffectPlan::lens_spread_px() const {
    const double of_motion = motion ? motion->objects.spread_px : 0;
    // Circles too narrow to count move nothing: the layer is drawn as without them, bit for bit.
    if (!defocus || defocus->objects.is_sharp()) return of_motion;
    const double widest_px = defocus->objects.widest_px();
    switch (defocus->settings.level) {
        case DepthOfFieldLevel::layers:
        case DepthOfFieldLevel::mipmap:
        case DepthOfFieldLevel::diffusion:
            // On coarser texels, or without an edge: four standard deviations of the disc.
            return widest_px + of_motion;
        case DepthOfFieldLevel::gather:
            return gathered_reach_px(widest_px, gather_knobs(defocus->quality)) + of_motion;
        case DepthOfFieldLevel::two_pass:
        case DepthOfFieldLevel::one_pass:
        case DepthOfFieldLevel::lens_samples:
            break;
    }
    return widest_px / 2 + of_motion;
}

double LayerEffectPlan::spread_px() const {
    double spread = lens_spread_px();
    // In the corners most is displaced; what lies between two texels is shown in both.
    if (color) spread += 1 + std::max(std::abs(color->red_px), std::abs(color->blue_px));
    if (repeated_blur) spread += repeated_blur_reach_px(*repeated_blur, repeated_blur_knobs(sensor_quality));
    return spread + softness_reach_px(softness_px, softness_knobs(sensor_quality));
}

bool LayerEffectPlan::samples_lens() const {
    return defocus && defocus->settings.level == DepthOfFieldLevel::lens_samples;
}

bool LayerEffectPlan::samples_time() const {
    return motion && motion->smears_objects && (samples_lens() || motion->settings.level != MotionBlurLevel::gather);
}

int LayerEffectPlan::samples() const {
    // Circles too narrow to count are none: all of the lens sees what its middle sees.
    const int of_lens = samples_lens() && !defocus->objects.is_sharp() ? defocus->settings.lens_samples : 1;
    return std::max(of_lens, samples_time() ? sub_frame_count(motion->settings) : 1);
}

bool LayerEffectPlan::needs_hidden() const {
    return defocus && defocus->settings.level == DepthOfFieldLevel::gather && gather_knobs(defocus->quality).hidden;
}

namespace {

/// What is out of focus, of the layer as drawn.
GraphTexture add_defocused(RenderGraph& graph, const LayerEffectInput& input, const FrameDefocus& defocus) {
    if (defocus.settings.level == DepthOfFieldLevel::gather) return add_gather(graph, input, defocus);
    const ResolvedLayer resolved = input.composite.add_resolved_layer(graph, input.input, input.objects);
    return add_defocus(graph, input.shaders,
                       {.light = resolved.light,
                        .inverse_depth = resolved.inverse_depth,
                        .focus = input.input.optics.focus,
                        .range = defocus.objects,
                        .bokeh = defocus.settings.bokeh},
                       defocus.settings.level, defocus.quality);
}

GraphTexture add_smeared(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan,
                         GraphTexture light) {
    const GraphTexture ways = add_plate_ways(graph, input.shaders, input.composite, input.input, input.objects);
    return add_motion_blur(graph, input.shaders,
                           {.light = light,
                            .ways = ways,
                            .way_px = plan.motion->objects.way_px,
                            .soft_px = plan.defocus ? plan.defocus->objects.widest_px() / 2 : 0},
                           motion_blur_knobs(input.motion_quality));
}

GraphTexture add_shadow_in_focus(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan,
                                 const Region& region) {
    if (!plan.surface_defocus) return input.composite.add_shadow_ratio(graph, input.input, region);
    const FrameSurfaceDefocus& defocus = *plan.surface_defocus;
    return input.surface_defocus.add(graph, input.composite,
                                     {.input = input.input,
                                      .focal_px = defocus.focus.focal_px(),
                                      .bokeh = defocus.bokeh,
                                      .tiles = defocus.tiles,
                                      .region = region.intersected(graph.frame())},
                                     defocus.knobs);
}

GraphTexture add_smeared_shadow(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    const FrameMotion& motion = *plan.motion;
    const double half_share = motion.shutter.share() / 2;
    const int spread_px = static_cast<int>(std::ceil(motion.surface.spread_px)) + 1;
    return add_shadow_motion_blur(
        graph, input.shaders, input.composite,
        {.ratio = add_shadow_in_focus(graph, input, plan, input.input.region.grown(spread_px)),
         .input = input.input,
         .ends = {.opening_camera_from_world = motion.shutter.camera_from_world(-half_share),
                  .closing_camera_from_world = motion.shutter.camera_from_world(half_share)},
         .way_px = motion.surface.way_px,
         .region = input.input.region},
        motion_blur_knobs(input.motion_quality));
}

/// Of what is blurred real things are a part, as they are before virtual ones; then the virtual light is taken out.
GraphTexture add_past_real_things(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    const GraphTexture light = add_lens_and_shutter(graph, input, plan);
    if (input.coverage == nullptr) return light;
    CompositeInput of_coverage = input.input;
    of_coverage.layer = input.coverage;
    LayerEffectInput again{.shaders = input.shaders,
                           .composite = input.composite,
                           .gather = input.gather,
                           .surface_defocus = input.surface_defocus,
                           .input = of_coverage,
                           .coverage = nullptr,
                           .layer_density = input.layer_density,
                           .parts_transparent = input.parts_transparent,
                           .objects = input.objects,
                           .motion_quality = input.motion_quality};
    const GraphTexture coverage = add_lens_and_shutter(graph, again, plan);
    return graph.add_pass({.name = "virtual coverage",
                           .reads = {{light}, {coverage}},
                           .writes = {GL_RGBA32F},
                           .draw = [&shaders = input.shaders, light, coverage](PassRun& run) {
                               Program& program = shaders.full_screen("composite/virtual_coverage.frag");
                               program.use();
                               run.bind(program, "light", 0, light);
                               run.bind(program, "coverage", 1, coverage);
                               run.draw(program);
                           }})[0];
}

}  // namespace

GraphTexture add_lens_and_shutter(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    const bool blurs_focus = plan.blurs_focus();
    const GraphTexture light = blurs_focus
                                   ? add_defocused(graph, input, *plan.defocus)
                                   : input.composite.add_resolved_layer(graph, input.input, input.objects).light;
    return plan.gathers_motion() ? add_smeared(graph, input, plan, light) : light;
}

PlateLayer add_layer_effects(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    PlateLayer layer;
    if (input.input.layer_drawn && (plan.blurs_focus() || plan.gathers_motion()))
        layer.light = add_past_real_things(graph, input, plan);
    if (input.input.shadow != nullptr) {
        if (plan.motion && plan.motion->smears_shadow) {
            layer.shadow = add_smeared_shadow(graph, input, plan);
        } else if (plan.surface_defocus) {
            layer.shadow = add_shadow_in_focus(graph, input, plan, input.input.region);
        }
    }
    if (!plan.acts_on_plate_pixels() || !input.input.layer_drawn) return layer;
    if (!layer.light) layer.light = input.composite.add_resolved_layer(graph, input.input, input.objects).light;
    if (plan.color_transform != nullptr)
        layer = plan.color_transform->add(graph, input.shaders, layer, plan.color_frame);
    if (plan.repeated_blur) {
        layer = add_repeated_blur(graph, input.shaders, layer, *plan.repeated_blur,
                                  repeated_blur_knobs(plan.sensor_quality));
    }
    if (plan.color) {
        layer = add_chromatic_aberration(graph, input.shaders, layer, *plan.color,
                                         chromatic_aberration_knobs(plan.sensor_quality));
    }
    return add_softness(graph, input.shaders, layer, plan.softness_px, softness_knobs(plan.sensor_quality));
}

}  // namespace matchlight
