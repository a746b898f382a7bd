// SSIM with a separable window; rows in parallel, sums in a fixed order.
#include "report/ssim.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace matchlight {
namespace {

constexpr double window_deviation_px = 1.5;
constexpr double stabilizer_mean = (0.01 * 255) * (0.01 * 255);      // C1 = (K1·L)²
constexpr double stabilizer_variance = (0.03 * 255) * (0.03 * 255);  // C2 = (K2·L)²

std::array<double, ssim_window_px> make_window() {
    std::array<double, ssim_window_px> window{};
    double sum = 0;
    for (int i = 0; i < ssim_window_px; ++i) {
        const int offset = i - ssim_window_px / 2;
        window[static_cast<std::size_t>(i)] =
            std::exp(-offset * offset / (2 * window_deviation_px * window_deviation_px));
        sum += window[static_cast<std::size_t>(i)];
    }
    for (double& weight : window) weight /= sum;
    return window;
}

std::vector<double> luma_rows(const Image8& image, int first_row, int rows) {
    std::vector<double> luma;
    luma.reserve(static_cast<std::size_t>(rows) * static_cast<std::size_t>(image.width()));
    for (int y = first_row; y < first_row + rows; ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const std::uint8_t* p = image.pixel(x, y);
            luma.push_back(0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2]);
        }
    }
    return luma;
}

/// Weighted sums of one row of window centres: over p, q, p², q² and pq, first down the columns, then along the row.
struct WindowSums {
    std::vector<double> column[5];
    double mean_p = 0, mean_q = 0, pp = 0, qq = 0, pq = 0;
};

double similarity(const WindowSums& s) {
    const double variance_p = s.pp - s.mean_p * s.mean_p;
    const double variance_q = s.qq - s.mean_q * s.mean_q;
    const double covariance = s.pq - s.mean_p * s.mean_q;
    return (2 * s.mean_p * s.mean_q + stabilizer_mean) * (2 * covariance + stabilizer_variance) /
           ((s.mean_p * s.mean_p + s.mean_q * s.mean_q + stabilizer_mean) *
            (variance_p + variance_q + stabilizer_variance));
}

}  // namespace

std::optional<double> ssim(const Image8& reference, const Image8& test, const Image8* mask) {
    assert(reference.bounds() == test.bounds() && reference.channels() == 3 && test.channels() == 3);
    assert(mask == nullptr || (mask->bounds() == reference.bounds() && mask->channels() == 1));
    const int width = reference.width();
    const int center_rows = reference.height() - ssim_window_px + 1;
    const int center_columns = width - ssim_window_px + 1;
    if (center_rows <= 0 || center_columns <= 0) return std::nullopt;

    const std::array<double, ssim_window_px> window = make_window();
    std::vector<double> row_sums(static_cast<std::size_t>(center_rows), 0.0);
    std::vector<std::int64_t> row_counts(static_cast<std::size_t>(center_rows), 0);
    constexpr int band_rows = 32;
    parallel_for((center_rows + band_rows - 1) / band_rows, [&](int band) {
        const int first = band * band_rows;
        const int rows = std::min(band_rows, center_rows - first);
        const std::vector<double> p = luma_rows(reference, first, rows + ssim_window_px - 1);
        const std::vector<double> q = luma_rows(test, first, rows + ssim_window_px - 1);
        WindowSums sums;
        for (auto& column : sums.column) column.resize(static_cast<std::size_t>(width));
        for (int y = 0; y < rows; ++y) {
            for (auto& column : sums.column) std::fill(column.begin(), column.end(), 0.0);
            for (int i = 0; i < ssim_window_px; ++i) {
                const double weight = window[static_cast<std::size_t>(i)];
                const double* p_row = p.data() + static_cast<std::size_t>(y + i) * static_cast<std::size_t>(width);
                const double* q_row = q.data() + static_cast<std::size_t>(y + i) * static_cast<std::size_t>(width);
                for (std::size_t x = 0; x < static_cast<std::size_t>(width); ++x) {
                    const double wp = weight * p_row[x], wq = weight * q_row[x];
                    sums.column[0][x] += wp;
                    sums.column[1][x] += wq;
                    sums.column[2][x] += wp * p_row[x];
                    sums.column[3][x] += wq * q_row[x];
                    sums.column[4][x] += wp * q_row[x];
                }
            }
            double row_sum = 0;
            std::int64_t row_count = 0;
            for (int x = 0; x < center_columns; ++x) {
                constexpr int half = ssim_window_px / 2;
                if (mask != nullptr && mask->at(x + half, first + y + half) == 0) continue;
                const auto along_row = [&](const std::vector<double>& column) {
                    double sum = 0;
                    for (std::size_t i = 0; i < window.size(); ++i)
                        sum += window[i] * column[static_cast<std::size_t>(x) + i];
                    return sum;
                };
                sums.mean_p = along_row(sums.column[0]);
                sums.mean_q = along_row(sums.column[1]);
                sums.pp = along_row(sums.column[2]);
                sums.qq = along_row(sums.column[3]);
                sums.pq = along_row(sums.column[4]);
                row_sum += similarity(sums);
                ++row_count;
            }
            const auto row = static_cast<std::size_t>(first) + static_cast<std::size_t>(y);
            row_sums[row] = row_sum;
            row_counts[row] = row_count;
        }
    });
    double sum = 0;
    std::int64_t count = 0;
    for (std::size_t y = 0; y < row_sums.size(); ++y) {
        sum += row_sums[y];
        count += row_counts[y];
    }
    if (count == 0) return std::nullopt;
    return sum / static_cast<double>(count);
}

}  // namespace matchlight
