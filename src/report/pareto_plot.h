// Error against run time of one effect, drawn as SVG.
#pragma once

#include <string>

#include "report/report.h"

namespace matchlight {

/// Milliseconds along a logarithmic x, mean FLIP along a logarithmic y; the Pareto front joined, the range of repeated
/// runs as a bar, the reference's own error as a dashed line. Self-contained.
std::string pareto_plot_svg(const EffectReport& effect);

}  // namespace matchlight
