// The flat targets a lens is calibrated with: what the user says of one, and where its corners lie.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

enum class BoardKind { chessboard, charuco, aprilgrid };

/// A board as it was printed. `columns` × `rows` counts inner corners of a chessboard, squares of a ChArUco board and
/// tags of an AprilGrid.
struct BoardSpec {
    BoardKind kind = BoardKind::chessboard;
    int columns = 0;
    int rows = 0;
    double square_m = 0;      // side of a square (chessboard, ChArUco), along the columns
    double row_square_m = 0;  // along the rows; chessboards in Kalibr's files may differ
    double marker_m = 0;      // ChArUco: side of a marker's black border
    std::string dictionary;   // ChArUco: OpenCV's name, such as DICT_5X5_100
    double tag_m = 0;         // AprilGrid: side of a tag's black border
    double spacing = 0;       // AprilGrid: gap between tags over the side of a tag
    int first_id = 0;         // AprilGrid: id of the tag at the lower left

    bool operator==(const BoardSpec&) const = default;
};

/// One line on how a board is named, for messages and help.
extern const char* const board_spec_forms;

/// A board given as text ("chessboard 9x6 0.025", "charuco 12x8 0.018 0.014 DICT_5X5_100", "aprilgrid 6x6 0.088 0.3",
/// lengths in metres) or as the name of a file: TOML with the same words as keys, or Kalibr's target YAML. Throws
/// InputError for what is neither, and for sizes that no board has.
BoardSpec read_board(const std::string& text_or_path);

/// "a chessboard of 9 × 6 inner corners, squares of 25 mm".
std::string board_text(const BoardSpec& board);
/// The text that read_board takes.
std::string board_spec_text(const BoardSpec& board);

/// The corners that a detector can find, by their number; metres, z = 0. A chessboard's and a ChArUco board's run by
/// rows; an AprilGrid's are four a tag, counter-clockwise from the tag's lower left, tags by rows from the lower left.
std::vector<Eigen::Vector3d> board_corners_m(const BoardSpec& board);
/// The distance between neighbouring corners of the same kind: what a prediction may be wrong by a part of.
double corner_spacing_m(const BoardSpec& board);
/// Half the side of the square around a corner in which the board shows nothing but two edges that cross there.
double plain_radius_m(const BoardSpec& board);

}  // namespace matchlight
