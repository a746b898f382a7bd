// Tables of light and slope over the codes of a file.
#include "calibration/code_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace matchlight {

CodeTable::CodeTable(const Response& response, bool linear, double code_step) : code_step_(code_step) {
    assert(code_step > 0 && code_step <= 1);
    const auto steps = static_cast<int>(std::lround(1 / code_step));
    codes_ = static_cast<float>(steps);
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<double> exact;
        for (int i = 0; i <= steps; ++i) {
            const double code = static_cast<double>(i) / steps;
            exact.push_back(linear ? code : response.linear_from_code(code, channel));
        }
        auto& light = light_[static_cast<std::size_t>(channel)];
        auto& slope = slope_[static_cast<std::size_t>(channel)];
        for (int i = 0; i <= steps; ++i) {
            const int below = std::max(i - 1, 0), above = std::min(i + 1, steps);
            light.push_back(static_cast<float>(exact[static_cast<std::size_t>(i)]));
            slope.push_back(
                static_cast<float>((exact[static_cast<std::size_t>(above)] - exact[static_cast<std::size_t>(below)]) *
                                   steps / (above - below)));
        }
    }
}

float CodeTable::code(float light, int channel) const {
    const std::vector<float>& table = light_[static_cast<std::size_t>(channel)];
    const auto above = std::upper_bound(table.begin() + 1, table.end() - 1, light);
    const auto below = above - 1;
    const float part = (light - *below) / (*above - *below);
    return std::clamp((static_cast<float>(below - table.begin()) + part) / codes_, 0.0f, 1.0f);
}

}  // namespace matchlight
