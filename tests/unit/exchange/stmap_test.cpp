// STMaps against each other and against the lens they hold.
#include "exchange/stmap.h"

#include <cmath>

#include <gtest/gtest.h>

#include "made_solve.h"

namespace matchlight::test {
namespace {

/// Where a map points, in pixels of its source, as a compositor interpolates it; nullopt beside marked pixels.
std::optional<Eigen::Vector2d> source_px(const Stmap& stmap, const Eigen::Vector2d& at, int width, int height) {
    const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
    const double right = at.x() - x, down = at.y() - y;
    Eigen::Vector2d uv(0, 0);
    for (const int dy : {0, 1}) {
        for (const int dx : {0, 1}) {
            if (!stmap.map.bounds().contains(x + dx, y + dy) || stmap.map.at(x + dx, y + dy, 2) != 1) return {};
            const double weight = (dx == 1 ? right : 1 - right) * (dy == 1 ? down : 1 - down);
            uv += weight * Eigen::Vector2d(stmap.map.at(x + dx, y + dy, 0), stmap.map.at(x + dx, y + dy, 1));
        }
    }
    return Eigen::Vector2d(uv.x() * width - 0.5, (1 - uv.y()) * height - 0.5);
}

/// Plate → straight picture → plate, at every pixel of a lattice; returns how many came back.
int expect_inverse(const Camera& camera, const UndistortedPicture& picture) {
    const Stmap undistort = undistort_map(camera, picture);
    const Stmap redistort = redistort_map(camera, picture);
    int back = 0;
    for (int y = 0; y < camera.height; y += 7) {
        for (int x = 0; x < camera.width; x += 7) {
            const auto straight =
                source_px(redistort, Eigen::Vector2d(x, y), picture.pinhole.width, picture.pinhole.height);
            if (!straight) continue;
            const auto plate = source_px(undistort, *straight, camera.width, camera.height);
            if (!plate) continue;
            EXPECT_LT((*plate - Eigen::Vector2d(x, y)).norm(), 0.01) << x << " " << y;
            ++back;
        }
    }
    return back;
}

int lattice(const Camera& camera) {
    return ((camera.width + 6) / 7 - 1) *
           ((camera.height + 6) / 7 - 1);  // less the edge, which has no neighbour beyond
}

TEST(Stmap, RedistortUndoesUndistort) {
    Camera barrel = wide_camera();
    barrel.width = 640;
    barrel.height = 360;
    barrel.fx = barrel.fy = 430;
    barrel.cx = 323;
    barrel.cy = 176;
    const UndistortedPicture of_barrel = undistorted_picture(barrel, std::nullopt, false);
    EXPECT_GT(of_barrel.margin_x, 0);
    EXPECT_EQ(of_barrel.uncovered, 0);
    EXPECT_GE(expect_inverse(barrel, of_barrel), lattice(barrel));
    EXPECT_GE(expect_inverse(barrel, undistorted_picture(barrel, std::nullopt, true)), lattice(barrel));

    Camera cushion = barrel;
    cushion.distortion = {0.08, -0.01, 0, 0};
    cushion.cx = 319.5;
    cushion.cy = 179.5;
    const UndistortedPicture of_cushion = undistorted_picture(cushion, std::nullopt, false);
    EXPECT_EQ(of_cushion.margin_x, 0);                        // the straight picture is smaller than the plate
    EXPECT_EQ(expect_inverse(cushion, of_cushion), 52 * 92);  // all of the lattice

    Camera fisheye = barrel;
    fisheye.lens = LensModel::fisheye;
    fisheye.fx = fisheye.fy = 300;  // 61° to the corners
    fisheye.distortion = {0.02, -0.005, 0.001, 0};
    const UndistortedPicture of_fisheye = undistorted_picture(fisheye, std::nullopt, false);
    EXPECT_EQ(of_fisheye.uncovered, 0);
    EXPECT_GE(expect_inverse(fisheye, of_fisheye), lattice(fisheye));
}

TEST(Stmap, FollowsNukesConvention) {
    Camera camera = wide_camera();
    camera.distortion.clear();
    const UndistortedPicture picture = undistorted_picture(camera, std::nullopt, false);
    EXPECT_EQ(picture.margin_x, 0);
    const Stmap identity = undistort_map(camera, picture);
    EXPECT_FLOAT_EQ(identity.map.at(0, 719, 0), 0.5f / 1280);  // the lower left pixel
    EXPECT_FLOAT_EQ(identity.map.at(0, 719, 1), 0.5f / 720);
    EXPECT_FLOAT_EQ(identity.map.at(1279, 0, 0), 1279.5f / 1280);
    EXPECT_FLOAT_EQ(identity.map.at(1279, 0, 1), 719.5f / 720);

    const UndistortedPicture wider = undistorted_picture(camera, 1.5, false);
    EXPECT_EQ(wider.margin_x, 320);
    EXPECT_EQ(wider.margin_y, 180);
    EXPECT_EQ(wider.pinhole.width, 1920);
    const Stmap undistort = undistort_map(camera, wider);
    EXPECT_FLOAT_EQ(undistort.map.at(320, 180, 0), 0.5f / 1280);
    EXPECT_FLOAT_EQ(undistort.map.at(0, 180, 0), -319.5f / 1280);  // outside the plate the map goes on
    const Stmap redistort = redistort_map(camera, wider);
    EXPECT_FLOAT_EQ(redistort.map.at(0, 0, 0), 320.5f / 1920);
    EXPECT_FLOAT_EQ(redistort.map.at(0, 0, 1), 1 - 180.5f / 1080);
}

TEST(Stmap, HoldsTheLens) {
    Camera camera = wide_camera();
    camera.width = 300;  // the upper left part of the picture: off the middle, with all its distortion
    camera.height = 200;
    const UndistortedPicture picture = undistorted_picture(camera, std::nullopt, true);
    const Stmap stmap = undistort_map(camera, picture);
    const PinholePicture& p = picture.pinhole;
    EXPECT_DOUBLE_EQ(p.cx, (p.width - 1) / 2.0);
    EXPECT_DOUBLE_EQ(p.cy, (p.height - 1) / 2.0);
    const Eigen::Vector2d normalized((100 - p.cx) / p.fx, (50 - p.cy) / p.fy);
    const Eigen::Vector2d plate = camera.pixel_from_normalized(normalized);
    EXPECT_NEAR(stmap.map.at(100, 50, 0), (plate.x() + 0.5) / 300, 1e-6);
    EXPECT_NEAR(stmap.map.at(100, 50, 1), 1 - (plate.y() + 0.5) / 200, 1e-6);
}

TEST(Stmap, MarksWhereTheLensFoldsBack) {
    Camera camera = wide_camera();
    camera.width = 320;
    camera.height = 180;
    camera.fx = camera.fy = 150;
    camera.cx = 159.5;
    camera.cy = 89.5;
    camera.distortion = {-0.25, 0, 0, 0};  // r (1 − r²/4) turns back at r = 1.15: 115 px from the axis
    const UndistortedPicture picture = undistorted_picture(camera, std::nullopt, false);
    EXPECT_GT(picture.uncovered, 0);
    const Stmap undistort = undistort_map(camera, picture);
    const Stmap redistort = redistort_map(camera, picture);
    for (const Stmap* stmap : {&undistort, &redistort}) {
        EXPECT_GT(stmap->unreachable, 0);
        std::int64_t marked = 0;
        for (int y = 0; y < stmap->map.height(); ++y) {
            for (int x = 0; x < stmap->map.width(); ++x) {
                const float* texel = stmap->map.pixel(x, y);
                ASSERT_TRUE(texel[2] == 0 || texel[2] == 1);
                if (texel[2] == 1) continue;
                ++marked;
                ASSERT_EQ(texel[0], -1);
                ASSERT_EQ(texel[1], -1);
            }
        }
        EXPECT_EQ(marked, stmap->unreachable);
    }
    // The fold lies where the polynomial's slope is 0; what is inside it comes back.
    const double fold_px = 150 * std::sqrt(4.0 / 3) * (1 - 1.0 / 3);
    EXPECT_EQ(redistort.map.at(static_cast<int>(159.5 + fold_px - 3), 89, 2), 1);
    EXPECT_EQ(redistort.map.at(static_cast<int>(159.5 + fold_px + 3), 89, 2), 0);
    EXPECT_GT(expect_inverse(camera, picture), 500);
}

TEST(Stmap, LensesTooWideForAPlaneAreCutOffAndCounted) {
    Camera camera = wide_camera();
    camera.width = 640;
    camera.height = 480;
    camera.lens = LensModel::fisheye;
    camera.fx = camera.fy = 200;  // 1.57 rad at 314 px: the sides reach 90° and the corners lie beyond
    camera.cx = 319.5;
    camera.cy = 239.5;
    camera.distortion = {0, 0, 0, 0};
    const UndistortedPicture picture = undistorted_picture(camera, std::nullopt, false);
    EXPECT_EQ(picture.pinhole.width, static_cast<int>(640 * largest_overscan));
    EXPECT_GT(picture.uncovered, 0);
    const Stmap redistort = redistort_map(camera, picture);
    EXPECT_GT(redistort.unreachable, 0);
    EXPECT_LT(redistort.unreachable, picture.uncovered);
}

}  // namespace
}  // namespace matchlight::test
