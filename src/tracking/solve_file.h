// The solve: what is known of the camera in every frame, as *.solve.json keeps it. The render needs nothing else.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "calibration/response.h"
#include "core/transforms.h"
#include "scene/effects.h"

namespace matchlight {

/// What "matchlight_solve" holds.
inline constexpr int solve_file_version = 1;

struct SolvedTag {
    int id = 0;
    double size_m = 0;
    RigidTransform world_from_tag = RigidTransform::Identity();
};

/// What the solve says of one parameter of the lens: "fx", "fy", "cx", "cy", or a coefficient, "k1", "k2", "p1", …
struct LensParameter {
    std::string name;
    double sigma = 0;      // standard deviation, in the parameter's own unit
    bool refined = false;  // by the clip; otherwise as it was calibrated
};

struct SolvedFrame {
    std::int64_t frame = 0;  // counted from 0
    double time_s = 0;
    std::optional<RigidTransform> camera_from_world;  // at mid-exposure; absent where there is no pose
    /// Rotation vector (rad) then translation (m), of a perturbation on the world side.
    std::optional<Eigen::Matrix<double, 6, 6>> covariance;
    bool bridged = false;                   // the pose rests on the path, not on tags of this frame
    std::optional<double> reprojection_px;  // RMS over the frame's corners
    std::vector<int> tags;                  // ids seen
    std::optional<double> exposure_ev;      // plate light = probe light · 2^ev · white_balance · vignette
    std::optional<std::array<double, 3>> white_balance;  // g = 1
    std::optional<double> focus_distance_m;
    std::optional<double> coc_scale_px_m;
    std::optional<double> shutter_fraction;
    std::optional<double> pose_confidence;  // 0..1
    std::optional<double> exposure_confidence;
    std::optional<double> focus_confidence;
    std::optional<double> shutter_confidence;
    std::optional<FrameExposure>
        simulated;  // instead of the footage's own; from the meter pass, not in the solve's file
};

struct Solve {
    std::string footage_file;  // as the scene names it
    std::int64_t frame_count = 0;
    Camera camera;
    std::vector<LensParameter> lens_parameters;  // those whose uncertainty is known
    std::optional<double> readout_s;             // rolling shutter: from the first row to the last; absent: not known
    std::vector<SolvedTag> rig;
    Response response = Response::srgb();
    std::optional<std::array<double, 2>> vignette;      // gain = 1 + v1 r² + v2 r⁴, r = 1 at the corner
    std::optional<std::array<double, 2>> noise;         // read, shot: variance = read² + shot · signal, plate-linear
    std::optional<double> noise_neighbour_correlation;  // of the noise of neighbouring pixels; 0: white
    std::optional<double> softness_px;                  // standard deviation of the blur that the codec adds
    std::optional<Eigen::Vector3d> light_gradient_ev_per_m;  // how the light on the rig changes over the world
    std::vector<SolvedFrame> frames;                         // in ascending order
    std::string provenance;                                  // version and the effective settings that made it

    /// The frame's entry, or nullptr.
    const SolvedFrame* find(std::int64_t frame) const;
    /// The frame itself when it knows its exposure, or else the one nearest in time that does, or nullptr.
    const SolvedFrame* exposed_near(const SolvedFrame& frame) const;
};

/// Throws InputError: not a solve file, another version, a matrix that is not rigid, non-finite numbers.
Solve load_solve(const std::filesystem::path& path);
/// Written whole or not at all.
void save_solve(const std::filesystem::path& path, const Solve& solve);

}  // namespace matchlight
