// Projection and look-up; the boards' ink is written down here anew, so that a detector's mistake is none of the
// test's.
#include "synthetic_board.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#include <opencv2/aruco.hpp>

#include "core/transfer.h"

namespace matchlight::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Extent {
    Vector3d low, high;
};

Extent extent_of(const BoardSpec& board) {
    Extent extent{Vector3d::Constant(1e9), Vector3d::Constant(-1e9)};
    for (const Vector3d& corner : board_corners_m(board)) {
        extent.low = extent.low.cwiseMin(corner);
        extent.high = extent.high.cwiseMax(corner);
    }
    return extent;
}

/// Reflectance of the board's plane, 0 black to 1 white.
class BoardInk {
public:
    explicit BoardInk(const BoardSpec& board) : board_(board), extent_(extent_of(board)) {
        if (board.kind == BoardKind::charuco) {
            const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
            for (int id = 0; id < 50; ++id) {
                cv::Mat marker;
                dictionary->drawMarker(id, 6, marker);
                markers_.push_back(marker);
            }
        }
    }
    ~BoardInk() { tag36h11_destroy(family_); }
    BoardInk(const BoardInk&) = delete;
    BoardInk& operator=(const BoardInk&) = delete;

    double at(double x, double y) const {
        switch (board_.kind) {
            case BoardKind::chessboard:
                return chessboard(x, y);
            case BoardKind::charuco:
                return charuco(x, y);
            case BoardKind::aprilgrid:
                break;
        }
        return aprilgrid(x, y);
    }

private:
    static constexpr double grey = 0.4;  // of the room

    double chessboard(double x, double y) const {
        const int column = static_cast<int>(std::floor(x / board_.square_m)) + 1;
        const int row = static_cast<int>(std::floor(y / board_.square_m)) + 1;
        if (column < -1 || row < -1 || column > board_.columns + 1 || row > board_.rows + 1) return grey;
        if (column < 0 || row < 0 || column > board_.columns || row > board_.rows) return 1;
        return (column + row) % 2 == 0 ? 0 : 1;
    }

    double charuco(double x, double y) const {
        const int column = static_cast<int>(std::floor(x / board_.square_m));
        const int row = static_cast<int>(std::floor(y / board_.square_m));
        if (column < -1 || row < -1 || column > board_.columns || row > board_.rows) return grey;
        if (column < 0 || row < 0 || column >= board_.columns || row >= board_.rows) return 1;
        if ((column + row) % 2 == 0) return 0;
        const double inset = (board_.square_m - board_.marker_m) / 2;
        const double u = (x - column * board_.square_m - inset) / board_.marker_m * 6;
        const double v = (y - row * board_.square_m - inset) / board_.marker_m * 6;
        if (u < 0 || v < 0 || u >= 6 || v >= 6) return 1;
        int id = 0;  // white squares before this one, by rows from the top
        for (int i = 0; i < row * board_.columns + column; ++i) {
            id += (i / board_.columns + i % board_.columns) % 2 != 0 ? 1 : 0;
        }
        return markers_[static_cast<std::size_t>(id)].at<std::uint8_t>(static_cast<int>(v), static_cast<int>(u)) /
               255.0;
    }

    /// y up, tags by rows from the lower left, a small square wherever four gaps' corners meet.
    double aprilgrid(double x, double y) const {
        const double step = board_.tag_m * (1 + board_.spacing), gap = board_.tag_m * board_.spacing;
        if (x < -2 * gap || y < -2 * gap || x > board_.columns * step + gap || y > board_.rows * step + gap)
            return grey;
        const int column = static_cast<int>(std::floor((x + gap) / step));
        const int row = static_cast<int>(std::floor((y + gap) / step));
        const double u = x + gap - column * step, v = y + gap - row * step;  // the gap comes first
        if (u < gap && v < gap) {
            return column >= 0 && row >= 0 && column <= board_.columns && row <= board_.rows ? 0 : 1;
        }
        if (u < gap || v < gap || column < 0 || row < 0 || column >= board_.columns || row >= board_.rows) return 1;
        const int cell_x = static_cast<int>((u - gap) / board_.tag_m * 10);
        const int cell_y = 9 - static_cast<int>((v - gap) / board_.tag_m * 10);
        for (std::uint32_t bit = 0; bit < family_->nbits; ++bit) {
            if (static_cast<int>(family_->bit_x[bit]) + 1 != cell_x ||
                static_cast<int>(family_->bit_y[bit]) + 1 != cell_y) {
                continue;
            }
            const std::uint64_t code = family_->codes[board_.first_id + row * board_.columns + column];
            return static_cast<double>(code >> (family_->nbits - 1 - bit) & 1u);
        }
        return 0;
    }

    BoardSpec board_;
    Extent extent_;
    std::vector<cv::Mat> markers_;
    apriltag_family_t* family_ = tag36h11_create();
};

}  // namespace

std::vector<RigidTransform> board_poses(const BoardSpec& board, const Camera& camera, int count, double most_tilt_deg) {
    const Extent extent = extent_of(board);
    const Vector3d middle = (extent.low + extent.high) / 2;
    const double size = (extent.high - extent.low).norm();
    // y up on an AprilGrid, down on the others: either way the print faces the camera.
    const Eigen::Matrix3d facing = board.kind == BoardKind::aprilgrid
                                       ? Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix()
                                       : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
    std::vector<RigidTransform> poses;
    for (int i = 0; i < count; ++i) {
        // Low-discrepancy numbers (multiples of the golden ratio and its kin) spread any count of poses.
        const auto spread = [&](double step) { return 2 * std::fmod(0.5 + (i + 1) * step, 1.0) - 1; };
        const double tilt = most_tilt_deg * std::numbers::pi / 180 * std::sqrt(std::abs(spread(0.8191725)));
        const double about = std::numbers::pi * spread(0.6710436), turn = 0.4 * spread(0.5497005);
        const Vector3d axis(std::cos(about), std::sin(about), 0);
        const double focal = std::min(camera.fx / camera.width, camera.fy / camera.height);
        const double distance = size * focal * (1.25 + 0.35 * spread(0.4503));
        const Vector2d px(camera.width * (0.5 + 0.22 * spread(0.618034)),
                          camera.height * (0.5 + 0.22 * spread(0.7548777)));
        const Vector3d ray = camera.normalized_from_pixel(px).homogeneous();
        RigidTransform pose = RigidTransform::Identity();
        pose.linear() =
            (Eigen::AngleAxisd(tilt, axis) * Eigen::AngleAxisd(turn, Vector3d::UnitZ())).toRotationMatrix() * facing;
        pose.translation() = distance * ray - pose.linear() * middle;
        poses.push_back(pose);
    }
    return poses;
}

LensData synthetic_corners(const BoardSpec& board, const SyntheticLens& lens,
                           const std::vector<RigidTransform>& camera_from_board, double noise_px, std::uint32_t seed) {
    const Extent extent = extent_of(board);
    const Vector3d middle = (extent.low + extent.high) / 2, half = (extent.high - extent.low) / 2;
    const std::vector<Vector3d> corners = board_corners_m(board);
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 1);
    LensData data{board, lens.camera.width, lens.camera.height, {}};
    for (std::size_t v = 0; v < camera_from_board.size(); ++v) {
        LensView view{"view " + std::to_string(v), static_cast<std::int64_t>(v), {}};
        for (std::size_t i = 0; i < corners.size(); ++i) {
            Vector3d at = corners[i];
            const double x = (at.x() - middle.x()) / half.x(), y = (at.y() - middle.y()) / half.y();
            at.z() = lens.bend_m[0] * (1 - x * x) + lens.bend_m[1] * (1 - y * y) + lens.bend_m[2] * x * y;
            const Vector3d seen = camera_from_board[v] * at;
            if (seen.z() <= 0) continue;
            BoardCorner corner;
            corner.index = static_cast<int>(i);
            corner.px = lens.camera.pixel_from_camera(seen) + noise_px * Vector2d(noise(random), noise(random));
            corner.blur_px = 0.7;
            if (corner.px.x() < 0 || corner.px.y() < 0 || corner.px.x() > data.width - 1 ||
                corner.px.y() > data.height - 1) {
                continue;
            }
            view.corners.push_back(corner);
        }
        data.views.push_back(view);
    }
    return data;
}

Image8 board_photograph(const BoardSpec& board, const Camera& camera, const RigidTransform& camera_from_board) {
    const BoardInk ink(board);
    const RigidTransform board_from_camera = camera_from_board.inverse();
    const int width = camera.width, height = camera.height;
    // Rays at the pixels' corners; between them they bend by far less than a hundredth of a pixel.
    std::vector<Vector2d> rays(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1));
    for (int y = 0; y <= height; ++y) {
        for (int x = 0; x <= width; ++x) {
            rays[static_cast<std::size_t>(y) * static_cast<std::size_t>(width + 1) + static_cast<std::size_t>(x)] =
                camera.normalized_from_pixel({x - 0.5, y - 0.5});
        }
    }
    const auto ray = [&](int x, int y) {
        return rays[static_cast<std::size_t>(y) * static_cast<std::size_t>(width + 1) + static_cast<std::size_t>(x)];
    };
    Image8 photograph(width, height, 3);
    constexpr int steps = 6;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (int i = 0; i < steps * steps; ++i) {
                const int column = i % steps, row = i / steps;
                const double u = (column + 0.5) / steps, v = (row + 0.5) / steps;
                const Vector2d n = (1 - v) * ((1 - u) * ray(x, y) + u * ray(x + 1, y)) +
                                   v * ((1 - u) * ray(x, y + 1) + u * ray(x + 1, y + 1));
                const Vector3d direction = board_from_camera.linear() * n.homogeneous();
                const Vector3d origin = board_from_camera.translation();
                const Vector3d hit = origin - origin.z() / direction.z() * direction;
                sum += n.allFinite() ? ink.at(hit.x(), hit.y()) : 0;
            }
            const double light = 0.03 + 0.8 * sum / (steps * steps);
            const auto code = static_cast<std::uint8_t>(std::lround(255 * srgb_code_from_linear(light)));
            for (int c = 0; c < 3; ++c) photograph.at(x, y, c) = code;
        }
    }
    return photograph;
}

}  // namespace matchlight::test
