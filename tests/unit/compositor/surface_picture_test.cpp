// The picture of the real surface, from a clip drawn of a plane with a known pattern.
#include "compositor/surface_picture.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "compositor/plane_grid.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

/// Probe-unit light of the plane: waves 0.2 m long about 0.4, and a bright patch.
Eigen::Vector3d pattern(const Eigen::Vector2d& place_m) {
    if ((place_m - Eigen::Vector2d(0.2, 0.1)).norm() < 0.06) return {2, 1.6, 1.2};
    const double wave = 0.15 * std::sin(10 * M_PI * place_m.x()) * std::cos(10 * M_PI * place_m.y());
    return {0.4 + wave, 0.4 - wave, 0.3 + 0.5 * wave};
}

class SurfacePictureOfClip : public testing::Test {
protected:
    static constexpr int frame_count = 5;

    void SetUp() override {
        folder_ = fs::temp_directory_path() / fmt::format("matchlight-surface-{}", getpid());
        fs::create_directories(folder_);
        solve_.footage_file = "plate_%d.png";
        solve_.camera = {.width = 240, .height = 160, .fx = 220, .fy = 220, .cx = 119.5, .cy = 79.5, .distortion = {}};
        solve_.rig.push_back({.id = 0, .size_m = 0.08});
        solve_.vignette = {-0.2, 0.05};
        solve_.frame_count = frame_count;
        for (int i = 0; i < frame_count; ++i) {
            const Eigen::Vector3d eye_m(0.1 * i - 0.2, -0.5, 0.55);
            SolvedFrame frame;
            frame.frame = i;
            frame.camera_from_world = camera_looking_along(eye_m, (Eigen::Vector3d(0.05, 0, 0) - eye_m).normalized());
            // Only the two darkest do not clip the patch.
            frame.exposure_ev = i < 3 ? 0.4 : -1.5;
            frame.white_balance = std::array<double, 3>{1.05, 1, 0.95};
            solve_.frames.push_back(frame);
        }
        scene_.path = folder_ / "scene.toml";
        scene_.footage.video = folder_ / "plate_%d.png";
        scene_.footage.solve = folder_ / "scene.solve.json";
        scene_.objects.emplace_back();
        scene_.effects.vignette = VignetteSettings{};
        save_solve(scene_.footage.solve, solve_);
        for (int i = 0; i < frame_count; ++i) draw_frame(i);
        warnings_.set_quiet(true);
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// A hand, black, lies over the frame's middle in frame 2.
    void draw_frame(int index) {
        const SolvedFrame& frame = solve_.frames[static_cast<std::size_t>(index)];
        const RigidTransform world_from_camera = frame.camera_from_world->inverse();
        const Eigen::Vector3d eye_m = world_from_camera.translation();
        const Camera& camera = solve_.camera;
        Image8 picture(camera.width, camera.height, 3);
        for (int y = 0; y < camera.height; ++y) {
            for (int x = 0; x < camera.width; ++x) {
                const bool hand = index == 2 && std::abs(x - 120) < 30 && std::abs(y - 80) < 20;
                const Eigen::Vector3d direction =
                    world_from_camera.linear() * camera.normalized_from_pixel({x, y}).homogeneous();
                const Eigen::Vector3d point_m = eye_m - eye_m.z() / direction.z() * direction;
                const Eigen::Vector3d light =
                    direction.z() < 0 && !hand ? pattern(point_m.head<2>()) : Eigen::Vector3d::Zero();
                const double r2 = (Eigen::Vector2d(x, y) - Eigen::Vector2d(119.5, 79.5)).squaredNorm() /
                                  Eigen::Vector2d(120, 80).squaredNorm();
                const double falloff = 1 - 0.2 * r2 + 0.05 * r2 * r2;
                for (int c = 0; c < 3; ++c) {
                    const double seen = light[c] * std::exp2(*frame.exposure_ev) *
                                        (*frame.white_balance)[static_cast<std::size_t>(c)] * falloff;
                    const double code = std::clamp(solve_.response.code_from_linear(seen, c), 0.0, 1.0);
                    picture.at(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * code));
                }
            }
        }
        write_png8(folder_ / fmt::format("plate_{}.png", index), picture);
    }

    static Eigen::Vector2i texel_of(const GatheredSurface& gathered, const Eigen::Vector2d& place_m) {
        return ((place_m - gathered.rectangle_m.min()) / gathered.texel_m()).cast<int>();
    }
    static Eigen::Vector3d light_at(const GatheredSurface& gathered, const Eigen::Vector2d& place_m) {
        const Eigen::Vector2i at = texel_of(gathered, place_m);
        const float* texel = gathered.radiance.pixel(at.x(), at.y());
        EXPECT_EQ(texel[3], 1) << place_m.transpose();
        return Eigen::Vector3f(texel[0], texel[1], texel[2]).cast<double>();
    }

    fs::path folder_;
    Scene scene_;
    Solve solve_;
    Warnings warnings_;
};

TEST_F(SurfacePictureOfClip, shows_the_pattern_unexposed_without_the_hand) {
    const auto gathered = gather_surface(scene_, solve_, {.quiet = true}, warnings_);
    ASSERT_TRUE(gathered);
    for (double y = -0.15; y < 0.2; y += 0.035) {
        for (double x = -0.2; x < 0.3; x += 0.03) {
            const Eigen::Vector2d place_m(x, y);
            if (std::abs((place_m - Eigen::Vector2d(0.2, 0.1)).norm() - 0.06) < 0.012) continue;  // the patch's edge
            // 8 bits, bilinear lookups of waves 60 pixels long and half a texel beside: 4 %.
            const Eigen::Vector3d truth = pattern(place_m), light = light_at(*gathered, place_m);
            EXPECT_LT((light - truth).cwiseAbs().maxCoeff(), 0.04 * truth.maxCoeff()) << place_m.transpose();
        }
    }
    const Eigen::Vector2i patch = texel_of(*gathered, {0.2, 0.1});
    EXPECT_EQ(gathered->clipped.at(patch.x(), patch.y()), 0.0f) << "dark frames know it";
}

TEST_F(SurfacePictureOfClip, flags_what_every_frame_clips) {
    solve_.frames.resize(3);
    solve_.frame_count = 3;
    const auto gathered = gather_surface(scene_, solve_, {.quiet = true}, warnings_);
    ASSERT_TRUE(gathered);
    const Eigen::Vector2i patch = texel_of(*gathered, {0.2, 0.1});
    EXPECT_EQ(gathered->clipped.at(patch.x(), patch.y()), 1.0f);
    EXPECT_GT(gathered->radiance.at(patch.x(), patch.y(), 0), 0.6f);  // code 1 at +0.4 EV, less white balance
    EXPECT_LT(gathered->radiance.at(patch.x(), patch.y(), 0), 1.0f);
}

TEST_F(SurfacePictureOfClip, leaves_out_what_a_holdout_hides) {
    const auto without = gather_surface(scene_, solve_, {.quiet = true}, warnings_);
    ObjectSettings box;
    box.shape = "box";
    box.name = "box";
    box.scale = {0.06, 0.06, 0.12};
    box.translate_m = {-0.1, 0.05, 0.06};
    box.holdout = true;
    scene_.objects.push_back(box);
    const auto with = gather_surface(scene_, solve_, {.quiet = true}, warnings_);
    ASSERT_TRUE(without && with);
    ASSERT_EQ(with->rectangle_m.min(), without->rectangle_m.min());
    int hidden = 0, changed_beside = 0;
    for (int row = 0; row < with->radiance.height(); ++row) {
        for (int column = 0; column < with->radiance.width(); ++column) {
            const bool was_known = without->radiance.at(column, row, 3) == 1;
            if (was_known && with->radiance.at(column, row, 3) == 0) ++hidden;
            const Eigen::Vector2d place_m =
                with->rectangle_m.min() + with->texel_m() * Eigen::Vector2d(column + 0.5, row + 0.5);
            // Cameras half a metre before and above it see it lie over what is behind and beside, and edges are
            // softened over 16 texels.
            const bool is_far = place_m.x() > 0.15 || place_m.x() < -0.3 || place_m.y() < -0.12;
            if (is_far && !std::equal(with->radiance.pixel(column, row), with->radiance.pixel(column, row) + 4,
                                      without->radiance.pixel(column, row)))
                ++changed_beside;
        }
    }
    EXPECT_GT(hidden, 100) << "its foot is never seen";
    EXPECT_EQ(with->radiance.pixel(texel_of(*with, {-0.1, 0.05}).x(), texel_of(*with, {-0.1, 0.05}).y())[3], 0);
    EXPECT_EQ(changed_beside, 0);
}

TEST_F(SurfacePictureOfClip, is_made_again_when_a_holdout_stands_elsewhere) {
    const auto first = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    ObjectSettings box;
    box.shape = "box";
    box.scale.setConstant(0.1);
    box.holdout = true;
    scene_.objects.push_back(box);
    const auto there = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_FALSE(std::ranges::equal(first->radiance.samples(), there->radiance.samples()));
    scene_.objects.back().translate_m.x() = 0.2;
    const auto elsewhere = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_FALSE(std::ranges::equal(there->radiance.samples(), elsewhere->radiance.samples()));
    // Virtual objects are not in the footage.
    scene_.objects.front().translate_m.x() = 0.3;
    const auto written = fs::last_write_time(surface_picture_file_of(scene_));
    surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_EQ(fs::last_write_time(surface_picture_file_of(scene_)), written);
}

TEST_F(SurfacePictureOfClip, its_file_gives_the_same_bits_and_is_made_again_when_something_changes) {
    const auto first = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    ASSERT_TRUE(first);
    const fs::path file = surface_picture_file_of(scene_);
    ASSERT_TRUE(fs::exists(file));
    const auto written = fs::last_write_time(file);
    const auto again = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_EQ(fs::last_write_time(file), written);
    EXPECT_TRUE(std::ranges::equal(first->radiance.samples(), again->radiance.samples()));
    EXPECT_TRUE(std::ranges::equal(first->clipped.samples(), again->clipped.samples()));
    EXPECT_EQ(first->rectangle_m.min(), again->rectangle_m.min());
    EXPECT_EQ(first->rectangle_m.max(), again->rectangle_m.max());

    // Another frame is now black: what it was made from changed, under the same names.
    write_png8(folder_ / "plate_4.png", Image8(240, 160, 3));
    const auto changed = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_FALSE(std::ranges::equal(first->radiance.samples(), changed->radiance.samples()));
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(SurfacePictureOfClip, a_damaged_file_is_made_again_and_a_closed_folder_is_a_warning) {
    const auto first = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    fs::resize_file(surface_picture_file_of(scene_), 1000);
    const auto again = surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_);
    EXPECT_TRUE(std::ranges::equal(first->radiance.samples(), again->radiance.samples()));
    EXPECT_TRUE(warnings_.empty());

    scene_.path = folder_ / "no such folder" / "scene.toml";
    EXPECT_TRUE(surface_picture_of_clip(scene_, solve_, {.quiet = true}, warnings_));
    EXPECT_FALSE(warnings_.empty());
}

TEST_F(SurfacePictureOfClip, is_none_where_nothing_needs_it) {
    Scene draft = scene_;
    draft.quality = QualityLevel::draft;
    EXPECT_FALSE(surface_picture_of_clip(draft, solve_, {.quiet = true}, warnings_));
    Scene empty = scene_;
    empty.objects.clear();
    EXPECT_FALSE(surface_picture_of_clip(empty, solve_, {.quiet = true}, warnings_));
    Scene without = scene_;
    without.surface.present = false;
    EXPECT_FALSE(surface_picture_of_clip(without, solve_, {.quiet = true}, warnings_));
    Solve poseless = solve_;
    for (SolvedFrame& frame : poseless.frames) frame.camera_from_world.reset();
    EXPECT_FALSE(surface_picture_of_clip(scene_, poseless, {.quiet = true}, warnings_));
    EXPECT_FALSE(fs::exists(surface_picture_file_of(scene_)));
}

}  // namespace
}  // namespace matchlight
