// Local homographies between a board and its picture.
#include "calibration/corner_net.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "calibration/saddle.h"
#include "core/median.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;

/// Moves points to their mean and scales them to a mean distance of √2.
template <class Get>
Matrix3d normaliser(const std::vector<BoardAnchor>& anchors, Get get) {
    Vector2d mean = Vector2d::Zero();
    for (const BoardAnchor& anchor : anchors) mean += get(anchor);
    mean /= static_cast<double>(anchors.size());
    double distance = 0;
    for (const BoardAnchor& anchor : anchors) distance += (get(anchor) - mean).norm();
    const double scale = std::sqrt(2.0) * static_cast<double>(anchors.size()) / std::max(distance, 1e-300);
    Matrix3d t;
    t << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
    return t;
}

}  // namespace

std::optional<Matrix3d> homography_of(const std::vector<BoardAnchor>& anchors) {
    if (anchors.size() < 4) return std::nullopt;
    const Matrix3d from = normaliser(anchors, [](const BoardAnchor& a) { return a.board_m; });
    const Matrix3d to = normaliser(anchors, [](const BoardAnchor& a) { return a.px; });
    Eigen::MatrixXd equations(2 * anchors.size(), 9);
    for (std::size_t i = 0; i < anchors.size(); ++i) {
        const Eigen::Vector3d m = from * anchors[i].board_m.homogeneous();
        const Vector2d p = (to * anchors[i].px.homogeneous()).hnormalized();
        equations.row(2 * static_cast<Eigen::Index>(i)) << m.transpose(), 0, 0, 0, -p.x() * m.transpose();
        equations.row(2 * static_cast<Eigen::Index>(i) + 1) << 0, 0, 0, m.transpose(), -p.y() * m.transpose();
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeFullV);
    // The eighth singular value is zero for points on a line; 1e-6 is far below what noise leaves of a real board.
    if (!(svd.singularValues()[7] > 1e-6 * svd.singularValues()[0])) return std::nullopt;
    const Eigen::VectorXd h = svd.matrixV().col(8);
    Matrix3d normalised;
    normalised << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
    return Matrix3d(to.inverse() * normalised * from);
}

std::optional<LocalView> local_view(const std::vector<BoardAnchor>& anchors, const Vector2d& board_m,
                                    std::size_t count) {
    std::vector<std::size_t> order(anchors.size());
    std::iota(order.begin(), order.end(), 0);
    count = std::min(count, anchors.size());
    const auto distance = [&](std::size_t i) { return (anchors[i].board_m - board_m).squaredNorm(); };
    std::ranges::stable_sort(order, {}, distance);
    std::vector<BoardAnchor> nearest;
    for (std::size_t i = 0; i < count; ++i) nearest.push_back(anchors[order[i]]);
    const std::optional<Matrix3d> h = homography_of(nearest);
    if (!h) return std::nullopt;
    const Eigen::Vector3d p = *h * board_m.homogeneous();
    LocalView view;
    view.px = p.hnormalized();
    view.px_from_board = (h->topLeftCorner<2, 2>() - view.px * h->bottomLeftCorner<1, 2>()) / p.z();
    if (!view.px.allFinite() || !view.px_from_board.allFinite()) return std::nullopt;
    return view;
}

bool measure_corner(const BoardPicture& picture, const LocalView& view, double radius_m, int index,
                    std::vector<BoardCorner>& corners) {
    const std::optional<Saddle> saddle = fit_saddle(picture.light, {view.px, view.px_from_board, radius_m});
    if (!saddle) return false;
    BoardCorner corner;
    corner.index = index;
    corner.px = saddle->px;
    corner.sigma_px = saddle->sigma_px;
    corner.blur_px = saddle->blur_px;
    corners.push_back(corner);
    return true;
}

void finish_sighting(BoardSighting& sighting) {
    std::ranges::sort(sighting.corners, {}, &BoardCorner::index);
    std::vector<double> blurs;
    for (const BoardCorner& corner : sighting.corners) blurs.push_back(corner.blur_px);
    if (blurs.empty()) return;
    sighting.blur_px = upper_median_in_place(blurs);
}

}  // namespace matchlight
