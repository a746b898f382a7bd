// Descriptions of views, and the greedy choice among them.
#include "calibration/view_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calibration/corner_net.h"
#include "core/median.h"

namespace matchlight {
namespace {

/// Place (2), size, tilt (2): each about 0 to 1 over what a good set of views holds.
using Description = Eigen::Matrix<double, 5, 1>;

struct DescribedView {
    Description at;
    double merit = 0;  // 0 to 1: sharpness and completeness
    double blur_px = 0;
};

double median_blur(const LensView& view) {
    std::vector<double> blurs;
    for (const BoardCorner& corner : view.corners) blurs.push_back(corner.blur_px);
    return upper_median_in_place(blurs);
}

/// The board's normal in a camera of an ordinary focal length: good enough to tell tilts apart.
Eigen::Vector2d rough_tilt(const Eigen::Matrix3d& px_from_board, const LensData& data) {
    const double focal_px = 1.2 * std::max(data.width, data.height);
    Eigen::Matrix3d k;
    k << focal_px, 0, (data.width - 1) / 2.0, 0, focal_px, (data.height - 1) / 2.0, 0, 0, 1;
    const Eigen::Matrix3d h = k.inverse() * px_from_board;
    Eigen::Vector3d normal = h.col(0).cross(h.col(1));
    normal.normalize();
    if (normal.z() < 0) normal = -normal;
    return normal.head<2>();
}

std::optional<DescribedView> describe(const LensView& view, const LensData& data,
                                      const std::vector<Eigen::Vector3d>& board) {
    std::vector<BoardAnchor> anchors;
    Eigen::Vector2d low = view.corners.front().px, high = low;
    for (const BoardCorner& corner : view.corners) {
        anchors.push_back({board[static_cast<std::size_t>(corner.index)].head<2>(), corner.px});
        low = low.cwiseMin(corner.px);
        high = high.cwiseMax(corner.px);
    }
    const std::optional<Eigen::Matrix3d> h = homography_of(anchors);
    if (!h) return std::nullopt;
    const Eigen::Vector2d middle = (low + high) / 2;
    const double size = std::sqrt((high - low).prod() / (static_cast<double>(data.width) * data.height));
    const Eigen::Vector2d tilt = rough_tilt(*h, data);
    DescribedView described;
    described.at << middle.x() / data.width, middle.y() / data.height, size, tilt.x(), tilt.y();
    described.blur_px = median_blur(view);
    described.merit = std::sqrt(static_cast<double>(view.corners.size()) / static_cast<double>(board.size()));
    return described.at.allFinite() ? std::optional(described) : std::nullopt;
}

}  // namespace

std::vector<std::size_t> choose_views(const LensData& data, std::size_t count) {
    const std::vector<Eigen::Vector3d> board = board_corners_m(data.board);
    std::vector<std::size_t> candidates;
    std::vector<DescribedView> described(data.views.size());
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        constexpr std::size_t least_corners = 8;  // fewer hardly hold a pose
        if (data.views[v].corners.size() < least_corners) continue;
        if (const auto view = describe(data.views[v], data, board)) {
            described[v] = *view;
            candidates.push_back(v);
        }
    }
    if (candidates.size() <= count) return candidates;
    // By sharpness; what is blurred half as much again as the sharpest quarter goes, as long as enough remain.
    std::ranges::stable_sort(candidates, {}, [&](std::size_t v) { return described[v].blur_px; });
    const double sharp_px = described[candidates[candidates.size() / 4]].blur_px;
    while (candidates.size() > count && described[candidates.back()].blur_px > 1.5 * sharp_px) candidates.pop_back();
    const double sharpest_px = described[candidates.front()].blur_px;
    for (const std::size_t v : candidates) described[v].merit *= std::sqrt(sharpest_px / described[v].blur_px);

    std::vector<std::size_t> chosen = {candidates.front()};
    std::vector<double> distance(data.views.size(), std::numeric_limits<double>::infinity());
    while (chosen.size() < std::min(count, candidates.size())) {
        std::size_t best = candidates.front();
        double most = -1;
        for (const std::size_t v : candidates) {
            distance[v] = std::min(distance[v], (described[v].at - described[chosen.back()].at).norm());
            const double score = distance[v] * described[v].merit;
            if (score > most || (score == most && v < best)) {
                most = score;
                best = v;
            }
        }
        if (!(most > 0)) break;  // the rest repeats what is chosen
        chosen.push_back(best);
    }
    std::ranges::sort(chosen);
    return chosen;
}

std::size_t distinct_views(const LensData& data) {
    constexpr double apart = 0.05;
    const std::vector<Eigen::Vector3d> board = board_corners_m(data.board);
    std::vector<Description> distinct;
    for (const LensView& view : data.views) {
        const std::optional<DescribedView> described = describe(view, data, board);
        if (!described) continue;
        const auto near = [&](const Description& other) { return (other - described->at).norm() < apart; };
        if (std::ranges::none_of(distinct, near)) distinct.push_back(described->at);
    }
    return distinct.size();
}

}  // namespace matchlight
