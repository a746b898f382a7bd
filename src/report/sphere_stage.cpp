// An even gradient of light, one matt grey material.
#include "report/sphere_stage.h"

#include <array>
#include <numbers>

#include "core/transfer.h"

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
    : environment_(shaders_, sky(), few_lookups()), renderer_(shaders_), drawn_{} {
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
    drawn_ = renderer_.draw(environment_, seen);
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

Eigen::Vector3d SphereStage::light_of(const SpherePoint& point) const {
    const Eigen::Vector3d seen_side = point.normal.dot(point.toward_eye) < 0 ? -point.normal : point.normal;
    return grey / std::numbers::pi * irradiance_from_sh(environment_.spherical_harmonics(), seen_side);
}

}  // namespace matchlight
