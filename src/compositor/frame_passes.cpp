// Adds passes, runs the graph, reads back.
#include "compositor/frame_passes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compositor/exchange.h"
#include "core/parallel.h"
#include "render/effects/exposure_meter.h"
#include "render/effects/spill.h"
#include "tracking/plate_light.h"

namespace matchlight {

namespace {

/// Code values over `region`, decoded in the runs alone; 0 beyond the frame.
ImageF code_of_runs(const PlateFrame& plate, const Region& region, const std::vector<Region>& runs,
                    const Overscan& overscan) {
    ImageF code(region.width, region.height, 3);
    const Region frame{overscan.x, overscan.y, plate.format().width, plate.format().height};
    for (const Region& whole_run : runs) {
        const Region run = whole_run.intersected(frame);
        if (run.empty()) continue;
        const ImageF part = plate.rgb_code(run.moved(-overscan.x, -overscan.y));
        for (int y = 0; y < run.height; ++y) {
            std::copy_n(part.pixel(0, y), 3 * run.width, code.pixel(run.x - region.x, run.y + y - region.y));
        }
    }
    return code;
}

/// Takes over what was read back (RGB, a = 1 where touched), for a result that covers `region` or more.
void take_code(CompositedFrame& result, const ImageF& read, const Region& region) {
    const int left = region.x - result.reach.x, top = region.y - result.reach.y;
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const float* from = read.pixel(x, y);
            if (!(from[3] > 0)) continue;
            std::copy_n(from, 3, result.code.pixel(left + x, top + y));
            result.touched.at(left + x, top + y) = 255;
        }
    });
}

GraphTexture add_inverse_depth(RenderGraph& graph, const ImageF& inverse_depth) {
    const Region frame = graph.frame();
    return graph.add_pass({.name = "real depth/upload",
                           .writes = {GL_R32F},
                           .region = frame,
                           .raster = false,
                           .bytes = static_cast<double>(inverse_depth.samples().size_bytes()),
                           .draw = [&inverse_depth, frame](PassRun& run) {
                               run.upload({0, 0, frame.width, frame.height}, inverse_depth.samples());
                           }})[0];
}

/// The result over a larger region: the plate's codes and untouched where it was not before.
void widen(CompositedFrame& result, const Region& region) {
    ImageF code(region.width, region.height, 3);
    Image8 touched(region.width, region.height, 1);
    const int left = result.reach.x - region.x, top = result.reach.y - region.y;
    for (int y = 0; y < result.reach.height; ++y) {
        std::copy_n(result.code.pixel(0, y), 3 * result.reach.width, code.pixel(left, top + y));
        std::copy_n(result.touched.pixel(0, y), result.reach.width, touched.pixel(left, top + y));
    }
    result.reach = region;
    result.code = std::move(code);
    result.touched = std::move(touched);
}

/// Counts from the frame's corner, and leaves of the picture what lies in the frame; layers stay whole.
void keep_frame(CompositedFrame& result, const Overscan& overscan) {
    const Region drawn = result.reach.moved(-overscan.x, -overscan.y);
    const Region kept = drawn.intersected({0, 0, result.plate.format().width, result.plate.format().height});
    ImageF code(kept.width, kept.height, 3);
    Image8 touched(kept.width, kept.height, 1);
    for (int y = 0; y < kept.height; ++y) {
        const int from_x = kept.x - drawn.x, from_y = kept.y - drawn.y + y;
        std::copy_n(result.code.pixel(from_x, from_y), 3 * kept.width, code.pixel(0, y));
        std::copy_n(result.touched.pixel(from_x, from_y), kept.width, touched.pixel(0, y));
    }
    result.reach = kept;
    result.code = std::move(code);
    result.touched = std::move(touched);
    result.layers->region = result.layers->region.moved(-overscan.x, -overscan.y);
}

}  // namespace

double half_code(const PlateFormat& format) {
    return 0.5 / ((1 << format.bit_depth) - 1);
}

CompositeInput FramePasses::composite_input(const ImageF& plate_code, const Region& region,
                                            const std::vector<Region>& runs) {
    CompositeInput input;
    input.plate_code = &plate_code;
    input.region = region;
    input.runs = runs;
    input.layer = layer_drawn_ ? &layer_ : nullptr;
    input.layer_drawn = layer_drawn_;
    input.background = background_;
    const std::optional<ContactShadow>& shadow = resources_.light.contact_shadow();
    input.shadow = shadow && plan_.posed ? &*shadow : nullptr;
    input.inverse_depth = inverse_depth_;
    input.matte = plan_.matte.empty() ? nullptr : &plan_.matte;
    input.optics = plan_.optics;
    if (plan_.posed) {
        input.reflection = resources_.light.add_reflection(
            resources_.graph,
            {.camera_from_world = plan_.optics.camera_from_world,
             .region = region,
             .runs = runs,
             .light = light_drawn_,
             .bind_lens = [this](Program& program, GLuint unit) { resources_.composite.set_lens(program, unit); }});
    }
    return input;
}

void FramePasses::take_unclipped(CompositeInput& input, CompositedFrame& result) {
    if (background_ || !plan_.in_shadow || input.shadow == nullptr) return;
    clipped_plate_ = unclip_plate(
        *input.plate_code, input.region, input.runs,
        {.gathered = resources_.gathered,
         .surface_z_m = input.shadow->surface_z_m,
         .optics = plan_.optics,
         .lens_map = resources_.lens_map,
         .in_shadow = plan_.in_shadow,
         .light_from_code = [this](float code,
                                   int channel) { return resources_.composite.linear_from_code(code, channel); },
         .rec709_from_footage = rec709_from(result.plate.format().primaries)});
    result.clipped_under_shadow = clipped_plate_.bounds;
    if (clipped_plate_.known.empty()) {
        resources_.graph.leave_out("plate/unclipped",
                                   "no clipped pixel under a shadow is better known by other frames or its neighbours");
        return;
    }
    input.unclipped = &clipped_plate_.known;
    input.clipped_code = PlateLight::clipped_code;
}

CompositeInput FramePasses::with_layer_effects(CompositeInput input) {
    const LayerEffectPlan& effects = plan_.layer_effects;
    if (holdouts_drawn_) {
        CompositeInput of_holdouts = input;
        of_holdouts.layer = &holdouts_;
        of_holdouts.layer_drawn = holdouts_drawn_;
        input.blurred.holdouts =
            add_lens_and_shutter(resources_.graph, layer_effect_input(of_holdouts, plan_.holdout_bounds), effects);
    }
    if (!effects.defocus && resources_.effects.settings().depth_of_field)
        resources_.graph.leave_out("depth of field", "no circle of confusion is a quarter of a pixel wide");
    if (!effects.motion_left_out.empty()) resources_.graph.leave_out("motion_blur", effects.motion_left_out);
    if (!effects.any()) return input;
    LayerEffectInput effect_input = layer_effect_input(input, plan_.object_bounds);
    if (parts_coverage()) effect_input.coverage = &coverage_layer_;
    const GraphTexture holdouts = input.blurred.holdouts;
    PlateLayer blurred = add_layer_effects(resources_.graph, effect_input, effects);
    blurred.holdouts = holdouts;
    input.blurred = blurred;
    return input;
}

LayerEffectInput FramePasses::layer_effect_input(const CompositeInput& input, const Eigen::AlignedBox2d& bounds) {
    const LayerEffectPlan& effects = plan_.layer_effects;
    constexpr int margin_px = 2;
    const int spread_px = static_cast<int>(std::ceil(effects.spread_px()));
    const bool is_of_objects = input.layer == &layer_;
    return {.shaders = resources_.shaders,
            .composite = resources_.composite,
            .gather = resources_.gather,
            .surface_defocus = resources_.surface_defocus,
            .input = input,
            .coverage = nullptr,
            .layer_density = (is_of_objects ? layer_ : holdouts_).fx / resources_.camera.fx,
            .parts_transparent = is_of_objects && parts_transparent(),
            .objects = bounds.isEmpty()
                           ? Region{}
                           : plate_region(bounds, resources_.camera, resources_.lens_map, margin_px + spread_px),
            .motion_quality = resources_.quality.motion_blur};
}

GraphTexture FramePasses::add_background() {
    if (resources_.background == nullptr) return {};
    const Camera& camera = resources_.camera;
    return resources_.background->add(resources_.graph, resources_.shaders,
                                      {.width = camera.width,
                                       .height = camera.height,
                                       .fx = camera.fx,
                                       .fy = camera.fy,
                                       .cx = camera.cx,
                                       .cy = camera.cy,
                                       .camera_from_world = plan_.optics.camera_from_world,
                                       .gain = plan_.optics.gain,
                                       .defocus = background_disc()});
}

std::optional<EvenDisc> FramePasses::background_disc() {
    const std::optional<DepthOfFieldSettings>& settings = resources_.effects.settings().depth_of_field;
    if (!settings) return std::nullopt;
    RenderGraph& graph = resources_.graph;
    const auto leave_out = [&](const char* why) {
        graph.leave_out("background defocus", why);
        return std::nullopt;
    };
    if (!resources_.background->can_blur()) return leave_out("even colours have no edges, and pictures their own blur");
    const double coc_px = signed_coc_px(plan_.optics.focus, std::numeric_limits<double>::infinity());
    if (coc_px < least_coc_px && graph.leaves_out())
        return leave_out("what is infinitely far away has no circle of confusion of a quarter pixel");
    // What is drawn from points of the lens sees the same background, at its finest.
    const bool exact = settings->level == DepthOfFieldLevel::lens_samples;
    return even_disc(settings->bokeh, coc_px, graph.frame(),
                     background_defocus_knobs(exact ? QualityLevel::reference : resources_.quality.depth_of_field));
}

std::optional<PlateBehind> FramePasses::plate_behind(const PlateFrame& plate) const {
    if (resources_.background != nullptr) {
        const std::optional<ImageF> picture = resources_.background->picture();
        if (!picture) return std::nullopt;
        return PlateBehind(*picture, resources_.camera, plan_.optics.camera_from_world);
    }
    const Camera& camera = resources_.camera;
    const Overscan& overscan = resources_.overscan;
    const Region frame{0, 0, camera.width, camera.height};
    const ImageF code = code_of_runs(plate, frame, {frame}, overscan);
    const Eigen::Matrix3d to_rec709 = rec709_from(plate.format().primaries);
    return PlateBehind(
        PlateBehind::Source{.code = code,
                            .shown = {overscan.x, overscan.y, plate.format().width, plate.format().height},
                            .camera = camera,
                            .lens_map = resources_.lens_map,
                            .optics = plan_.optics,
                            .light_from_code = [&](const float* rgb) -> Eigen::Vector3d {
                                const CompositePass& composite = resources_.composite;
                                return to_rec709 * Eigen::Vector3d(composite.linear_from_code(rgb[0], 0),
                                                                   composite.linear_from_code(rgb[1], 1),
                                                                   composite.linear_from_code(rgb[2], 2));
                            }});
}

void FramePasses::begin(const PlateFrame& plate, bool layers) {
    resources_.graph.begin_frame(resources_.camera.width, resources_.camera.height);
    for (const LeftOutEffect& effect : plan_.left_out) resources_.graph.leave_out(effect.name, effect.why);
    if (!plan_.inverse_depth.empty()) inverse_depth_ = add_inverse_depth(resources_.graph, plan_.inverse_depth);
    if (!plan_.object_bounds.isEmpty() && resources_.surfaces.any_transmits()) plate_behind_ = plate_behind(plate);
    light_drawn_ = resources_.light.add_passes(resources_.graph);
    layer_drawn_ = add_surface(layers);
    holdouts_drawn_ = add_holdouts();
    background_ = add_background();
}

ImageF FramePasses::decoded_plate(const PlateFrame& plate, const Region& region,
                                  const std::vector<Region>& runs) const {
    return background_ ? ImageF() : code_of_runs(plate, region, runs, resources_.overscan);
}

void FramePasses::take_picture(CompositedFrame& result, GraphTexture code, const std::vector<Region>& runs) const {
    const Region& region = result.reach;
    result.code = ImageF(region.width, region.height, 3);
    result.touched = Image8(region.width, region.height, 1);
    take_code(result, read_runs(resources_.graph.texture(code), region, runs, 4), region);
}

void FramePasses::composite(CompositedFrame& result, const CompositorOptions& options) {
    begin(result.plate, options.layers);
    result.reach = plan_.reach.bounds;
    if (options.layers || resources_.effects.any()) {
        composite_light(result, options.layers);
    } else {
        resources_.effects.explain(resources_.graph);
        composite_code(result);
    }
}

ImageF FramePasses::meter_map(const PlateFrame& plate) {
    RenderGraph& graph = resources_.graph;
    const Region& region = plan_.reach.bounds;
    begin(plate, false);
    const ImageF code = decoded_plate(plate, region, plan_.reach.runs);
    CompositeInput input = composite_input(code, region, plan_.reach.runs);
    input.light = true;
    input = with_layer_effects(input);
    const CompositePicture picture = resources_.composite.add(graph, input);
    const int block_px = meter_block_px(resources_.camera.width, resources_.camera.height);
    const GraphTexture map = add_exposure_meter(graph, resources_.shaders, picture.light.after, block_px);
    graph.output(map);
    graph.run(resources_.timed);
    const Region texels = graph.shape(map).region;
    return read_runs(graph.texture(map), texels, {texels}, 3);
}

void FramePasses::composite_code(CompositedFrame& result) {
    RenderGraph& graph = resources_.graph;
    const Region& region = result.reach;
    const std::vector<Region>& runs = plan_.reach.runs;
    const ImageF code = decoded_plate(result.plate, region, runs);
    CompositeInput input = composite_input(code, region, runs);
    input.least_visible_loss = half_code(result.plate.format());
    input.grain = add_grain(result, region);
    take_unclipped(input, result);
    input = with_layer_effects(input);
    const CompositePicture picture = resources_.composite.add(graph, input);
    graph.output(picture.code);
    graph.run(resources_.timed);
    take_picture(result, picture.code, runs);
}

double FramePasses::least_visible_light(const CompositedFrame& frame) const {
    return resources_.composite.least_visible_light(frame.plate.format().bit_depth);
}

std::optional<FrameGrain> FramePasses::add_grain(const CompositedFrame& frame, const Region& region) {
    if (!plan_.grain) return std::nullopt;
    GrainModel model = *plan_.grain;
    model.brightest = plan_.optics.white_light > 0 ? plan_.optics.white_light : resources_.composite.brightest_light();
    const double least_deviation = least_grain_deviation(model, least_visible_light(frame));
    RenderGraph& graph = resources_.graph;
    if (graph.leaves_out() && model.largest_deviation() < least_deviation) {
        graph.leave_out("grain", "none of its noise can move a code by half a step");
        return std::nullopt;
    }
    return FrameGrain{model, resources_.grain.add(graph, model, region), least_deviation};
}

void FramePasses::composite_light(CompositedFrame& result, bool layers) {
    RenderGraph& graph = resources_.graph;
    std::vector<Region> runs = plan_.reach.runs;
    if (layers) {
        // Layers are pictures: whole, and as far as the effects spill.
        if (resources_.effects.any()) result.reach = {0, 0, resources_.camera.width, resources_.camera.height};
        runs = {result.reach};
    }
    const Region region = result.reach;
    const ImageF code = decoded_plate(result.plate, region, runs);
    CompositeInput input = composite_input(code, region, runs);
    input.least_visible_loss = half_code(result.plate.format());
    input.light = true;
    input.layers = layers;
    input.grain = add_grain(result, region);
    take_unclipped(input, result);
    input = with_layer_effects(input);
    const CompositePicture picture = resources_.composite.add(graph, input);
    FrameLight light = picture.light;
    if (background_) light.before = {};  // no part of this light has spilled yet
    const GraphTexture spill = resources_.effects.add(graph, light);
    const ResponsePicture shown =
        resources_.composite.add_response(graph, {.plate = picture.plate,
                                                  .region = region,
                                                  .runs = runs,
                                                  .light = picture.light,
                                                  .spill = spill,
                                                  .white_light = plan_.optics.white_light,
                                                  .least_visible_code = half_code(result.plate.format()),
                                                  .least_visible_light = least_visible_light(result),
                                                  .layers = layers,
                                                  .grain = input.grain,
                                                  .plate_share = picture.plate_share});
    graph.output(shown.code);
    if (layers && plan_.neighbours && layer_drawn_) {
        exchange_ = add_exchange_layers(graph, resources_.shaders, resources_.composite, input);
        graph.output(exchange_->motion);
        for (const GraphTexture parts : exchange_->parts) graph.output(parts);
    }
    GraphTexture tiles;
    if (!layers && !background_) {
        tiles = add_spill_tiles(graph, resources_.shaders, spill, Reach::tile_px);
        graph.output(spill);
        graph.output(tiles);
    }
    for (const GraphTexture layer : {shown.linear, picture.shadow, picture.reflection, picture.virtual_rgba,
                                     picture.geometry, picture.object_id}) {
        graph.output(layer);
    }
    if (layers) {
        for (const GraphTexture layer : {background_, picture.light.before, shown.spill, input.blurred.coverage})
            graph.output(layer);
    }
    graph.run(resources_.timed);

    take_picture(result, shown.code, runs);
    if (tiles) composite_surroundings(result, spill, tiles);
    if (!layers) return;
    read_layers(result, picture, shown, input);
    if (resources_.overscan.any()) keep_frame(result, resources_.overscan);
}

void FramePasses::composite_surroundings(CompositedFrame& result, GraphTexture spill, GraphTexture tiles) {
    RenderGraph& graph = resources_.graph;
    const Region tile_region = graph.shape(tiles).region;
    const ImageF most = read_runs(graph.texture(tiles), tile_region, {tile_region}, 1);
    const double least_light = least_visible_light(result);
    const Reach around = tiles_of(resources_.camera, [&](int column, int row) {
        if (!tile_region.contains(column, row) || plan_.reach.has_tile(column, row)) return false;
        return !graph.leaves_out() || most.at(column - tile_region.x, row - tile_region.y) >= least_light;
    });
    if (around.runs.empty()) {
        graph.leave_out("response around", "no visible light spills beyond what objects touch");
        return;
    }
    const ImageF code = decoded_plate(result.plate, around.bounds, around.runs);
    const ResponsePicture shown =
        resources_.composite.add_response(graph, {.plate_code = &code,
                                                  .region = around.bounds,
                                                  .runs = around.runs,
                                                  .spill = spill,
                                                  .least_visible_code = half_code(result.plate.format()),
                                                  .least_visible_light = least_light,
                                                  .grain = add_grain(result, around.bounds)});
    graph.output(shown.code);
    graph.run(resources_.timed);
    widen(result, result.reach.united(around.bounds));
    take_code(result, read_runs(graph.texture(shown.code), around.bounds, around.runs, 4), around.bounds);
}

}  // namespace matchlight
