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
#include "core/error.h"
#include "core/parallel.h"
#include "gl/shader_library.h"
#include "render/composite_pass.h"
#include "render/surface.h"
#include "scene/model.h"
#include "scene/subdivide.h"

namespace matchlight {

namespace {

Eigen::Matrix4d world_from_model(const ObjectSettings& object, const Solve& solve, const std::filesystem::path& scene) {
    Eigen::Affine3d placement = Eigen::Translation3d(object.translate_m) * rotation_from_degrees(object.rotate_deg) *
                                Eigen::Scaling(object.scale);
    if (!object.parent_tag) return placement.matrix();
    for (const SolvedTag& tag : solve.rig) {
        if (tag.id == *object.parent_tag) return (tag.world_from_tag * placement).matrix();
    }
    throw InputError(scene,
                     fmt::format("object '{}' stands on tag {}, whose place the solve does not know", object.name,
                                 *object.parent_tag),
                     "track the clip again with that tag in the rig");
}

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

/// Shadows between objects are kept at vertices: a face is given some, about as many along a model as a small shadow
/// needs. Larger meshes stay as they are, being fine already.
void shorten_edges(Model& model) {
    constexpr double edges_along_model = 48;
    constexpr std::size_t most_vertices = 200'000;
    const double longest_m = model.bounds_m.sizes().maxCoeff() / edges_along_model;
    for (ModelMesh& mesh : model.meshes) mesh = with_short_edges(mesh, longest_m, most_vertices);
}

}  // namespace

struct Compositor::Impl {
    Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve, const CompositorOptions& the_options,
         Warnings& the_warnings);

    void place_objects(const Scene& scene, Warnings& warnings);
    void prepare_composite(const PlateFormat& format);
    const Response& response_of(const PlateFormat& format) const;
    FrameOptics optics_of(const SolvedFrame& frame) const;
    /// The frame itself when it knows its exposure, or else the one nearest in time that does, or nullptr.
    const SolvedFrame* exposed_neighbour(const SolvedFrame& frame) const;
    /// Also extends `object_bounds` (normalised coordinates) by every object in view.
    Reach reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                   Eigen::AlignedBox2d& object_bounds);

    GlContext& context;
    Solve solve;
    CompositorOptions options;
    Quality quality;
    Warnings& warnings;
    ShaderLibrary shaders;
    SurfaceRenderer surfaces;
    RenderGraph graph;
    std::optional<ClipLight> light;
    std::optional<Background> background;      // of a scene without footage
    std::optional<ShadowFootprint> footprint;  // made with the first frame, whose depth sets the limit
    LensMap lens_map;
    std::unique_ptr<CompositePass> composite_pass;
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
      lens_map(make_lens_map(solve.camera)),
      effects(shaders, scene.effects, the_options.quality) {
    place_objects(scene, warnings);
    light.emplace(shaders, surfaces, scene, quality, warnings);
    if (scene.camera) {
        background.emplace(scene.background, light->probe(), solve.camera.width, solve.camera.height, warnings);
    }
    graph.set_leaves_out(options.leave_out);
    graph.begin_frame(solve.camera.width, solve.camera.height);
    for (const PassInput& input : light->add_passes(graph)) graph.output(input.texture);
    graph.run(options.timed);
    check_no_gl_error("making what the whole clip shares");
}

void Compositor::Impl::place_objects(const Scene& scene, Warnings& the_warnings) {
    const bool shade_each_other =
        quality.object_shadow.directions > 0 && std::ranges::any_of(scene.objects, &ObjectSettings::casts_shadow);
    int id = 0;
    for (const ObjectSettings& object : scene.objects) {
        Model model =
            object.model.empty() ? make_shape(object.shape, scene.path) : load_model(object.model, the_warnings);
        if (shade_each_other) shorten_edges(model);
        surfaces.add_object({.model = &model,
                             .world_from_model = world_from_model(object, solve, scene.path),
                             .material = object.material,
                             .reflection = object.reflection,
                             .id = ++id,
                             .casts_shadow = object.casts_shadow});
    }
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

const SolvedFrame* Compositor::Impl::exposed_neighbour(const SolvedFrame& frame) const {
    if (frame.exposure_ev) return &frame;
    const SolvedFrame* nearest = nullptr;
    std::int64_t distance = std::numeric_limits<std::int64_t>::max();
    for (const SolvedFrame& other : solve.frames) {
        if (!other.exposure_ev || std::abs(other.frame - frame.frame) >= distance) continue;
        distance = std::abs(other.frame - frame.frame);
        nearest = &other;
    }
    return nearest;
}

FrameOptics Compositor::Impl::optics_of(const SolvedFrame& frame) const {
    FrameOptics optics;
    optics.camera_from_world = *frame.camera_from_world;
    optics.frame_width = solve.camera.width;
    optics.frame_height = solve.camera.height;
    if (solve.vignette) optics.vignette = *solve.vignette;
    const SolvedFrame* exposed = exposed_neighbour(frame);
    if (exposed == nullptr) {
        warnings.add("the solve knows no frame's exposure: the probe's light is taken as the plate's");
        return optics;
    }
    if (exposed != &frame) warnings.add("frames without a measured exposure take their nearest neighbour's");
    optics.gain.setConstant(std::exp2(*exposed->exposure_ev));
    if (exposed->white_balance) {
        const auto& balance = *exposed->white_balance;
        optics.gain = optics.gain.cwiseProduct(Eigen::Vector3d(balance[0], balance[1], balance[2]));
    }
    return optics;
}

Compositor::Compositor(GlContext& context, const Scene& scene, const Solve& solve, const CompositorOptions& options,
                       Warnings& warnings)
    : impl_(std::make_unique<Impl>(context, scene, solve, options, warnings)) {}

Compositor::~Compositor() = default;

SurfaceRenderer& Compositor::surfaces() {
    return impl_->surfaces;
}

Reach Compositor::Impl::reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                                 Eigen::AlignedBox2d& object_bounds) {
    constexpr int margin_px = 2;  // footprints and antialiased edges
    std::vector<Region> regions;
    for (std::size_t i = 0; i < surfaces.object_count(); ++i) {
        const Eigen::AlignedBox2d bounds =
            normalized_bounds_of_box(surfaces.object_bounds_m(i), camera_from_world, lens_map);
        if (bounds.isEmpty()) continue;
        object_bounds.extend(bounds);
        regions.push_back(plate_region(bounds, solve.camera, margin_px));
    }
    if (background)
        return {.runs = {{0, 0, format.width, format.height}}, .bounds = {0, 0, format.width, format.height}};
    const std::optional<ContactShadow>& shadow = light->contact_shadow();
    if (!shadow) return make_reach(regions, {}, 0, camera_from_world, lens_map, solve.camera);
    if (!footprint) footprint.emplace(shadow->far, shadow->fine, half_code(format));
    return make_reach(
        regions, [this](const Eigen::AlignedBox2d& box_m) { return footprint->touches(box_m); }, shadow->surface_z_m,
        camera_from_world, lens_map, solve.camera);
}

CompositedFrame Compositor::composite(PlateFrame plate) {
    Impl& impl = *impl_;
    CompositedFrame result{std::move(plate), {}, {}, {}, std::nullopt};
    const PlateFormat& format = result.plate.format();
    const Camera& camera = impl.solve.camera;
    if (format.width != camera.width || format.height != camera.height) {
        throw InputError(
            impl.solve.footage_file, result.plate.index(),
            fmt::format("is {}×{}, the solve is for {}×{}", format.width, format.height, camera.width, camera.height),
            "track this footage again");
    }
    const SolvedFrame* solved = impl.solve.find(result.plate.index());
    if (solved == nullptr || !solved->camera_from_world) return result;

    const RigidTransform& camera_from_world = *solved->camera_from_world;
    Eigen::AlignedBox2d object_bounds;
    impl.context.make_current();
    Reach reach = impl.reach_of(camera_from_world, format, object_bounds);
    if (!impl.options.leave_out) {
        reach = tiles_of(camera, [](int, int) { return true; });
        if (object_bounds.isEmpty()) object_bounds = impl.lens_map.normalized_bounds;
    }
    if (reach.bounds.empty()) {
        impl.graph.begin_frame(camera.width, camera.height);
        impl.graph.leave_out("surface", "no object is in view, and none of its shadow");
        return result;
    }

    impl.prepare_composite(format);
    const FramePlan plan{.optics = impl.optics_of(*solved), .object_bounds = object_bounds, .reach = reach};
    FramePasses({.context = impl.context,
                 .shaders = impl.shaders,
                 .graph = impl.graph,
                 .surfaces = impl.surfaces,
                 .light = *impl.light,
                 .composite = *impl.composite_pass,
                 .effects = impl.effects,
                 .camera = impl.solve.camera,
                 .quality = impl.quality,
                 .background = impl.background ? &*impl.background : nullptr,
                 .timed = impl.options.timed},
                plan)
        .composite(result, impl.options);
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
            // The curve belongs to the light of the covered part: undo the coverage, code, and cover again.
            for (int c = 0; c < 3; ++c) {
                const double code = std::clamp(response.code_from_linear(light[c] / alpha, c), 0.0, 1.0);
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
