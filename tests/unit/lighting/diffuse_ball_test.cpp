#include "lighting/diffuse_ball.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "report/synthetic_ball.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

constexpr int rows = 128;
const Eigen::Vector3d sun = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();
const Eigen::Vector3d window = Eigen::Vector3d(-0.8, -0.4, 0.3).normalized();

struct Lamp {
    Eigen::Vector3d towards, radiance;
};
const std::vector<Lamp> both = {{sun, {4000, 3500, 2800}}, {window, {400, 500, 700}}};

bool lit_by(const Lamp& lamp, const Eigen::Vector3d& direction) {
    return direction.dot(lamp.towards) > std::cos(5 * std::numbers::pi / 180);
}

/// A room, and lamps in it.
Probe room_with(const std::vector<Lamp>& lamps) {
    return test::probe_of(rows, [&](const Eigen::Vector3d& d) -> Eigen::Vector3d {
        for (const Lamp& lamp : lamps) {
            if (lit_by(lamp, d)) return lamp.radiance;
        }
        return test::smooth_sky(d) * (d.z() > 0 ? 1 : 0.3);
    });
}

/// What photographs hold of it that clip at `limit`.
BallProbe clipped_at(const Probe& truth, float limit) {
    BallProbe probe;
    probe.radiance = truth.latlong;
    const int width = probe.radiance.width(), height = probe.radiance.height();
    probe.sigma = ImageF(width, height, 1);
    probe.seen = ImageF(width, height, 1);
    probe.clipped = ImageF(width, height, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            probe.seen.at(x, y) = 1;
            for (int c = 0; c < 3; ++c) {
                if (probe.radiance.at(x, y, c) <= limit) continue;
                probe.radiance.at(x, y, c) = limit;
                probe.clipped.at(x, y) = 1;
            }
        }
    }
    return probe;
}

/// A Lambertian ball in the light of `truth`, and its outline.
BallView diffuse_view(const Probe& truth, const Eigen::Vector3d& albedo, int width = 160) {
    BallShot shot;
    shot.ball = {{0, 0, 0.05}, 0.035};
    shot.camera = long_lens(width, width * 3 / 4, 6 * width);
    shot.camera_from_world = looking_at({0.3, -0.6, 0.35}, shot.ball.centre_m);
    BallView view =
        photographed_matte(shot, albedo, [&](const Eigen::Vector3d& normal) { return irradiance(truth, normal); });
    view.name = "grey.exr";
    const Eigen::Vector3d centre = *view.camera_from_world * shot.ball.centre_m;
    view.outline.axis = centre.normalized();
    view.outline.half_angle = std::asin(shot.ball.radius_m / centre.norm());
    return view;
}

TEST(DiffuseBall, TellsWhatEachOfTwoLampsSends) {
    const Probe truth = room_with(both);
    BallProbe probe = clipped_at(truth, 60);
    const auto lights = solve_clipped_lights(probe, {diffuse_view(truth, {0.4, 0.5, 0.6}), std::nullopt});
    ASSERT_EQ(lights.size(), 2U);
    for (const ClippedLight& light : lights) {
        const Lamp& lamp = light.direction.dot(sun) > 0.99 ? both[0] : both[1];
        EXPECT_GT(light.direction.dot(lamp.towards), 0.999);
        for (int c = 0; c < 3; ++c) {
            // The patches' flat normals and the small map of the rest are all that is not exact.
            EXPECT_NEAR(light.gain[c], lamp.radiance[c] / 60, 0.03 * lamp.radiance[c] / 60);
            EXPECT_LT(light.sigma[c], 0.15);
        }
    }
    for (const Eigen::Vector3d& normal : {sun, window, Eigen::Vector3d(0, 0, 1)}) {
        const Eigen::Vector3d got = irradiance({probe.radiance}, normal), wanted = irradiance(truth, normal);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 0.03 * wanted[c]);
    }
}

TEST(DiffuseBall, AnAlbedoThatIsKnownServesWhereNoPartIsShaded) {
    // Light from the eye's side reaches all of the ball that is seen: only the albedo parts it from the rest.
    const Lamp flash{Eigen::Vector3d(0.3, -0.6, 0.3).normalized(), {900, 900, 900}};
    const Probe truth = room_with({flash});
    BallProbe probe = clipped_at(truth, 60);
    const auto lights = solve_clipped_lights(
        probe, {diffuse_view(truth, Eigen::Vector3d::Constant(0.18)), Eigen::Vector3d::Constant(0.18)});
    ASSERT_EQ(lights.size(), 1U);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(lights[0].gain[c], 15, 0.5);
}

TEST(DiffuseBall, WhereNothingIsClippedNothingChanges) {
    const Probe truth = room_with({});
    BallProbe probe = clipped_at(truth, 60);
    EXPECT_TRUE(solve_clipped_lights(probe, {diffuse_view(truth, {0.5, 0.5, 0.5}), std::nullopt}).empty());
    EXPECT_TRUE(std::ranges::equal(probe.radiance.samples(), truth.latlong.samples()));
}

TEST(DiffuseBall, OneThatIsClippedItselfIsRefusedByName) {
    const Probe truth = room_with(both);
    BallView view = diffuse_view(truth, {0.5, 0.5, 0.5});
    view.clipped = Image8(view.camera.width, view.camera.height, 1);
    std::ranges::fill(view.clipped.samples(), std::uint8_t{255});
    BallProbe probe = clipped_at(truth, 60);
    try {
        solve_clipped_lights(probe, {view, std::nullopt});
        FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("grey.exr"), std::string::npos) << error.what();
    }
}

TEST(DiffuseBall, ASmallOneStillTells) {
    const Probe truth = room_with(both);
    BallProbe probe = clipped_at(truth, 60);
    // Thirty pixels across: some 600 patches of one pixel each.
    const auto lights = solve_clipped_lights(probe, {diffuse_view(truth, {0.5, 0.5, 0.5}, 48), std::nullopt});
    ASSERT_EQ(lights.size(), 2U);
    for (const ClippedLight& light : lights) {
        const Lamp& lamp = light.direction.dot(sun) > 0.99 ? both[0] : both[1];
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(light.gain[c], lamp.radiance[c] / 60, 0.06 * lamp.radiance[c] / 60);
    }
}

}  // namespace
}  // namespace matchlight
