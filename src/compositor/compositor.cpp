// Brings scene and solve together: what is made once for the clip, and what every frame needs.
#include "compositor/compositor.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

#include "compositor/lens_map.h"
#include "compositor/quality.h"
#include "compositor/reach.h"
#include "core/error.h"
#include "core/parallel.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "render/composite_pass.h"
#include "render/environment.h"
#include "render/surface.h"
#include "scene/model.h"
#include "scene/subdivide.h"

namespace matchlight {

namespace {

/// Without a probe objects are lit evenly from everywhere; half of the light that makes code 1 keeps white paper
/// (albedo 0.8) well below clipping.
constexpr float even_light = 0.5f;

Probe even_probe() {
    Probe probe;
    probe.latlong = ImageF(16, 8, 3, even_light);
    return probe;
}

Probe probe_of(const Scene& scene, Warnings& warnings) {
    if (!scene.probe) {
        warnings.add(scene.path.string() + ": no light probe: objects are lit evenly from everywhere");
        return even_probe();
    }
    return placed(load_probe(scene.probe->path, scene.probe->mapping, warnings), scene.probe->placement);
}

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

ImageF channels_of(const ImageF& image, int first, int count) {
    ImageF part(image.width(), image.height(), count);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < count; ++c) part.at(x, y, c) = image.at(x, y, first + c);
        }
    }
    return part;
}

}  // namespace

struct Compositor::Impl {
    Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve, const CompositorOptions& the_options,
         Warnings& the_warnings);

    void place_objects(const Scene& scene, Warnings& warnings);
    ShadowCasters shadow_casters();
    void draw_contact_shadow(const Scene& scene, const Probe& probe);
    void bake_object_shadow(const Probe& probe);
    void describe_surface(const Scene& scene);
    void prepare_composite(const PlateFormat& format);
    const Response& response_of(const PlateFormat& format) const;
    FrameOptics optics_of(const SolvedFrame& frame) const;
    /// The frame itself when it knows its exposure, or else the one nearest in time that does, or nullptr.
    const SolvedFrame* exposed_neighbour(const SolvedFrame& frame) const;
    /// Also extends `object_bounds` (normalised coordinates) by every object in view.
    Reach reach_of(const RigidTransform& camera_from_world, const PlateFormat& format,
                   Eigen::AlignedBox2d& object_bounds);
    VirtualLayer draw_layer(const RigidTransform& camera_from_world, const Eigen::AlignedBox2d& bounds);

    GlContext& context;
    Solve solve;
    CompositorOptions options;
    Quality quality;
    Warnings& warnings;
    ShaderLibrary shaders;
    SurfaceRenderer surfaces;
    std::unique_ptr<Environment> environment;
    std::optional<ContactShadow> shadow;
    std::optional<ShadowFootprint> footprint;  // made with the first frame, whose depth sets the limit
    SurfaceShading shading;
    Texture2D nothing{TextureShape{.format = GL_RGBA32F, .width = 2, .height = 2}};  // where there is no shadow
    LensMap lens_map;
    std::unique_ptr<CompositePass> composite_pass;
    Response pq = Response::pq();
    Response hlg = Response::hlg();
};

Compositor::Impl::Impl(GlContext& gl_context, const Scene& scene, const Solve& the_solve,
                       const CompositorOptions& the_options, Warnings& the_warnings)
    : context(gl_context),
      solve(the_solve),
      options(the_options),
      quality(quality_of(the_options.quality)),
      warnings(the_warnings),
      surfaces(shaders),
      lens_map(make_lens_map(solve.camera)) {
    place_objects(scene, warnings);
    const Probe probe = probe_of(scene, warnings);
    environment =
        std::make_unique<Environment>(shaders, probe, EnvironmentSettings{.face_size = quality.mirror_face_px});
    if (environment->clamped_values() > 0) {
        warnings.add(fmt::format("{}: {} values beyond the range of half floats are taken as 65504 in reflections",
                                 scene.probe ? scene.probe->path.string() : "probe", environment->clamped_values()));
    }
    draw_contact_shadow(scene, probe);
    describe_surface(scene);
    bake_object_shadow(probe);
    check_no_gl_error("making what the whole clip shares");
}

void Compositor::Impl::place_objects(const Scene& scene, Warnings& the_warnings) {
    int id = 0;
    for (const ObjectSettings& object : scene.objects) {
        Model model =
            object.model.empty() ? make_shape(object.shape, scene.path) : load_model(object.model, the_warnings);
        if (quality.object_shadow.directions > 0) shorten_edges(model);
        surfaces.add_object({.model = &model,
                             .world_from_model = world_from_model(object, solve, scene.path),
                             .material = object.material,
                             .reflection = object.reflection,
                             .id = ++id,
                             .casts_shadow = object.casts_shadow});
    }
}

ShadowCasters Compositor::Impl::shadow_casters() {
    return {surfaces.shadow_caster_bounds_m(), [this](Program& program) { surfaces.draw_shadow_casters(program); }};
}

void Compositor::Impl::draw_contact_shadow(const Scene& scene, const Probe& probe) {
    if (!scene.surface.present || !scene.surface.shadow) return;
    shadow =
        make_contact_shadow(shaders, shadow_casters(),
                            make_surface_light(probe, scene.surface.z_m, quality.shadow.directions), quality.shadow);
}

void Compositor::Impl::describe_surface(const Scene& scene) {
    // The probe shows the surface from its own place; without that place the surface is taken as far away.
    const bool is_near =
        scene.surface.present && scene.probe && scene.probe->place_m && scene.probe->place_m->z() > scene.surface.z_m;
    const Eigen::Vector3d place = is_near ? *scene.probe->place_m : Eigen::Vector3d::Zero();
    shading.bind = [this, is_near, place, z = scene.surface.z_m](Program& program) {
        constexpr GLuint unit = SurfaceShading::first_free_unit;
        program.set("surface_z_m", z);
        program.set("surface_is_near", is_near);
        program.set("probe_place_m", Eigen::Vector3f(place.cast<float>()));
        program.set("surface_shadow_present", shadow.has_value());
        if (shadow) {
            shadow->bind(program, unit);
        } else {
            program.bind_texture("shadow_fine", unit, nothing);
            program.bind_texture("shadow_far", unit + 1, nothing);
        }
    };
}

void Compositor::Impl::bake_object_shadow(const Probe& probe) {
    const ShadowCasters casters = shadow_casters();
    if (quality.object_shadow.directions == 0 || casters.bounds_m.isEmpty()) return;
    const auto samples = sample_directions(probe, quality.object_shadow.directions, -1, false);
    if (samples.empty()) return;
    const ObjectShadow object_shadow(shaders, casters, samples, quality.object_shadow);
    Program& bake = shaders.compute("effects/object_shadow/bake.comp");
    bake.use();
    object_shadow.bind(bake, SurfaceShading::first_free_unit + 2);
    shading.bind(bake);
    surfaces.bake_visibility(bake);
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

VirtualLayer Compositor::Impl::draw_layer(const RigidTransform& camera_from_world, const Eigen::AlignedBox2d& bounds) {
    // Two layer pixels around what is in view, so that footprints at its edge find what they look for.
    constexpr int margin = 2;
    // What llvmpipe and GPUs alike hold as a target; wider views are drawn coarser.
    const double limit = std::min(8192, context.info().max_texture_size) - 2 * margin - 1;
    const Camera& camera = solve.camera;
    const Eigen::Vector2d span = bounds.sizes();
    double density = quality.supersampling;
    density = std::min({density, limit / (span.x() * camera.fx), limit / (span.y() * camera.fy)});
    VirtualLayer layer;
    layer.fx = camera.fx * density;
    layer.fy = camera.fy * density;
    layer.cx = margin - std::floor(bounds.min().x() * layer.fx);
    layer.cy = margin - std::floor(bounds.min().y() * layer.fy);
    SurfaceView view;
    view.width = static_cast<int>(std::ceil(span.x() * layer.fx)) + 2 * margin + 1;
    view.height = static_cast<int>(std::ceil(span.y() * layer.fy)) + 2 * margin + 1;
    view.samples = quality.samples;
    const PinholeView pinhole{.fx = layer.fx,
                              .fy = layer.fy,
                              .cx = layer.cx,
                              .cy = layer.cy,
                              .width = static_cast<double>(view.width),
                              .height = static_cast<double>(view.height),
                              .near_m = near_plane_m};
    view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
    view.eye_world_m = camera_from_world.inverse().translation();
    layer.picture = surfaces.draw(*environment, view, shading);
    if (options.layers) {
        const SurfacePicture geometry = surfaces.draw_layers(view);
        layer.picture.depth_m = geometry.depth_m;
        layer.picture.normal = geometry.normal;
        layer.picture.object_id = geometry.object_id;
    }
    return layer;
}

Compositor::Compositor(GlContext& context, const Scene& scene, const Solve& solve, const CompositorOptions& options,
                       Warnings& warnings)
    : impl_(std::make_unique<Impl>(context, scene, solve, options, warnings)) {}

Compositor::~Compositor() = default;

namespace {

/// Half a code value of the footage's depth, as a share of the brightest light: response curves are steepest in
/// relative terms with exponent 1, so no code moves by more than a half.
double least_visible_loss(const PlateFormat& format) {
    return 0.5 / ((1 << format.bit_depth) - 1);
}

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

}  // namespace

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
    if (!shadow) return make_reach(regions, {}, 0, camera_from_world, lens_map, solve.camera);
    if (!footprint) footprint.emplace(shadow->far, shadow->fine, least_visible_loss(format));
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
    const Reach reach_tiles = impl.reach_of(camera_from_world, format, object_bounds);
    result.reach = reach_tiles.bounds;
    if (result.reach.empty()) return result;

    impl.context.make_current();
    impl.prepare_composite(format);
    CompositeInput input;
    input.region = result.reach;
    input.runs = impl.options.layers ? std::vector{result.reach} : reach_tiles.runs;
    const ImageF plate_code = code_of_runs(result.plate, input.region, input.runs);
    input.plate_code = &plate_code;
    input.least_visible_loss = least_visible_loss(format);
    if (!object_bounds.isEmpty()) input.layer = impl.draw_layer(camera_from_world, object_bounds);
    input.shadow = impl.shadow ? &*impl.shadow : nullptr;
    input.optics = impl.optics_of(*solved);
    input.layers = impl.options.layers;
    CompositeOutput output = impl.composite_pass->draw(input);
    check_no_gl_error(fmt::format("compositing frame {}", result.plate.index()));

    const Region& reach = result.reach;
    result.touched = Image8(reach.width, reach.height, 1);
    ImageF code(reach.width, reach.height, 3);
    parallel_for(reach.height, [&](int y) {
        for (int x = 0; x < reach.width; ++x) {
            const float* from = output.code.pixel(x, y);
            std::copy_n(from, 3, code.pixel(x, y));
            result.touched.at(x, y) = from[3] > 0 ? 255 : 0;
        }
    });
    result.code = std::move(code);
    if (impl.options.layers) {
        result.layers = FrameLayers{.region = reach,
                                    .beauty = channels_of(output.linear, 0, 3),
                                    .alpha = channels_of(output.linear, 3, 1),
                                    .depth = channels_of(output.geometry, 3, 1),
                                    .normal = channels_of(output.geometry, 0, 3),
                                    .shadow = std::move(output.shadow),
                                    .object_id = std::move(output.object_id),
                                    .virtual_rgba = std::move(output.virtual_rgba)};
    }
    return result;
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
