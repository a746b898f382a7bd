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
                        const ClipLight& lit = resources_.light;
                        layer_.picture = draw_surface(view, pinhole);
                        layer_.hidden = layer_.transparent = {};
                        if (plan_.layer_effects.needs_hidden()) {
                            layer_.hidden = resources_.surfaces.draw_hidden(lit.environment(), view, lit.shading());
                        }
                        if (view.lens && view.lens->parts_transparent) {
                            layer_.transparent =
                                resources_.surfaces.draw_transparent(lit.environment(), view, lit.shading());
                        }
                        if (plan_.layer_effects.gathers_motion()) draw_shutter_ways(view);
                        if (plan_.neighbours) draw_exchange(view);
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

const Texture2D* FramePasses::draw_ways(const SurfaceView& view, const FrameShutter& shutter,
                                        std::array<double, 2> times, WayPicture picture) {
    std::vector<ObjectWay> ways;
    for (std::size_t object = 0; object < resources_.surfaces.object_count(); ++object) {
        const auto camera_from_model = [&](double time) -> Eigen::Matrix4d {
            return shutter.camera_from_world(time).matrix() *
                   resources_.objects.world_from_model(object, shutter.time(time));
        };
        ways.push_back({.opening_camera_from_model = camera_from_model(times[0]),
                        .closing_camera_from_model = camera_from_model(times[1])});
    }
    return &resources_.surfaces.draw_ways(view, ways, picture);
}

void FramePasses::draw_shutter_ways(const SurfaceView& view) {
    const FrameShutter& shutter = plan_.layer_effects.motion->shutter;
    const double half_share = shutter.share() / 2;
    layer_.ways = draw_ways(view, shutter, {-half_share, half_share}, WayPicture::shutter);
}

void FramePasses::draw_exchange(const SurfaceView& view) {
    layer_.way_to_next = draw_ways(view, *plan_.neighbours, {0, 1}, WayPicture::to_next);
    layer_.way_to_previous = draw_ways(view, *plan_.neighbours, {0, -1}, WayPicture::to_previous);
    layer_.parts = &resources_.surfaces.draw_parts(view);
}

}  // namespace matchlight
