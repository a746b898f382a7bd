// Printed sheets: their ink, their size, and that the program's own detectors read them.
#include "calibration/board_sheet.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "../media/scratch_folder.h"
#include "calibration/board_detector.h"
#include "calibration/board_sheet_file.h"
#include "calibration/ink_shape.h"
#include "core/error.h"
#include "media/image_io.h"
#include "tracking/tag_detector.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

double area_of(const InkOutline& outline) {
    double twice = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
        twice += a.x() * b.y() - a.y() * b.x();
    }
    return twice / 2;
}

double area_of(const InkShape& shape) {
    double sum = 0;
    for (const InkOutline& outline : shape) sum += area_of(outline);
    return sum;
}

TEST(InkShape, NeighboursBecomeOneOutline) {
    // A row of three cells whose common edges differ by rounding, and one below the middle: a T of eight corners.
    const InkShape t =
        united({{0, 0, 0.1, 1}, {0.1, 0, 0.3, 1}, {0.1 + 0.2, 0, 0.4, 1}, {0.1, 1, 0.30000000000000004, 2}});
    ASSERT_EQ(t.size(), 1u);
    EXPECT_EQ(t[0].size(), 8u);
    EXPECT_NEAR(area_of(t), 0.6, 1e-12);
}

TEST(InkShape, HolesAndCornersThatTouchKeepTheirArea) {
    std::vector<InkRectangle> ring;
    for (int i = 0; i < 9; ++i) {
        if (i != 4) ring.push_back({i % 3 * 1.0, i / 3 * 1.0, i % 3 + 1.0, i / 3 + 1.0});
    }
    const InkShape with_hole = united(ring);
    ASSERT_EQ(with_hole.size(), 2u);
    EXPECT_NEAR(area_of(with_hole), 8, 1e-12);
    EXPECT_EQ(with_hole[0].size() + with_hole[1].size(), 8u);

    const InkShape diagonal = united({{0, 0, 1, 1}, {1, 1, 2, 2}});
    ASSERT_EQ(diagonal.size(), 2u);
    EXPECT_NEAR(area_of(diagonal), 2, 1e-12);
    EXPECT_TRUE(united({}).empty());
}

constexpr double dpi = 300;

class PrintedSheet : public ScratchFolder {
protected:
    std::vector<Image8> rendered(const BoardSheet& sheet) const;
    void expect_true_to_size(const std::string& spec, const std::string& paper) const;
    void expect_tags_true_to_size(const std::string& spec_text, std::size_t pages, int per_page = 0) const;
};

/// The sheet as `write_sheet` draws it, read back; by pages.
std::vector<Image8> PrintedSheet::rendered(const BoardSheet& sheet) const {
    const std::filesystem::path pattern = folder_ / "page_%02d.png";
    write_sheet(sheet, pattern, dpi);
    std::vector<Image8> pages;
    for (const auto& file : sheet_files(sheet, pattern)) pages.push_back(read_rgb8(file));
    return pages;
}

Vector2d mm_from_px(const Vector2d& px) {
    return (px + Vector2d(0.5, 0.5)) * 25.4 / dpi;
}

/// Every corner of the board is found within `tolerance` of where the board's own geometry has it on the page.
void PrintedSheet::expect_true_to_size(const std::string& spec, const std::string& paper) const {
    SCOPED_TRACE(spec);
    const BoardSpec board = read_board(spec);
    const BoardSheet sheet = board_sheet(board, read_paper(paper));
    ASSERT_EQ(sheet.pages.size(), 1u);
    const std::vector<Eigen::Vector3d> truth_m = board_corners_m(board);
    const double up = board.kind == BoardKind::aprilgrid ? -1 : 1;
    const Vector2d origin = sheet.pages[0].corners_mm[0] - 1000 * Vector2d(truth_m[0].x(), up * truth_m[0].y());
    const Image8 picture = rendered(sheet)[0];
    EXPECT_EQ(picture.width(), std::lround(sheet.paper.width_mm / 25.4 * dpi));
    const BoardSighting seen = BoardDetector::create(board)->detect(board_picture(picture));
    ASSERT_EQ(seen.corners.size(), truth_m.size());
    const auto printed = [&](int index) {
        const Eigen::Vector3d& m = truth_m[static_cast<std::size_t>(index)];
        return Vector2d(origin + 1000 * Vector2d(m.x(), up * m.y()));
    };
    // A chessboard's corners may be counted from either end: OpenCV takes the colour of the squares there.
    const int last = static_cast<int>(truth_m.size()) - 1;
    const Vector2d first_mm = mm_from_px(seen.corners[0].px);
    const bool from_the_end =
        board.kind == BoardKind::chessboard && (first_mm - printed(last)).norm() < (first_mm - printed(0)).norm();
    for (const BoardCorner& corner : seen.corners) {
        const Vector2d mm = printed(from_the_end ? last - corner.index : corner.index);
        EXPECT_LT((mm_from_px(corner.px) - mm).norm(), 0.05) << corner.index;
    }
}

TEST_F(PrintedSheet, DetectorsFindEveryCornerWhereTheSpecHasIt) {
    expect_true_to_size("chessboard 9x6 0.025", "a4");
    expect_true_to_size("chessboard 8x5 0.021", "letter");
    expect_true_to_size("charuco 12x8 0.018 0.014 DICT_5X5_100", "a4");
    expect_true_to_size("charuco 5x7 0.03 0.0215 DICT_APRILTAG_36h11", "a4");
    expect_true_to_size("aprilgrid 5x6 0.0257 0.3", "a4");
}

TEST(BoardSheet, TurnsThePaperButNotOneOfGivenSides) {
    const BoardSheet sheet = board_sheet(read_board("chessboard 9x6 0.025"), read_paper("a4"));
    EXPECT_EQ(sheet.paper.width_mm, 297);
    EXPECT_EQ(sheet.paper.height_mm, 210);
    EXPECT_NO_THROW(board_sheet(read_board("chessboard 9x6 0.025"), read_paper("297x210mm")));
    EXPECT_THROW(board_sheet(read_board("chessboard 9x6 0.025"), read_paper("210x297")), InputError);
}

/// Each tag is read once, and its corners lie where size and place say.
void PrintedSheet::expect_tags_true_to_size(const std::string& spec_text, std::size_t pages, int per_page) const {
    SCOPED_TRACE(spec_text);
    const TagSheetSpec spec = read_tag_sheet(spec_text);
    const BoardSheet sheet = tag_sheet(spec, read_paper("a4"), per_page);
    ASSERT_EQ(sheet.pages.size(), pages);
    std::vector<int> ids;
    const std::vector<Image8> pictures = rendered(sheet);
    for (std::size_t p = 0; p < pages; ++p) {
        Image8 gray(pictures[p].width(), pictures[p].height(), 1);
        for (int y = 0; y < gray.height(); ++y) {
            for (int x = 0; x < gray.width(); ++x) gray.at(x, y) = pictures[p].at(x, y);
        }
        const std::vector<TagDetection> seen = TagDetector(spec.family, {}).detect(gray);
        const SheetPage& page = sheet.pages[p];
        ASSERT_EQ(seen.size(), page.tags.size());
        for (const TagDetection& tag : seen) {
            ids.push_back(tag.id);
            const auto printed = std::ranges::find(page.tags, tag.id, &PrintedTag::id);
            ASSERT_NE(printed, page.tags.end());
            for (std::size_t c = 0; c < 4; ++c) {
                // Counter-clockwise from the lower left; y is down on the page.
                const double x = c == 1 || c == 2 ? 500 : -500, y = c < 2 ? 500 : -500;
                const Vector2d mm = printed->middle_mm + spec.size_m * Vector2d(x, y);
                EXPECT_LT((mm_from_px(tag.corners_px[c]) - mm).norm(), 0.05) << tag.id << " corner " << c;
                const std::size_t index = 4 * static_cast<std::size_t>(printed - page.tags.begin()) + c;
                EXPECT_LT((page.corners_mm[index] - mm).norm(), 1e-9);
            }
        }
    }
    std::ranges::sort(ids);
    std::vector<int> wanted = spec.ids;
    std::ranges::sort(wanted);
    EXPECT_EQ(ids, wanted);
}

TEST_F(PrintedSheet, TheDetectorReadsEveryTagWhereItBelongs) {
    expect_tags_true_to_size("tags tag36h11 0-5 0.08", 2);
    expect_tags_true_to_size("tags tag36h11 586,7,3-4 0.05", 1);
    expect_tags_true_to_size("tags tag36h11 0-2 0.16", 3);
    expect_tags_true_to_size("tags tagStandard41h12 0-5 0.03", 1);
    expect_tags_true_to_size("tags tagCircle21h7 0-3 0.03", 1);
    expect_tags_true_to_size("tags tag16h5 0-3 0.04", 2, 2);
}

TEST(TagSheet, TheSceneGetsThePlacesOfTheFirstPage) {
    const TagSheetSpec spec = read_tag_sheet("tags tag36h11 4,2,9 0.06");
    const BoardSheet sheet = tag_sheet(spec, read_paper("a4"), 0);
    ASSERT_EQ(sheet.pages.size(), 1u);
    // Two a row: 60 mm of ink, a cell of 7.5 mm on either side, and 7 mm for small print between the rows.
    EXPECT_EQ(rig_text(spec, sheet),
              "[tags]\nfamily = \"tag36h11\"\nrig = [\n"
              "    {id = 4, size = 0.06, x = -0.075, y = 0},\n"
              "    {id = 2, size = 0.06, x = 0, y = 0},\n"
              "    {id = 9, size = 0.06, x = -0.075, y = -0.082},\n]\n");
    const std::string two_pages = rig_text(spec, tag_sheet(spec, read_paper("a4"), 2));
    EXPECT_NE(two_pages.find("{id = 9, size = 0.06},"), std::string::npos);
}

/// What the error says.
std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

TEST(TagSheet, RefusesWhatNoSheetIs) {
    const auto said = [](const std::string& text) { return refusal([&] { (void)read_tag_sheet(text); }); };
    EXPECT_NE(said("tags tag99h9 0 0.08").find("tag36h11"), std::string::npos);
    EXPECT_NE(said("tags tag36h11 580-587 0.08").find("ids 0 to 586, not 587"), std::string::npos);
    EXPECT_NE(said("tags tag36h11 0,3,0-2 0.08").find("the id 0 is named twice"), std::string::npos);
    EXPECT_NE(said("tags tag36h11 5-2 0.08").find("backwards"), std::string::npos);
    for (const char* ids : {"-1", "x", "1.5", "99999999999", "1-", ","}) {
        EXPECT_NE(said(std::string("tags tag36h11 ") + ids + " 0.08").find("id"), std::string::npos) << ids;
    }
    for (const char* size : {"0", "-0.1", "nan", "inf", "1e9", "0.08m"}) {
        EXPECT_NE(said(std::string("tags tag36h11 0 ") + size).find("no size of a tag"), std::string::npos) << size;
    }
    EXPECT_NE(said("tags tag36h11 0").find("3 words"), std::string::npos);
    const std::string as_board = refusal([] { (void)read_board("tags tag36h11 0-5 0.08"); });
    EXPECT_NE(as_board.find("calibrated with a board"), std::string::npos) << as_board;
}

TEST(Paper, NamesTheOneThatIsLargeEnough) {
    const auto said = [](const std::string& spec, const std::string& paper) {
        return refusal([&] { (void)board_sheet(read_board(spec), read_paper(paper)); });
    };
    EXPECT_NE(said("aprilgrid 6x6 0.088 0.3", "a4").find("fits on a0"), std::string::npos);
    EXPECT_NE(said("chessboard 9x6 0.035", "a4").find("fits on tabloid, a3, a2, a1, a0"), std::string::npos);
    EXPECT_NE(said("chessboard 9x6 0.5", "a4").find("plotter"), std::string::npos);
    const auto tags = refusal([] { (void)tag_sheet(read_tag_sheet("tags tag36h11 0 0.25"), read_paper("letter"), 0); });
    EXPECT_NE(tags.find("fits on a2, a1, a0"), std::string::npos) << tags;
    for (const char* paper : {"a9", "", "x", "200x", "nanxnan", "-200x300", "0x0", "200x300cm", "1e9x300mm"}) {
        EXPECT_NE(refusal([&] { (void)read_paper(paper); }), "no error") << paper;
    }
}

}  // namespace
}  // namespace matchlight
