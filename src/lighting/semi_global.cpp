// One label for every pixel of a lat-long map, cheap by itself and smooth with its neighbours.
#include "lighting/semi_global.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// The path's costs at a pixel from those at the pixel before it; both less the least of the one before.
void follow(const float* own, const float* before, float least, int labels, const LabelPenalties& penalties, float jump,
            float* into) {
    for (int l = 0; l < labels; ++l) {
        float best = std::min(before[l], least + jump);
        if (l > 0) best = std::min(best, before[l - 1] + penalties.step);
        if (l + 1 < labels) best = std::min(best, before[l + 1] + penalties.step);
        into[l] = own[l] + best - least;
    }
}

/// Adds one direction's path costs to the sums. Paths step from row to row; a horizontal one goes round twice, so that
/// it has no beginning.
void add_path(const LabelCosts& costs, const ImageF& guide, const LabelPenalties& penalties, int dx, int dy,
              LabelCosts& sums) {
    const int width = costs.width, height = costs.height, labels = costs.labels;
    const auto one_step = [&](int x, int y, int from_x, int from_y, const std::vector<float>& before,
                              std::vector<float>& now) {
        const float contrast = std::min(1.F, std::abs(guide.at(x, y) - guide.at(from_x, from_y))) / penalties.contrast;
        // A jump never costs less than a step.
        const float jump = std::max(penalties.step, penalties.jump / (1 + contrast));
        const float least = *std::min_element(before.begin(), before.end());
        follow(costs.at(x, y), before.data(), least, labels, penalties, jump, now.data());
    };
    const auto add = [&](int x, int y, const std::vector<float>& now) {
        float* sum = sums.at(x, y);
        for (int l = 0; l < labels; ++l) sum[l] += now[l];
    };
    if (dy == 0) {
        parallel_for(height, [&](int y) {
            std::vector<float> before(labels, 0.F), now(labels);
            for (int k = 0; k < 2 * width; ++k) {
                const int x = ((dx * k) % width + width) % width;
                one_step(x, y, (x - dx + width) % width, y, before, now);
                if (k >= width) add(x, y, now);
                std::swap(before, now);
            }
        });
        return;
    }
    parallel_for(width, [&](int start) {
        std::vector<float> before(labels), now(labels);
        int x = start, y = dy > 0 ? 0 : height - 1;
        std::copy_n(costs.at(x, y), labels, before.begin());
        add(x, y, before);
        for (int k = 1; k < height; ++k) {
            const int from_x = x, from_y = y;
            x = (x + dx + width) % width;
            y += dy;
            one_step(x, y, from_x, from_y, before, now);
            add(x, y, now);
            std::swap(before, now);
        }
    });
}

}  // namespace

LabelCosts smoothed(const LabelCosts& costs) {
    LabelCosts result(costs.width, costs.height, costs.labels);
    parallel_for(costs.height, [&](int y) {
        for (int x = 0; x < costs.width; ++x) {
            float* into = result.at(x, y);
            for (int k = 0; k < 9; ++k) {
                const int from_x = (x + k % 3 - 1 + costs.width) % costs.width;
                const float* from = costs.at(from_x, std::clamp(y + k / 3 - 1, 0, costs.height - 1));
                for (int l = 0; l < costs.labels; ++l) into[l] += from[l] / 9;
            }
        }
    });
    return result;
}

LabelCosts semi_global_sums(const LabelCosts& costs, const ImageF& guide, const LabelPenalties& penalties) {
    LabelCosts sums(costs.width, costs.height, costs.labels);
    constexpr std::array<std::pair<int, int>, 8> paths = {
        {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};
    for (const auto& [dx, dy] : paths) add_path(costs, guide, penalties, dx, dy, sums);
    return sums;
}

}  // namespace matchlight
