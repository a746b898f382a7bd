// Balls seen in parallel rays, each pixel by the light that its normal sends on.
#include "preview/probe_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "core/transfer.h"

namespace matchlight {

using Eigen::Vector3d;

namespace {

void write_pixel(Image8& picture, int x, int y, const Vector3d& light) {
    for (int c = 0; c < 3; ++c) {
        const double code = srgb_code_from_linear(std::clamp(light[c], 0.0, 1.0));
        picture.at(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * code));
    }
}

void draw_latlong(Image8& picture, const Probe& probe, double gain) {
    // Twice as wide as high, as large as fits.
    const int width = std::min(picture.width(), 2 * picture.height()), height = width / 2;
    const int left = (picture.width() - width) / 2, top = (picture.height() - height) / 2;
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            write_pixel(picture, left + x, top + y, gain * probe.radiance(latlong_direction(x, y, width, height)));
        }
    });
}

/// Light of few directions, for what is too rough to tell more.
struct CoarseLight {
    std::vector<DirectionalSample> samples;

    /// Over a lobe of cos⁴⁰ about a direction (Phong 1975, "Illumination for Computer Generated Pictures"), normalised:
    /// a highlight some twenty degrees wide.
    Vector3d over_lobe(const Vector3d& about) const {
        Vector3d sum = Vector3d::Zero();
        double weights = 0;
        for (const DirectionalSample& sample : samples) {
            const double cosine = sample.direction.dot(about);
            if (cosine <= 0) continue;
            const double to_2 = cosine * cosine, to_8 = to_2 * to_2 * to_2 * to_2;
            const double weight = to_8 * to_8 * to_8 * to_8 * to_8;
            sum += weight * sample.radiance_times_solid_angle;
            weights += weight * sample.solid_angle_sr;
        }
        return weights > 0 ? Vector3d(sum / weights) : Vector3d(Vector3d::Zero());
    }
};

/// Sums of the probe's pixels over blocks of about six degrees.
CoarseLight coarse_light_of(const Probe& probe) {
    constexpr int columns = 64, rows = columns / 2;
    const ImageF& pixels = probe.latlong;
    std::vector<DirectionalSample> blocks(static_cast<std::size_t>(columns) * rows);
    for (int y = 0; y < pixels.height(); ++y) {
        const double polar = std::numbers::pi / pixels.height();
        const double ring_sr = 2 * std::numbers::pi * (std::cos(y * polar) - std::cos((y + 1) * polar));
        const double pixel_sr = ring_sr / pixels.width();
        const std::size_t row = static_cast<std::size_t>(y) * rows / static_cast<std::size_t>(pixels.height());
        for (int x = 0; x < pixels.width(); ++x) {
            const std::size_t column = static_cast<std::size_t>(x) * columns / static_cast<std::size_t>(pixels.width());
            DirectionalSample& block = blocks[row * columns + column];
            const float* radiance = pixels.pixel(x, y);
            block.radiance_times_solid_angle += pixel_sr * Vector3d(radiance[0], radiance[1], radiance[2]);
            block.solid_angle_sr += pixel_sr;
        }
    }
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        blocks[i].direction =
            latlong_direction(static_cast<int>(i % columns), static_cast<int>(i / columns), columns, rows);
    }
    return {std::move(blocks)};
}

void draw_balls(Image8& picture, const Probe& probe, const ProbeLook& look, double gain) {
    constexpr double share = 0.45;  // of its third of the width that a ball's radius takes
    const CoarseLight coarse = coarse_light_of(probe);
    const SphericalHarmonics9 sh = project_to_sh(probe);
    const double third = picture.width() / 3.0;
    const double radius = std::min(share * third, 0.45 * picture.height());
    const Vector3d along = look.world_from_camera * Vector3d::UnitZ();
    parallel_for(picture.height(), [&](int y) {
        for (int x = 0; x < picture.width(); ++x) {
            const int ball = std::min(2, static_cast<int>((x + 0.5) / third));
            const double u = (x + 0.5 - (ball + 0.5) * third) / radius, v = (y + 0.5 - picture.height() / 2.0) / radius;
            const double inside = 1 - u * u - v * v;
            if (inside <= 0) continue;
            const Vector3d normal = look.world_from_camera * Vector3d(u, v, -std::sqrt(inside));
            const Vector3d mirrored = along - 2 * along.dot(normal) * normal;
            Vector3d light = probe.radiance(mirrored);
            if (ball == 1) light = coarse.over_lobe(mirrored);
            if (ball == 2) light = irradiance_from_sh(sh, normal).cwiseMax(0) / std::numbers::pi;
            write_pixel(picture, x, y, gain * light);
        }
    });
}

}  // namespace

Image8 probe_picture(const Probe& probe, const ProbeLook& look) {
    Image8 picture(look.width, look.height, 3);
    const double gain = std::exp2(look.exposure_ev);
    if (look.form == ProbeForm::latlong) {
        draw_latlong(picture, probe, gain);
    } else {
        draw_balls(picture, probe, look, gain);
    }
    return picture;
}

}  // namespace matchlight
