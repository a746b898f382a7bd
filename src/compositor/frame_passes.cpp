// Adds passes, runs the graph, reads back.
#include "compositor/frame_passes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "render/effects/bokeh.h"
#include "render/effects/exposure_meter.h"
#include "render/effects/spill.h"

namespace matchlight {

namespace {

/// Layer pixels around what is in view, so that footprints at its edge find what they look for.
constexpr int layer_margin = 2;

/// Code values over `region`, decoded in the runs alone.
ImageF code_of_runs(const PlateFrame& plate, const Region& region, const std::vector<Region>& runs) {
    ImageF code(region.width, region.height, 3);
    for (const Region& run : runs) {
        const ImageF part = plate.rgb_code(run);
        for (int y = 0; y < run.height; ++y) {
            std::copy_n(part.pixel(0, y), 3 * run.width, code.pixel(run.x - region.x, run.y + y - region.y));
        }
    }
    return code;
}

ImageF channels_of(const ImageF& image, int first, int count) {
    ImageF part(image.width(), image.height(), count);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < count; ++c) part.at(x, y, c) = image.at(x, y, first + c);
        }
    }
    return part;
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

}  // namespace

double half_code(const PlateFormat& format) {
    return 0.5 / ((1 << format.bit_depth) - 1);
}

CompositeInput FramePasses::composite_input(const ImageF& plate_code, const Region& region,
                                            const std::vector<Region>& runs) const {
    CompositeInput input;
    input.plate_code = &plate_code;
    input.region = region;
    input.runs = runs;
    input.layer = layer_drawn_ ? &layer_ : nullptr;
    input.layer_drawn = layer_drawn_;
    input.background = background_;
    const std::optional<ContactShadow>& shadow = resources_.light.contact_shadow();
    input.shadow = shadow && plan_.posed ? &*shadow : nullptr;
    input.optics = plan_.optics;
    return input;
}

GraphTexture FramePasses::add_surface(bool layers) {
    RenderGraph& graph = resources_.graph;
    const std::vector<PassInput> light = resources_.light.add_passes(graph);
    Eigen::AlignedBox2d bounds = plan_.object_bounds;
    if (bounds.isEmpty()) {
        graph.leave_out("surface", "no object is in view");
        return {};
    }
    // What llvmpipe and GPUs alike hold as a target; wider views are drawn coarser.
    const double limit = std::min(8192, resources_.context.info().max_texture_size) - 4 * layer_margin - 1;
    const Camera& camera = resources_.camera;
    if (plan_.layer_effects.lens_spread_px() > 0) {
        const Eigen::Vector2d spread =
            plan_.layer_effects.lens_spread_px() * Eigen::Vector2d(1 / camera.fx, 1 / camera.fy);
        const Eigen::AlignedBox2d& frame = resources_.lens_map.normalized_bounds;
        bounds = Eigen::AlignedBox2d(bounds.min() - spread, bounds.max() + spread)
                     .intersection(Eigen::AlignedBox2d(frame.min() - spread, frame.max() + spread));
    }
    const Eigen::Vector2d span = bounds.sizes();
    double density = resources_.quality.supersampling;
    density = std::min({density, limit / (span.x() * camera.fx), limit / (span.y() * camera.fy)});
    layer_.fx = camera.fx * density;
    layer_.fy = camera.fy * density;
    SurfaceView view;
    if (!camera.has_distortion() && density == std::round(density)) {
        place_on_plate_pixels(bounds, view);
    } else {
        layer_.whole_density = 0;
        layer_.cx = layer_margin - std::floor(bounds.min().x() * layer_.fx);
        layer_.cy = layer_margin - std::floor(bounds.min().y() * layer_.fy);
        view.width = static_cast<int>(std::ceil(span.x() * layer_.fx)) + 2 * layer_margin + 1;
        view.height = static_cast<int>(std::ceil(span.y() * layer_.fy)) + 2 * layer_margin + 1;
    }
    // Depth of field reads the depth of single pixels.
    view.samples = plan_.layer_effects.blurs_focus() ? 1 : resources_.quality.samples;
    const PinholeView pinhole{.fx = layer_.fx,
                              .fy = layer_.fy,
                              .cx = layer_.cx,
                              .cy = layer_.cy,
                              .width = static_cast<double>(view.width),
                              .height = static_cast<double>(view.height),
                              .near_m = near_plane_m};
    const RigidTransform& camera_from_world = plan_.optics.camera_from_world;
    view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
    view.eye_world_m = camera_from_world.inverse().translation();
    view.lens = surface_lens(density);
    // Colour (half floats) and depth are written once a sample.
    constexpr double bytes_a_sample = 8 + 4;
    const GraphTexture drawn = graph.import(
        nullptr, {.format = GL_NONE, .region = plate_region(bounds, camera, resources_.lens_map, layer_margin)});
    graph.add_pass({.name = "surface",
                    .reads = light,
                    .provides = {drawn},
                    .bytes = bytes_a_sample * view.width * view.height * view.samples,
                    .draw = [this, view, pinhole, layers](PassRun&) {
                        layer_.picture = draw_surface(view, pinhole);
                        layer_.hidden = layer_.transparent = {};
                        if (plan_.layer_effects.needs_hidden(resources_.quality.depth_of_field)) {
                            const ClipLight& lit = resources_.light;
                            layer_.hidden = resources_.surfaces.draw_hidden(lit.environment(), view, lit.shading());
                        }
                        if (view.lens && view.lens->parts_transparent) {
                            const ClipLight& lit = resources_.light;
                            layer_.transparent =
                                resources_.surfaces.draw_transparent(lit.environment(), view, lit.shading());
                        }
                        if (plan_.layer_effects.gathers_motion()) draw_ways(view);
                        if (!layers) return;
                        const SurfacePicture geometry = resources_.surfaces.draw_layers(view);
                        layer_.picture.depth_m = geometry.depth_m;
                        layer_.picture.normal = geometry.normal;
                        layer_.picture.object_id = geometry.object_id;
                    }});
    return drawn;
}

/// Every plate pixel is a square of whole layer pixels, which the layer begins and ends with.
void FramePasses::place_on_plate_pixels(const Eigen::AlignedBox2d& bounds, SurfaceView& view) {
    const Camera& camera = resources_.camera;
    const double density = std::round(layer_.fx / camera.fx);
    // Pixels count from their middle.
    const Eigen::Array2d focal(camera.fx, camera.fy), corner(camera.cx + 0.5, camera.cy + 0.5);
    const Eigen::Array2i first = (bounds.min().array() * focal + corner).floor().cast<int>() - 1;
    const Eigen::Array2i end = (bounds.max().array() * focal + corner).ceil().cast<int>() + 1;
    layer_.whole_density = static_cast<int>(density);
    layer_.first_pixel = first.matrix();
    layer_.cx = (corner.x() - first.x()) * density - 0.5;
    layer_.cy = (corner.y() - first.y()) * density - 0.5;
    view.width = (end.x() - first.x()) * layer_.whole_density;
    view.height = (end.y() - first.y()) * layer_.whole_density;
}

bool FramePasses::parts_transparent() const {
    const std::optional<FrameDefocus>& defocus = plan_.layer_effects.defocus;
    return defocus && !defocus->objects.is_sharp() && defocus->settings.level == DepthOfFieldLevel::gather &&
           resources_.surfaces.any_blends();
}

std::optional<SurfaceLens> FramePasses::surface_lens(double layer_density) const {
    const LayerEffectPlan& effects = plan_.layer_effects;
    if (!effects.blurs_focus() || effects.defocus->objects.is_sharp()) return std::nullopt;
    const FrameDefocus& defocus = *effects.defocus;
    const bool focuses_reflections =
        defocus.settings.reflections == ReflectionFocus::virtual_image &&
        (defocus.settings.level != DepthOfFieldLevel::gather || gather_knobs(defocus.quality).reflections);
    // Then the depth alone tells.
    if (!focuses_reflections && defocus.apart.empty() && !parts_transparent()) return std::nullopt;
    const double diameter_m = plan_.optics.focus.coc_scale_px_m / resources_.camera.fx;
    const Eigen::Matrix3d world_from_camera = plan_.optics.camera_from_world.linear().transpose();
    return SurfaceLens{.focus = plan_.optics.focus,
                       .range = defocus.objects,
                       .right_world_m = diameter_m * world_from_camera.col(0),
                       .down_world_m = diameter_m * world_from_camera.col(1),
                       .layer_density = layer_density,
                       .focuses_reflections = focuses_reflections,
                       .parts_transparent = parts_transparent(),
                       .apart = defocus.apart};
}

SurfacePicture FramePasses::draw_surface(const SurfaceView& view, const PinholeView& pinhole) {
    const ClipLight& lit = resources_.light;
    const LayerEffectPlan& effects = plan_.layer_effects;
    const int count = effects.samples();
    if (count == 1) return resources_.surfaces.draw(lit.environment(), view, lit.shading());
    const Focus& focus = plan_.optics.focus;
    std::vector<Eigen::Vector2d> points(static_cast<std::size_t>(count), Eigen::Vector2d::Zero());
    if (effects.samples_lens() && !effects.defocus->objects.is_sharp())
        points = lens_points(effects.defocus->settings.bokeh, count);
    const std::vector<double> times =
        effects.samples_time() ? shutter_times(count, effects.samples_lens()) : std::vector<double>(points.size(), 0.0);
    const double opening_radius_m = focus.coc_scale_px_m / resources_.camera.fx / 2;
    SurfaceAccumulator& sum = resources_.accumulator;
    sum.begin(view.width, view.height);
    for (std::size_t i = 0; i < points.size(); ++i) {
        RigidTransform camera_from_world = plan_.optics.camera_from_world;
        if (effects.samples_time()) {
            const double time = times[i] * effects.motion->shutter.share();
            camera_from_world = effects.motion->shutter.camera_from_world(time);
            resources_.objects.place(effects.motion->shutter.time(time));
        }
        // Light from beyond the focus shows the opening upright (render/effects/bokeh.h).
        const Eigen::Vector2d on_lens_m = opening_radius_m * points[i];
        RigidTransform lens_from_camera = RigidTransform::Identity();
        lens_from_camera.translation() = Eigen::Vector3d(-on_lens_m.x(), -on_lens_m.y(), 0);
        const RigidTransform lens_from_world = lens_from_camera * camera_from_world;
        // Sheared, so that the plane of focus stays where it is.
        const auto clip_from_world = [&](double focus_distance_m) -> Eigen::Matrix4d {
            PinholeView sheared = pinhole;
            sheared.cx += pinhole.fx * on_lens_m.x() / focus_distance_m;
            sheared.cy += pinhole.fy * on_lens_m.y() / focus_distance_m;
            return clip_from_camera(sheared) * lens_from_world.matrix();
        };
        SurfaceView seen = view;
        std::vector<ObjectView> apart;
        const Eigen::Matrix4d through_the_middle = clip_from_camera(pinhole) * camera_from_world.matrix();
        seen.clip_from_world = effects.samples_lens() ? clip_from_world(focus.focus_distance_m) : through_the_middle;
        seen.eye_world_m = lens_from_world.inverse().translation();
        if (effects.samples_lens()) {
            for (const ObjectFocus& own : effects.defocus->apart) {
                apart.push_back(
                    own.distance_m
                        ? ObjectView{own.object, clip_from_world(*own.distance_m), seen.eye_world_m}
                        : ObjectView{own.object, through_the_middle, camera_from_world.inverse().translation()});
            }
        }
        seen.apart = apart;
        sum.add(resources_.surfaces.draw(lit.environment(), seen, lit.shading()),
                1 / static_cast<double>(points.size()));
    }
    if (effects.samples_time()) resources_.objects.place(effects.motion->shutter.time(0));
    return sum.picture();
}

void FramePasses::draw_ways(const SurfaceView& view) {
    const FrameShutter& shutter = plan_.layer_effects.motion->shutter;
    const double half_share = shutter.share() / 2;
    std::vector<ObjectWay> ways;
    for (std::size_t object = 0; object < resources_.surfaces.object_count(); ++object) {
        const auto camera_from_model = [&](double time) -> Eigen::Matrix4d {
            return shutter.camera_from_world(time).matrix() *
                   resources_.objects.world_from_model(object, shutter.time(time));
        };
        ways.push_back({.opening_camera_from_model = camera_from_model(-half_share),
                        .closing_camera_from_model = camera_from_model(half_share)});
    }
    layer_.ways = &resources_.surfaces.draw_ways(view, ways);
}

CompositeInput FramePasses::with_layer_effects(CompositeInput input) {
    const LayerEffectPlan& effects = plan_.layer_effects;
    if (!effects.defocus && resources_.effects.settings().depth_of_field)
        resources_.graph.leave_out("depth of field", "no circle of confusion is a quarter of a pixel wide");
    if (!effects.motion_left_out.empty()) resources_.graph.leave_out("motion_blur", effects.motion_left_out);
    if (!effects.any()) return input;
    constexpr int margin_px = 2;
    const int spread_px = static_cast<int>(std::ceil(effects.spread_px()));
    const Region objects = plan_.object_bounds.isEmpty() ? Region{}
                                                         : plate_region(plan_.object_bounds, resources_.camera,
                                                                        resources_.lens_map, margin_px + spread_px);
    input.blurred = add_layer_effects(resources_.graph,
                                      {.shaders = resources_.shaders,
                                       .composite = resources_.composite,
                                       .gather = resources_.gather,
                                       .surface_defocus = resources_.surface_defocus,
                                       .input = input,
                                       .layer_density = layer_.fx / resources_.camera.fx,
                                       .parts_transparent = parts_transparent(),
                                       .objects = objects,
                                       .defocus_quality = resources_.quality.depth_of_field,
                                       .motion_quality = resources_.quality.motion_blur},
                                      effects);
    return input;
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

void FramePasses::begin(bool layers) {
    resources_.graph.begin_frame(resources_.camera.width, resources_.camera.height);
    for (const LeftOutEffect& effect : plan_.left_out) resources_.graph.leave_out(effect.name, effect.why);
    layer_drawn_ = add_surface(layers);
    background_ = add_background();
}

ImageF FramePasses::decoded_plate(const PlateFrame& plate, const Region& region,
                                  const std::vector<Region>& runs) const {
    return background_ ? ImageF() : code_of_runs(plate, region, runs);
}

void FramePasses::take_picture(CompositedFrame& result, GraphTexture code, const std::vector<Region>& runs) const {
    const Region& region = result.reach;
    result.code = ImageF(region.width, region.height, 3);
    result.touched = Image8(region.width, region.height, 1);
    take_code(result, read_runs(resources_.graph.texture(code), region, runs, 4), region);
}

void FramePasses::composite(CompositedFrame& result, const CompositorOptions& options) {
    begin(options.layers);
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
    begin(false);
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
    GraphTexture tiles;
    if (!layers && !background_) {
        tiles = add_spill_tiles(graph, resources_.shaders, spill, Reach::tile_px);
        graph.output(spill);
        graph.output(tiles);
    }
    for (const GraphTexture layer :
         {shown.linear, picture.shadow, picture.virtual_rgba, picture.geometry, picture.object_id}) {
        graph.output(layer);
    }
    if (layers) graph.output(background_);
    graph.run(resources_.timed);

    take_picture(result, shown.code, runs);
    if (tiles) composite_surroundings(result, spill, tiles);
    if (!layers) return;
    const auto read = [&](GraphTexture texture, int channels) {
        return read_runs(graph.texture(texture), region, runs, channels);
    };
    const ImageF linear = read(shown.linear, 4), geometry = read(picture.geometry, 4);
    result.layers = FrameLayers{.region = region,
                                .beauty = channels_of(linear, 0, 3),
                                .alpha = channels_of(linear, 3, 1),
                                .depth = channels_of(geometry, 3, 1),
                                .normal = channels_of(geometry, 0, 3),
                                .shadow = read(picture.shadow, 3),
                                .object_id = read(picture.object_id, 1),
                                .virtual_rgba = read(picture.virtual_rgba, 4),
                                .white_light = plan_.optics.white_light,
                                .background = background_ ? read(background_, 3) : ImageF()};
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
