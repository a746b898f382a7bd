// matchlight board: what is printed has its true size in every format, reads back, and calibrates.
#include <cstdlib>
#include <regex>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "../unit/calibration/synthetic_board.h"
#include "calibration/board_detector.h"
#include "calibration/camera.h"
#include "media/image_io.h"
#include "run_matchlight.h"
#include "scene/scene_file.h"
#include "tracking/tag_detector.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using nlohmann::json;

constexpr double dpi = 300, mm_per_px = 25.4 / dpi;

Image8 first_channel(const Image8& picture) {
    Image8 gray(picture.width(), picture.height(), 1);
    for (int y = 0; y < gray.height(); ++y) {
        for (int x = 0; x < gray.width(); ++x) gray.at(x, y) = picture.at(x, y);
    }
    return gray;
}

class BoardTest : public CommandTest {
protected:
    RunResult board(const std::string& spec, const std::string& output, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments = {"--json", "-q", "board", spec, "-o", (scratch_ / output).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_matchlight(arguments);
    }
    /// A page as another program draws it: poppler for PDF, librsvg for SVG.
    Image8 drawn(const std::string& file, int page = 1, int at_dpi = static_cast<int>(dpi)) {
        const std::string from = (scratch_ / file).string(), to = (scratch_ / "drawn").string();
        const std::string resolution = std::to_string(at_dpi);
        const std::string command = file.ends_with(".pdf")
                                        ? "pdftoppm -r " + resolution + " -gray -png -singlefile -f " +
                                              std::to_string(page) + " '" + from + "' '" + to + "'"
                                        : "rsvg-convert --dpi-x " + resolution + " --dpi-y " + resolution +
                                              " -b white -o '" + to + ".png' '" + from + "'";
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        return read_rgb8(to + ".png");
    }
};

/// The board's corners in a page drawn at `dpi` lie where the command's result says, to 0.05 mm.
void expect_board(const BoardSpec& board, const Image8& page, const json& result) {
    EXPECT_NEAR(page.width() * mm_per_px, result["width_mm"], 2 * mm_per_px);
    EXPECT_NEAR(page.height() * mm_per_px, result["height_mm"], 2 * mm_per_px);
    const BoardSighting seen = BoardDetector::create(board)->detect(board_picture(page));
    const json& corners = result["pages"][0]["corners_mm"];
    ASSERT_EQ(seen.corners.size(), corners.size());
    for (const BoardCorner& corner : seen.corners) {
        const json& at = corners[static_cast<std::size_t>(corner.index)];
        const Vector2d mm = (corner.px + Vector2d(0.5, 0.5)) * mm_per_px;
        EXPECT_LT((mm - Vector2d(at[0], at[1])).norm(), 0.05) << corner.index;
    }
}

TEST_F(BoardTest, IsTheSameBoardInEveryFormat) {
    const std::string spec = "charuco 8x6 0.02 0.015 DICT_4X4_50";
    const BoardSpec board_spec = read_board(spec);
    for (const char* file : {"board.pdf", "board.svg", "board.png"}) {
        SCOPED_TRACE(file);
        const RunResult made = board(spec, file, {"--dpi", "300"});
        ASSERT_TRUE(succeeded(made));
        const json result = json::parse(made.standard_output);
        EXPECT_EQ(result["width_mm"], 210);
        expect_board(board_spec, fs::path(file).extension() == ".png" ? read_rgb8(scratch_ / file) : drawn(file),
                     result);
    }
    // A4 in points, in millimetres, and in pixels an inch.
    std::smatch found;
    const std::string pdf = bytes_of(scratch_ / "board.pdf"), svg = bytes_of(scratch_ / "board.svg");
    ASSERT_TRUE(std::regex_search(pdf, found, std::regex(R"(/MediaBox \[ 0 0 ([0-9.]+) ([0-9.]+) \])")));
    EXPECT_NEAR(std::stod(found[1]), 210 / 25.4 * 72, 0.01);
    EXPECT_NEAR(std::stod(found[2]), 297 / 25.4 * 72, 0.01);
    ASSERT_TRUE(std::regex_search(svg, found, std::regex(R"re(width="([0-9.]+)mm" height="([0-9.]+)mm")re")));
    EXPECT_EQ(std::stod(found[1]), 210);
    EXPECT_EQ(std::stod(found[2]), 297);
    const std::string png = bytes_of(scratch_ / "board.png");
    const std::size_t resolution = png.find("pHYs");
    ASSERT_NE(resolution, std::string::npos);
    const int per_metre =
        static_cast<unsigned char>(png[resolution + 6]) << 8 | static_cast<unsigned char>(png[resolution + 7]);
    EXPECT_NEAR(per_metre, 1000 / mm_per_px, 1);
}

TEST_F(BoardTest, PrintsTagsOnPagesAndTheirPlacesForTheScene) {
    const RunResult made = board("tags tag36h11 0-5 0.08", "tags.pdf");
    ASSERT_TRUE(succeeded(made));
    const json result = json::parse(made.standard_output);
    ASSERT_EQ(result["pages"].size(), 2u);
    std::vector<int> ids;
    for (int page = 1; page <= 2; ++page) {
        for (const TagDetection& tag : TagDetector("tag36h11", {}).detect(first_channel(drawn("tags.pdf", page)))) {
            ids.push_back(tag.id);
            for (std::size_t c = 0; c < 4; ++c) {
                const json& at =
                    result["pages"][page - 1]["corners_mm"][4 * (static_cast<std::size_t>(tag.id) % 4) + c];
                const Vector2d mm = (tag.corners_px[c] + Vector2d(0.5, 0.5)) * mm_per_px;
                EXPECT_LT((mm - Vector2d(at[0], at[1])).norm(), 0.05) << tag.id;
            }
        }
    }
    EXPECT_EQ(ids, (std::vector<int>{0, 1, 2, 3, 4, 5}));

    // The lines are a scene's: the places are those between the tags on the sheet.
    scratch_.write("clip.mp4", "");
    const fs::path scene =
        scratch_.write("scene.toml", "[footage]\nvideo = \"clip.mp4\"\n" + std::string(result["rig"]));
    Warnings warnings;
    const Scene read = load_scene(scene, warnings);
    ASSERT_EQ(read.tags.rig.size(), 6u);
    EXPECT_EQ(read.tags.rig[3].size_m, 0.08);
    ASSERT_TRUE(read.tags.rig[3].world_from_tag.has_value());
    const json& tags = result["pages"][0]["tags"];
    EXPECT_NEAR(1000 * read.tags.rig[3].world_from_tag->translation().y(),
                double(tags[0]["middle_mm"][1]) - double(tags[3]["middle_mm"][1]), 1e-3);
    EXPECT_FALSE(read.tags.rig[4].world_from_tag.has_value());

    // One file a page, numbered from 1; nothing is replaced unasked.
    ASSERT_TRUE(succeeded(board("tags tag36h11 0-5 0.08", "tag_%02d.svg", {"--per-page", "1", "--paper", "a5"})));
    EXPECT_EQ(TagDetector("tag36h11", {}).detect(first_channel(drawn("tag_06.svg"))).at(0).id, 5);
    EXPECT_TRUE(failed_naming(board("tags tag36h11 0-5 0.08", "tag_%02d.svg"), {"tag_01.svg", "exists"}));
}

TEST_F(BoardTest, CalibratesFromWhatItPrints) {
    const std::string spec = "charuco 8x6 0.03 0.022 DICT_4X4_50";
    const RunResult made = board(spec, "board.png", {"--dpi", "100"});
    ASSERT_TRUE(succeeded(made));
    const json result = json::parse(made.standard_output);
    const cv::Mat print = cv::imread((scratch_ / "board.png").string(), cv::IMREAD_GRAYSCALE);
    Camera camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 600;
    camera.cx = 322;
    camera.cy = 236;
    camera.distortion = {0, 0, 0, 0};
    // The print as a pinhole camera sees it: the plane z = 0 by a homography.
    const json& corner = result["pages"][0]["corners_mm"][0];
    const double px_per_m = 100 / 0.0254;
    Eigen::Matrix3d board_from_print;  // pixel centres at whole numbers
    board_from_print << 1 / px_per_m, 0, 0.5 / px_per_m - double(corner[0]) / 1000, 0, 1 / px_per_m,
        0.5 / px_per_m - double(corner[1]) / 1000, 0, 0, 1;
    fs::create_directory(scratch_ / "photos");
    int taken = 0;
    for (const RigidTransform& pose : board_poses(read_board(spec), camera, 14, 40)) {
        Eigen::Matrix3d plane;
        plane << pose.linear().col(0), pose.linear().col(1), pose.translation();
        const Eigen::Matrix3d h = camera.matrix() * plane * board_from_print;
        cv::Mat homography(3, 3, CV_64F), photo;
        for (int i = 0; i < 9; ++i) homography.at<double>(i / 3, i % 3) = h(i / 3, i % 3);
        // Four times as fine, then averaged: a warp alone would alias.
        const cv::Mat finer = (cv::Mat_<double>(3, 3) << 4, 0, 1.5, 0, 4, 1.5, 0, 0, 1);
        cv::warpPerspective(print, photo, finer * homography, {4 * camera.width, 4 * camera.height}, cv::INTER_LINEAR,
                            cv::BORDER_CONSTANT, 150);
        cv::resize(photo, photo, {camera.width, camera.height}, 0, 0, cv::INTER_AREA);
        cv::imwrite(numbered(scratch_ / "photos/photo_%02d.png", taken++).string(), photo);
    }
    const fs::path output = scratch_ / "camera.yaml";
    ASSERT_TRUE(succeeded(run_matchlight(
        {"-q", "calibrate", (scratch_ / "photos").string(), "--board", spec, "-o", output.string(), "--no-report"})));
    const Camera found = load_camera(output);
    EXPECT_NEAR(found.fx, camera.fx, 0.003 * camera.fx);
    EXPECT_NEAR(found.fy, camera.fy, 0.003 * camera.fy);
    EXPECT_NEAR(found.cx, camera.cx, 2);
    EXPECT_NEAR(found.cy, camera.cy, 2);
}

TEST_F(BoardTest, TheShelfHoldsWhatTheCommandPrints) {
    const fs::path shelf = fs::path(MATCHLIGHT_SOURCE_DIR) / "calib/boards";
    const struct {
        std::string spec, pdf, paper;
        int pages;
    } shelved[] = {{(shelf / "opencv_chessboard_9x6.toml").string(), "opencv_chessboard_9x6.pdf", "a4", 1},
                   {(shelf / "charuco_12x8.toml").string(), "charuco_12x8.pdf", "a4", 1},
                   {(shelf / "aprilgrid_6x8_a4.toml").string(), "aprilgrid_6x8_a4.pdf", "a4", 1},
                   {(shelf / "kalibr_aprilgrid_6x6.yaml").string(), "kalibr_aprilgrid_6x6.pdf", "a0", 1},
                   {"tags tag36h11 0-7 0.08", "tags_80mm.pdf", "a4", 2}};
    constexpr int coarse_dpi = 60;  // a pixel is 0.4 mm: a cell that moved or turned shows
    for (const auto& each : shelved) {
        SCOPED_TRACE(each.pdf);
        ASSERT_TRUE(succeeded(board(each.spec, "made.pdf", {"--paper", each.paper, "--overwrite"})));
        fs::copy_file(shelf / each.pdf, scratch_ / "shelved.pdf", fs::copy_options::overwrite_existing);
        for (int page = 1; page <= each.pages; ++page) {
            const Image8 made = drawn("made.pdf", page, coarse_dpi), kept = drawn("shelved.pdf", page, coarse_dpi);
            ASSERT_EQ(made.width(), kept.width());
            ASSERT_EQ(made.height(), kept.height());
            // The small print may be set in another font where it was made.
            std::size_t differing = 0;
            for (std::size_t i = 0; i < made.samples().size(); ++i) {
                differing += std::abs(made.samples()[i] - kept.samples()[i]) > 8 ? 1 : 0;
            }
            EXPECT_LT(static_cast<double>(differing), 0.005 * static_cast<double>(made.samples().size()));
        }
    }
}

TEST_F(BoardTest, RefusesWhatCannotBePrinted) {
    const auto refused = [&](const std::string& spec, const std::vector<std::string>& words,
                             const std::string& output = "out.pdf", const std::vector<std::string>& more = {}) {
        EXPECT_TRUE(failed_naming(board(spec, output, more), words)) << spec;
        EXPECT_TRUE(nothing_left_of(scratch_ / output));
    };
    refused("tags tag12h3 0 0.05", {"tag12h3", "tag36h11"});
    refused("tags tag25h9 30-40 0.05", {"tag25h9", "ids 0 to 34"});
    refused("tags tag36h11 0 0", {"no size"});
    refused("tags tag36h11 0 nan", {"no size"});
    refused("tags tag36h11 0 0.4", {"does not fit on a4", "a1"});
    refused("chessboard 9x6 nan", {"length"});
    refused("chessboard 9x6 0", {"length"});
    refused("charuco 8x6 0.02 0.015 DICT_9X9", {"DICT_9X9"});
    refused("charuco 20x20 0.009 0.006 DICT_4X4_50", {"200 markers", "50"});
    refused("aprilgrid 6x6 0.088 0.3", {"does not fit on a4", "a0"});
    refused("tags tag36h11 0-5 0.08", {"2 pages", "%02d"}, "out.svg");
    refused("chessboard 9x6 0.02", {"out.tiff", ".pdf"}, "out.tiff");
    refused("chessboard 9x6 0.02", {"paper", "a11"}, "out.pdf", {"--paper", "a11"});
    refused("chessboard 9x6 0.02", {"pixels", "--dpi"}, "out.png", {"--dpi", "4000"});
    refused("chessboard 9x6 0.02", {"no_such_folder"}, "no_such_folder/out.png");
    EXPECT_TRUE(refused_call(board("chessboard 9x6 0.02", "out.png", {"--dpi", "nan"})));
    EXPECT_TRUE(refused_call(board("chessboard 9x6 0.02", "out.png", {"--per-page", "2"})));
    EXPECT_TRUE(refused_call(run_matchlight({"board", "chessboard", "9x6", "0.02"})));
}

}  // namespace
}  // namespace matchlight::test
