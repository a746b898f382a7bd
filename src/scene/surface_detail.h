// What the scene lays on an object's surface beside the model's own textures: relief, patterns, layers of pictures.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace matchlight {

/// How a height map is shown; surface/relief.glsl knows them by these numbers.
enum class ReliefMethod { bump, parallax, occlusion, relief, cone_step, sphere_tracing };

struct ReliefSettings {
    std::filesystem::path height_map;  // white is the surface itself, black the deepest
    double depth_m = 0;                // from white down to black, in the world; 0: no relief
    ReliefMethod method = ReliefMethod::relief;
    int steps = 32;

    bool operator==(const ReliefSettings&) const = default;
    bool present() const { return !height_map.empty() && depth_m > 0; }
};

/// surface/patterns.glsl knows them by these numbers.
enum class PatternKind { square_wave, checker, noise, wood, marble };
enum class PatternSpace { object, uv };

struct PatternSettings {
    PatternKind kind = PatternKind::square_wave;
    PatternSpace space = PatternSpace::object;
    std::array<double, 3> color{1, 1, 1}, second_color{0, 0, 0};  // scene-linear
    std::optional<std::array<double, 3>> middle_color;            // halfway between the two unless given
    double frequency = 8;                                         // periods a unit of the space
    std::array<double, 3> direction{1, 0,
                                    0};  // of a wave, of marble's veins' normal, of wood's trunk; any length but 0
    double share = 0.5;                  // of a wave's period that has the first colour
    int octaves = 4;
    double turbulence = 1;  // of wood and marble, in periods
    bool filtered = true;

    bool operator==(const PatternSettings&) const = default;
};

/// One picture over those before it: MT(n) = T(n)·a + MT(n−1)·(1−a).
struct PictureLayer {
    std::filesystem::path texture;
    double alpha = 1;  // times the picture's own
    double uv_scale = 1;

    bool operator==(const PictureLayer&) const = default;
};

enum class PictureFilter { nearest, linear, mipmapped };
enum class PictureWrap { repeat, clamp, mirror };

/// How the material's textures are read, in place of what the model says.
struct PictureSampling {
    std::optional<PictureFilter> filter;
    std::optional<PictureWrap> wrap;
    std::optional<int> anisotropy;

    bool operator==(const PictureSampling&) const = default;
    bool says_something() const { return filter || wrap || anisotropy; }
};

struct SurfaceDetail {
    std::filesystem::path normal_map;
    ReliefSettings relief;
    std::optional<PatternSettings> pattern;
    std::vector<PictureLayer> layers;
    PictureSampling sampling;
    double uv_scale = 1;

    bool operator==(const SurfaceDetail&) const = default;
};

}  // namespace matchlight
