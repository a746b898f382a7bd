// What a camera sees of sphere sets, ray by ray in double precision: what their renderer is held against.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "core/transforms.h"
#include "report/transparency_reference.h"
#include "scene/scene_file.h"
#include "scene/sphere_caster.h"

namespace matchlight {

/// A pinhole: nothing nearer than `pinhole.near_m` along the camera's axis is seen, so that a sphere that it cuts open
/// shows its inside.
struct ReferenceView {
    RigidTransform camera_from_world = RigidTransform::Identity();
    PinholeView pinhole;

    int width() const { return static_cast<int>(pinhole.width); }
    int height() const { return static_cast<int>(pinhole.height); }
    /// Through a place of the picture (pixel centres at whole numbers). Multiples of its direction are depths along the
    /// camera's axis in metres.
    SphereRay ray_through(double x_px, double y_px) const;
};

/// The same picture with `times` pixels along the side of each.
ReferenceView finer(const ReferenceView& view, int times);
/// A part of it alone.
ReferenceView cropped(const ReferenceView& view, const Region& region);

/// What is met first, for shading.
struct SpherePoint {
    SphereHit hit;
    Eigen::Vector3d position_m, normal;  // outward, also where the inside is seen
    Eigen::Vector3d toward_eye;          // of unit length
};
/// Scene-linear light toward the eye.
using SphereLight = std::function<Eigen::Vector3d(const SpherePoint&)>;
SpherePoint point_of(const SphereCaster& spheres, const SphereRay& ray, const SphereHit& hit);

/// Of a sphere, scene-linear; and how much of what is behind it covers.
Eigen::Vector3d color_of(const SphereSet& set, std::uint32_t sphere);
double opacity_of(const SphereSet& set, std::uint32_t sphere);

/// Spheres counted through all sets in their order; nothing is −1.
inline constexpr std::int64_t no_sphere = -1;
std::int64_t sphere_id(const SphereCaster& spheres, const SphereHit& hit);

/// At pixel centres.
struct SpherePicture {
    Image<std::int64_t> ids;
    Image<double> depth_m;  // along the camera's axis; infinite where nothing is
    /// As the depth buffer has it, reversed: near / depth.
    double reversed_depth(int x, int y, double near_m) const { return near_m / depth_m.at(x, y); }
};
SpherePicture reference_picture(const SphereCaster& spheres, const ReferenceView& view);

/// The share of a pixel's square that shows a sphere, of `side` × `side` places in it.
struct SphereShare {
    std::int64_t id = no_sphere;
    double share = 0;
};
/// By id; shares sum to 1.
std::vector<SphereShare> reference_coverage(const SphereCaster& spheres, const ReferenceView& view, int x, int y,
                                            int side);

/// Whether a pixel shows more than one thing (a silhouette, a seam where spheres meet) or comes within `margin_px` of
/// it, by `side` × `side` places, the outermost on the border of the grown pixel.
struct EdgeTest {
    int side = 4;
    double margin_px = 0;
};
bool is_sphere_edge(const SphereCaster& spheres, const ReferenceView& view, int x, int y, const EdgeTest& test);

/// RGB and the share that spheres cover, the mean of `side` × `side` places a pixel; light is premultiplied.
ImageF reference_opaque(const SphereCaster& spheres, const ReferenceView& view, int side, const SphereLight& light);

/// The share of its light that halos leave each pixel: by every pixel around it. 1 where nothing is.
Image<double> reference_halos(const SphereCaster& spheres, const ReferenceView& view, const SphereHalo& halo);

/// Every sphere that the ray meets, nearest first.
std::vector<TransparentLayer> reference_layers(const SphereCaster& spheres, const SphereRay& ray,
                                               const SphereLight& light);

/// ∫ L cos θ dω over the hemisphere above a point of a sphere's outside, of the light that no other sphere takes, by
/// `side` × `side` directions.
Eigen::Vector3d reference_irradiance(const SphereCaster& spheres, const SpherePoint& point, int side,
                                     const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& radiance);

/// The open share of the cosine-weighted hemisphere over a point of a sphere's outside, by `side` × `side` directions.
/// Every sphere is an occluder.
double reference_open_share(const SphereCaster& spheres, const SpherePoint& point, int side);

}  // namespace matchlight
