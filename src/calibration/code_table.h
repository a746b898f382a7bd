// A photograph's codes turned into light by table, exact at the codes that its file can hold.
#pragma once

#include <array>
#include <vector>

#include "calibration/response.h"

namespace matchlight {

class CodeTable {
public:
    /// `linear`: code is light already. `code_step`: between neighbouring codes.
    CodeTable(const Response& response, bool linear, double code_step);

    /// Light that gives `code` (0..1), 1 where code is 1 by the families sRGB and gamma; between codes of the file (in
    /// resampled photographs) linear interpolation.
    float light(float code, int channel) const { return at(light_[static_cast<std::size_t>(channel)], code); }
    /// d light / d code.
    float slope(float code, int channel) const { return at(slope_[static_cast<std::size_t>(channel)], code); }
    /// The code that gives `light`, by inverse interpolation of the table.
    float code(float light, int channel) const;
    double code_step() const { return code_step_; }

private:
    float at(const std::vector<float>& values, float code) const;

    double code_step_;
    float codes_;  // the index of code 1
    std::array<std::vector<float>, 3> light_, slope_;
};

inline float CodeTable::at(const std::vector<float>& values, float code) const {
    const float place = code * codes_;
    if (!(place > 0)) return values.front();
    if (place >= codes_) return values.back();
    const auto below = static_cast<std::size_t>(place);
    const float part = place - static_cast<float>(below);
    return values[below] + part * (values[below + 1] - values[below]);
}

}  // namespace matchlight
