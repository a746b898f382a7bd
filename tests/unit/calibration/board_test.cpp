// What a board may be called, and where its corners lie.
#include "calibration/board.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {
namespace {

std::string error_of(const std::string& text) {
    try {
        (void)read_board(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

class BoardFile : public testing::Test {
protected:
    ~BoardFile() override { std::filesystem::remove(path_); }
    BoardSpec read(const std::string& extension, const std::string& text) {
        path_ = std::filesystem::temp_directory_path() / ("matchlight_board_" + std::to_string(getpid()) + extension);
        std::ofstream(path_) << text;
        return read_board(path_.string());
    }
    std::filesystem::path path_;
};

TEST(Board, IsReadFromWords) {
    const BoardSpec chess = read_board("chessboard 9x6 0.025");
    EXPECT_EQ(chess.kind, BoardKind::chessboard);
    EXPECT_EQ(chess.columns, 9);
    EXPECT_EQ(chess.rows, 6);
    EXPECT_EQ(chess.square_m, 0.025);
    const BoardSpec charuco = read_board("charuco 12x8 0.018 0.014 DICT_5X5_100");
    EXPECT_EQ(charuco.kind, BoardKind::charuco);
    EXPECT_EQ(charuco.marker_m, 0.014);
    EXPECT_EQ(charuco.dictionary, "DICT_5X5_100");
    const BoardSpec grid = read_board("AprilGrid 6x6 0.088 0.3");
    EXPECT_EQ(grid.kind, BoardKind::aprilgrid);
    EXPECT_EQ(grid.tag_m, 0.088);
    EXPECT_EQ(grid.spacing, 0.3);
    for (const BoardSpec& board : {chess, charuco, grid}) EXPECT_EQ(read_board(board_spec_text(board)), board);
}

TEST_F(BoardFile, IsReadFromToml) {
    const BoardSpec board =
        read(".toml", "type = \"aprilgrid\"\ncolumns = 11\nrows = 6\ntag_size = 0.02\nspacing = 0.25\nfirst_id = 36\n");
    EXPECT_EQ(board.kind, BoardKind::aprilgrid);
    EXPECT_EQ(board.columns, 11);
    EXPECT_EQ(board.first_id, 36);
    EXPECT_THROW(read(".toml", "type = \"chessboard\"\ncolumns = 9\nrows = 6\nsqare = 0.02\n"), InputError);
    EXPECT_THROW(read(".toml", "type = \"chessboard\"\ncolumns = 9\nrows = 6\n"), InputError);
    EXPECT_THROW(read(".toml", "type = [\n"), InputError);
}

TEST_F(BoardFile, IsReadFromKalibrsTargets) {
    const BoardSpec grid =
        read(".yaml", "target_type: 'aprilgrid'  # grid\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n");
    EXPECT_EQ(grid.kind, BoardKind::aprilgrid);
    EXPECT_EQ(grid.columns, 6);
    EXPECT_EQ(grid.rows, 5);
    const BoardSpec chess = read(".yaml",
                                 "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
                                 "colSpacingMeters: 0.05\n");
    EXPECT_EQ(chess.kind, BoardKind::chessboard);
    EXPECT_EQ(chess.square_m, 0.05);
    EXPECT_EQ(board_corners_m(chess).back(), Eigen::Vector3d(5 * 0.05, 6 * 0.06, 0));
    EXPECT_THROW(read(".yaml", "target_type: 'circlegrid'\n"), InputError);
    EXPECT_THROW(read(".yaml", "target_type: 'aprilgrid'\ntagCols: 6\n"), InputError);
}

TEST(ReadyBoards, AllAreRead) {
    int boards = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "calib" / "boards")) {
        if (entry.path().extension() == ".pdf") continue;  // to print
        EXPECT_FALSE(board_corners_m(read_board(entry.path().string())).empty()) << entry.path();
        ++boards;
    }
    EXPECT_GE(boards, 3);
}

TEST(Board, SaysWhatIsNonsense) {
    EXPECT_NE(error_of("").find("empty"), std::string::npos);
    EXPECT_NE(error_of("dartboard 9x6 1").find("neither"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9 0.025").find("9x6"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9x6").find("words"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9x6 nan").find("length"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9x6 -1").find("length"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9x6 1cm").find("no number"), std::string::npos);
    EXPECT_NE(error_of("chessboard 2x6 0.025").find("at least"), std::string::npos);
    EXPECT_NE(error_of("chessboard 9x1000000000 0.025").find("rows"), std::string::npos);
    EXPECT_NE(error_of("charuco 5x7 0.03 0.04 DICT_4X4_50").find("as large"), std::string::npos);
    EXPECT_NE(error_of("aprilgrid 6x6 0.088 30").find("spacing"), std::string::npos);
    EXPECT_NE(error_of("aprilgrid 60x60 0.088 0.3").find("586"), std::string::npos);
}

TEST(Board, AnAprilgridsCornersAreTagByTag) {
    const BoardSpec board = read_board("aprilgrid 3x2 0.1 0.3");
    const std::vector<Eigen::Vector3d> corners = board_corners_m(board);
    ASSERT_EQ(corners.size(), 24u);
    EXPECT_EQ(corners[2], Eigen::Vector3d(0.1, 0.1, 0));
    EXPECT_LT((corners[4] - Eigen::Vector3d(0.13, 0, 0)).norm(), 1e-12);   // the second tag
    EXPECT_LT((corners[12] - Eigen::Vector3d(0, 0.13, 0)).norm(), 1e-12);  // the second row
}

}  // namespace
}  // namespace matchlight
