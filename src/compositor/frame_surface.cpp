// Draws the objects: what the layer covers, and through which points of the lens and at which times it is seen.
#include <algorithm>
#include <cmath>

#include "compositor/frame_passes.h"
#include "render/effects/bokeh.h"

namespace matchlight {

namespace {

/// Layer pixels around what is in view, so that footprints at its edge find what they look for.
constexpr int layer_margin = 2;

}  // namespace

FramePasses::PlacedView FramePasses::place_view(Eigen::AlignedBox2d bounds, VirtualLayer& layer) const {
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
    PlacedView placed;
    double& density = placed.layer_density;
    density = resources_.quality.supersampling;
    density = std::min({density, limit / (span.x() * camera.fx), limit / (span.y() * camera.fy)});
    placed.view.density = density;
    layer.fx = camera.fx * density;
    layer.fy = camera.fy * density;
    SurfaceView& view = placed.view;
    if (!camera.has_distortion() && density == std::round(density)) {
        place_on_plate_pixels(bounds, layer, view);
    } else {
        layer.whole_density = 0;
        layer.cx = layer_margin - std::floor(bounds.min().x() * layer.fx);
        layer.cy = layer_margin - std::floor(bounds.min().y() * layer.fy);
        view.width = static_cast<int>(std::ceil(span.x() * layer.fx)) + 2 * layer_margin + 1;
        view.height = static_cast<int>(std::ceil(span.y() * layer.fy)) + 2 * layer_margin + 1;
    }
    // Depth of field reads the depth of single pixels.
    view.samples = plan_.layer_effects.blurs_focus() ? 1 : resources_.quality.samples;
    view.sphere_detail_px = resources_.quality.sphere_detail_px;
    view.halo_step_px = resources_.quality.halo_step_px;
    view.sphere_edge_places = resources_.quality.sphere_edge_places;
    placed.pinhole = {.fx = layer.fx,
                      .fy = layer.fy,
                      .cx = layer.cx,
                      .cy = layer.cy,
                      .width = static_cast<double>(view.width),
                      .height = static_cast<double>(view.height),
                      .near_m = near_plane_m};
    const RigidTransform& camera_from_world = plan_.optics.camera_from_world;
    view.clip_from_world = clip_from_camera(placed.pinhole) * camera_from_world.matrix();
    view.eye_world_m = camera_from_world.inverse().translation();
    placed.plate = plate_region(bounds, camera, resources_.lens_map, layer_margin);
    return placed;
}

bool FramePasses::parts_coverage() const {
    const LayerEffectPlan& effects = plan_.layer_effects;
    const bool has_real_things = inverse_depth_ || resources_.surfaces.any_holdout();
    return has_real_things && (effects.blurs_focus() || effects.gathers_motion());
}

std::optional<RealDepth> FramePasses::real_depth(const PlacedView& placed) const {
    if (!inverse_depth_) return std::nullopt;
    // The first node lies one cell before the first pixel.
    constexpr int spacing = LensMap::spacing;
    const Region& seen = placed.plate;
    const ImageF& nodes = resources_.lens_map.nodes;
    const Region cells =
        Region{seen.x / spacing, seen.y / spacing, seen.width / spacing + 3, seen.height / spacing + 3}.intersected(
            {0, 0, nodes.width() - 1, nodes.height() - 1});
    return RealDepth{.bind =
                         [this](Program& program) {
                             resources_.composite.set_lens(program, RealDepth::first_unit);
                             program.bind_texture("real_inverse_depth", RealDepth::first_unit + 1,
                                                  resources_.graph.texture(inverse_depth_));
                         },
                     .clip_from_camera = clip_from_camera(placed.pinhole),
                     .cells = cells};
}

SurfaceShading FramePasses::shading() const {
    SurfaceShading shading = resources_.light.shading();
    if (const std::optional<DepthCueSettings>& cue = resources_.effects.settings().depth_cue;
        cue && (cue->strength > 0 || !resources_.graph.leaves_out())) {
        shading.fades_with_depth = true;
        shading.bind = [light = shading.bind, cue = *cue](Program& program) {
            if (light) light(program);
            program.set("depth_cue_color", Eigen::Vector3f(Eigen::Vector3d(cue.color.data()).cast<float>()));
            program.set("depth_cue_range_m", Eigen::Vector2f(Eigen::Vector2d(cue.near_m, cue.far_m).cast<float>()));
            program.set("depth_cue_strength", cue.strength);
        };
    }
    if (!plate_behind_) return shading;
    shading.bind = [light = shading.bind, &behind = *plate_behind_](Program& program) {
        if (light) light(program);
        behind.bind(program);
    };
    return shading;
}

GraphTexture FramePasses::add_surface(bool layers) {
    RenderGraph& graph = resources_.graph;
    std::vector<PassInput> inputs = light_drawn_;
    if (plan_.object_bounds.isEmpty()) {
        graph.leave_out("surface", "no object is in view");
        return {};
    }
    PlacedView placed = place_view(plan_.object_bounds, layer_);
    placed.view.lens = surface_lens(placed.layer_density);
    placed.view.parts_coverage = parts_coverage();
    const std::optional<RealDepth> depth = real_depth(placed);
    if (depth) inputs.push_back({inverse_depth_});
    // Colour (half floats) and depth are written once a sample.
    constexpr double bytes_a_sample = 8 + 4;
    const SurfaceView& view = placed.view;
    const GraphTexture drawn = graph.import(nullptr, {.format = GL_NONE, .region = placed.plate});
    if (const std::optional<DrawnObjects> kept = resources_.drawn) {
        graph.add_pass({.name = "surface as it was", .provides = {drawn}, .draw = [this, kept](PassRun&) {
                            layer_ = kept->layer;
                            coverage_layer_ = kept->coverage_layer;
                        }});
        return drawn;
    }
    graph.add_pass({.name = "surface",
                    .reads = inputs,
                    .provides = {drawn},
                    .bytes = bytes_a_sample * view.width * view.height * view.samples,
                    .draw = [this, placed, depth, layers](PassRun&) {
                        PlacedView drawn_view = placed;
                        SurfaceView& seen = drawn_view.view;
                        seen.real_depth = depth ? &*depth : nullptr;
                        const ClipLight& lit = resources_.light;
                        SurfaceRenderer& surfaces = resources_.surfaces;
                        layer_.picture = draw_surface(drawn_view, resources_.accumulator, [&](const SurfaceView& one) {
                            return surfaces.draw(lit.environment(), one, shading());
                        });
                        layer_.hidden = layer_.transparent = {};
                        if (plan_.layer_effects.needs_hidden())
                            layer_.hidden = surfaces.draw_hidden(lit.environment(), seen, shading());
                        if (seen.lens && seen.lens->parts_transparent)
                            layer_.transparent = surfaces.draw_transparent(lit.environment(), seen, shading());
                        if (plan_.layer_effects.gathers_motion())
                            layer_.ways = &surfaces.draw_ways(seen, shutter_ways());
                        if (plan_.neighbours) draw_exchange(seen);
                        coverage_layer_ = layer_;
                        for (SurfacePicture* picture :
                             {&coverage_layer_.picture, &coverage_layer_.hidden, &coverage_layer_.transparent})
                            picture->color = picture->coverage;
                        if (!layers) return keep_objects();
                        const SurfacePicture geometry = surfaces.draw_layers(seen);
                        layer_.picture.depth_m = geometry.depth_m;
                        layer_.picture.normal = geometry.normal;
                        layer_.picture.object_id = geometry.object_id;
                    }});
    return drawn;
}

void FramePasses::keep_objects() {
    // Holdouts are drawn after the objects, and may take textures of theirs.
    if (resources_.surfaces.any_holdout() || plan_.neighbours) return;
    resources_.drawn = DrawnObjects{.layer = layer_, .coverage_layer = coverage_layer_};
}

GraphTexture FramePasses::add_holdouts() {
    RenderGraph& graph = resources_.graph;
    constexpr const char* pass = "holdouts";
    const auto leave_out = [&](const char* why) {
        graph.leave_out(pass, why);
        return GraphTexture{};
    };
    if (!resources_.surfaces.any_holdout()) return leave_out("the scene has none");
    if (plan_.holdout_bounds.isEmpty()) return leave_out("none in view can lie in a shadow");
    const PlacedView placed = place_view(plan_.holdout_bounds, holdouts_);
    const std::optional<RealDepth> depth = real_depth(placed);
    std::vector<PassInput> inputs = light_drawn_;
    if (depth) inputs.push_back({inverse_depth_});
    const GraphTexture drawn = graph.import(nullptr, {.format = GL_NONE, .region = placed.plate});
    graph.add_pass({.name = pass, .reads = inputs, .provides = {drawn}, .draw = [this, placed, depth](PassRun&) {
                        PlacedView drawn_view = placed;
                        drawn_view.view.real_depth = depth ? &*depth : nullptr;
                        SurfaceRenderer& surfaces = resources_.surfaces;
                        holdouts_.picture =
                            draw_surface(drawn_view, resources_.holdout_accumulator,
                                         [&](const SurfaceView& one) { return surfaces.draw_holdouts(one); });
                        if (plan_.layer_effects.gathers_motion())
                            holdouts_.ways = &surfaces.draw_holdout_ways(drawn_view.view, shutter_ways());
                    }});
    return drawn;
}

/// Every plate pixel is a square of whole layer pixels, which the layer begins and ends with.
void FramePasses::place_on_plate_pixels(const Eigen::AlignedBox2d& bounds, VirtualLayer& layer,
                                        SurfaceView& view) const {
    const Camera& camera = resources_.camera;
    const double density = std::round(layer.fx / camera.fx);
    // Pixels count from their middle.
    const Eigen::Array2d focal(camera.fx, camera.fy), corner(camera.cx + 0.5, camera.cy + 0.5);
    const Eigen::Array2i first = (bounds.min().array() * focal + corner).floor().cast<int>() - 1;
    const Eigen::Array2i end = (bounds.max().array() * focal + corner).ceil().cast<int>() + 1;
    layer.whole_density = static_cast<int>(density);
    layer.first_pixel = first.matrix();
    layer.cx = (corner.x() - first.x()) * density - 0.5;
    layer.cy = (corner.y() - first.y()) * density - 0.5;
    view.width = (end.x() - first.x()) * layer.whole_density;
    view.height = (end.y() - first.y()) * layer.whole_density;
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

SurfacePicture FramePasses::draw_surface(const PlacedView& placed, SurfaceAccumulator& sum,
                                         const std::function<SurfacePicture(const SurfaceView&)>& draw) {
    const SurfaceView& view = placed.view;
    const PinholeView& pinhole = placed.pinhole;
    const LayerEffectPlan& effects = plan_.layer_effects;
    const int count = effects.samples();
    if (count == 1) return draw(view);
    const Focus& focus = plan_.optics.focus;
    std::vector<Eigen::Vector2d> points(static_cast<std::size_t>(count), Eigen::Vector2d::Zero());
    if (effects.samples_lens() && !effects.defocus->objects.is_sharp())
        points = lens_points(effects.defocus->settings.bokeh, count);
    const std::vector<double> times =
        effects.samples_time() ? shutter_times(count, effects.samples_lens()) : std::vector<double>(points.size(), 0.0);
    const double opening_radius_m = focus.coc_scale_px_m / resources_.camera.fx / 2;
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
        sum.add(draw(seen), 1 / static_cast<double>(points.size()));
    }
    if (effects.samples_time()) resources_.objects.place(effects.motion->shutter.time(0));
    return sum.picture();
}

std::vector<ObjectWay> FramePasses::object_ways(const FrameShutter& shutter, std::array<double, 2> times) const {
    resources_.objects.set_ways(shutter.time(times[0]), shutter.time(times[1]));
    std::vector<ObjectWay> ways;
    for (std::size_t object = 0; object < resources_.surfaces.object_count(); ++object) {
        const auto camera_from_model = [&](double time) -> Eigen::Matrix4d {
            return shutter.camera_from_world(time).matrix() *
                   resources_.objects.world_from_model(object, shutter.time(time));
        };
        ways.push_back({.opening_camera_from_model = camera_from_model(times[0]),
                        .closing_camera_from_model = camera_from_model(times[1]),
                        .deforms = resources_.objects.deforms(object)});
    }
    return ways;
}

std::vector<ObjectWay> FramePasses::shutter_ways() const {
    const FrameShutter& shutter = plan_.layer_effects.motion->shutter;
    const double half_share = shutter.share() / 2;
    return object_ways(shutter, {-half_share, half_share});
}

void FramePasses::draw_exchange(const SurfaceView& view) {
    SurfaceRenderer& surfaces = resources_.surfaces;
    const FrameShutter& neighbours = *plan_.neighbours;
    layer_.way_to_next = &surfaces.draw_ways(view, object_ways(neighbours, {0, 1}), WayPicture::to_next);
    layer_.way_to_previous = &surfaces.draw_ways(view, object_ways(neighbours, {0, -1}), WayPicture::to_previous);
    layer_.parts = &surfaces.draw_parts(view);
}

}  // namespace matchlight
