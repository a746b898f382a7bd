// Milliseconds of repeated runs.
#pragma once

#include <vector>

namespace matchlight {

struct RunTime {
    double median_ms = 0, min_ms = 0, max_ms = 0;
};

/// Median, least and largest of at least one sample.
RunTime run_time_of(std::vector<double> samples_ms);

}  // namespace matchlight
