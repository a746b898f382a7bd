// The shadow on the surface and the shadows between objects, against rays in double precision.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "core/parallel.h"
#include "lighting/probe.h"
#include "render/effects/contact_shadow.h"
#include "render/effects/object_shadow.h"
#include "report/experiments.h"
#include "report/shadow_reference.h"

namespace matchlight {
namespace {

/// The scene's objects for both sides: on the GPU as the compositor draws them, and as triangles for rays.
struct MeasuredObjects {
    std::unique_ptr<Compositor> compositor;
    std::vector<PlacedMesh> meshes;
    RayCaster casters;
    std::vector<double> reflectance;  // of each mesh of the casters

    ShadowCasters shadow_casters() const {
        SurfaceRenderer& surfaces = compositor->surfaces();
        return {surfaces.shadow_caster_bounds_m(),
                [&surfaces](Program& program) { surfaces.draw_shadow_casters(program); }};
    }
};

std::shared_ptr<MeasuredObjects> measured_objects(const SceneStage& stage) {
    auto objects = std::make_shared<MeasuredObjects>();
    objects->compositor = stage.compositor(quality_of(QualityLevel::final_), true);
    // Objects that move now stand where they do in this frame.
    objects->compositor->composite(*stage.plate);
    objects->meshes = objects->compositor->surfaces().read_meshes();
    for (const PlacedMesh& mesh : objects->meshes) {
        if (!mesh.casts_shadow) continue;
        objects->casters.add_mesh(mesh.positions_m, mesh.indices);
        objects->reflectance.push_back(mesh.reflectance);
    }
    objects->casters.build();
    return objects;
}

Scene without_casters(const Scene& scene) {
    Scene changed = scene;
    for (ObjectSettings& object : changed.objects) object.casts_shadow = false;
    return changed;
}

int difference_of_frames(const SceneStage& stage, Compositor& a, Compositor& b) {
    return largest_code_difference(a.composite(*stage.plate).rgb8(), b.composite(*stage.plate).rgb8());
}

/// The frame's picture with this ratio on the surface in place of the compositor's own; all else stays.
ImageF with_ratio(const FrameLayers& layers, const ImageF& plate_linear, const ImageF& ratio) {
    const Region& region = layers.region;
    ImageF picture(region.width, region.height, 3);
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const float* seen = layers.virtual_rgba.pixel(x, y);
            const float* plate = plate_linear.pixel(region.x + x, region.y + y);
            for (int c = 0; c < 3; ++c) {
                picture.at(x, y, c) = plate[c] * ratio.at(x, y, c) * (1 - seen[3]) + seen[c];
            }
        }
    });
    return picture;
}

/// A frame's ratio over another region; 1 outside of what it holds.
ImageF ratio_over(const FrameLayers& layers, const Region& region) {
    ImageF ratio(region.width, region.height, 3, 1.0F);
    const Region common = region.intersected(layers.region);
    for (int y = common.y; y < common.y + common.height; ++y) {
        std::copy_n(layers.shadow.pixel(common.x - layers.region.x, y - layers.region.y), 3 * common.width,
                    ratio.pixel(common.x - region.x, y - region.y));
    }
    return ratio;
}

ImageF reference_ratio(const SceneStage& stage, const MeasuredObjects& objects, const Region& region, int directions) {
    const SurfaceLight light = make_surface_light(stage.probe, stage.scene.surface.z_m, directions);
    const ContactShadowReference reference({light.z_m, light.samples, light.radiance_per_irradiance}, objects.casters,
                                           objects.reflectance);
    const RigidTransform world_from_camera = stage.solved().camera_from_world->inverse();
    const Eigen::Vector3d eye = world_from_camera.translation();
    ImageF ratio(region.width, region.height, 3, 1.0F);
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const Eigen::Vector2d normalized =
                stage.solve.camera.normalized_from_pixel(Eigen::Vector2d(region.x + x, region.y + y));
            if (!normalized.allFinite()) continue;
            const Eigen::Vector3d ray = world_from_camera.linear() * normalized.homogeneous();
            const double distance = (light.z_m - eye.z()) / ray.z();
            if (!(distance > 0) || !std::isfinite(distance)) continue;
            const Eigen::Vector3d left = reference.ratio(eye.head<2>() + distance * ray.head<2>());
            for (int c = 0; c < 3; ++c) ratio.at(x, y, c) = static_cast<float>(left[c]);
        }
    });
    return ratio;
}

struct ShadowChoice {
    std::string label;
    int directions, resolution;
};

std::vector<Knob> knobs_of(const ShadowChoice& choice) {
    return {{"directions", static_cast<double>(choice.directions)},
            {"resolution", static_cast<double>(choice.resolution)}};
}

}  // namespace

std::optional<Experiment> contact_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    if (!stage.scene.surface.present || !stage.scene.surface.shadow) return std::nullopt;
    const auto objects = measured_objects(stage);
    const auto layers = std::make_shared<CompositedFrame>(objects->compositor->composite(*stage.plate));
    const auto plate_linear = std::make_shared<ImageF>(objects->compositor->plate_linear(*stage.plate));
    Experiment experiment;
    experiment.report.name = "contact_shadow";
    experiment.report.what =
        "The shadow of the objects on the real surface: making its maps, once for the clip. Errors are of the frame.";
    experiment.report.unit = WorkUnit::clip;
    if (!layers->layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    const FrameLayers& frame = *layers->layers;
    experiment.report.region = frame.region;
    const int rays = options.quick ? 256 : 4096;
    experiment.report.reference = fmt::format("{} rays a pixel towards the probe's light, in double precision", rays);
    experiment.reference = with_ratio(frame, *plate_linear, reference_ratio(stage, *objects, frame.region, rays));
    experiment.coarse_reference =
        with_ratio(frame, *plate_linear, reference_ratio(stage, *objects, frame.region, rays / 2));

    std::vector<ShadowChoice> choices;
    for (const auto& [name, level] : quality_levels) {
        const ContactShadowSettings settings = quality_of(level).shadow;
        choices.push_back({std::string(name), settings.directions, settings.resolution});
    }
    if (options.quick) {
        std::erase_if(choices, [](const ShadowChoice& choice) { return choice.label == "reference"; });
    } else {
        for (const int directions : {8, 16, 32, 64, 256}) {
            choices.push_back({fmt::format("{} directions", directions), directions, 1024});
        }
        for (const int resolution : {128, 256, 512, 2048}) {
            choices.push_back({fmt::format("{} texels", resolution), 128, resolution});
        }
    }
    for (const ShadowChoice& choice : choices) {
        Quality quality = quality_of(QualityLevel::final_);
        quality.shadow.directions = choice.directions;
        quality.shadow.resolution = choice.resolution;
        if (choice.label == "reference") quality.shadow = quality_of(QualityLevel::reference).shadow;
        Candidate candidate;
        candidate.point = {.level = choice.label, .knobs = knobs_of(choice), .precision = "32F"};
        candidate.picture = [&stage, quality, layers, plate_linear] {
            const auto compositor = stage.compositor(quality, true);
            const CompositedFrame composited = compositor->composite(*stage.plate);
            const Region& region = layers->layers->region;
            return with_ratio(*layers->layers, *plate_linear,
                              composited.layers ? ratio_over(*composited.layers, region)
                                                : ImageF(region.width, region.height, 3, 1.0F));
        };
        candidate.work = [&stage, objects, settings = quality.shadow] {
            const SurfaceLight light = make_surface_light(stage.probe, stage.scene.surface.z_m, settings.directions);
            make_contact_shadow(stage.shaders, objects->shadow_casters(), light, settings);
        };
        if (choice.label == "final") {
            experiment.left_out = LeftOutTrial{.condition = "no object casts a shadow on the surface",
                                               .drawn = candidate.work,
                                               .skipped = {},
                                               .code_difference = [&stage, quality] {
                                                   const Scene open = without_casters(stage.scene);
                                                   Scene off = open;
                                                   off.surface.shadow = false;
                                                   const auto a = stage.compositor(open, quality, false);
                                                   const auto b = stage.compositor(off, quality, false);
                                                   return difference_of_frames(stage, *a, *b);
                                               }};
        }
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

namespace {

/// What the contact shadow leaves of the surface's light where a ray meets it, as the GPU reads it: nearest texels.
class LightLeft {
public:
    LightLeft(const ContactShadow& shadow, double z_m)
        : z_m_(z_m), fine_(map_of(shadow.fine)), far_(map_of(shadow.far)) {}

    double along(const Eigen::Vector3d& position_m, const Eigen::Vector3d& direction) const {
        const double height = position_m.z() - z_m_;
        if (direction.z() >= 0 || height < 0) return 1;
        const Eigen::Vector2d met = position_m.head<2>() + direction.head<2>() * (height / -direction.z());
        const Eigen::Vector4d loss = loss_at(fine_, met) + loss_at(far_, met);
        const Eigen::Vector3d left = (Eigen::Vector3d::Ones() - loss.head<3>()) / std::max(1 - loss[3], 0.1);
        return left.cwiseMax(0).cwiseMin(1).mean();
    }

private:
    struct Map {
        ImageF loss;
        Eigen::AlignedBox2d rectangle_m;
    };
    static Map map_of(const ShadowMap& map) { return {map.loss.read<float>(map.loss.bounds(), 4), map.rectangle_m}; }
    static Eigen::Vector4d loss_at(const Map& map, const Eigen::Vector2d& point_m) {
        if (!map.rectangle_m.contains(point_m)) return Eigen::Vector4d::Zero();
        const Eigen::Vector2d share = (point_m - map.rectangle_m.min()).cwiseQuotient(map.rectangle_m.sizes());
        const int x = std::min(static_cast<int>(share.x() * map.loss.width()), map.loss.width() - 1);
        const int y = std::min(static_cast<int>(share.y() * map.loss.height()), map.loss.height() - 1);
        return Eigen::Vector4f(map.loss.pixel(x, y)).cast<double>();
    }

    double z_m_;
    Map fine_, far_;
};

using Visibilities = std::vector<std::vector<Eigen::Vector3f>>;  // of every mesh, of every vertex

Visibilities reference_visibility(const SceneStage& stage, const MeasuredObjects& objects, int directions) {
    const Quality quality = quality_of(QualityLevel::final_);
    std::optional<LightLeft> left;
    if (stage.scene.surface.present && stage.scene.surface.shadow) {
        const double z_m = stage.scene.surface.z_m;
        const auto shadow =
            make_contact_shadow(stage.shaders, objects.shadow_casters(),
                                make_surface_light(stage.probe, z_m, quality.shadow.directions), quality.shadow);
        if (shadow) left.emplace(*shadow, z_m);
    }
    const std::vector<DirectionalSample> samples = sample_directions(stage.probe, directions, -1, false);
    const double radius_m = objects.compositor->surfaces().bounds_m().sizes().norm() / 2;
    constexpr double own_facets = 1e-4;  // of the objects' radius
    const VertexShadowReference reference{samples, objects.casters,
                                          [&](const Eigen::Vector3d& position, const Eigen::Vector3d& direction) {
                                              return left ? left->along(position, direction) : 1.0;
                                          },
                                          own_facets * radius_m};
    Visibilities visibilities;
    for (const PlacedMesh& mesh : objects.meshes) {
        std::vector<Eigen::Vector3f>& of_mesh = visibilities.emplace_back(mesh.positions_m.size());
        constexpr int block = 256;  // vertices for a thread at a time
        const int count = static_cast<int>(of_mesh.size());
        parallel_for((count + block - 1) / block, [&](int first) {
            for (int i = first * block; i < std::min(count, (first + 1) * block); ++i) {
                const auto at = static_cast<std::size_t>(i);
                of_mesh[at] = reference.visibility(mesh.positions_m[at], mesh.normals[at]).cast<float>();
            }
        });
    }
    return visibilities;
}

ImageF picture_with(const SceneStage& stage, MeasuredObjects& objects, const Visibilities& visibilities,
                    const Region& region) {
    for (std::size_t mesh = 0; mesh < visibilities.size(); ++mesh) {
        if (!visibilities[mesh].empty()) objects.compositor->surfaces().set_visibility(mesh, visibilities[mesh]);
    }
    const CompositedFrame frame = objects.compositor->composite(*stage.plate);
    return cropped(frame.layers->beauty, region.moved(-frame.layers->region.x, -frame.layers->region.y));
}

}  // namespace

std::optional<Experiment> object_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    const auto objects = measured_objects(stage);
    if (objects->compositor->surfaces().shadow_caster_bounds_m().isEmpty()) return std::nullopt;
    Experiment experiment;
    experiment.report.name = "object_shadow";
    experiment.report.what =
        "What objects take of each other's and their own light: making depth maps and looking them up at every vertex, "
        "once for the clip. Errors are of the frame.";
    experiment.report.unit = WorkUnit::clip;
    const CompositedFrame frame = objects->compositor->composite(*stage.plate);
    if (!frame.layers) {
        experiment.report.left_out_of_frame = "nothing virtual is in view";
        return experiment;
    }
    const Region region = frame.layers->region;
    experiment.report.region = region;
    const int rays = options.quick ? 256 : 2048;
    experiment.report.reference = fmt::format("{} rays a vertex towards the probe's light, in double precision", rays);
    experiment.reference = picture_with(stage, *objects, reference_visibility(stage, *objects, rays), region);
    experiment.coarse_reference =
        picture_with(stage, *objects, reference_visibility(stage, *objects, rays / 2), region);

    std::vector<ShadowChoice> choices;
    for (const auto& [name, level] : quality_levels) {
        const ObjectShadowSettings settings = quality_of(level).object_shadow;
        choices.push_back({std::string(name), settings.directions, settings.resolution});
    }
    if (!options.quick) {
        for (const int directions : {16, 32, 128, 256}) {
            choices.push_back({fmt::format("{} directions", directions), directions, 256});
        }
        for (const int resolution : {32, 64, 128, 512}) {
            choices.push_back({fmt::format("{} texels", resolution), 64, resolution});
        }
    }
    for (const ShadowChoice& choice : choices) {
        Quality quality = quality_of(QualityLevel::final_);
        quality.object_shadow = {.directions = choice.directions, .resolution = choice.resolution};
        Candidate candidate;
        candidate.point = {.level = choice.label, .knobs = knobs_of(choice), .precision = "32F"};
        candidate.picture = [&stage, quality, region] {
            const auto compositor = stage.compositor(quality, true);
            const CompositedFrame composited = compositor->composite(*stage.plate);
            const Region& held = composited.layers->region;
            return cropped(composited.layers->beauty, region.moved(-held.x, -held.y));
        };
        if (choice.directions > 0)
            candidate.work = [&stage, objects, settings = quality.object_shadow] {
                ShaderLibrary& shaders = stage.shaders;
                const ObjectShadow shadow(shaders, objects->shadow_casters(),
                                          sample_directions(stage.probe, settings.directions, -1, false), settings);
                Program& bake = shaders.compute("effects/object_shadow/bake.comp");
                bake.use();
                bake.set("surface_shadow_present", 0);
                bake.set("surface_is_near", 0);
                shadow.bind(bake, SurfaceShading::first_free_unit + 2);
                objects->compositor->surfaces().bake_visibility(bake);
            };
        if (choice.label == "final") {
            experiment.left_out = LeftOutTrial{.condition = "no object casts a shadow",
                                               .drawn = candidate.work,
                                               .skipped = {},
                                               .code_difference = [&stage, quality] {
                                                   const Scene open = without_casters(stage.scene);
                                                   Quality off = quality;
                                                   off.object_shadow.directions = 0;
                                                   const auto a = stage.compositor(open, quality, false);
                                                   const auto b = stage.compositor(open, off, false);
                                                   return difference_of_frames(stage, *a, *b);
                                               }};
        }
        experiment.candidates.push_back(std::move(candidate));
    }
    return experiment;
}

}  // namespace matchlight
