// cv::calibrateCamera under the same cross-validation.
#include "calibration/lens_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/calib3d.hpp>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// OpenCV's lens from the views that `in_use` names, as a fit whose poses are those of `fit`.
LensFit opencv_fit(const LensData& data, const LensFit& fit, const std::vector<char>& in_use) {
    const std::vector<Eigen::Vector3d> board = board_corners_m(data.board);
    std::vector<std::vector<cv::Point3f>> objects;
    std::vector<std::vector<cv::Point2f>> pictures;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        if (in_use[v] == 0) continue;
        objects.emplace_back();
        pictures.emplace_back();
        for (const BoardCorner& corner : data.views[v].corners) {
            const Eigen::Vector3f at = board[static_cast<std::size_t>(corner.index)].cast<float>();
            objects.back().emplace_back(at.x(), at.y(), at.z());
            pictures.back().emplace_back(static_cast<float>(corner.px.x()), static_cast<float>(corner.px.y()));
        }
    }
    cv::Mat k, distortion;
    std::vector<cv::Mat> turns, translations;
    LensFit made = fit;
    made.rms_px = cv::calibrateCamera(objects, pictures, {data.width, data.height}, k, distortion, turns, translations);
    made.candidate = {LensModel::radtan, 3, false};
    made.bend_m = {};
    made.lens = {k.at<double>(0, 0), k.at<double>(1, 1), k.at<double>(0, 2), k.at<double>(1, 2)};
    for (int i = 0; i < 5; ++i) made.lens[static_cast<std::size_t>(4 + i)] = distortion.at<double>(i);
    return made;
}

ComparedCalibration compare(const LensData& data, const LensFit& start, const std::string& name) {
    ComparedCalibration compared;
    compared.name = name;
    const LensFit whole = opencv_fit(data, start, std::vector<char>(data.views.size(), 1));
    compared.rms_px = whole.rms_px;
    compared.camera = camera_of(whole.candidate, whole.lens, data.width, data.height);
    const std::size_t folds = fold_count(data.views.size());
    std::vector<double> sums(data.views.size());
    parallel_for(static_cast<int>(folds), [&](int index) {
        const auto fold = static_cast<std::size_t>(index);
        std::vector<char> in_use(data.views.size(), 1);
        for (std::size_t v = fold; v < data.views.size(); v += folds) in_use[v] = 0;
        LensFit without = opencv_fit(data, start, in_use);
        for (std::size_t v = fold; v < data.views.size(); v += folds) {
            adjust_pose(data, without, v);
            for (const Eigen::Vector2d& residual : residuals_of(data, without, v)) sums[v] += residual.squaredNorm();
        }
    });
    double sum = 0, count = 0;
    for (std::size_t v = 0; v < sums.size(); ++v) {
        sum += sums[v];
        count += static_cast<double>(data.views[v].corners.size());
    }
    compared.held_out_px = std::sqrt(sum / count);
    return compared;
}

}  // namespace

std::vector<ComparedCalibration> compare_with_opencv(const LensCalibration& calibration) {
    std::vector<ComparedCalibration> rows;
    LensData own = calibration.data;
    bool measured = true;
    for (LensView& view : own.views) {
        for (BoardCorner& corner : view.corners) {
            measured = measured && corner.opencv_px.allFinite();
            corner.px = corner.opencv_px;
        }
    }
    if (measured) rows.push_back(compare(own, calibration.fit, "OpenCV, its own corners"));
    rows.push_back(compare(calibration.data, calibration.fit, "OpenCV, our corners"));
    return rows;
}

}  // namespace matchlight
