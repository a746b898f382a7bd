// The middle of the samples, robust against what else the machine does.
#include "report/measured_time.h"

#include <algorithm>
#include <cassert>
#include <cstddef>

namespace matchlight {

RunTime run_time_of(std::vector<double> samples_ms) {
    assert(!samples_ms.empty());
    std::ranges::sort(samples_ms);
    const std::size_t middle = samples_ms.size() / 2;
    const double median =
        samples_ms.size() % 2 != 0 ? samples_ms[middle] : (samples_ms[middle - 1] + samples_ms[middle]) / 2;
    return {median, samples_ms.front(), samples_ms.back()};
}

}  // namespace matchlight
