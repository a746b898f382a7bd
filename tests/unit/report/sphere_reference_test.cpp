// The reference of sphere sets where answers are known in closed form.
#include "report/sphere_reference.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr double focal_px = 120;

/// At the world's origin, looking along +z, x to the right and y down.
ReferenceView view_of(int width, int height) {
    ReferenceView view;
    view.pinhole = {.fx = focal_px,
                    .fy = focal_px,
                    .cx = (width - 1) / 2.0,
                    .cy = (height - 1) / 2.0,
                    .width = static_cast<double>(width),
                    .height = static_cast<double>(height),
                    .near_m = 1e-3};
    return view;
}

SphereSet set_of(std::vector<Sphere> spheres) {
    SphereSet set;
    set.spheres = std::move(spheres);
    set.update_bounds();
    return set;
}

SphereCaster caster_of(const SphereSet& set) {
    SphereCaster caster;
    caster.add_set(set);
    return caster;
}

Vector3d white(const SpherePoint&) {
    return Vector3d::Ones();
}

TEST(SphereReference, ASpheresPictureHasTheEllipsesArea) {
    const ReferenceView view = view_of(141, 141);
    for (const Vector3d& centre : {Vector3d(0, 0, 4), Vector3d(1, -0.5, 4), Vector3d(0.5, 0.25, 2)}) {
        const double radius = 0.5;
        const SphereSet set =
            set_of({{{static_cast<float>(centre.x()), static_cast<float>(centre.y()), static_cast<float>(centre.z())},
                     static_cast<float>(radius)}});
        const ImageF picture = reference_opaque(caster_of(set), view, 8, white);
        double area = 0;
        for (int y = 0; y < 141; ++y) {
            for (int x = 0; x < 141; ++x) area += picture.at(x, y, 3);
        }
        // The tangent cone cut by the picture's plane: π f² r² √((l² − r²)/(z² − r²)) / (z² − r²).
        const double r2 = radius * radius, z2 = centre.z() * centre.z() - r2, l2 = centre.squaredNorm() - r2;
        const double expected = std::numbers::pi * focal_px * focal_px * r2 * std::sqrt(l2 / z2) / z2;
        // 64 places a pixel along an outline of some 100 pixels: each row's end is off by a twentieth at random.
        EXPECT_NEAR(area, expected, 1e-3 * expected);
    }
}

TEST(SphereReference, DepthIsAlongTheAxisOfTheCamera) {
    const SphereSet set = set_of({{{0, 0, 4}, 0.5F}});
    ReferenceView view = view_of(101, 101);
    const SpherePicture picture = reference_picture(caster_of(set), view);
    EXPECT_EQ(picture.ids.at(50, 50), 0);
    EXPECT_NEAR(picture.depth_m.at(50, 50), 3.5, 1e-14);
    EXPECT_NEAR(picture.reversed_depth(50, 50, 1e-3), 1e-3 / 3.5, 1e-17);
    EXPECT_EQ(picture.ids.at(0, 0), no_sphere);
    EXPECT_TRUE(std::isinf(picture.depth_m.at(0, 0)));
    // (x, y, z)·t on the sphere: t²(1 + s²) − 8t + 15.75 = 0 with s = 10 px / f.
    const double s = 10 / focal_px, a = 1 + s * s;
    EXPECT_NEAR(picture.depth_m.at(60, 50), (4 - std::sqrt(16 - a * 15.75)) / a, 1e-14);
}

TEST(SphereReference, SeesAsTheProjectionOfTransformsDoes) {
    ReferenceView view = view_of(64, 48);
    view.camera_from_world = camera_looking_along({1, -3, 2}, Vector3d(-0.2, 0.9, -0.5).normalized());
    view.pinhole.origin_x = 7;
    view.pinhole.origin_y = -3;
    const Eigen::Matrix4d clip_from_world = clip_from_camera(view.pinhole) * view.camera_from_world.matrix();
    for (const auto& [x, y] : {std::pair{0, 0}, std::pair{63, 47}, std::pair{20, 31}}) {
        const SphereRay ray = view.ray_through(x, y);
        const double depth = 5;
        const Eigen::Vector4d clip = clip_from_world * (ray.origin_m + depth * ray.direction).homogeneous();
        EXPECT_NEAR((clip.x() / clip.w() + 1) / 2 * 64 - 0.5, x, 1e-10);
        EXPECT_NEAR((1 - clip.y() / clip.w()) / 2 * 48 - 0.5, y, 1e-10);
        EXPECT_NEAR(clip.z() / clip.w(), 1e-3 / depth, 1e-15);
    }
}

TEST(SphereReference, SpheresMeetInACircleAndHideWhatIsInside) {
    // Side by side and alike, they meet in the plane between them.
    const ReferenceView view = view_of(100, 81);
    const SphereSet alike = set_of({{{-0.3F, 0, 3}, 0.5F}, {{0.3F, 0, 3}, 0.5F}});
    const SpherePicture picture = reference_picture(caster_of(alike), view);
    for (int y = 35; y < 46; ++y) {
        EXPECT_EQ(picture.ids.at(49, y), 0);
        EXPECT_EQ(picture.ids.at(50, y), 1);
    }
    // Unlike ones meet in the plane of equal power; no point that is seen lies inside the other.
    const SphereSet unlike = set_of({{{-0.3F, 0.1F, 3}, 0.5F}, {{0.2F, 0, 2.8F}, 0.3F}});
    const SphereCaster caster = caster_of(unlike);
    int both = 0;
    for (int y = 0; y < 81; ++y) {
        for (int x = 0; x < 100; ++x) {
            const SphereRay ray = view.ray_through(x, y);
            const auto hit = caster.nearest(ray);
            if (!hit) continue;
            const Sphere& other = unlike.spheres[1 - hit->sphere];
            const Vector3d point = ray.origin_m + hit->distance * ray.direction;
            EXPECT_GE((point - Eigen::Vector3f(other.centre_m.data()).cast<double>()).norm(), other.radius_m - 1e-12);
            both |= 1 << hit->sphere;
        }
    }
    EXPECT_EQ(both, 3);
}

TEST(SphereReference, FromInsideEverythingIsTheInside) {
    const SphereSet set = set_of({{{0, 0, 0.5F}, 2}});
    const SpherePicture picture = reference_picture(caster_of(set), view_of(21, 21));
    for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 21; ++x) EXPECT_EQ(picture.ids.at(x, y), 0);
    }
    EXPECT_NEAR(picture.depth_m.at(10, 10), 2.5, 1e-14);
}

TEST(SphereReference, CoverageOfAStraightEdgeIsItsShare) {
    // A sphere so large that its outline is straight over a pixel: its left end lies on the axis of the camera.
    constexpr double radius = 1e4, depth = 3e4;
    const double tangent = radius / std::sqrt(depth * depth - radius * radius);
    ReferenceView view = view_of(21, 21);
    const SphereSet set = set_of({{{0, 0, static_cast<float>(depth)}, static_cast<float>(radius)}});
    const SphereCaster caster = caster_of(set);
    for (const double share : {0.1, 0.5, 0.8}) {
        // The right end of the outline, at f · tangent from the middle, cuts pixel 10 at `share` from its left.
        view.pinhole.cx = 10 - 0.5 + share - focal_px * tangent;
        const std::vector<SphereShare> shares = reference_coverage(caster, view, 10, 10, 16);
        ASSERT_EQ(shares.size(), 2U);
        EXPECT_EQ(shares[0].id, no_sphere);
        EXPECT_EQ(shares[1].id, 0);
        EXPECT_NEAR(shares[0].share + shares[1].share, 1, 1e-12);
        // Half a column of places, and the outline's bend: a pixel over a radius of 42.
        EXPECT_NEAR(shares[1].share, share, 0.5 / 16 + 0.006);
    }
}

TEST(SphereReference, EdgesAreSilhouettesAndSeams) {
    const ReferenceView view = view_of(100, 81);
    const SphereSet set = set_of({{{-0.3F, 0, 3}, 0.5F}, {{0.3F, 0, 3}, 0.5F}});
    const SphereCaster caster = caster_of(set);
    const auto is_edge = [&](int x, double margin_px) { return is_sphere_edge(caster, view, x, 40, {4, margin_px}); };
    // The seam runs between columns 49 and 50, half a pixel from both their middles.
    EXPECT_FALSE(is_edge(49, -0.01));
    EXPECT_TRUE(is_edge(49, 0.1));
    EXPECT_TRUE(is_edge(50, 0.1));
    EXPECT_FALSE(is_edge(40, 0.1));
    EXPECT_FALSE(is_edge(0, 0.1));
    // The outline of the left one is one line.
    int edges = 0;
    for (int x = 0; x < 49; ++x) edges += is_edge(x, 0.1) ? 1 : 0;
    EXPECT_GE(edges, 1);
    EXPECT_LE(edges, 2);
}

TEST(SphereReference, OpenShareUnderASphereIsItsViewFactor) {
    for (const double tilt_deg : {0.0, 30.0}) {
        const double tilt = tilt_deg * std::numbers::pi / 180;
        // The point is the top of sphere 0; sphere 1 stands over it, whole above its horizon.
        const Vector3d over = Vector3d(0, 0, 1) + 3 * Vector3d(std::sin(tilt), 0, std::cos(tilt));
        const SphereSet set =
            set_of({{{0, 0, 0}, 1}, {{static_cast<float>(over.x()), 0, static_cast<float>(over.z())}, 1.5F}});
        const SphereCaster caster = caster_of(set);
        const SpherePoint top{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
        // A cone of half angle θ about a direction β off the normal takes cos β · sin² θ.
        const double expected = 1 - std::cos(tilt) * 0.25;
        EXPECT_NEAR(reference_open_share(caster, top, 128), expected, 1e-3);
    }
}

TEST(SphereReference, OpenShareOnAFloorIsHalfOfOnePlusTheCosine) {
    // A floor that is a sphere of 100,000 radii: its horizon is 0.3° low.
    const SphereSet set = set_of({{{0, 0, -1e5F}, 1e5F}, {{0, 0, 1}, 1}});
    const SphereCaster caster = caster_of(set);
    for (const double from_up_deg : {0.0, 45.0, 90.0, 150.0}) {
        const double angle = from_up_deg * std::numbers::pi / 180;
        const Vector3d normal(std::sin(angle), 0, std::cos(angle));
        const SpherePoint point{{1, 0, 1}, Vector3d(0, 0, 1) + normal, normal, normal};
        EXPECT_NEAR(reference_open_share(caster, point, 64), (1 + std::cos(angle)) / 2, 4e-3) << from_up_deg;
    }
    const SphereSet alone = set_of({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}});
    EXPECT_EQ(reference_open_share(caster_of(alone), {{1, 0, 0}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, 32), 1);
}

TEST(SphereReference, EverySphereIsOneLayer) {
    SphereSet set = set_of({{{0, 0, 5}, 1}, {{0, 0, 3}, 0.5F}, {{0, 0, 5}, 1}, {{0, 0, 0}, 1}});
    set.opacities = {0.1F, 0.2F, 0.3F, 0.4F};
    set.colors = {{255, 0, 0, 0}, {0, 255, 0, 0}, {0, 0, 255, 0}, {188, 188, 188, 0}};
    const auto own = [&](const SpherePoint& point) { return color_of(set, point.hit.sphere); };
    const std::vector<TransparentLayer> layers = reference_layers(caster_of(set), view_of(3, 3).ray_through(1, 1), own);
    ASSERT_EQ(layers.size(), 4U);
    // The camera is inside of the last; the coincident ones come by their number.
    EXPECT_NEAR(layers[0].depth_m, 1, 1e-14);
    EXPECT_NEAR(layers[0].light.x(), 0.503, 1e-3);  // sRGB 188
    EXPECT_NEAR(layers[1].depth_m, 2.5, 1e-14);
    EXPECT_EQ(layers[1].light, Vector3d(0, 1, 0));
    EXPECT_NEAR(layers[2].depth_m, 4, 1e-14);
    EXPECT_NEAR(layers[2].opacity, 0.1, 1e-7);
    EXPECT_NEAR(layers[3].depth_m, 4, 1e-14);
    EXPECT_NEAR(layers[3].opacity, 0.3, 1e-7);
}

}  // namespace
}  // namespace matchlight
