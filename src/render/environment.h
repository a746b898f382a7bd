// A placed probe on the GPU: what surfaces reflect and what lights them from all around.
#pragma once

#include <cstdint>

#include "gl/objects.h"
#include "gl/program.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"

namespace matchlight {

struct EnvironmentSettings {
    /// Most texels along a face of the mirror level, a power of two, 16 to 2048. A probe that holds less (a quarter of
    /// its width is the same resolution) gets no more than it holds.
    int face_size = 512;
    int sphere_map_size = 512;  // pixels across the ball of the sphere map, 16 to 4096
    /// Lookups spent on each rough level, shared among its texels (32 to 512 each); at least 10,000.
    int lookups_per_level = 3'000'000;
    /// False: the cube and the sphere map wait for make_cube() and make_sphere_map(), for scenes that need one of them.
    bool maps_at_once = true;

    /// Throws std::invalid_argument naming the value that is out of range.
    void check() const;
};

/// The light of a probe as shaders/common/environment.glsl reads it:
/// - a cube map whose levels hold the probe under GGX lobes of growing roughness, level 0 being the mirror;
/// - irradiance by spherical harmonics to order 2;
/// - the split-sum table of the GGX surface;
/// - the same light as a mirror-ball image, for the classic sphere-map lookup.
class Environment {
public:
    /// `probe` is already placed (turned and scaled) in the scene.
    Environment(ShaderLibrary& shaders, const Probe& probe, const EnvironmentSettings& settings = {});

    /// Each draws its map the first time it is called.
    void make_cube(ShaderLibrary& shaders);
    void make_sphere_map(ShaderLibrary& shaders);

    /// Binds the textures (those that were made) to the units below and sets the uniforms of common/environment.glsl.
    void bind(Program& program) const;

    static constexpr GLuint cube_unit = 5;
    static constexpr GLuint split_sum_unit = 6;
    static constexpr GLuint sphere_map_unit = 7;

    const TextureCube& cube() const { return cube_; }
    const Texture2D& sphere_map() const { return sphere_map_; }
    const SphericalHarmonics9& spherical_harmonics() const { return sh_; }
    /// Roughness whose lobe a level of the cube map holds.
    double roughness_of_level(int level) const;
    /// Values of the probe that were beyond a half float (65504) and are taken as that.
    std::int64_t clamped_values() const { return clamped_values_; }

private:
    void draw_mirror_level(ShaderLibrary& shaders, const TextureCube& mirror) const;
    void draw_rough_levels(ShaderLibrary& shaders, const TextureCube& mirror, int lookups_per_level) const;

    EnvironmentSettings settings_;
    SphericalHarmonics9 sh_;
    Texture2D latlong_;  // what the maps are made from
    TextureCube cube_;
    Texture2D split_sum_;
    Texture2D sphere_map_;
    std::int64_t clamped_values_ = 0;
};

}  // namespace matchlight
