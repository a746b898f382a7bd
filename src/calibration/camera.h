// The lens of the footage: pinhole and distortion as in OpenCV's own YAML, with pixel centres at whole numbers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

enum class LensModel { radtan, fisheye };

/// Whether a lens model takes that many coefficients.
bool valid_distortion_count(LensModel lens, std::size_t count);

/// Standard deviations of a calibration's parameters: pixels, and the units of the coefficients. 0 where a parameter
/// was given and not estimated.
struct CameraSigmas {
    double fx = 0, fy = 0, cx = 0, cy = 0;
    std::vector<double> distortion;  // one for each of the camera's coefficients
};

/// A calibrated camera. `distortion` holds OpenCV's coefficients in OpenCV's order: for radtan k1 k2 p1 p2 [k3 [k4 k5
/// k6 [s1 s2 s3 s4 [tx ty]]]] (0, 4, 5, 8, 12 or 14 of them), for fisheye k1..k4 (Kannala & Brandt 2006).
struct Camera {
    int width = 0;
    int height = 0;
    double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels
    LensModel lens = LensModel::radtan;
    std::vector<double> distortion;
    std::optional<CameraSigmas> sigmas = std::nullopt;  // where the calibration's file says them

    Eigen::Matrix3d matrix() const;
    bool has_distortion() const;

    /// Pixel of a point on the plane z = 1 of the camera (x right, y down).
    Eigen::Vector2d pixel_from_normalized(const Eigen::Vector2d& normalized) const;
    /// The inverse, by Newton's method to 1e-10; NaN where the lens model does not reach the pixel (folded or
    /// diverging).
    Eigen::Vector2d normalized_from_pixel(const Eigen::Vector2d& pixel) const;
    /// Pixel of a point in camera coordinates (z > 0).
    Eigen::Vector2d pixel_from_camera(const Eigen::Vector3d& point_camera_m) const {
        return pixel_from_normalized(point_camera_m.head<2>() / point_camera_m.z());
    }
};

/// The homography of a sensor tilted by τx about x, then τy about y, as OpenCV defines it: the last step before the
/// camera matrix in the radtan model; the identity without tilt.
Eigen::Matrix3d sensor_tilt_homography(const Camera& camera);

/// Reads OpenCV YAML/XML/JSON (`image_width`, `image_height`, `camera_matrix`, `distortion_coefficients`, optional
/// `distortion_model`/`camera_model` "fisheye", optional `parameter_sigmas`: those of fx fy cx cy and of each
/// coefficient); ROS' camera_info, also as printed from a topic; Kalibr's camchain (pinhole-radtan, pinhole-equi; its
/// first camera). Throws InputError: focal length zero, negative or NaN, sizes missing,
/// a matrix of another shape, non-finite coefficients.
Camera load_camera(const std::filesystem::path& path);
/// Writes OpenCV's YAML. Other formats: camera_formats.h.
void save_camera(const std::filesystem::path& path, const Camera& camera);

/// The camera for footage of another size with the same field of view (a calibration at full resolution used on a
/// proxy): scales with pixel centres at whole numbers. Throws InputError (naming `reported`) when the aspect differs by
/// more than 1 %.
Camera camera_for_size(const Camera& camera, int width, int height, const std::filesystem::path& reported);

}  // namespace matchlight
