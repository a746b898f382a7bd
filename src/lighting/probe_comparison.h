// How far a probe is from the true one: in what it lights, where its lamps stand, and what a mirror ball shows of it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "lighting/probe.h"

namespace matchlight {

/// What is left free before a test is held against the truth: exposure and white balance are solved elsewhere.
enum class FreeGain { none, common, channel };

struct ProbeComparisonOptions {
    FreeGain free_gain = FreeGain::channel;
    int ball_px = 0;  // side of the mirror balls compared; 0: what the smaller probe holds, at most 512
};

/// A lamp of the truth, above its surroundings, and what the test has in the same place.
struct ComparedLight {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    double angle_deg = 0;    // between the two
    double power_ev = 0;     // log2 of the test's power (luminance) over the truth's
    double power_share = 0;  // of the truth's whole light
    double solid_angle_sr = 0;
};

struct ProbeComparison {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // on the test
    /// Root mean square over directions and channels of the difference of irradiance, over the truth's mean.
    double irradiance_rmse = 0;
    double worst_irradiance = 0;      // largest difference of any channel, over the truth's mean
    double brightest_angle_deg = 0;   // between the brightest parts, smoothed by 2.8°
    double median_abs_ev = 0;         // of luminance by solid angle, over what both light
    double percentile_95_abs_ev = 0;  // likewise
    double mean_ev = 0;               // likewise, signed
    double black_share = 0;           // of the sphere: where the test is black and the truth is not
    int ball_px = 0;
    double ball_rms_ev = 0;  // of the mirror balls' luminance
    double ball_median_abs_ev = 0;
    std::vector<ComparedLight> lights;  // strongest first
};

ProbeComparison compare_probes(const Probe& truth, const Probe& test, const ProbeComparisonOptions& options = {});

/// `count` directions spread evenly over the sphere (spherical Fibonacci, Keinert et al. 2015, Spherical Fibonacci
/// Mapping).
std::vector<Eigen::Vector3d> even_directions(int count);

}  // namespace matchlight
