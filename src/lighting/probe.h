// Light probes: HDR images of all the light that arrives at a point, and the mappings between direction and image.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

/// Lat-long: row 0 is straight up, the middle column looks along world +y, columns run to +x on the right of it.
/// Angular (Debevec 1998) and mirror ball: the middle looks along world +y, up is +z, right is +x.
/// Cube: a vertical or horizontal cross, a 6×1 strip or a 1×6 column; the face order is documented in mappings.h.
enum class ProbeMapping { latlong, angular, mirrorball, cube };

std::optional<ProbeMapping> probe_mapping_from_name(const std::string& name);
std::string name_of(ProbeMapping mapping);

/// Incoming radiance in scene-linear Rec.709, kept as a lat-long image (RGB float), width = 2 × height.
struct Probe {
    ImageF latlong;

    /// Radiance from `world_direction` (unit length), bilinear, wrapping in longitude and clamped at the poles.
    Eigen::Vector3d radiance(const Eigen::Vector3d& world_direction) const;
};

/// How a probe is placed in the scene.
struct ProbePlacement {
    double rotation_deg = 0;  // turns the light counter-clockwise seen from above
    double exposure_ev = 0;   // radiance × 2^ev

    bool operator==(const ProbePlacement&) const = default;
};

/// Direction of the lat-long pixel (x, y), whose centre lies at (x + ½, y + ½) / size.
Eigen::Vector3d latlong_direction(double x, double y, int width, int height);
/// Continuous pixel coordinates (centres at whole numbers) of a direction.
Eigen::Vector2d latlong_pixel(const Eigen::Vector3d& direction, int width, int height);

/// Reads .hdr or .exr in any mapping (recognised by shape and metadata unless given), checks the header before
/// allocating, replaces NaN, clamps ±Inf and negatives and counts them as warnings, and resamples to lat-long.
/// Throws InputError.
Probe load_probe(const std::filesystem::path& path, std::optional<ProbeMapping> mapping, Warnings& warnings);

/// The probe turned and scaled as the scene says.
Probe placed(const Probe& probe, const ProbePlacement& placement);

/// Irradiance E(n) = ∫ L(ω) max(0, n·ω) dω by summing over all pixels, in double precision. RGB.
Eigen::Vector3d irradiance(const Probe& probe, const Eigen::Vector3d& normal);

/// Radiance in real spherical harmonics to order 2 (Ramamoorthi & Hanrahan 2001): 9 RGB coefficients, ordered
/// (0,0), (1,−1), (1,0), (1,1), (2,−2), (2,−1), (2,0), (2,1), (2,2), about world z.
using SphericalHarmonics9 = std::array<Eigen::Vector3d, 9>;
SphericalHarmonics9 project_to_sh(const Probe& probe);
Eigen::Vector3d irradiance_from_sh(const SphericalHarmonics9& sh, const Eigen::Vector3d& normal);

/// A directional sample of the probe's light: ∫ over its stratum, so that Σ radiance_times_solid_angle = ∫ L dω.
struct DirectionalSample {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // towards the light, world
    Eigen::Vector3d radiance_times_solid_angle = Eigen::Vector3d::Zero();
    double solid_angle_sr = 0;
};
/// Splits the directions with world z ≥ `minimum_z` into `count` strata of about equal power × angular spread (power is
/// luminance, × max(z, 0) when `weight_by_cosine`): median cut (Debevec 2005) that goes where one direction would stand
/// for its stratum worst (Viriyothai & Debevec 2009). Deterministic.
std::vector<DirectionalSample> sample_directions(const Probe& probe, int count, double minimum_z,
                                                 bool weight_by_cosine);

}  // namespace matchlight
