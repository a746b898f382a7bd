// Chessboards, ChArUco boards and AprilGrids as black rectangles on a page.
#include "calibration/board_sheet.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "calibration/aruco_dictionary.h"
#include "calibration/ink_shape.h"
#include "calibration/paper_sizes.h"
#include "calibration/sheet_frame.h"
#include "calibration/tag_family.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

/// A board's ink, millimetres from its upper left corner.
struct BoardInk {
    double width_mm = 0, height_mm = 0;
    std::vector<InkRectangle> black;
    Vector2d origin_mm;    // where board_corners_m has (0, 0)
    bool y_is_up = false;  // of board_corners_m
};

void add_square(BoardInk& ink, double left, double top, double width, double height) {
    ink.black.push_back({left, top, left + width, top + height});
}

BoardInk chessboard_ink(const BoardSpec& board) {
    const double width = 1000 * board.square_m, height = 1000 * board.row_square_m;
    const int columns = board.columns + 1, rows = board.rows + 1;  // squares, one more than corners
    BoardInk ink{columns * width, rows * height, {}, {width, height}};
    for (int row = 0; row < rows; ++row) {
        for (int column = row % 2; column < columns; column += 2) {
            add_square(ink, column * width, row * height, width, height);
        }
    }
    return ink;
}

/// As OpenCV draws it since 4.6.1: a black square at the upper left, markers in the white ones by rows from the top.
BoardInk charuco_ink(const BoardSpec& board) {
    const double width = 1000 * board.square_m, height = 1000 * board.row_square_m, side = 1000 * board.marker_m;
    const auto dictionary = cv::aruco::getPredefinedDictionary(aruco_dictionary_of(board).id);
    const int cells = dictionary->markerSize + 2;  // with the border
    BoardInk ink{board.columns * width, board.rows * height, {}, {0, 0}};
    int id = 0;
    for (int row = 0; row < board.rows; ++row) {
        for (int column = 0; column < board.columns; ++column) {
            if ((row + column) % 2 == 0) {
                add_square(ink, column * width, row * height, width, height);
                continue;
            }
            cv::Mat marker;
            cv::aruco::drawMarker(dictionary, id++, cells, marker);
            const double left = column * width + (width - side) / 2, top = row * height + (height - side) / 2;
            for (int y = 0; y < cells; ++y) {
                for (int x = 0; x < cells; ++x) {
                    if (marker.at<std::uint8_t>(y, x) != 0) continue;
                    add_square(ink, left + x * side / cells, top + y * side / cells, side / cells, side / cells);
                }
            }
        }
    }
    return ink;
}

/// Kalibr's: ids from the lower left, a border of two cells, a small square wherever gaps cross, also outside.
BoardInk aprilgrid_ink(const BoardSpec& board) {
    const double tag = 1000 * board.tag_m, gap = tag * board.spacing, step = tag + gap;
    constexpr int code_cells = 6, border_cells = 2, cells = code_cells + 2 * border_cells;
    const TagFamily family("tag36h11");
    BoardInk ink{board.columns * step + gap, board.rows * step + gap, {}, {}, true};
    ink.origin_mm = {gap, ink.height_mm - gap};
    for (int row = 0; row <= board.rows; ++row) {
        for (int column = 0; column <= board.columns; ++column) {
            add_square(ink, column * step, row * step, gap, gap);
            if (row == board.rows || column == board.columns) continue;
            const TagPattern pattern = family.pattern(board.first_id + (board.rows - 1 - row) * board.columns + column);
            const int inset = static_cast<int>(pattern.border_begin) + 1 - border_cells;  // its border has one cell
            for (int y = 0; y < cells; ++y) {
                for (int x = 0; x < cells; ++x) {
                    const bool border = std::min({x, y, cells - 1 - x, cells - 1 - y}) < border_cells;
                    if (!border && pattern.at(x + inset, y + inset) == TagPattern::white) continue;
                    add_square(ink, gap + column * step + x * tag / cells, gap + row * step + y * tag / cells,
                               tag / cells, tag / cells);
                }
            }
        }
    }
    return ink;
}

BoardInk ink_of(const BoardSpec& board) {
    switch (board.kind) {
        case BoardKind::chessboard:
            return chessboard_ink(board);
        case BoardKind::charuco:
            return charuco_ink(board);
        case BoardKind::aprilgrid:
            break;
    }
    return aprilgrid_ink(board);
}

/// Upper left corner of the board, in the middle of what header and footer leave of the page; nothing where it does
/// not fit.
std::optional<Vector2d> place_on(const Paper& paper, const BoardInk& ink) {
    constexpr double side = sheet_margin_mm + white_mm;
    constexpr double above = side + top_mark_mm, below = side + footer_mm;
    const double spare_x = paper.width_mm - 2 * side - ink.width_mm;
    const double spare_y = paper.height_mm - above - below - ink.height_mm;
    if (spare_x < 0 || spare_y < 0) return std::nullopt;
    return Vector2d(side + spare_x / 2, above + spare_y / 2);
}

}  // namespace

BoardSheet board_sheet(const BoardSpec& board, const Paper& paper) {
    const BoardInk ink = ink_of(board);
    for (const Paper& way : ways_to_lay(paper)) {
        const std::optional<Vector2d> at = place_on(way, ink);
        if (!at) continue;
        SheetPage page;
        std::vector<InkRectangle> black = ink.black;
        for (InkRectangle& r : black) {
            r = {r.left + at->x(), r.top + at->y(), r.right + at->x(), r.bottom + at->y()};
        }
        page.ink.push_back(united(black));
        for (const Eigen::Vector3d& corner : board_corners_m(board)) {
            page.corners_mm.emplace_back(*at + ink.origin_mm +
                                         1000 * Vector2d(corner.x(), ink.y_is_up ? -corner.y() : corner.y()));
        }
        add_top_mark(page, {way.width_mm / 2, at->y() - white_mm});
        add_footer(page, way, board_spec_text(board));
        return {way, board_text(board), {page}};
    }
    refuse_paper(fmt::format("{}: {:.4g} × {:.4g} mm", board_text(board), ink.width_mm, ink.height_mm), paper,
                 [&](const Paper& other) { return place_on(other, ink).has_value(); });
}

}  // namespace matchlight
