// Turns a lat-long probe into prefiltered cube levels, spherical harmonics and a sphere map.
#include "render/environment.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"
#include "render/split_sum.h"

namespace matchlight {

namespace {

constexpr float largest_half = 65504;

// Each level back from the last multiplies roughness by this, alpha by its square: with faces that double, every lobe
// then spans about two texels to half its height, wide enough for linear filtering to follow it.
constexpr double roughness_ratio = 0.66;
constexpr int last_face_size = 4;  // of roughness 1

// Directions averaged for a texel of a rough level: the coarse levels, whose lobes are wide and whose texels are few,
// get the most.
constexpr int least_lobe_samples = 32;
constexpr int most_lobe_samples = 512;

int face_size_for(const Probe& probe, const EnvironmentSettings& settings) {
    constexpr int least = 64;  // for the rough levels, whatever the probe
    const auto held = static_cast<int>(std::bit_ceil(static_cast<unsigned>(probe.latlong.width() / 4)));
    return std::min(std::max(held, least), settings.face_size);
}

int level_count(int face_size) {
    return std::bit_width(static_cast<unsigned>(face_size / last_face_size));
}

/// Half the size, each pixel the mean of four weighted by the solid angles of their rows.
ImageF reduced(const ImageF& image) {
    ImageF half(image.width() / 2, image.height() / 2, 3);
    for (int y = 0; y < half.height(); ++y) {
        const double step = std::numbers::pi / image.height();
        const double upper = std::cos(2 * y * step) - std::cos((2 * y + 1) * step);
        const double lower = std::cos((2 * y + 1) * step) - std::cos((2 * y + 2) * step);
        const auto w0 = static_cast<float>(upper / (2 * (upper + lower)));
        const auto w1 = static_cast<float>(lower / (2 * (upper + lower)));
        for (int x = 0; x < half.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                half.at(x, y, c) = w0 * (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c)) +
                                   w1 * (image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c));
            }
        }
    }
    return half;
}

/// Directions of a GGX lobe about its axis z, by equal shares of probability, with the mip level of `mirror` whose
/// texels are as wide as the share (w).
std::vector<Eigen::Vector4f> lobe_directions(double roughness, int count, int mirror_face_size) {
    const double alpha2 = std::pow(roughness, 4);
    // At the middle of a face; the shader takes the place on the face into account.
    const double texel_solid_angle = 4.0 / mirror_face_size / mirror_face_size;
    // Lookups a little wider than their shares overlap, so that a small light does not show the pattern of the samples.
    // Křivánek & Colbert (2008, section 3) double the width; with as many samples as here half of that (in levels)
    // does, and keeps the lobe's shape to 3 % where doubling costs 5 % (against sums over all pixels).
    constexpr double overlap_levels = 0.5;
    std::vector<Eigen::Vector4f> directions;
    for (int i = 0; i < count; ++i) {
        const double u = (i + 0.5) / count;
        // The golden angle spreads the azimuths evenly at every radius.
        const double azimuth = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
        const double cosine2 = (1 - u) / (1 + (alpha2 - 1) * u);
        const double light_z = 2 * cosine2 - 1;  // the half vector reflects the axis to twice its angle
        if (light_z <= 0) continue;
        const double light_xy = std::sqrt(std::max(0.0, 1 - light_z * light_z));
        const double base = cosine2 * (alpha2 - 1) + 1;
        const double density = alpha2 / (std::numbers::pi * base * base) / 4;  // D(h)·(n·h)/(4 v·h), and n·h = v·h
        const double share = 1 / (count * density);
        const double level = 0.5 * std::log2(share / texel_solid_angle) + overlap_levels;
        directions.emplace_back(static_cast<float>(light_xy * std::cos(azimuth)),
                                static_cast<float>(light_xy * std::sin(azimuth)), static_cast<float>(light_z),
                                static_cast<float>(level));
    }
    return directions;
}

/// Factors of the polynomial in common/environment.glsl: the coefficients of radiance times those of the clamped cosine
/// (π, 2π/3, π/4 by order: Ramamoorthi & Hanrahan 2001, equation 8) and the constants of the real harmonics.
std::array<Eigen::Vector3f, 9> irradiance_terms(const SphericalHarmonics9& sh) {
    constexpr double pi = std::numbers::pi;
    const double order_0 = pi * 0.5 * std::sqrt(1 / pi);
    const double order_1 = 2 * pi / 3 * std::sqrt(3 / (4 * pi));
    const double order_2 = pi / 4 * 0.5 * std::sqrt(15 / pi);
    const double order_2_axial = pi / 4 * 0.25 * std::sqrt(5 / pi);
    const std::array<double, 9> factors = {order_0, order_1,       order_1, order_1,    order_2,
                                           order_2, order_2_axial, order_2, order_2 / 2};
    std::array<Eigen::Vector3f, 9> terms;
    for (std::size_t i = 0; i < terms.size(); ++i) terms[i] = (factors[i] * sh[i]).cast<float>();
    return terms;
}

}  // namespace

void EnvironmentSettings::check() const {
    const auto require = [](bool fine, const char* name, int value) {
        if (!fine) throw std::invalid_argument(fmt::format("environment: {} cannot be {}", name, value));
    };
    const bool power = std::has_single_bit(static_cast<unsigned>(std::max(face_size, 0)));
    require(power && face_size >= 16 && face_size <= 2048, "face_size", face_size);
    require(sphere_map_size >= 16 && sphere_map_size <= 4096, "sphere_map_size", sphere_map_size);
    require(lookups_per_level >= 10'000, "lookups_per_level", lookups_per_level);
}

Environment::Environment(ShaderLibrary& shaders, const Probe& probe, const EnvironmentSettings& settings)
    : settings_(settings), sh_(project_to_sh(probe)) {
    settings.check();
    settings_.face_size = face_size_for(probe, settings);
    ImageF image = probe.latlong;
    // A lat-long image of width 4·face has the cube's resolution at the horizon; twice that is all that can be seen.
    const int widest = 8 * settings_.face_size;
    while (image.width() > widest && image.width() % 2 == 0 && image.height() % 2 == 0) image = reduced(image);
    for (float& value : image.samples()) {
        if (value > largest_half) {
            value = largest_half;
            ++clamped_values_;
        }
    }
    latlong_ = Texture2D({.format = GL_RGBA32F, .width = image.width(), .height = image.height()});
    latlong_.upload(image);
    latlong_.set_filter(Filter::linear);
    latlong_.set_wrap(Wrap::repeat, Wrap::clamp_to_edge);

    // 64² texels and 128 visible normals: within 2e-3 of the integral where roughness is above 0.1.
    constexpr int table_size = 64, table_samples = 128;
    static const ImageF table = split_sum_table(table_size, table_samples);
    split_sum_ = Texture2D({.format = GL_RG32F, .width = table_size, .height = table_size});
    split_sum_.upload(table);
    split_sum_.set_filter(Filter::linear);
    if (!settings.maps_at_once) return;
    make_cube(shaders);
    make_sphere_map(shaders);
}

void Environment::make_cube(ShaderLibrary& shaders) {
    if (cube_) return;
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    const int face_size = settings_.face_size;
    // The source of the lobes: box-filtered mip levels down to one texel.
    TextureCube mirror(GL_RGBA32F, face_size, std::bit_width(static_cast<unsigned>(face_size)));
    draw_mirror_level(shaders, mirror);
    mirror.make_mipmaps();

    cube_ = TextureCube(GL_RGBA16F, face_size, level_count(face_size));
    for (int face = 0; face < 6; ++face) {
        const Framebuffer from({Attachment(mirror, 0, face)});
        from.resolve_color_to(Framebuffer({Attachment(cube_, 0, face)}), from.bounds());
    }
    draw_rough_levels(shaders, mirror, settings_.lookups_per_level);
}

void Environment::make_sphere_map(ShaderLibrary& shaders) {
    if (sphere_map_) return;
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    const int size = settings_.sphere_map_size;
    sphere_map_ = Texture2D({.format = GL_RGBA16F, .width = size, .height = size, .levels = 0});
    Program& program = shaders.full_screen("surface/environment_sphere_map.frag");
    latlong_.bind(0);
    program.use();
    const Framebuffer target({sphere_map_});
    target.bind();
    FullScreenTriangle().draw();
    sphere_map_.make_mipmaps();
    sphere_map_.set_filter(Filter::trilinear);
}

void Environment::draw_mirror_level(ShaderLibrary& shaders, const TextureCube& mirror) const {
    // Two samples for each lat-long pixel under a texel, and at least three, keep the energy of lights of one pixel to
    // a tenth; with two across it is a seventh.
    const double pixels_a_texel = latlong_.height() / (2.0 * mirror.face_size());
    const int samples_across = std::clamp(static_cast<int>(std::ceil(2 * pixels_a_texel)), 3, 8);
    Program& program = shaders.full_screen("surface/environment_cube.frag");
    program.use();
    program.set("samples_across", samples_across);
    latlong_.bind(0);
    const FullScreenTriangle triangle;
    for (int face = 0; face < 6; ++face) {
        const Framebuffer target({Attachment(mirror, 0, face)});
        target.bind();
        program.set("face", face);
        triangle.draw();
    }
}

void Environment::draw_rough_levels(ShaderLibrary& shaders, const TextureCube& mirror, int lookups_per_level) const {
    Program& program = shaders.full_screen("surface/environment_prefilter.frag",
                                           {{"MOST_SAMPLES", std::to_string(most_lobe_samples)}});
    program.use();
    mirror.bind(0);
    const FullScreenTriangle triangle;
    for (int level = 1; level < cube_.levels(); ++level) {
        const int texels = 6 * cube_.face_size(level) * cube_.face_size(level);
        const int count = std::clamp(lookups_per_level / texels, least_lobe_samples, most_lobe_samples);
        const auto lobe = lobe_directions(roughness_of_level(level), count, mirror.face_size());
        program.set("sample_count", static_cast<int>(lobe.size()));
        program.set("lobe", std::span<const Eigen::Vector4f>(lobe));
        for (int face = 0; face < 6; ++face) {
            const Framebuffer target({Attachment(cube_, level, face)});
            target.bind();
            program.set("face", face);
            triangle.draw();
        }
    }
}

double Environment::roughness_of_level(int level) const {
    return level == 0 ? 0 : std::pow(roughness_ratio, cube_.levels() - 1 - level);
}

void Environment::bind(Program& program) const {
    cube_.bind(cube_unit);
    split_sum_.bind(split_sum_unit);
    sphere_map_.bind(sphere_map_unit);
    if (cube_) program.set("last_level", cube_.levels() - 1.0);
    program.set("levels_per_octave", 1 / std::log2(1 / roughness_ratio));
    if (cube_) program.set("first_roughness", roughness_of_level(1));
    const auto terms = irradiance_terms(sh_);
    program.set("irradiance_terms", std::span<const Eigen::Vector3f>(terms));
}

}  // namespace matchlight
