// Pictures made ready for the detectors, and the choice between these.
#include "calibration/board_detector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "core/transfer.h"

namespace matchlight {

BoardPicture board_picture(const Image8& rgb) {
    std::array<float, 256> linear{};
    for (std::size_t i = 0; i < linear.size(); ++i) {
        linear[i] = static_cast<float>(linear_from_srgb_code(static_cast<double>(i) / 255));
    }
    const bool colour = rgb.channels() == 3;
    BoardPicture picture{Image8(rgb.width(), rgb.height(), 1), ImageF(rgb.width(), rgb.height(), 1)};
    for (int y = 0; y < rgb.height(); ++y) {
        for (int x = 0; x < rgb.width(); ++x) {
            const std::uint8_t* p = rgb.pixel(x, y);
            const std::uint8_t r = p[0], g = colour ? p[1] : p[0], b = colour ? p[2] : p[0];
            // Luma as JPEG defines it (Rec.601), luminance by Rec.709.
            picture.code.at(x, y) = static_cast<std::uint8_t>((299 * r + 587 * g + 114 * b + 500) / 1000);
            picture.light.at(x, y) = static_cast<float>(luminance_rec709(linear[r], linear[g], linear[b]));
        }
    }
    return picture;
}

BoardPicture board_picture(const ImageF& gray_code) {
    BoardPicture picture{Image8(gray_code.width(), gray_code.height(), 1), gray_code};
    std::ranges::transform(gray_code.samples(), picture.code.samples().begin(), [](float code) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0f, 1.0f)));
    });
    for (float& value : picture.light.samples()) value = static_cast<float>(linear_from_srgb_code(value));
    return picture;
}

void measure_as_opencv(const BoardPicture& picture, BoardSighting& sighting) {
    if (sighting.corners.empty()) return;
    std::vector<cv::Point2f> points;
    for (const BoardCorner& corner : sighting.corners) {
        // From whole pixels, as its own searches leave them.
        points.emplace_back(static_cast<float>(std::round(corner.px.x())),
                            static_cast<float>(std::round(corner.px.y())));
    }
    const cv::Mat code(picture.code.height(), picture.code.width(), CV_8UC1,
                       const_cast<std::uint8_t*>(picture.code.samples().data()));
    // The window and the end of OpenCV's own calibration sample.
    cv::cornerSubPix(code, points, {5, 5}, {-1, -1},
                     cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001));
    for (std::size_t i = 0; i < points.size(); ++i) {
        sighting.corners[i].opencv_px = {points[i].x, points[i].y};
    }
}

std::unique_ptr<BoardDetector> BoardDetector::create(const BoardSpec& board) {
    switch (board.kind) {
        case BoardKind::chessboard:
            return create_chessboard_detector(board);
        case BoardKind::charuco:
            return create_charuco_detector(board);
        case BoardKind::aprilgrid:
            break;
    }
    return create_aprilgrid_detector(board);
}

}  // namespace matchlight
