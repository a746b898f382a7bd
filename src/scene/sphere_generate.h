// Sphere sets made by rule, for comparison: the same spheres from the same seed on every machine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "scene/sphere_set.h"

namespace matchlight {

struct GeneratedSet {
    std::string_view name;
    std::uint64_t count;  // unless another is asked for
    std::string_view help;
};

/// C1 to C4: situations that a renderer of spheres meets. Each fills a cube of side 1 m around the origin, within 0.05
/// m.
std::span<const GeneratedSet> generated_sets();

struct GenerateOptions {
    std::string_view name;  // one of generated_sets()
    std::uint64_t seed = 1;
    std::optional<std::uint64_t> count;
};

/// How many spheres it will be. Throws InputError where there is no set of that name.
std::uint64_t generated_count(const GenerateOptions& options);

/// Hands the spheres over one after the other, neighbours together. Throws as generated_count() does.
void generate_spheres(const GenerateOptions& options, const std::function<void(const Sphere&)>& take);

/// The same in memory. Throws InputError where there is not enough of it.
SphereSet generate_sphere_set(const GenerateOptions& options);

}  // namespace matchlight
