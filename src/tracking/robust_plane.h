// A plane through samples of a surface, some of which lie in a shadow or a glint.
#pragma once

#include <vector>

namespace matchlight {

/// A value at (a, b); `weight` is how many pixels stand behind it.
struct PlaneSample {
    double a = 0, b = 0;
    double value = 0;
    double weight = 1;
};

struct PlaneFit {
    double value = 0;  // at (0, 0)
    double standard_error = 0;
};

/// Iterated weights (Cauchy's) about the spread that the samples have, no less than `least_spread`: samples in a shadow
/// lose their voice. A level without slopes where samples are fewer than 8. `samples` must not be empty.
PlaneFit fit_robust_plane(const std::vector<PlaneSample>& samples, double least_spread);

}  // namespace matchlight
