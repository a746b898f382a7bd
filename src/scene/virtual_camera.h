// The camera and the background of a scene without footage, as the scene file gives them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

/// A circle about the world's vertical. Angles count counter-clockwise seen from above, 0 along world +x.
struct OrbitSettings {
    Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
    double radius_m = 1;  // from target to eye
    double elevation_deg = 0;
    double from_deg = 0;  // at the first frame
    double to_deg = 360;  // at the last frame

    bool operator==(const OrbitSettings&) const = default;
};

/// Where the camera stands at a frame, and what point it has in its middle.
struct CameraKey {
    std::int64_t frame = 0;
    Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d target_m = Eigen::Vector3d::Zero();

    bool operator==(const CameraKey&) const = default;
};

struct LensSettings {
    double f_number = 2.8;
    double focus_distance_m = 1;
    double sensor_width_mm = 36;

    bool operator==(const LensSettings&) const = default;
};

/// A camera without distortion; pixels are square.
struct CameraSettings {
    int width = 0, height = 0;
    std::int64_t frames = 1;
    double fps = 25;
    double vertical_fov_deg = 40;
    std::optional<OrbitSettings> orbit;
    std::vector<CameraKey> keys;  // ascending; instead of an orbit
    std::optional<LensSettings> lens;
    double exposure_ev = 0;  // scene-linear light · 2^ev is plate-linear

    bool operator==(const CameraSettings&) const = default;
};

/// What stands behind the objects: one of these, or black.
struct BackgroundSettings {
    bool probe = false;                          // the probe as skydome
    std::optional<std::array<double, 3>> color;  // scene-linear
    std::filesystem::path image;                 // of the camera's size

    bool operator==(const BackgroundSettings&) const = default;
};

struct CameraView {
    Eigen::Vector3d eye_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d target_m = Eigen::Vector3d::Zero();
};

/// Where the camera of a frame stands and looks: a pure function of the frame's number. Between keys a cubic Hermite
/// curve through them (Catmull & Rom 1974, "A class of local interpolating splines", with tangents for uneven steps);
/// before the first and after the last key it stands still.
CameraView camera_view(const CameraSettings& camera, double frame);

}  // namespace matchlight
