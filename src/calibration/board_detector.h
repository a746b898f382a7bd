// Finds a board in a picture: which of its corners are seen, and where, to hundredths of a pixel.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/board.h"
#include "core/image.h"

namespace matchlight {

/// A picture as the detectors want it.
struct BoardPicture {
    Image8 code;   // 1 channel: code values, in which codes and squares are read
    ImageF light;  // 1 channel: scene-linear, in which corners are measured
};
/// From R'G'B' or grey code values, taken as sRGB: corners of crossing edges do not move when the response is another.
BoardPicture board_picture(const Image8& rgb);
BoardPicture board_picture(const ImageF& gray_code);

struct BoardCorner {
    int index = 0;  // into board_corners_m
    Eigen::Vector2d px;
    double sigma_px = 0;  // of the corner's own fit
    double blur_px = 0;   // standard deviation of its edges
    Eigen::Vector2d opencv_px = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());  // if asked for
};

/// The board as one picture shows it.
struct BoardSighting {
    std::vector<BoardCorner> corners;  // by index; empty where the board was not found
    int marks = 0;                     // markers or tags that were read
    double blur_px = 0;                // median over the corners
};

class BoardDetector {
public:
    virtual ~BoardDetector() = default;
    /// May be called from one thread at a time.
    virtual BoardSighting detect(const BoardPicture& picture) const = 0;
    /// What there is instead of the board, for the message that says so: "a chessboard of at least 7 × 5 inner
    /// corners"; empty where nothing of the kind is seen.
    virtual std::string seen_instead(const BoardPicture& picture) const = 0;

    /// Throws InputError for a dictionary that OpenCV does not know.
    static std::unique_ptr<BoardDetector> create(const BoardSpec& board);
};

/// Fills in `opencv_px` of the corners, to compare with: cv::cornerSubPix on code values.
void measure_as_opencv(const BoardPicture& picture, BoardSighting& sighting);

// One a kind of board; `create` chooses.
std::unique_ptr<BoardDetector> create_chessboard_detector(const BoardSpec& board);
std::unique_ptr<BoardDetector> create_charuco_detector(const BoardSpec& board);
std::unique_ptr<BoardDetector> create_aprilgrid_detector(const BoardSpec& board);

}  // namespace matchlight
