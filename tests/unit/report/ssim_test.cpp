// SSIM against the formula written out, window by window.
#include "report/ssim.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "picture.h"

namespace matchlight {
namespace {

using test::flat_picture;
using test::noise_picture;

double luma(const Image8& image, int x, int y) {
    return 0.299 * image.at(x, y, 0) + 0.587 * image.at(x, y, 1) + 0.114 * image.at(x, y, 2);
}

/// Wang et al. 2004, eqs. 13 to 17, with central moments, for the window around (cx, cy).
double ssim_at(const Image8& p, const Image8& q, int cx, int cy) {
    double weight[11][11], total = 0;
    for (int j = 0; j < 11; ++j) {
        for (int i = 0; i < 11; ++i) {
            weight[j][i] = std::exp(-((i - 5) * (i - 5) + (j - 5) * (j - 5)) / (2 * 1.5 * 1.5));
            total += weight[j][i];
        }
    }
    double mean_p = 0, mean_q = 0;
    for (int j = 0; j < 11; ++j) {
        for (int i = 0; i < 11; ++i) {
            weight[j][i] /= total;
            mean_p += weight[j][i] * luma(p, cx + i - 5, cy + j - 5);
            mean_q += weight[j][i] * luma(q, cx + i - 5, cy + j - 5);
        }
    }
    double variance_p = 0, variance_q = 0, covariance = 0;
    for (int j = 0; j < 11; ++j) {
        for (int i = 0; i < 11; ++i) {
            const double dp = luma(p, cx + i - 5, cy + j - 5) - mean_p, dq = luma(q, cx + i - 5, cy + j - 5) - mean_q;
            variance_p += weight[j][i] * dp * dp;
            variance_q += weight[j][i] * dq * dq;
            covariance += weight[j][i] * dp * dq;
        }
    }
    const double c1 = 6.5025, c2 = 58.5225;
    return (2 * mean_p * mean_q + c1) * (2 * covariance + c2) /
           ((mean_p * mean_p + mean_q * mean_q + c1) * (variance_p + variance_q + c2));
}

TEST(Ssim, EqualsTheFormulaWrittenOut) {
    const Image8 p = noise_picture(47, 80, 11);
    Image8 q = noise_picture(47, 80, 12);
    for (std::size_t i = 0; i < q.samples().size(); ++i) {
        q.samples()[i] = static_cast<std::uint8_t>((3 * p.samples()[i] + q.samples()[i]) / 4);
    }
    Image8 mask(47, 80, 1);
    double sum = 0, masked_sum = 0;
    int count = 0, masked_count = 0;
    for (int y = 5; y < 75; ++y) {
        for (int x = 5; x < 42; ++x) {
            const double value = ssim_at(p, q, x, y);
            sum += value;
            ++count;
            if ((x * 7 + y * 3) % 5 == 0) {
                mask.at(x, y) = 255;
                masked_sum += value;
                ++masked_count;
            }
        }
    }
    EXPECT_NEAR(ssim(p, q).value(), sum / count, 1e-10);  // E[x²] − E[x]² loses five digits of sixteen
    EXPECT_NEAR(ssim(p, q, &mask).value(), masked_sum / masked_count, 1e-10);
}

TEST(Ssim, KnownValues) {
    const Image8 noise = noise_picture(40, 30, 5);
    EXPECT_NEAR(ssim(noise, noise).value(), 1, 1e-12);
    // Flat pictures have only the term of the means.
    const double expected = (2 * 100.0 * 150 + 6.5025) / (100.0 * 100 + 150 * 150 + 6.5025);
    EXPECT_NEAR(ssim(flat_picture(20, 20, 100, 100, 100), flat_picture(20, 20, 150, 150, 150)).value(), expected, 1e-9);
}

TEST(Ssim, NeedsRoomForItsWindow) {
    const Image8 small = flat_picture(10, 40, 1, 2, 3);
    EXPECT_FALSE(ssim(small, small).has_value());
    const Image8 just = flat_picture(11, 11, 1, 2, 3);
    EXPECT_NEAR(ssim(just, just).value(), 1, 1e-12);
}

}  // namespace
}  // namespace matchlight
