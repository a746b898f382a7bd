// Geometry of the boards, and the short texts that name them.
#include "calibration/board.h"

#include <algorithm>

#include <fmt/format.h>

namespace matchlight {
namespace {

std::string millimetres(double metres) {
    return fmt::format("{:.4g} mm", 1000 * metres);
}

}  // namespace

std::string board_text(const BoardSpec& board) {
    switch (board.kind) {
        case BoardKind::chessboard:
            return fmt::format("a chessboard of {} × {} inner corners, squares of {}", board.columns, board.rows,
                               millimetres(board.square_m));
        case BoardKind::charuco:
            return fmt::format("a ChArUco board of {} × {} squares of {}, markers of {} from {}", board.columns,
                               board.rows, millimetres(board.square_m), millimetres(board.marker_m), board.dictionary);
        case BoardKind::aprilgrid:
            break;
    }
    return fmt::format("an AprilGrid of {} × {} tags (tag36h11, border of two cells) of {}, spacing {:.4g}",
                       board.columns, board.rows, millimetres(board.tag_m), board.spacing);
}

std::string board_spec_text(const BoardSpec& board) {
    const std::string size = fmt::format("{}x{}", board.columns, board.rows);
    switch (board.kind) {
        case BoardKind::chessboard:
            return fmt::format("chessboard {} {}", size, board.square_m);
        case BoardKind::charuco:
            return fmt::format("charuco {} {} {} {}", size, board.square_m, board.marker_m, board.dictionary);
        case BoardKind::aprilgrid:
            break;
    }
    return fmt::format("aprilgrid {} {} {}", size, board.tag_m, board.spacing);
}

std::vector<Eigen::Vector3d> board_corners_m(const BoardSpec& board) {
    std::vector<Eigen::Vector3d> corners;
    if (board.kind == BoardKind::aprilgrid) {
        const double step = board.tag_m * (1 + board.spacing);
        for (int row = 0; row < board.rows; ++row) {
            for (int column = 0; column < board.columns; ++column) {
                const Eigen::Vector3d origin(column * step, row * step, 0);
                corners.push_back(origin);
                corners.push_back(origin + Eigen::Vector3d(board.tag_m, 0, 0));
                corners.push_back(origin + Eigen::Vector3d(board.tag_m, board.tag_m, 0));
                corners.push_back(origin + Eigen::Vector3d(0, board.tag_m, 0));
            }
        }
        return corners;
    }
    const int less = board.kind == BoardKind::charuco ? 1 : 0;  // its squares are counted, not its corners
    for (int row = 0; row < board.rows - less; ++row) {
        for (int column = 0; column < board.columns - less; ++column) {
            corners.emplace_back((column + less) * board.square_m, (row + less) * board.row_square_m, 0);
        }
    }
    return corners;
}

double corner_spacing_m(const BoardSpec& board) {
    if (board.kind == BoardKind::aprilgrid) return board.tag_m * std::min(1.0, board.spacing);
    return std::min(board.square_m, board.row_square_m);
}

double plain_radius_m(const BoardSpec& board) {
    switch (board.kind) {
        case BoardKind::chessboard:
            return 0.5 * corner_spacing_m(board);
        case BoardKind::charuco:
            return (board.square_m - board.marker_m) / 2;  // the paper between a marker and its square
        case BoardKind::aprilgrid:
            break;
    }
    // Two of a tag's ten cells are its border; half the small square and half the gap belong to other corners.
    return std::min(0.2, board.spacing / 2) * board.tag_m;
}

}  // namespace matchlight
