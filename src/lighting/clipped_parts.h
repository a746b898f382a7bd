// The parts of a probe that no photograph could hold, and their energy from surfaces that they light.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "lighting/ball_probe.h"
#include "lighting/probe.h"

namespace matchlight {

/// A connected part of the probe that every photograph clips.
struct ClippedLight {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // its centroid
    double solid_angle_sr = 0;
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();   // energy over the lower bound that was photographed, RGB
    Eigen::Vector3d sigma = Eigen::Vector3d::Zero();  // of the gain, relative; 1 where nothing tells of it
};

/// The same with its pixels.
struct ClippedPart {
    struct Pixel {
        int x = 0, y = 0;
        Eigen::Vector3d towards;
        Eigen::Vector3d light;  // radiance × solid angle
    };
    ClippedLight light;
    std::vector<Pixel> pixels;

    /// What was photographed of it at least, the channels' sum.
    double bound() const;
};

/// Parts of the map where a tenth of a pixel or more is a lower bound, joined across the seam; brightest bound first.
std::vector<ClippedPart> clipped_parts(const BallProbe& probe);

/// The probe's light without the parts.
Probe light_without(const BallProbe& probe, std::span<const ClippedPart> parts);

/// A patch of a Lambertian surface, RGB: what was seen of it, and what lights it by what was photographed.
struct LitPatch {
    Eigen::Vector3d radiance;
    Eigen::Vector3d rest;                // irradiance / π of all but the clipped parts
    std::vector<Eigen::Vector3d> parts;  // the same, of each part
    Eigen::Vector3d relative_sigma;      // of radiance
};

/// What is known of the surface before.
struct AlbedoPrior {
    Eigen::Vector3d albedo;
    double relative_sigma = 0;
};

/// Solves the gain of every part, channel by channel, from
///     radiance = albedo · (rest + Σ gain · part)
/// (Debevec, Tchou, Gardner et al. 2003, "Estimating Surface Reflectance Properties of a Complex Scene under Captured
/// Natural Illumination", section 3.2): least squares over the albedo, one for all patches, and albedo · gain of each
/// part, errors relative, Huber's weights. A gain below 1 is held at 1 and the rest solved again. `alike` patches share
/// their errors: they count as one.
void solve_gains(std::vector<ClippedPart>& parts, std::span<const LitPatch> patches,
                 const std::optional<AlbedoPrior>& prior, double alike);

/// Multiplies the pixels of the parts by their gains; `sigma` grows where a gain is less sure.
std::vector<ClippedLight> apply_gains(BallProbe& probe, const std::vector<ClippedPart>& parts);

}  // namespace matchlight
