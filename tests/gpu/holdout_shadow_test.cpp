// The shadow of virtual objects on holdouts, against known answers.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>

#include <fmt/format.h>
#include <unistd.h>

#include "compositor_shot.h"
#include "media/image_io.h"

namespace matchlight::test {
namespace {

constexpr double ball_radius_m = 0.02;

ObjectSettings shape(const std::string& kind, const Eigen::Vector3d& place_m, const Eigen::Vector3d& size) {
    ObjectSettings object;
    object.shape = object.name = kind;
    object.translate_m = place_m;
    object.scale = size;
    return object;
}

/// A real wall that faces the camera, y = 0, and a ball before it; no table.
class HoldoutShadow : public CompositorTest {
protected:
    HoldoutShadow() {
        shot_.scene.surface.present = false;
        shot_.scene.objects = {wall(0), shape("sphere", ball_m_, Eigen::Vector3d::Constant(2 * ball_radius_m))};
    }

    static ObjectSettings wall(double y_m) {
        ObjectSettings wall = shape("plane", {0, y_m, 0.06}, {0.2, 0.16, 1});
        wall.holdout = true;
        wall.rotate_deg = {90, 0, 0};  // its front towards the camera
        return wall;
    }

    /// Grey light, as the scene's probe.
    std::filesystem::path save_probe(const std::function<float(const Eigen::Vector3d&)>& radiance) {
        const std::filesystem::path probe =
            std::filesystem::temp_directory_path() / fmt::format("matchlight_probe_{}.exr", getpid());
        ImageF light(64, 32, 3);
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 64; ++x) {
                for (int c = 0; c < 3; ++c) light.at(x, y, c) = radiance(latlong_direction(x, y, 64, 32));
            }
        }
        write_exr(probe, 64, 32, {{"", {"R", "G", "B"}, &light, false, {}}}, {});
        shot_.scene.probe.emplace().path = probe;
        return probe;
    }

    FrameLayers layers(int directions = 256) {
        Warnings warnings;
        warnings.set_quiet(true);
        Quality quality = without_rays(quality_of(QualityLevel::final_));
        quality.object_shadow = {.directions = directions, .resolution = 512};
        Compositor compositor(context(), shot_.scene, shot_.solve, {.settings = quality, .layers = true}, warnings);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        EXPECT_TRUE(frame.layers);
        return std::move(*frame.layers);
    }

    /// Where a pixel's ray meets the plane y = 0.
    Eigen::Vector3d on_wall(double x, double y) const {
        const RigidTransform world_from_camera = shot_.solve.frames[0].camera_from_world->inverse();
        const Eigen::Vector3d ray =
            world_from_camera.linear() * shot_.solve.camera.normalized_from_pixel({x, y}).homogeneous();
        return world_from_camera.translation() - ray * (world_from_camera.translation().y() / ray.y());
    }

    Eigen::Vector3d ball_m_{0, -0.05, 0.06};
    Shot shot_ = make_shot();
};

TEST_F(HoldoutShadow, AWallLosesTheFormFactorOfABallInEvenLight) {
    const std::filesystem::path probe = save_probe([](const Eigen::Vector3d&) { return 0.5F; });
    const FrameLayers seen = layers();
    int compared = 0;
    double sum = 0, worst = 0;
    for (int y = 0; y < seen.region.height; ++y) {
        for (int x = 0; x < seen.region.width; ++x) {
            const Eigen::Vector3d point = on_wall(seen.region.x + x, seen.region.y + y);
            if (std::abs(point.x()) > 0.09 || std::abs(point.z() - 0.06) > 0.07 || seen.alpha.at(x, y) > 0) continue;
            // A sphere above the horizon takes (r/d)² cos θ of the light (Howell, configuration factor B-37).
            const Eigen::Vector3d way = ball_m_ - point;
            const double cosine = -way.y() / way.norm();
            const double left = 1 - std::pow(ball_radius_m / way.norm(), 2) * cosine;
            const double error = seen.shadow.at(x, y, 0) - left;
            ++compared;
            sum += error;
            worst = std::max(worst, std::abs(error));
        }
    }
    ASSERT_GT(compared, 2000);
    // 256 directions over the sphere stand for 4π/256 sr each, of which at the rim of the ball one is in or out: its
    // cosine-weighted share of the hemisphere is at most 2/128. Three of them may be so at once.
    EXPECT_LT(worst, 3 * 2.0 / 128);
    EXPECT_NEAR(sum / compared, 0, 0.004);
    std::filesystem::remove(probe);
}

TEST_F(HoldoutShadow, SpheresCatchItAsAShapeOfThemDoes) {
    const std::filesystem::path probe = save_probe([](const Eigen::Vector3d& to) { return to.z() > 0.7 ? 1.0F : 0; });
    // A real ball below the virtual one.
    ObjectSettings real = shape("sphere", {0, 0, 0.03}, Eigen::Vector3d::Constant(0.06));
    real.holdout = true;
    shot_.scene.objects = {real, shape("sphere", {0, 0, 0.09}, Eigen::Vector3d::Constant(0.04))};
    constexpr int directions = 64;
    const FrameLayers of_shape = layers(directions);
    real.shape.clear();
    real.scale /= 2;  // the shape's radius is ½
    real.spheres = std::filesystem::temp_directory_path() / fmt::format("matchlight_real_ball_{}.xyz", getpid());
    std::ofstream(real.spheres) << "1\n\nO 0 0 0\n";
    real.sphere.radius = 1;
    shot_.scene.objects.front() = real;
    const FrameLayers of_set = layers(directions);
    std::filesystem::remove(real.spheres);
    std::filesystem::remove(probe);
    ASSERT_EQ(of_set.region.width, of_shape.region.width);
    ASSERT_EQ(of_set.region.height, of_shape.region.height);
    double difference = 0, taken = 0;
    for (std::size_t i = 0; i < of_set.shadow.samples().size(); ++i) {
        difference += std::abs(of_set.shadow.samples()[i] - of_shape.shadow.samples()[i]);
        taken += std::abs(1 - of_shape.shadow.samples()[i]);
    }
    ASSERT_GT(taken, 100) << "a shadow lies on the real ball";
    EXPECT_LT(difference, 0.03 * taken);
}

TEST_F(HoldoutShadow, TheTableHiddenBehindARealBoxKeepsItsShadowToItself) {
    // Seen from the camera the box stands before the ball's shadow on the table.
    shot_.scene.surface.present = true;
    ObjectSettings ball = shape("sphere", {0, 0.1, 0.02}, Eigen::Vector3d::Constant(0.04));
    ObjectSettings box = shape("box", {0, 0, 0.1}, {0.3, 0.02, 0.2});
    box.holdout = true;
    shot_.scene.objects = {ball};
    const CompositedFrame without = composite(shot_, true);
    shot_.scene.objects = {ball, box};
    const CompositedFrame with = composite(shot_, true);
    const auto touched = [](const CompositedFrame& frame) {
        return std::ranges::count_if(frame.touched.samples(), [](std::uint8_t one) { return one != 0; });
    };
    ASSERT_GT(touched(without), 500);
    // On the box's front the ball behind it casts nothing.
    EXPECT_LT(touched(with), touched(without) / 20);
}

TEST_F(HoldoutShadow, LightThatARealThingShadesIsNotTakenAway) {
    // All light comes from one lamp, before the wall and above.
    const Eigen::Vector3d to_lamp = Eigen::Vector3d(0, -1, 1).normalized();
    const std::filesystem::path probe =
        save_probe([&](const Eigen::Vector3d& direction) { return direction.dot(to_lamp) > 0.995 ? 100.0F : 0.0F; });
    shot_.scene.objects[1].translate_m = ball_m_ = {0, -0.05, 0.1};
    const auto least = [&] {
        const FrameLayers seen = layers();
        float least_left = 1;
        for (int y = 0; y < seen.region.height; ++y) {
            for (int x = 0; x < seen.region.width; ++x) {
                if (seen.alpha.at(x, y) == 0) least_left = std::min(least_left, seen.shadow.at(x, y, 1));
            }
        }
        return least_left;
    };
    EXPECT_LT(least(), 0.5) << "the ball's shadow lies on the wall";
    // A second real thing between lamp and ball: the wall lies in its shadow, as the footage shows.
    ObjectSettings roof = shape("box", ball_m_ + 0.08 * to_lamp, {0.25, 0.25, 0.01});
    roof.rotate_deg = {45, 0, 0};
    roof.holdout = true;
    shot_.scene.objects.push_back(roof);
    EXPECT_GT(least(), 0.98);
    std::filesystem::remove(probe);
}

TEST_F(HoldoutShadow, ARealThingInEvenLightSendsWhatItTakes) {
    // Where all is equally bright a real thing is so too, and changes nothing beside it.
    const std::filesystem::path probe = save_probe([](const Eigen::Vector3d&) { return 0.5F; });
    const ObjectSettings ball = shot_.scene.objects[1];
    ObjectSettings box = shape("box", ball_m_ + Eigen::Vector3d(-0.06, 0, 0), Eigen::Vector3d(0.06, 0.2, 0.2));
    box.holdout = true;
    shot_.scene.objects = {ball};
    const FrameLayers alone = layers(32);
    shot_.scene.objects = {ball, box};
    const FrameLayers beside = layers(32);
    int seen = 0;
    double most = 0;
    for (int y = 0; y < alone.region.height; ++y) {
        for (int x = 0; x < alone.region.width; ++x) {
            const int there_x = x + alone.region.x - beside.region.x, there_y = y + alone.region.y - beside.region.y;
            if (alone.alpha.at(x, y) < 1 || beside.alpha.at(there_x, there_y) < 1) continue;
            ++seen;
            const double was = static_cast<double>(alone.beauty.at(x, y, 1));
            most = std::max(most, std::abs(static_cast<double>(beside.beauty.at(there_x, there_y, 1)) / was - 1));
        }
    }
    EXPECT_GT(seen, 150);
    EXPECT_LT(most, 0.005);
    std::filesystem::remove(probe);
}

TEST_F(HoldoutShadow, ASceneWithoutHoldoutsDrawsNothingForThem) {
    shot_.scene.objects.erase(shot_.scene.objects.begin());
    expect_same_without(shot_, "holdouts");
    const auto report = std::ranges::find(reports_, "holdouts", &PassReport::name);
    ASSERT_NE(report, reports_.end());
    EXPECT_EQ(report->why, "the scene has none");
    EXPECT_FALSE(was_drawn("virtual coverage"));
    EXPECT_FALSE(was_drawn("matte/upload"));
    EXPECT_FALSE(was_drawn("real depth/upload"));
}

TEST_F(HoldoutShadow, BlurredEdgesAreThoseThatPointsOfTheLensSee) {
    shot_.scene.surface.present = false;
    ObjectSettings ball = shape("sphere", {0, 0.15, 0.05}, Eigen::Vector3d::Constant(0.12));
    ball.casts_shadow = false;
    ObjectSettings box = shape("box", {-0.06, -0.02, 0.06}, {0.12, 0.02, 0.2});
    box.holdout = true;
    box.casts_shadow = false;
    shot_.scene.objects = {ball, box};
    // In focus on the box; the ball is several pixels out of it.
    DepthOfFieldSettings blur;
    blur.focus_distance_m = 0.59;
    blur.coc_scale_px_m = 20;
    blur.lens_samples = 256;
    const auto alpha_at = [&](DepthOfFieldLevel level) {
        blur.level = level;
        shot_.scene.effects.depth_of_field = blur;
        return layers();
    };
    const FrameLayers exact = alpha_at(DepthOfFieldLevel::lens_samples);
    const FrameLayers gathered = alpha_at(DepthOfFieldLevel::gather);
    const Region both = exact.region.intersected(gathered.region);
    double sum = 0;
    int soft = 0, leaked = 0;
    for (int y = both.y; y < both.y + both.height; ++y) {
        for (int x = both.x; x < both.x + both.width; ++x) {
            const float a = exact.alpha.at(x - exact.region.x, y - exact.region.y);
            const float b = gathered.alpha.at(x - gathered.region.x, y - gathered.region.y);
            if (a == 0 && b > 0.1F) ++leaked;
            if (!(a > 0.02F && a < 0.98F)) continue;
            ++soft;
            sum += std::abs(a - b);
        }
    }
    ASSERT_GT(soft, 100);
    EXPECT_EQ(leaked, 0) << "the ball's blur does not spread over the box";
    EXPECT_LT(sum / soft, 0.06) << "as gathered edges without a holdout are";
}

}  // namespace
}  // namespace matchlight::test
