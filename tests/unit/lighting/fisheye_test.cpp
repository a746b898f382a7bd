// Fisheye pictures of known light: circles found, pairs matched and laid onto the sphere.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "fisheye_pictures.h"
#include "lighting/dominant_lights.h"
#include "lighting/fisheye_circle.h"
#include "lighting/fisheye_pair.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;
constexpr std::array projections = {FisheyeProjection::equidistant, FisheyeProjection::equisolid,
                                    FisheyeProjection::stereographic};

const std::vector<Vector3d> lamps = {Vector3d(0.3, 0.8, 0.5).normalized(), Vector3d(-0.5, -0.7, 0.2).normalized(),
                                     Vector3d(0.9, 0.02, 0.35).normalized()};  // the last one is seen by both

FisheyePicture picture_of(const test::FisheyeShot& shot, const test::Light& light) {
    FisheyePicture picture{test::fisheye_picture(light, shot), {}, 0};
    const auto circle = find_fisheye_circle(picture.light, picture.light.bounds());
    EXPECT_TRUE(circle.has_value());
    if (circle) picture.lens = lens_of_circle(shot.projection, *circle, shot.fov_deg * degree);
    return picture;
}

Probe rgb_of(const ImageF& four) {
    Probe probe{ImageF(four.width(), four.height(), 3)};
    for (int y = 0; y < four.height(); ++y) {
        for (int x = 0; x < four.width(); ++x) std::copy_n(four.pixel(x, y), 3, probe.latlong.pixel(x, y));
    }
    return probe;
}

/// Irradiance from all sides, in parts of the truth's.
double worst_irradiance(const Probe& found, const Probe& truth) {
    double worst = 0;
    std::mt19937 generator(3);
    for (int i = 0; i < 60; ++i) {
        const Vector3d normal = test::random_direction(generator);
        const Vector3d a = irradiance(found, normal), b = irradiance(truth, normal);
        worst = std::max(worst, (a - b).cwiseQuotient(b).cwiseAbs().maxCoeff());
    }
    return worst;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) / degree;
}

/// Power-weighted middle of what is within 4° of a direction, over the smooth light beside it.
Vector3d lamp_near(const Probe& probe, const Vector3d& lamp) {
    Vector3d sum = Vector3d::Zero();
    const int width = probe.latlong.width(), height = probe.latlong.height();
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Vector3d direction = latlong_direction(x, y, width, height);
            constexpr double lit = 20;  // far above the walls
            const double light = probe.latlong.at(x, y, 1);
            if (angle_deg(direction, lamp) > 4 || light < lit) continue;
            sum += (light - lit) * std::sin(std::numbers::pi * (y + 0.5) / height) * direction;
        }
    }
    return sum.normalized();
}

TEST(FisheyeLens, CircleAndAngleOfViewGiveTheFocalLength) {
    const PixelCircle circle{{100, 90}, 80};
    std::vector<FisheyeProjection> all(projections.begin(), projections.end());
    all.push_back(FisheyeProjection::orthographic);
    for (const FisheyeProjection projection : all) {
        const FisheyeLens lens = lens_of_circle(projection, circle, 160 * degree);
        const Vector3d at_rim(std::sin(80 * degree), 0, std::cos(80 * degree));
        EXPECT_NEAR((*lens.pixel_from_direction(at_rim) - Vector2d(180, 90)).norm(), 0, 1e-9);
        EXPECT_FALSE(lens.pixel_from_direction(Vector3d(1, 0, 0)).has_value());
        EXPECT_EQ(*lens.pixel_from_direction(Vector3d::UnitZ()), circle.centre_px);
        // A test's own inverse: 50° falls where the formula has it.
        const double radius = (*lens.pixel_from_direction({0, std::sin(50 * degree), std::cos(50 * degree)})).y() - 90;
        EXPECT_NEAR(test::angle_of_radius(projection, radius / lens.focal_px.x()), 50 * degree, 1e-12);
    }
    FisheyeLens folding{FisheyeProjection::kannala_brandt, {0, 0}, {100, 100}, {-0.1, 0, 0, 0}, 1};
    FisheyeLens half{FisheyeProjection::orthographic, {0, 0}, {100, 100}, {}, 1};
    EXPECT_NEAR(widest_angle(half), 90 * degree, 1e-12);
    // θ − 0.1 θ³ rises until θ² = 10/3.
    EXPECT_NEAR(widest_angle(folding), std::sqrt(10.0 / 3), 2e-3);
}

TEST(FisheyeCircle, IsFoundToAFractionOfAPixel) {
    const test::Light room = test::striped_room(lamps);
    for (const PixelCircle& circle : {PixelCircle{{229.5, 229.5}, 220}, PixelCircle{{250.3, 210.7}, 180.4},
                                      PixelCircle{{229.5, 240}, 260}}) {  // the last one is cut off on all sides
        test::FisheyeShot shot;
        shot.circle = circle;
        shot.frame_light = 0.002;
        const ImageF picture = test::fisheye_picture(room, shot);
        const auto found = find_fisheye_circle(picture, picture.bounds());
        ASSERT_TRUE(found.has_value());
        EXPECT_LT((found->centre_px - circle.centre_px).norm(), 0.3);
        EXPECT_NEAR(found->radius_px, circle.radius_px, 0.3);
    }
}

TEST(FisheyeCircle, IsNotMadeUp) {
    EXPECT_FALSE(find_fisheye_circle(ImageF(200, 200, 3), {0, 0, 200, 200}).has_value());
    EXPECT_FALSE(find_fisheye_circle(ImageF(200, 200, 3, 0.5f), {0, 0, 200, 200}).has_value());
    EXPECT_FALSE(find_fisheye_circle(ImageF(20, 20, 3, 0.5f), {0, 0, 20, 20}).has_value());
    ImageF square(200, 200, 3);  // a bright square on black is no circle
    for (int y = 40; y < 160; ++y) {
        for (int x = 40; x < 160; ++x) {
            for (int c = 0; c < 3; ++c) square.at(x, y, c) = 1;
        }
    }
    EXPECT_FALSE(find_fisheye_circle(square, square.bounds()).has_value());
}

TEST(FisheyePair, OfAnyProjectionGivesTheLightBack) {
    const test::Light room = test::striped_room(lamps);
    const Probe truth = test::probe_of(512, room);
    for (const FisheyeProjection projection : projections) {
        SCOPED_TRACE(static_cast<int>(projection));
        test::FisheyeShot shot;
        shot.projection = projection;
        shot.world_from_camera = test::front_camera();
        const FisheyePicture front = picture_of(shot, room);
        shot.world_from_camera = test::back_camera();
        const FisheyePicture back = picture_of(shot, room);
        const StitchedSphere sphere =
            stitched_pair(front, &back, match_pair(front, back, {}), Matrix3d::Identity(), 300);
        EXPECT_NEAR(sphere.seen_share, 1, 1e-12);
        const Probe found = rgb_of(sphere.latlong);
        EXPECT_LT(worst_irradiance(found, truth), 0.01);
        for (const Vector3d& lamp : lamps) EXPECT_LT(angle_deg(lamp_near(found, lamp), lamp), 0.2);
    }
}

TEST(FisheyePair, IsTurnedAndBrightenedUntilItAgrees) {
    const test::Light room = test::striped_room(lamps);
    const Probe truth = test::probe_of(512, room);
    test::FisheyeShot shot;
    shot.world_from_camera = test::front_camera();
    FisheyePicture front = picture_of(shot, room);
    // The back camera stands askew: what it shows lies elsewhere in its picture than the pair's axes say.
    const Vector3d askew(0.8 * degree, -0.5 * degree, 1.2 * degree);
    shot.world_from_camera =
        Eigen::AngleAxisd(askew.norm(), askew.normalized()).toRotationMatrix() * test::back_camera();
    shot.gain = {0.7, 0.8, 0.95};
    const FisheyePicture back = picture_of(shot, room);

    const PairMatch match = match_pair(front, back, {});
    EXPECT_TRUE(match.turned);
    EXPECT_NEAR(match.overlap_deg, 20, 1e-9);
    EXPECT_LT((match.turn_rad + askew).norm(), 0.1 * degree);
    EXPECT_LT(match.difference_ev, 0.5 * match.difference_before_ev);
    EXPECT_LT((match.back_gain.cwiseProduct(shot.gain) - Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.01);

    const Probe found = rgb_of(stitched_pair(front, &back, match, Matrix3d::Identity(), 300).latlong);
    EXPECT_LT(worst_irradiance(found, truth), 0.01);
    for (const Vector3d& lamp : lamps) EXPECT_LT(angle_deg(lamp_near(found, lamp), lamp), 0.2);
    // Across the seam (the plane y = 0) light is the truth's on either side of it: no step where one picture ends.
    for (const double from_front_deg : {79.0, 81.0, 89.0, 91.0, 99.0, 101.0}) {
        double sum_found = 0, sum_truth = 0;
        for (int i = 0; i < 360; ++i) {
            const double azimuth = i * degree, angle = from_front_deg * degree;
            const Vector3d d(std::sin(angle) * std::cos(azimuth), std::cos(angle), std::sin(angle) * std::sin(azimuth));
            if (angle_deg(d, lamps[2]) < 5) continue;
            sum_found += found.radiance(d).y();
            sum_truth += room(d).y();
        }
        EXPECT_NEAR(sum_found / sum_truth, 1, 0.005) << from_front_deg;
    }

    MatchOptions as_it_is;
    as_it_is.turn = as_it_is.gain = false;
    const PairMatch unmatched = match_pair(front, back, as_it_is);
    EXPECT_FALSE(unmatched.turned);
    EXPECT_EQ(unmatched.back_gain, Vector3d::Ones());
    const Probe worse = rgb_of(stitched_pair(front, &back, unmatched, Matrix3d::Identity(), 300).latlong);
    EXPECT_GT(worst_irradiance(worse, truth), 0.05);
}

TEST(FisheyePair, WithoutDetailStaysAsItIs) {
    const test::Light plain = [](const Vector3d&) { return Vector3d(0.5, 0.5, 0.5).eval(); };
    test::FisheyeShot shot;
    shot.world_from_camera = test::front_camera();
    const FisheyePicture front = picture_of(shot, plain);
    shot.world_from_camera = test::back_camera();
    const PairMatch match = match_pair(front, picture_of(shot, plain), {});
    EXPECT_FALSE(match.turned);
    EXPECT_NEAR(match.back_gain.x(), 1, 1e-6);
    shot.fov_deg = 90;  // two halves that do not meet
    const PairMatch apart = match_pair(front, picture_of(shot, plain), {});
    EXPECT_LT(apart.overlap_deg, 0);
    EXPECT_FALSE(apart.turned);
}

TEST(FisheyePair, OneAloneLeavesTheRestUnseen) {
    const test::Light room = test::striped_room({});
    test::FisheyeShot shot;
    shot.world_from_camera = test::front_camera();
    const FisheyePicture front = picture_of(shot, room);
    // The lens points at the zenith, the picture's top towards −y.
    Matrix3d world_from_pair;
    world_from_pair << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    const StitchedSphere sphere = stitched_pair(front, nullptr, {}, world_from_pair, 180);
    // Up to the rim, whose own pixel is left out.
    const double rim = 100 * degree - 1 / front.lens.focal_px.x();
    EXPECT_NEAR(sphere.seen_share, (1 - std::cos(rim)) / 2, 5e-4);  // the map's lattice is a third of a degree
    const int bottom = sphere.latlong.height() - 1;
    for (int x = 0; x < sphere.latlong.width(); ++x) {
        EXPECT_EQ(sphere.latlong.at(x, 0, 3), 1);
        for (int c = 0; c < 4; ++c) EXPECT_EQ(sphere.latlong.at(x, bottom, c), 0);
    }
    // What was forward is up: the room along (0, 1, 0) is at the zenith.
    const Vector3d forward = room(Vector3d::UnitY());
    EXPECT_NEAR(sphere.latlong.at(7, 0, 1), forward.y(), 0.02 * forward.y());
}

TEST(FisheyePair, ALampOfOnePixelKeepsItsEnergy) {
    FisheyePicture front{ImageF(300, 300, 3), {}, 0};
    front.lens = lens_of_circle(FisheyeProjection::equidistant, {{149.3, 150.6}, 140}, 190 * degree);
    const double focal = front.lens.focal_px.x();
    for (const int height : {150, 40}) {
        double worst = 0;
        for (int i = 0; i < 8; ++i) {
            const double angle = 90 * degree * std::sqrt((i + 0.5) / 8), azimuth = 2.4 * i;  // spread over the disc
            const Vector2d px = front.lens.centre_px + focal * angle * Vector2d(std::cos(azimuth), std::sin(azimuth));
            const int x = static_cast<int>(std::lround(px.x())), y = static_cast<int>(std::lround(px.y()));
            std::fill_n(front.light.pixel(x, y), 3, 1e5f);
            const StitchedSphere sphere = stitched_pair(front, nullptr, {}, Matrix3d::Identity(), height);
            std::fill_n(front.light.pixel(x, y), 3, 0.0f);
            double energy = 0;
            for (int row = 0; row < height; ++row) {
                const double top = std::cos(std::numbers::pi * row / height);
                const double bottom = std::cos(std::numbers::pi * (row + 1) / height);
                for (int column = 0; column < 2 * height; ++column) {
                    const float* pixel = sphere.latlong.pixel(column, row);
                    energy += pixel[0] * pixel[3] * (top - bottom) * std::numbers::pi / height;
                }
            }
            // A pixel of an equidistant lens holds sin θ / θ / f² steradians.
            const double own = (Vector2d(x, y) - front.lens.centre_px).norm() / focal;
            const double truth = 1e5 * (own > 0 ? std::sin(own) / own : 1) / (focal * focal);
            worst = std::max(worst, std::abs(energy / truth - 1));
        }
        EXPECT_LT(worst, 0.01) << height;
    }
}

TEST(FisheyePair, PicturesThatLieOnTheirSideAreTurnedUpright) {
    const test::Light room = test::striped_room({});
    test::FisheyeShot shot;
    shot.world_from_camera = test::front_camera();
    const FisheyePicture upright = picture_of(shot, room);
    // The camera's body rolled clockwise (seen from behind it): its picture shows the world rolled the other way.
    shot.world_from_camera =
        test::front_camera() * Eigen::AngleAxisd(90 * degree, Vector3d::UnitZ()).toRotationMatrix();
    FisheyePicture rolled = picture_of(shot, room);
    rolled.upright_deg = 90;
    const ImageF a = stitched_pair(upright, nullptr, {}, Matrix3d::Identity(), 90).latlong;
    const ImageF b = stitched_pair(rolled, nullptr, {}, Matrix3d::Identity(), 90).latlong;
    for (std::size_t i = 0; i < a.samples().size(); ++i) ASSERT_NEAR(a.samples()[i], b.samples()[i], 0.02);
}

}  // namespace
}  // namespace matchlight
