// Places are whole numbers until the end, in units of 2⁻³² m: no compiler and no mathematical library rounds them
// otherwise.
#include "scene/sphere_generate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "scene/scene_schema.h"

namespace matchlight {
namespace {

constexpr std::int64_t metre = std::int64_t{1} << 32;

constexpr std::array<GeneratedSet, 4> sets = {{
    {"C1", 1'000'000, "sparse, with a clump in the centre"},
    {"C2", 2'463'048, "small clumps that touch each other"},
    {"C3", 8'000'000, "many small clumps apart from each other"},
    {"C4", 27'000'000, "one block"},
}};

using Place = std::array<std::int64_t, 3>;

float metres(std::int64_t units) {
    return static_cast<float>(static_cast<double>(units) / static_cast<double>(metre));
}

Sphere sphere_at(const Place& centre, std::int64_t radius) {
    return {{metres(centre[0]), metres(centre[1]), metres(centre[2])}, metres(radius)};
}

/// Its numbers are the standard's; what is made of them is ours.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    /// From −reach to reach.
    std::int64_t within(std::int64_t reach) {
        const auto top = static_cast<std::int64_t>(engine_() >> 40);  // 24 bits
        return (2 * top - (1 << 24)) * (reach >> 8) / (1 << 16);
    }
    Place place_within(std::int64_t reach) {
        const std::int64_t x = within(reach), y = within(reach);
        return {x, y, within(reach)};
    }

private:
    std::mt19937_64 engine_;
};

/// The most cells along a side so that each of the cube's gets at least `each` spheres.
std::int64_t cells_along(std::uint64_t count, std::uint64_t each) {
    std::int64_t side = 1;
    while (static_cast<std::uint64_t>((side + 1) * (side + 1) * (side + 1)) * each <= count) ++side;
    return side;
}

std::int64_t squared(const Place& place) {
    return place[0] * place[0] + place[1] * place[1] + place[2] * place[2];
}

/// The `count` points of a cubic lattice that are nearest to the origin.
std::vector<Place> lattice_ball(std::uint64_t count) {
    std::int64_t reach = 1;
    // A ball of radius `reach` holds more points than the cube inside it.
    while (static_cast<std::uint64_t>(reach * reach * reach) < count) ++reach;
    std::vector<Place> points;
    for (std::int64_t z = -reach; z <= reach; ++z) {
        for (std::int64_t y = -reach; y <= reach; ++y) {
            for (std::int64_t x = -reach; x <= reach; ++x) points.push_back({x, y, z});
        }
    }
    std::sort(points.begin(), points.end(), [](const Place& a, const Place& b) {
        return std::make_tuple(squared(a), a) < std::make_tuple(squared(b), b);
    });
    points.resize(count);
    return points;
}

/// Lattice neighbours overlap by a tenth of their distance.
constexpr double radius_of_spacing = 0.55;

struct ClumpShape {
    std::uint64_t each;      // spheres in a clump, at least
    double reach_of_cell;    // from a clump's middle to its farthest point
    std::int64_t loosening;  // middles are shifted by up to a cell over this
};

void generate_clumps(std::uint64_t count, const ClumpShape& shape, Random& random,
                     const std::function<void(const Sphere&)>& take) {
    const std::int64_t side = cells_along(count, shape.each);
    const auto cells = static_cast<std::uint64_t>(side * side * side);
    const std::int64_t cell = metre / side;
    const std::vector<Place> ball = lattice_ball(count / cells + 1);
    const double farthest = std::sqrt(static_cast<double>(squared(ball.back()))) + radius_of_spacing;
    const auto spacing = static_cast<std::int64_t>(static_cast<double>(cell) * shape.reach_of_cell / farthest);
    const auto radius = static_cast<std::int64_t>(static_cast<double>(spacing) * radius_of_spacing);
    for (std::uint64_t c = 0; c < cells; ++c) {
        const auto index = static_cast<std::int64_t>(c);
        const Place corner{index % side, index / side % side, index / (side * side)};
        const Place shift = random.place_within(cell / shape.loosening);
        const std::uint64_t in_clump = count / cells + (c < count % cells ? 1 : 0);
        for (std::uint64_t i = 0; i < in_clump; ++i) {
            Place centre{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                centre[axis] = (2 * corner[axis] + 1) * cell / 2 - metre / 2 + shift[axis] + ball[i][axis] * spacing;
            }
            take(sphere_at(centre, radius));
        }
    }
}

/// A fifth of the spheres is in the clump, whose density falls off from the middle as a normal distribution's does.
void generate_sparse(std::uint64_t count, Random& random, const std::function<void(const Sphere&)>& take) {
    const std::uint64_t in_clump = count / 5;
    for (std::uint64_t i = 0; i < count; ++i) {
        Place centre = random.place_within(metre / 2);
        if (i < in_clump) {
            // The sum of uniform numbers: σ is half a metre over 6 times the root of 4/3, 0.096 m.
            for (int more = 1; more < 4; ++more) {
                const Place next = random.place_within(metre / 2);
                for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] += next[axis];
            }
            for (std::int64_t& coordinate : centre) coordinate /= 6;
        }
        const std::int64_t radius = metre / 1500;
        take(sphere_at(centre, radius + random.within(radius / 2)));
    }
}

/// A lattice whose points are a little off their places, so that no two rows look alike.
void generate_block(std::uint64_t count, Random& random, const std::function<void(const Sphere&)>& take) {
    std::int64_t side = cells_along(count, 1);
    if (static_cast<std::uint64_t>(side * side * side) < count) ++side;
    const std::int64_t cell = metre / side;
    const auto radius = static_cast<std::int64_t>(static_cast<double>(cell) * radius_of_spacing);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto index = static_cast<std::int64_t>(i);
        const Place corner{index % side, index / side % side, index / (side * side)};
        const Place shift = random.place_within(cell / 20);
        Place centre{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            centre[axis] = (2 * corner[axis] + 1) * cell / 2 - metre / 2 + shift[axis];
        }
        take(sphere_at(centre, radius));
    }
}

const GeneratedSet& set_named(std::string_view name) {
    std::vector<std::string_view> known;
    for (const GeneratedSet& set : sets) {
        if (set.name == name) return set;
        known.push_back(set.name);
    }
    throw InputError({}, fmt::format("there is no set '{}' to generate", name),
                     fmt::format("did you mean '{}'?", nearest_word(name, known)));
}

}  // namespace

std::span<const GeneratedSet> generated_sets() {
    return sets;
}

std::uint64_t generated_count(const GenerateOptions& options) {
    return options.count.value_or(set_named(options.name).count);
}

void generate_spheres(const GenerateOptions& options, const std::function<void(const Sphere&)>& take) {
    const std::uint64_t count = generated_count(options);
    if (count == 0) return;
    Random random(options.seed);
    // At their own counts: 24³ clumps of 178 spheres, 64³ of 30.
    if (options.name == "C1") return generate_sparse(count, random, take);
    if (options.name == "C2") {
        return generate_clumps(count, {.each = 178, .reach_of_cell = 0.6, .loosening = 32}, random, take);
    }
    if (options.name == "C3") {
        return generate_clumps(count, {.each = 30, .reach_of_cell = 0.37, .loosening = 10}, random, take);
    }
    generate_block(count, random, take);
}

SphereSet generate_sphere_set(const GenerateOptions& options) {
    const std::uint64_t count = generated_count(options);
    const std::uint64_t available = available_memory_bytes();
    if (count > available / sizeof(Sphere)) {
        throw InputError(
            {}, fmt::format("{} spheres need {:.1f} GB of memory, and there are {:.1f} GB", count,
                            static_cast<double>(count) * sizeof(Sphere) * 1e-9, static_cast<double>(available) * 1e-9));
    }
    SphereSet set;
    set.name = options.name;
    set.spheres.reserve(count);
    generate_spheres(options, [&](const Sphere& sphere) { set.spheres.push_back(sphere); });
    set.update_bounds();
    return set;
}

}  // namespace matchlight
