// The lamps of a probe, found by growing peaks, and what its light is like on the whole.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/probe.h"

namespace matchlight {

/// A connected bright part of the probe.
struct DominantLight {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // its centroid, weighted by power
    double solid_angle_sr = 0;
    Eigen::Vector3d power = Eigen::Vector3d::Zero();  // ∫ L dω over it, RGB
    double power_share = 0;                           // of the luminance of the whole sphere
    double peak_luminance = 0;
};

struct DominantLightOptions {
    int most = 8;
    /// A light's peak is at least this many times the median luminance (by solid angle) of the sphere.
    double least_peak_over_median = 8;
    /// It reaches down to this part of its peak.
    double edge_over_peak = 0.1;
    /// Lights of less than this share of the sphere's power are left out.
    double least_power_share = 0.005;
};

/// Strongest power first. Growth starts at the brightest pixel that no light has yet and takes its neighbours in as
/// long as they stay bright; the halo that falls away from them belongs to the light's surroundings, and no other light
/// starts in it.
std::vector<DominantLight> dominant_lights(const Probe& probe, const DominantLightOptions& options = {});

/// Figures of the sphere as a whole; luminance is that of Rec.709, means are by solid angle.
struct ProbeStatistics {
    Eigen::Vector3d mean_radiance = Eigen::Vector3d::Zero();
    double mean_luminance = 0;
    double median_luminance = 0;
    double largest_luminance = 0;
    double least_positive_luminance = 0;  // 0 where all is black
    double black_share = 0;               // of the sphere

    /// log2 of largest over least positive; 0 where all is black.
    double dynamic_range_ev() const;
};
ProbeStatistics probe_statistics(const Probe& probe);

/// 1 (else 0; 1 channel) at pixels that share the largest value of a channel, where four or more do and it stands out
/// (twice the channel's mean): a flat top is what an exposure series leaves of a lamp brighter than its darkest
/// photograph.
ImageF flat_tops(const ImageF& image);
/// How many there are.
std::int64_t clipped_pixels(const ImageF& image);

}  // namespace matchlight
