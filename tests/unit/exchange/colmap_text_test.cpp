// COLMAP's files read back, and projected by OpenCV, whose lens models COLMAP shares.
#include "exchange/colmap_text.h"

#include <map>
#include <sstream>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "core/error.h"
#include "made_solve.h"

namespace matchlight::test {
namespace {

std::vector<std::string> data_lines(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with("#")) lines.push_back(line);
    }
    return lines;
}

struct ColmapImage {
    int id = 0;
    cv::Vec3d turn, place;
    std::string name;
    std::vector<cv::Vec3d> points;  // x, y, point id
};

struct ColmapModel {
    std::string lens;
    int width = 0, height = 0;
    std::vector<double> parameters;
    std::vector<ColmapImage> images;
    std::map<int, cv::Vec3d> points;
    std::map<int, std::vector<int>> tracks;

    explicit ColmapModel(const std::vector<std::string>& texts) {
        std::istringstream camera(data_lines(texts[0]).at(0));
        int id = 0;
        camera >> id >> lens >> width >> height;
        for (double value = 0; camera >> value;) parameters.push_back(value);
        const std::vector<std::string> lines = data_lines(texts[1]);
        for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
            ColmapImage& image = images.emplace_back();
            Eigen::Quaterniond q;
            int camera_id = 0;
            std::istringstream head(lines[i]), points2d(lines[i + 1]);
            head >> image.id >> q.w() >> q.x() >> q.y() >> q.z() >> image.place[0] >> image.place[1] >>
                image.place[2] >> camera_id >> image.name;
            cv::Mat rotation;
            const Eigen::Matrix3d matrix = q.toRotationMatrix();
            cv::eigen2cv(matrix, rotation);
            cv::Rodrigues(rotation, image.turn);
            for (cv::Vec3d p; points2d >> p[0] >> p[1] >> p[2];) image.points.push_back(p);
        }
        for (const std::string& line : data_lines(texts[2])) {
            std::istringstream numbers(line);
            int point_id = 0, r = 0, g = 0, b = 0;
            double error = 0;
            cv::Vec3d p;
            numbers >> point_id >> p[0] >> p[1] >> p[2] >> r >> g >> b >> error;
            points[point_id] = p;
            for (int value = 0; numbers >> value;) tracks[point_id].push_back(value);
        }
    }

    /// COLMAP's pixels, by OpenCV: its centre of the first pixel is (½, ½).
    cv::Vec2d project(const ColmapImage& image, const cv::Vec3d& point) const {
        const cv::Matx33d k(parameters[0], 0, parameters[2], 0, parameters[1], parameters[3], 0, 0, 1);
        const std::vector<cv::Vec3d> in{point};
        std::vector<cv::Vec2d> out;
        std::vector<double> distortion(parameters.begin() + 4, parameters.end());
        if (lens == "OPENCV_FISHEYE") {
            cv::fisheye::projectPoints(in, out, image.turn, image.place, k, distortion);
        } else {
            cv::projectPoints(in, image.turn, image.place, k, distortion, out);
        }
        return out[0];
    }
};

void expect_the_solves_projections(const Solve& solve, const std::string& lens) {
    const CameraTrack track = track_of(solve);
    const ColmapModel model(colmap_texts(track, "clip_%04d.png", "clip.solve.json"));
    EXPECT_EQ(model.lens, lens);
    ASSERT_EQ(model.images.size(), 8u);
    ASSERT_EQ(model.points.size(), 8u);
    const std::vector<Eigen::Vector3d> corners = corners_of(solve.rig);
    std::size_t at = 0;
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        const ColmapImage& image = model.images[at++];
        ASSERT_EQ(image.points.size(), 8u);
        for (std::size_t i = 0; i < 8; ++i) {
            const Eigen::Vector2d expected = solve.camera.pixel_from_camera(*frame.camera_from_world * corners[i]);
            const cv::Vec2d px = model.project(image, model.points.at(static_cast<int>(i) + 1));
            EXPECT_LT((Eigen::Vector2d(px[0] - 0.5, px[1] - 0.5) - expected).norm(), agreement_px);
            EXPECT_LT((Eigen::Vector2d(image.points[i][0] - 0.5, image.points[i][1] - 0.5) - expected).norm(),
                      agreement_px);
            EXPECT_EQ(image.points[i][2], static_cast<double>(i + 1));
        }
    }
}

TEST(ColmapText, ProjectsTheRigAsTheSolveDoes) {
    Solve solve = made_solve();
    expect_the_solves_projections(solve, "FULL_OPENCV");
    solve.camera.distortion.resize(4);
    expect_the_solves_projections(solve, "OPENCV");
    solve.camera.distortion = {-0.1, 0.02, 0, 0, 0.001, 0.05, 0.01, 0.002};
    expect_the_solves_projections(solve, "FULL_OPENCV");
    solve.camera.distortion.clear();
    expect_the_solves_projections(solve, "PINHOLE");
    solve.camera.lens = LensModel::fisheye;
    solve.camera.distortion = {0.01, -0.003, 0.0004, 0};
    expect_the_solves_projections(solve, "OPENCV_FISHEYE");
}

TEST(ColmapText, ImagesAreNamedByNumberAndTracksPointBack) {
    CameraTrackOptions options;
    options.first_number = 101;
    const ColmapModel model(colmap_texts(track_of(made_solve(), options), "clip_%04d.png", "clip.solve.json"));
    EXPECT_EQ(model.images[0].name, "clip_0101.png");
    EXPECT_EQ(model.images[4].name, "clip_0107.png");  // after the two without a pose
    const std::vector<int>& track = model.tracks.at(3);
    ASSERT_EQ(track.size(), 16u);
    for (std::size_t i = 0; i < track.size(); i += 2) {
        const ColmapImage& image = model.images.at(static_cast<std::size_t>(track[i] - 1));
        EXPECT_EQ(image.points.at(static_cast<std::size_t>(track[i + 1]))[2], 3);
    }
}

TEST(ColmapText, ACentredCameraIsAPinhole) {
    CameraTrackOptions options;
    options.centred = true;
    const ColmapModel model(colmap_texts(track_of(made_solve(), options), "%d.png", "clip.solve.json"));
    EXPECT_EQ(model.lens, "PINHOLE");
    EXPECT_EQ(model.parameters, (std::vector<double>{905, 905, 640, 360}));
}

TEST(ColmapText, RefusesWhatNoModelHolds) {
    Solve solve = made_solve();
    solve.camera.distortion = {0, 0, 0, 0, 0, 0, 0, 0, 1e-3, 0, 0, 0};
    EXPECT_THROW(colmap_texts(track_of(solve), "%d.png", "clip.solve.json"), InputError);
    solve.camera.distortion[8] = 0;
    EXPECT_NO_THROW(colmap_texts(track_of(solve), "%d.png", "clip.solve.json"));
}

}  // namespace
}  // namespace matchlight::test
