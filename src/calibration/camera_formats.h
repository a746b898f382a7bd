// The files in which cameras are written: OpenCV's, Kalibr's and ROS', and what each of them cannot hold.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera.h"

namespace matchlight {

enum class CameraFormat { opencv, kalibr, ros };

/// How a calibration came about: kept in OpenCV's files, whose readers skip what they do not know.
struct CalibrationNotes {
    std::string model;  // "radtan3"
    std::string board;
    int views = 0, corners = 0;
    double rms_px = 0, held_out_rms_px = 0;
    double pixel_sigma_px = 0;  // what the parameters' uncertainty does to a pixel, over the picture
};

/// What `format` loses of the camera, in words; it is written without.
std::vector<std::string> lost_in(CameraFormat format, const Camera& camera);

/// The text of a camera file. `reported` is named where the format has no such lens at all: InputError.
std::string camera_text(const Camera& camera, CameraFormat format, const std::filesystem::path& reported,
                        const std::optional<CalibrationNotes>& notes = std::nullopt);

}  // namespace matchlight
