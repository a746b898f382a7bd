// An even gradient of light, one matt grey material.
#include "report/sphere_stage.h"

#include <array>
#include <numbers>
#include <utility>

#include "core/transfer.h"
#include "lighting/octahedral_directions.h"

namespace matchlight {
namespace {

constexpr double grey = 0.6;

/// 0.35 below, 1.05 above, in proportion to the height.
Probe sky() {
    constexpr int height = 64;
    Probe probe{ImageF(2 * height, height, 3)};
    for (int y = 0; y < height; ++y) {
        const double up = latlong_direction(0, y, 2 * height, height).z();
        for (float& value : probe.latlong.row(y)) value = static_cast<float>(0.7 + 0.35 * up);
    }
    return probe;
}

EnvironmentSettings few_lookups() {
    // Matt spheres show the harmonics alone.
    return {.face_size = 16, .sphere_map_size = 16, .lookups_per_level = 10'000, .maps_at_once = true};
}

SurfaceObject matt() {
    SurfaceObject object;
    object.material.diffuse = std::array{grey, grey, grey};
    object.material.specular = std::array{0.0, 0.0, 0.0};
    return object;
}

}  // namespace

SphereStage::SphereStage(const SphereSet& set)
    : sky_(sky()), environment_(shaders_, sky_, few_lookups()), renderer_(shaders_), drawn_{} {
    renderer_.add_spheres(matt(), set);
}

void SphereStage::draw(const ReferenceView& view, const SphereVisibility& visibility) {
    if (SphereSets* spheres = renderer_.spheres()) spheres->visibility = visibility;
    SurfaceView seen;
    seen.clip_from_world = clip_from_camera(view.pinhole) * view.camera_from_world.matrix();
    seen.eye_world_m = view.camera_from_world.inverse().translation();
    seen.width = view.width();
    seen.height = view.height();
    seen.samples = 1;
    seen.sphere_edge_places = edge_places_;
    seen.sphere_detail_px = detail_px_;
    seen.halo_step_px = halo_step_px_;
    SurfaceShading shading;
    if (occlusion_) {
        const ObjectShadow& maps = maps_of(*occlusion_);
        shading.pairs_maps = true;
        shading.bind = [&maps](Program& program) {
            program.set("objects_shade", true);
            maps.bind(program, SurfaceShading::object_shadow_unit);
        };
    }
    drawn_ = renderer_.draw(environment_, seen, shading);
}

const ObjectShadow& SphereStage::maps_of(const Occlusion& occlusion) {
    const auto found = maps_.find(occlusion);
    if (found != maps_.end()) return found->second;
    ShadowCasters casters{renderer_.shadow_caster_bounds_m(),
                          [this](Program& program) { renderer_.draw_shadow_casters(program); },
                          [this](const SphereCast& cast) { renderer_.cast_shadow_spheres(cast); }};
    if (renderer_.spheres() == nullptr) casters.cast_spheres = {};
    ObjectShadow made(shaders_, casters, sample_octahedrally(sky_, occlusion.divisions),
                      {.resolution = occlusion.resolution, .octahedron_divisions = occlusion.divisions});
    return maps_.emplace(occlusion, std::move(made)).first->second;
}

ImageF SphereStage::picture() const {
    return drawn_.color->read<float>({0, 0, drawn_.width, drawn_.height}, 4);
}

void SphereStage::see(const ReferenceView& view, const SphereVisibility& visibility) {
    SphereSets* spheres = renderer_.spheres();
    if (spheres == nullptr) return;
    spheres->visibility = visibility;
    PlacedSpheres placed;
    placed.clip_from_world = clip_from_camera(view.pinhole) * view.camera_from_world.matrix();
    spheres->see(std::span(&placed, 1), view.width(), view.height());
}

std::vector<Knob> SphereStage::drawn_cells() {
    const SphereSets* spheres = renderer_.spheres();
    if (spheres == nullptr) return {};
    return {{"cells", static_cast<double>(spheres->culling().cells_drawn())}};
}

std::vector<Knob> SphereStage::drawn_spheres() {
    const SphereSets* spheres = renderer_.spheres();
    if (spheres == nullptr) return {};
    return {{"spheres", static_cast<double>(spheres->culling().spheres_drawn())}};
}

double SphereStage::most_light() const {
    constexpr double slack = 1.001;  // of half floats
    return slack *
           light_of({{}, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ()}).maxCoeff();
}

Eigen::Vector3d SphereStage::occluded_light_of(const SphereCaster& rays, const SpherePoint& point, int side) const {
    const auto radiance = [&](const Eigen::Vector3d& direction) { return sky_.radiance(direction); };
    return grey / std::numbers::pi * reference_irradiance(rays, point, side, radiance);
}

Eigen::Vector3d SphereStage::light_of(const SpherePoint& point) const {
    const Eigen::Vector3d seen_side = point.normal.dot(point.toward_eye) < 0 ? -point.normal : point.normal;
    return grey / std::numbers::pi * irradiance_from_sh(environment_.spherical_harmonics(), seen_side);
}

}  // namespace matchlight
