// Chessboards: OpenCV finds the squares, the corners are measured in linear light.
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/board_detector.h"
#include "calibration/corner_net.h"

namespace matchlight {
namespace {

cv::Mat view_of(const Image8& code) {
    return {code.height(), code.width(), CV_8UC1, const_cast<std::uint8_t*>(code.samples().data())};
}

class ChessboardDetector : public BoardDetector {
public:
    explicit ChessboardDetector(const BoardSpec& board) : board_(board), points_(board_corners_m(board)) {}

    BoardSighting detect(const BoardPicture& picture) const override {
        const cv::Mat code = view_of(picture.code);
        const cv::Size size(board_.columns, board_.rows);
        std::vector<cv::Point2f> found;
        // Duda & Frese, "Accurate Detection and Localization of Checkerboard Corners for Calibration" (2018), and where
        // that finds none the older search by quadrangles: each sees boards that the other misses.
        if (!cv::findChessboardCornersSB(code, size, found, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE) &&
            !cv::findChessboardCorners(
                code, size, found,
                cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK)) {
            return {};
        }
        std::vector<BoardAnchor> anchors;
        for (std::size_t i = 0; i < found.size(); ++i) {
            anchors.push_back({points_[i].head<2>(), {found[i].x, found[i].y}});
        }
        BoardSighting sighting;
        constexpr std::size_t neighbours = 9;
        for (std::size_t i = 0; i < anchors.size(); ++i) {
            std::optional<LocalView> view = local_view(anchors, anchors[i].board_m, neighbours);
            if (!view) continue;
            view->px = anchors[i].px;
            measure_corner(picture, *view, plain_radius_m(board_), static_cast<int>(i), sighting.corners);
        }
        finish_sighting(sighting);
        return sighting;
    }

    std::string seen_instead(const BoardPicture& picture) const override {
        std::vector<cv::Point2f> found;
        cv::Mat kinds;
        const bool any = cv::findChessboardCornersSB(
            view_of(picture.code), cv::Size(3, 3), found,
            cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER, kinds);
        if (!any) return {};
        return fmt::format("a chessboard of at least {} × {} inner corners", kinds.cols, kinds.rows);
    }

private:
    BoardSpec board_;
    std::vector<Eigen::Vector3d> points_;
};

}  // namespace

std::unique_ptr<BoardDetector> create_chessboard_detector(const BoardSpec& board) {
    return std::make_unique<ChessboardDetector>(board);
}

}  // namespace matchlight
