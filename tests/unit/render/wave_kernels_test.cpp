// Kernels of diffraction and of the halo against what is known of them in closed form.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "render/effects/diffraction.h"
#include "render/effects/halo.h"
#include "render/effects/spectral_color.h"

namespace matchlight {
namespace {

using std::numbers::pi;

Eigen::Vector3d sum_of(const Image<double>& kernel) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) sum[c] += kernel.at(x, y, c);
        }
    }
    return sum;
}

/// Mean distance of a channel's light from the middle, in texels.
double mean_distance(const Image<double>& kernel, int channel) {
    const int radius = kernel.width() / 2;
    double sum = 0;
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            sum += kernel.at(x, y, channel) * std::hypot(x - radius, y - radius);
        }
    }
    return sum;
}

/// Directions in which a ring's green light has a peak above three times its mean.
int streaks_of(const Image<double>& kernel, double radius_texels) {
    constexpr int directions = 720;
    const int middle = kernel.width() / 2;
    std::vector<double> light(directions);
    for (int i = 0; i < directions; ++i) {
        // Along a part of the ray, so that rings across it even out.
        for (double r = 0.8; r < 1.2; r += 0.01) {
            const double angle = 2 * pi * i / directions;
            const int x = middle + static_cast<int>(std::lround(r * radius_texels * std::cos(angle)));
            const int y = middle - static_cast<int>(std::lround(r * radius_texels * std::sin(angle)));
            light[static_cast<std::size_t>(i)] += kernel.at(x, y, 1);
        }
    }
    double mean = 0;
    for (const double value : light) mean += value / directions;
    // Each run of directions above the limit is a streak; a run may span the first direction.
    int streaks = 0;
    for (int i = 0; i < directions; ++i) {
        const double before = light[static_cast<std::size_t>((i + directions - 1) % directions)];
        if (light[static_cast<std::size_t>(i)] > 3 * mean && before <= 3 * mean) ++streaks;
    }
    return streaks;
}

TEST(SpectralColor, FollowsTheStandardObserver) {
    // CIE 1931 2° tables at 555 nm: X 0.5121, Y 1.0000, Z 0.0057; the fit's own error is below 0.02.
    const Eigen::Vector3d color = spectral_color_rec709(555);
    EXPECT_NEAR(0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2], 1.0, 0.02);
    EXPECT_GT(spectral_color_rec709(620)[0], 10 * std::abs(spectral_color_rec709(620)[2]));
    EXPECT_GT(spectral_color_rec709(450)[2], 5 * std::abs(spectral_color_rec709(450)[1]));
    Eigen::Vector3d white = Eigen::Vector3d::Zero();
    for (const SpectralSample& sample : white_spectrum(16)) white += sample.color_rec709;
    EXPECT_NEAR((white - Eigen::Vector3d::Ones()).norm(), 0, 1e-12);
}

TEST(DiffractionKernel, HoldsUnitEnergyAndIsPointSymmetric) {
    for (const int scale : {1, 2, 4, 16}) {
        ApertureSettings aperture{.blades = 5, .rotation_deg = 20, .eyelashes = 10, .dust = 10};
        const Image<double> kernel = make_diffraction_kernel(aperture, 70, {.scale = scale}, {.aperture_side = 512});
        EXPECT_NEAR((sum_of(kernel) - Eigen::Vector3d::Ones()).norm(), 0, 1e-12) << scale;
        EXPECT_EQ(kernel.width() % 2, 1);
        const int last = kernel.width() - 1;
        for (int y = 0; y <= last; ++y) {
            for (int x = 0; x <= last; ++x) {
                ASSERT_EQ(kernel.at(x, y, 1), kernel.at(last - x, last - y, 1));
                ASSERT_GE(kernel.at(x, y, 0), 0);
            }
        }
    }
}

TEST(DiffractionKernel, EvenBladesMakeAsManyStreaksOddOnesTwice) {
    for (const auto& [blades, streaks] : {std::pair{4, 4}, {5, 10}, {6, 6}, {7, 14}, {8, 8}, {3, 6}}) {
        const ApertureSettings aperture{.blades = blades, .rotation_deg = 10};
        const Image<double> kernel = make_diffraction_kernel(aperture, 100, {});
        EXPECT_EQ(streaks_of(kernel, 50), streaks) << blades;
    }
}

TEST(DiffractionKernel, StreaksRunAcrossTheBladesEdges) {
    // A square whose edges face 30°, 120°, …: light goes there, and not in between.
    const ApertureSettings aperture{.blades = 4, .rotation_deg = 30};
    const Image<double> kernel = make_diffraction_kernel(aperture, 100, {});
    const auto along = [&](double angle_deg) {
        const double angle = angle_deg * pi / 180;
        double sum = 0;
        for (int r = 20; r < 60; ++r) {
            sum += kernel.at(100 + static_cast<int>(std::lround(r * std::cos(angle))),
                             100 - static_cast<int>(std::lround(r * std::sin(angle))), 1);
        }
        return sum;
    };
    EXPECT_GT(along(30), 20 * along(75));
    EXPECT_GT(along(120), 20 * along(165));
}

TEST(DiffractionKernel, IsWiderInRedThanInBlue) {
    const Image<double> kernel = make_diffraction_kernel({.blades = 0}, 100, {});
    EXPECT_GT(mean_distance(kernel, 0), 1.1 * mean_distance(kernel, 1));
    EXPECT_GT(mean_distance(kernel, 1), 1.1 * mean_distance(kernel, 2));
}

TEST(DiffractionKernel, IsAirysPatternForARoundAperture) {
    constexpr double reach_px = 96;
    const DiffractionQuality quality{.aperture_side = 1024, .wavelengths = 8, .samples = 2};
    const Image<double> kernel = make_diffraction_kernel({.blades = 0}, reach_px, {}, quality);
    // Airy 1835: (2 J1(x) / x)², first dark at x = 3.8317; its first bright ring has 0.0175.
    const double ring_px = reach_px / reach_in_airy_radii;
    const auto airy = [](double x) {
        return x < 1e-9 ? 0.0175 : std::min(0.0175, std::pow(2 * std::cyl_bessel_j(1, x) / x, 2));
    };
    const int radius = kernel.width() / 2;
    Image<double> expected(kernel.width(), kernel.height(), 3);
    const auto spectrum = white_spectrum(quality.wavelengths);
    constexpr int points = 4;
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int i = 0; i < points * points; ++i) {
                const int column = i % points, row = i / points;
                const double distance =
                    std::hypot(x - radius + (column + 0.5) / points - 0.5, y - radius + (row + 0.5) / points - 0.5);
                const double outer = std::clamp(4 * distance / reach_px - 3, 0.0, 1.0);
                for (const SpectralSample& sample : spectrum) {
                    const double narrowed = 550 / sample.wavelength_nm;
                    sum += sample.color_rec709 * airy(3.8317 * distance / ring_px * narrowed) * narrowed * narrowed *
                           (0.5 + 0.5 * std::cos(pi * outer));
                }
            }
            for (int c = 0; c < 3; ++c) expected.at(x, y, c) = std::max(sum[c], 0.0);
        }
    }
    const Eigen::Vector3d total = sum_of(expected);
    double error = 0, light = 0, far_error = 0, far_light = 0;
    for (int y = 0; y < kernel.height(); ++y) {
        for (int x = 0; x < kernel.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double truth = expected.at(x, y, c) / total[c];
                const double off = kernel.at(x, y, c) - truth;
                error += off * off;
                light += truth * truth;
                if (std::hypot(x - radius, y - radius) < 8 * ring_px) continue;
                far_error += off * off;
                far_light += truth * truth;
            }
        }
    }
    // Splines between samples of the spectrum, and how finely each gathers a pixel.
    EXPECT_LT(std::sqrt(error / light), 0.02);
    EXPECT_LT(std::sqrt(far_error / far_light), 0.05);
}

TEST(DiffractionKernel, HasItsTrueSizeWhereTheLensIsKnown) {
    // 1.22 · 0.55 µm · 16 over 5 µm.
    EXPECT_NEAR(airy_radius_px(16, 5), 2.147, 0.001);
    GlareSettings settings;
    EXPECT_DOUBLE_EQ(diffraction_reach_px(settings, 1080), 270);
    settings.aperture.f_number = 16;
    EXPECT_DOUBLE_EQ(diffraction_reach_px(settings, 1080), 270);
    settings.aperture.pixel_pitch_um = 5;
    EXPECT_NEAR(diffraction_reach_px(settings, 1080), 32 * 2.147, 0.05);
}

TEST(HaloKernel, HoldsUnitEnergyInRingsOfItsRadii) {
    constexpr double focal_px = 600;
    const Image<double> kernel = make_halo_kernel(focal_px, {});
    EXPECT_NEAR((sum_of(kernel) - Eigen::Vector3d::Ones()).norm(), 0, 1e-12);
    // Spencer et al.: 3° at 568 nm, in proportion to the wavelength. The channels' own middles are near 610, 545 and
    // 450 nm.
    const auto brightest_deg = [&](int channel) {
        const int middle = kernel.width() / 2;
        int best = 0;
        for (int r = 1; r <= middle; ++r) {
            if (kernel.at(middle + r, middle, channel) > kernel.at(middle + best, middle, channel)) best = r;
        }
        return std::atan(best / focal_px) * 180 / pi;
    };
    EXPECT_NEAR(brightest_deg(0), 3.0 * 605 / 568, 0.15);
    EXPECT_NEAR(brightest_deg(1), 3.0 * 540 / 568, 0.15);
    EXPECT_NEAR(brightest_deg(2), 3.0 * 450 / 568, 0.15);
    EXPECT_EQ(kernel.at(0, 0, 0), 0);
}

TEST(HaloKernel, KeepsItsEnergyWhereTheFrameDoesNotHoldIt) {
    const Image<double> whole = make_halo_kernel(900, {.scale = 2});
    const Image<double> cut = make_halo_kernel(900, {.scale = 2, .most_radius = 30});
    ASSERT_EQ(cut.width(), 61);
    const int offset = whole.width() / 2 - 30;
    for (int i = 0; i < 61; ++i) {
        // The total is summed at a coarser scale: 1 %.
        EXPECT_NEAR(cut.at(i, 30, 1), whole.at(offset + i, offset + 30, 1),
                    0.01 * whole.at(offset + i, offset + 30, 1));
    }
}

TEST(Kernels, StandExtremes) {
    // Frames of a pixel and lenses of a kilometre: finite, no energy made.
    for (const double reach_px : {1e-3, 0.25, 1.0, 1e5}) {
        const Image<double> kernel =
            make_diffraction_kernel({}, reach_px, {.scale = 1, .most_radius = 40}, {.aperture_side = 256});
        EXPECT_LE(sum_of(kernel).maxCoeff(), 1 + 1e-9) << reach_px;
        EXPECT_GT(sum_of(kernel).minCoeff(), 0) << reach_px;
    }
    for (const double focal_px : {1e-3, 1.0, 1e6}) {
        const Image<double> kernel = make_halo_kernel(focal_px, {.scale = 4, .most_radius = 40});
        EXPECT_LE(sum_of(kernel).maxCoeff(), 1 + 1e-9) << focal_px;
        EXPECT_GE(sum_of(kernel).minCoeff(), 0) << focal_px;
    }
}

}  // namespace
}  // namespace matchlight
