// A named number beside a measurement.
#pragma once

#include <string>
#include <vector>

namespace matchlight {

struct Knob {
    std::string name;  // "directions"
    double value = 0;
};

/// "128 directions, 1024 resolution".
std::string knobs_text(const std::vector<Knob>& knobs);

}  // namespace matchlight
