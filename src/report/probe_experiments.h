// What making a probe costs and how far it is from the truth: photographs merged, balls unwrapped, parallax, mappings.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "report/experiment.h"

namespace matchlight {

inline constexpr std::size_t probe_experiment_count = 4;

/// Of synthetic photographs of rooms that are computed in double precision, which are the references. `done` is called
/// after each is made ready.
std::vector<Experiment> probe_experiments(const std::function<void()>& done);

/// Of their light: sRGB, so that walls are a middle grey.
Image8 probe_codes(const ImageF& light);

}  // namespace matchlight
