// Rays against spheres: analytic cases, and every sphere tried one by one.
#include "scene/sphere_caster.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/transforms.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

SphereSet set_of(std::vector<Sphere> spheres) {
    SphereSet set;
    set.spheres = std::move(spheres);
    set.update_bounds();
    return set;
}

SphereSet random_set(unsigned seed, int count, float least_radius, float most_radius) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-1, 1), radius(std::log(least_radius), std::log(most_radius));
    SphereSet set;
    for (int i = 0; i < count; ++i) {
        set.spheres.push_back({{place(random), place(random), place(random)}, std::exp(radius(random))});
    }
    set.update_bounds();
    return set;
}

Vector3d random_direction(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// Every sphere tried in turn.
std::vector<SphereHit> one_by_one(const SphereSet& set, const SphereRay& ray, bool both) {
    std::vector<SphereHit> hits;
    for (std::uint32_t i = 0; i < set.size(); ++i) {
        const Sphere& sphere = set.spheres[i];
        const auto roots = sphere_roots(ray.origin_m, ray.direction,
                                        Eigen::Vector3f(sphere.centre_m.data()).cast<double>(), sphere.radius_m);
        if (!roots) continue;
        for (const double root : *roots) {
            if (root <= ray.least || root > ray.most) continue;
            hits.push_back({root, 0, i});
            if (!both) break;
        }
    }
    std::ranges::sort(hits);
    return hits;
}

TEST(SphereCaster, MeetsTheFrontOfOneSphereAndFromInsideItsBack) {
    const SphereSet set = set_of({{{0, 0, 5}, 2}});
    SphereCaster caster;
    caster.add_set(set);
    const auto front = caster.nearest({.origin_m = {0, 1, 0}});
    ASSERT_TRUE(front);
    EXPECT_NEAR(front->distance, 5 - std::sqrt(3), 1e-14);
    EXPECT_NEAR(caster.nearest({.origin_m = {0, 0, 4}})->distance, 3, 1e-14);
    // A near plane that cuts the front off shows the inside too.
    EXPECT_NEAR(caster.nearest({.least = 4})->distance, 7, 1e-14);
    EXPECT_FALSE(caster.nearest({.origin_m = {0, 2.0001, 0}}));
    EXPECT_FALSE(caster.nearest({.origin_m = {0, 0, 8}}));
    EXPECT_FALSE(caster.nearest({.most = 2.999}));
    EXPECT_TRUE(caster.nearest({.most = 3.001}));
}

TEST(SphereCaster, TangentRaysTouch) {
    const SphereSet set = set_of({{{0, 0, 5}, 2}});
    SphereCaster caster;
    caster.add_set(set);
    const auto touch = caster.nearest({.origin_m = {2, 0, 0}});
    ASSERT_TRUE(touch);
    // √ of what is left of r² − r² is not resolved: half of the digits.
    EXPECT_NEAR(touch->distance, 5, 1e-7);
}

TEST(SphereCaster, RootsHoldFromAMillionthToAMillionOfTheDistance) {
    for (const double radius : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
        // The surface is 1 away; a ray that is off by half a radius (or by half of what is far) meets it where the
        // circle says.
        const Vector3d centre(0, 0, 1 + radius);
        const double off = 0.5 * std::min(radius, 1.0);
        const auto roots = sphere_roots({off, 0, 0}, Vector3d::UnitZ(), centre, radius);
        ASSERT_TRUE(roots) << radius;
        const double sagitta = off * off / (radius + std::sqrt(radius * radius - off * off));
        // The centre itself is rounded to 1e-16 of the radius.
        EXPECT_NEAR((*roots)[0], 1 + sagitta, 1e-15 + 4e-16 * radius) << radius;
    }
}

TEST(SphereCaster, OfCoincidentSpheresTheLowestNumberIsMet) {
    const SphereSet set = set_of(std::vector<Sphere>(100, Sphere{{0.1F, 0.2F, 3}, 0.5F}));
    SphereCaster caster;
    caster.add_set(set);
    caster.add_set(set);
    const auto hit = caster.nearest({});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->set, 0U);
    EXPECT_EQ(hit->sphere, 0U);
    std::vector<SphereHit> hits;
    caster.all({}, SphereCaster::Surfaces::first, hits);
    ASSERT_EQ(hits.size(), 200U);
    for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQ(hits[i].set * 100 + hits[i].sphere, i);
}

TEST(SphereCaster, OfNothingIsNeverMet) {
    const SphereSet none;
    SphereCaster caster;
    EXPECT_FALSE(caster.nearest({}));
    caster.add_set(none);
    EXPECT_FALSE(caster.nearest({}));
    EXPECT_FALSE(caster.meets({}));
}

TEST(SphereCaster, AgreesWithTryingEverySphere) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-2, 2);
    // Even, and of radii from a thousandth to the size of the whole set.
    for (const auto& [least, most] : {std::pair{0.02F, 0.05F}, std::pair{0.001F, 1.0F}}) {
        const SphereSet set = random_set(7, 500, least, most);
        SphereCaster caster;
        caster.add_set(set);
        int met = 0;
        std::vector<SphereHit> hits;
        for (int i = 0; i < 2000; ++i) {
            SphereRay ray{.origin_m = {place(random), place(random), place(random)}};
            ray.direction = random_direction(random) - ray.origin_m;
            if (i % 2 == 1) ray.least = 0.2;
            if (i % 3 == 1) ray.most = 0.9;
            const std::vector<SphereHit> fronts = one_by_one(set, ray, false);
            const auto nearest = caster.nearest(ray);
            ASSERT_EQ(nearest.has_value(), !fronts.empty());
            EXPECT_EQ(caster.meets(ray), !fronts.empty());
            if (nearest) {
                EXPECT_EQ(*nearest, fronts.front());
            }
            met += nearest ? 1 : 0;
            caster.all(ray, SphereCaster::Surfaces::first, hits);
            EXPECT_EQ(hits, fronts);
            caster.all(ray, SphereCaster::Surfaces::both, hits);
            EXPECT_EQ(hits, one_by_one(set, ray, true));
        }
        EXPECT_GT(met, 500);
    }
}

TEST(SphereCaster, PlacesSetsRigidlyAndByOneScale) {
    const SphereSet set = random_set(9, 200, 0.02F, 0.2F);
    RigidTransform world_from_set = RigidTransform::Identity();
    world_from_set.linear() = rotation_from_degrees({20, -40, 70});
    world_from_set.translation() = Vector3d(3, -2, 1);
    constexpr double scale = 2.5;
    // The same spheres moved one by one; their centres are rounded to floats.
    SphereSet moved = set;
    for (Sphere& sphere : moved.spheres) {
        const Vector3d centre = world_from_set * (scale * Eigen::Vector3f(sphere.centre_m.data()).cast<double>());
        for (std::size_t axis = 0; axis < 3; ++axis) {
            sphere.centre_m.at(axis) = static_cast<float>(centre[static_cast<int>(axis)]);
        }
        sphere.radius_m *= static_cast<float>(scale);
    }
    SphereCaster caster, expected;
    caster.add_set(set, world_from_set, scale);
    expected.add_set(moved);
    std::mt19937 random(5);
    int met = 0;
    for (int i = 0; i < 500; ++i) {
        const SphereRay ray{.origin_m = Vector3d(3, -2, 1) + 6 * random_direction(random)};
        SphereRay aimed = ray;
        aimed.direction = Vector3d(3, -2, 1) + random_direction(random) - ray.origin_m;
        const auto hit = caster.nearest(aimed), wanted = expected.nearest(aimed);
        ASSERT_EQ(hit.has_value(), wanted.has_value());
        if (!hit) continue;
        ++met;
        // Float centres are 2e-7 off, which a grazing ray sees a hundredfold.
        EXPECT_NEAR(hit->distance, wanted->distance, 1e-4);
        EXPECT_EQ(hit->sphere, wanted->sphere);
        const Vector3d position = aimed.origin_m + hit->distance * aimed.direction;
        EXPECT_NEAR(caster.normal_at(*hit, position).norm(), 1, 1e-12);
        EXPECT_LT((caster.normal_at(*hit, position) - expected.normal_at(*wanted, position)).norm(), 1e-4);
        EXPECT_NEAR(caster.radius_m(*hit), expected.radius_m(*wanted), 1e-6);
    }
    EXPECT_GT(met, 200);
}

TEST(SphereCaster, PassesByTheSphereThatARayStartsOn) {
    const SphereSet set = set_of({{{0, 0, 0}, 1}, {{0, 0, 3}, 1}});
    SphereCaster caster;
    caster.add_set(set);
    const SphereHit own{1, 0, 0};
    EXPECT_TRUE(caster.meets({.origin_m = {0, 0, 0.5}, .direction = {0, 1, 0}}));
    EXPECT_FALSE(caster.meets({.origin_m = {0, 0, 0.5}, .direction = {0, 1, 0}}, &own));
    EXPECT_TRUE(caster.meets({.origin_m = {0, 0, 0.5}}, &own));
}

}  // namespace
}  // namespace matchlight
