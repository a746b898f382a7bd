// Writes camera files.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "calibration/camera_formats.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/version.h"

namespace matchlight {
namespace {

std::string opencv_text(const Camera& camera, const std::optional<CalibrationNotes>& notes) {
    cv::FileStorage file(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
    file << "image_width" << camera.width << "image_height" << camera.height;
    const cv::Mat k = (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
    file << "camera_matrix" << k;
    if (camera.lens == LensModel::fisheye)
        file << "distortion_model"
             << "fisheye";
    const cv::Mat column(camera.distortion, true);
    file << "distortion_coefficients" << (column.empty() ? column : column.reshape(1, 1));
    if (camera.sigmas) {
        std::vector<double> sigmas = {camera.sigmas->fx, camera.sigmas->fy, camera.sigmas->cx, camera.sigmas->cy};
        sigmas.insert(sigmas.end(), camera.sigmas->distortion.begin(), camera.sigmas->distortion.end());
        file << "parameter_sigmas" << cv::Mat(sigmas, true).reshape(1, 1);
    }
    if (notes) {
        file << "rms_px" << notes->rms_px << "held_out_rms_px" << notes->held_out_rms_px << "pixel_sigma_px"
             << notes->pixel_sigma_px << "views" << notes->views << "corners" << notes->corners << "model"
             << notes->model << "board" << notes->board << "software" << (std::string("matchlight ") + version);
    }
    return file.releaseAndGetString();
}

/// The coefficients without trailing zeros, but not fewer than `least`.
std::vector<double> trimmed(std::vector<double> coefficients, std::size_t least) {
    while (coefficients.size() > least && coefficients.back() == 0) coefficients.pop_back();
    coefficients.resize(std::max(coefficients.size(), least), 0.0);
    return coefficients;
}

[[noreturn]] void fail(const std::filesystem::path& path, const char* format, const std::string& what,
                       const char* cure) {
    throw InputError(path, fmt::format("{}'s camera file cannot hold {}", format, what), cure);
}

std::string list_text(const std::vector<double>& numbers) {
    return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string kalibr_text(const Camera& camera, const std::filesystem::path& reported) {
    const std::vector<double> coefficients = trimmed(camera.distortion, 4);
    if (coefficients.size() > 4) {
        fail(reported, "Kalibr", "more than two radial terms",
             "calibrate with --model radtan2 or fisheye, or with --format kalibr from the start");
    }
    const bool fisheye = camera.lens == LensModel::fisheye;
    return fmt::format(
        "cam0:\n  camera_model: pinhole\n  intrinsics: {}\n  distortion_model: {}\n  distortion_coeffs: {}\n"
        "  resolution: [{}, {}]\n",
        list_text({camera.fx, camera.fy, camera.cx, camera.cy}), fisheye ? "equidistant" : "radtan",
        list_text(coefficients), camera.width, camera.height);
}

std::string ros_matrix(const char* name, int rows, int columns, const std::vector<double>& numbers) {
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows, columns, list_text(numbers));
}

std::string ros_text(const Camera& camera, const std::filesystem::path& reported) {
    const bool fisheye = camera.lens == LensModel::fisheye;
    std::vector<double> coefficients = trimmed(camera.distortion, fisheye ? 4 : 5);
    if (coefficients.size() > 8) {
        fail(reported, "ROS", "a thin prism or a tilted sensor",
             "calibrate the camera anew with `matchlight calibrate`");
    }
    const bool rational = coefficients.size() > 5;
    if (rational) coefficients.resize(8, 0.0);
    std::string text =
        fmt::format("image_width: {}\nimage_height: {}\ncamera_name: camera\n", camera.width, camera.height);
    text += ros_matrix("camera_matrix", 3, 3, {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
    text += fmt::format("distortion_model: {}\n", fisheye    ? "equidistant"
                                                  : rational ? "rational_polynomial"
                                                             : "plumb_bob");
    text += ros_matrix("distortion_coefficients", 1, static_cast<int>(coefficients.size()), coefficients);
    text += ros_matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    text += ros_matrix("projection_matrix", 3, 4, {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0});
    return text;
}

}  // namespace

std::vector<std::string> lost_in(CameraFormat format, const Camera& camera) {
    if (format == CameraFormat::opencv || !camera.sigmas) return {};
    return {"the sigmas of the parameters"};
}

std::string camera_text(const Camera& camera, CameraFormat format, const std::filesystem::path& reported,
                        const std::optional<CalibrationNotes>& notes) {
    switch (format) {
        case CameraFormat::kalibr:
            return kalibr_text(camera, reported);
        case CameraFormat::ros:
            return ros_text(camera, reported);
        case CameraFormat::opencv:
            break;
    }
    return opencv_text(camera, notes);
}

void save_camera(const std::filesystem::path& path, const Camera& camera) {
    write_text_file(path, camera_text(camera, CameraFormat::opencv, path));
}

}  // namespace matchlight
