// Tags drawn into probes.
#include "tracking/probe_card.h"

#include <gtest/gtest.h>

namespace matchlight {
namespace {

constexpr double size_m = 0.08;
constexpr std::array<double, 3> paper{1.8, 1.5, 1.1}, ink{0.1, 0.08, 0.07};

/// What a probe at `place_m` sees: a sky of one half, and below it a grey floor with one tag at `world_from_tag`.
Probe probe_over(const TagPattern& pattern, const RigidTransform& world_from_tag, const Eigen::Vector3d& place_m) {
    Probe probe;
    constexpr int height = 512;
    probe.latlong = ImageF(2 * height, height, 3);
    const RigidTransform tag_from_world = world_from_tag.inverse();
    const double cell_m = size_m / (pattern.border_end - pattern.border_begin);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Eigen::Vector3d direction = tag_from_world.linear() * latlong_direction(x, y, 2 * height, height);
            const Eigen::Vector3d from = tag_from_world * place_m;
            std::array<double, 3> light{0.5, 0.5, 0.5};
            if (direction.z() < 0) {
                const Eigen::Vector3d hit = from - direction * (from.z() / direction.z());
                const double a = hit.x() / cell_m + 0.5 * pattern.cells, b = 0.5 * pattern.cells - hit.y() / cell_m;
                const bool on_tag = a >= 0 && b >= 0 && a < pattern.cells && b < pattern.cells;
                if (!on_tag) {
                    light = {0.4, 0.3, 0.2};
                } else {
                    light = pattern.at(static_cast<int>(a), static_cast<int>(b)) == TagPattern::white ? paper : ink;
                }
            }
            for (int c = 0; c < 3; ++c) {
                probe.latlong.at(x, y, c) = static_cast<float>(light[static_cast<std::size_t>(c)]);
            }
        }
    }
    return probe;
}

RigidTransform turned(double x_m, double y_m, double angle_rad) {
    RigidTransform place = RigidTransform::Identity();
    place.translation() << x_m, y_m, 0.001;
    place.linear() = Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return place;
}

TEST(ProbeCard, ReadsATagBelowTheProbe) {
    const TagPattern pattern = TagFamily("tag36h11").pattern(0);
    const Eigen::Vector3d probe_place_m(0, 0.02, 0.05);
    const RigidTransform place = turned(0.01, 0.01, 0.7);
    const Probe probe = probe_over(pattern, place, probe_place_m);
    const auto difference = card_in_probe(probe, probe_place_m, pattern, {size_m, place});
    ASSERT_TRUE(difference);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR((*difference)[c], paper[c] - ink[c], 0.01 * paper[c]);
}

TEST(ProbeCard, BelievesOnlyATagThatIsThere) {
    const TagPattern pattern = TagFamily("tag36h11").pattern(0);
    const Eigen::Vector3d probe_place_m(0, 0.02, 0.05);
    const Probe probe = probe_over(pattern, turned(0, 0, 0), probe_place_m);
    EXPECT_TRUE(card_in_probe(probe, probe_place_m, pattern, {size_m, turned(0, 0, 0)}));
    EXPECT_FALSE(card_in_probe(probe, probe_place_m, TagFamily("tag36h11").pattern(7), {size_m, turned(0, 0, 0)}));
    EXPECT_FALSE(card_in_probe(probe, probe_place_m, pattern, {size_m, turned(0.02, 0.01, 0)}));  // elsewhere
    EXPECT_FALSE(card_in_probe(probe, probe_place_m, pattern, {size_m, turned(0.5, 0, 0)}));      // seen too flat
}

}  // namespace
}  // namespace matchlight
