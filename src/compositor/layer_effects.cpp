// One effect after the other on plate pixels.
#include "compositor/layer_effects.h"

#include <cmath>

#include "render/effects/defocus_diffusion.h"
#include "render/effects/defocus_layers.h"
#include "render/effects/defocus_mipmap.h"
#include "render/effects/defocus_one_pass.h"
#include "render/effects/defocus_two_pass.h"

namespace matchlight {

namespace {

GraphTexture add_gather(RenderGraph& graph, const LayerEffectInput& input, const FrameDefocus& defocus) {
    return input.gather.add(graph,
                            {.layer_drawn = input.input.layer_drawn,
                             .bind_layer = [&composite = input.composite, layer = input.input](
                                               Program& program) { composite.set_layer(program, layer); },
                             .region = input.objects,
                             .layer_density = input.layer_density,
                             .focus = input.input.optics.focus,
                             .range = defocus.objects,
                             .bokeh = defocus.settings.bokeh},
                            gather_knobs(input.quality));
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

double LayerEffectPlan::spread_px() const {
    if (!defocus) return 0;
    const double widest_px = defocus->objects.widest_px();
    switch (defocus->settings.level) {
        case DepthOfFieldLevel::layers:
        case DepthOfFieldLevel::mipmap:
        case DepthOfFieldLevel::diffusion:
            // On coarser texels, or without an edge: four standard deviations of the disc.
            return widest_px;
        case DepthOfFieldLevel::gather:
        case DepthOfFieldLevel::two_pass:
        case DepthOfFieldLevel::one_pass:
        case DepthOfFieldLevel::lens_samples:
            break;
    }
    return widest_px / 2;
}

bool LayerEffectPlan::samples_lens() const {
    return defocus && defocus->settings.level == DepthOfFieldLevel::lens_samples;
}

bool LayerEffectPlan::needs_hidden(QualityLevel quality) const {
    return defocus && defocus->settings.level == DepthOfFieldLevel::gather && gather_knobs(quality).hidden;
}

PlateLayer add_layer_effects(RenderGraph& graph, const LayerEffectInput& input, const LayerEffectPlan& plan) {
    PlateLayer layer;
    if (!plan.any()) return layer;
    if (plan.defocus && !plan.samples_lens() && input.input.layer_drawn) {
        if (plan.defocus->settings.level == DepthOfFieldLevel::gather) {
            layer.light = add_gather(graph, input, *plan.defocus);
        } else {
            const ResolvedLayer resolved = input.composite.add_resolved_layer(graph, input.input, input.objects);
            layer.light = add_defocus(graph, input.shaders,
                                      {.light = resolved.light,
                                       .inverse_depth = resolved.inverse_depth,
                                       .focus = input.input.optics.focus,
                                       .range = plan.defocus->objects,
                                       .bokeh = plan.defocus->settings.bokeh},
                                      plan.defocus->settings.level, input.quality);
        }
    }
    return layer;
}

}  // namespace matchlight
