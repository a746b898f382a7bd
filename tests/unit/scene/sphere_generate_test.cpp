// Generated sets: their counts, boxes and shapes, the same from the same seed, and the same again from a file.
#include "scene/sphere_generate.h"

#include "core/content_hash.h"
#include "scene/sphere_write.h"
#include "sphere_test.h"

namespace matchlight {
namespace {

using testing::HasSubstr;

std::string hash_of(const SphereSet& set) {
    ContentHash hash;
    hash.add({reinterpret_cast<const char*>(set.spheres.data()), set.size() * sizeof(Sphere)});
    return hash.hex();
}

using GeneratedSpheres = SphereFile;

TEST_F(GeneratedSpheres, HaveTheStudysCounts) {
    const std::vector<std::uint64_t> counts = {1'000'000, 2'463'048, 8'000'000, 27'000'000};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(generated_count({.name = generated_sets()[i].name, .seed = 1, .count = {}}), counts[i]);
    }
    // The two smaller ones in full.
    EXPECT_EQ(generate_sphere_set({.name = "C1", .seed = 1, .count = {}}).size(), 1'000'000u);
    EXPECT_EQ(generate_sphere_set({.name = "C2", .seed = 1, .count = {}}).size(), 2'463'048u);
    EXPECT_THROW(generated_count({.name = "C5", .seed = 1, .count = {}}), InputError);
}

TEST_F(GeneratedSpheres, FillACubeOfAMetre) {
    for (const GeneratedSet& one : generated_sets()) {
        const SphereSet set = generate_sphere_set({.name = one.name, .seed = 3, .count = 100'000});
        ASSERT_EQ(set.size(), 100'000u);
        EXPECT_LT((set.bounds_m.sizes() - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff(), 0.1) << one.name;
        EXPECT_LT(set.bounds_m.center().cwiseAbs().maxCoeff(), 0.05) << one.name;
        for (const Sphere& sphere : set.spheres) ASSERT_GT(sphere.radius_m, 0) << one.name;
    }
}

TEST_F(GeneratedSpheres, AreTheSameFromTheSameSeed) {
    // Known bytes: places are whole numbers until the last step, so that every machine has these.
    const std::vector<std::string> hashes = {"6e00c129b1025aa4", "a72bb8dc82676a0c", "7f18553430989859",
                                             "22d29256c61738e7"};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::string_view name = generated_sets()[i].name;
        const SphereSet set = generate_sphere_set({.name = name, .seed = 7, .count = 5000});
        EXPECT_EQ(hash_of(set), hashes[i]) << name;
        EXPECT_NE(hash_of(set), hash_of(generate_sphere_set({.name = name, .seed = 8, .count = 5000}))) << name;
    }
}

TEST_F(GeneratedSpheres, ClumpsTouchOrStandApart) {
    // Spheres of one clump follow one another; the first of each is its middle.
    const auto least_gap = [](const SphereSet& set, std::size_t each, std::size_t clumps) {
        double least = 1;
        for (std::size_t a = 0; a < each * clumps; ++a) {
            for (std::size_t b = a + each - a % each; b < each * clumps; ++b) {
                const Eigen::Vector3f from(set.spheres[a].centre_m.data()), to(set.spheres[b].centre_m.data());
                least = std::min(
                    least, static_cast<double>((from - to).norm() - set.spheres[a].radius_m - set.spheres[b].radius_m));
            }
        }
        return least;
    };
    EXPECT_LT(least_gap(generate_sphere_set({.name = "C2", .seed = 1, .count = 178 * 27}), 178, 9), 0);
    EXPECT_GT(least_gap(generate_sphere_set({.name = "C3", .seed = 1, .count = 30 * 64}), 30, 64), 0);
    // Within a clump neighbours overlap.
    const SphereSet one = generate_sphere_set({.name = "C3", .seed = 1, .count = 30 * 64});
    const Eigen::Vector3f middle(one.spheres[0].centre_m.data()), next(one.spheres[1].centre_m.data());
    EXPECT_LT((middle - next).norm(), 2 * one.spheres[0].radius_m);
}

TEST_F(GeneratedSpheres, ComeBackFromEveryFile) {
    SphereSet set = generate_sphere_set({.name = "C1", .seed = 5, .count = 1000});
    set.colors.assign(1000, {10, 20, 30, 255});
    set.colors[7] = {0, 255, 1, 255};
    set.opacities.assign(1000, 0.25F);
    for (const char* name : {"a.ply", "a.xyz", "a.csv"}) {
        write_sphere_set(folder_ / name, set);
        const SphereSet again = load_sphere_set(folder_ / name, {}, warnings_);
        EXPECT_EQ(hash_of(again), hash_of(set)) << name;
        EXPECT_EQ(again.colors, set.colors) << name;
        EXPECT_EQ(again.opacities, set.opacities) << name;
    }
    EXPECT_TRUE(warnings_.empty());
    EXPECT_THROW(write_sphere_set(folder_ / "a.pdb", set), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "a.pdb"));
}

}  // namespace
}  // namespace matchlight
