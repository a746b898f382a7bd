// Error against run time of one effect, drawn as SVG.
#pragma once

#include <string>

#include "report/report.h"

namespace matchlight {

/// What the axes are called; an effect's points keep their error under `flip` whatever it measures.
struct PlotWords {
    std::string time = "ms, once a frame";
    std::string error = "FLIP", against = "FLIP against the reference";
};

/// Milliseconds along a logarithmic x, error along a logarithmic y; the Pareto front joined, the range of repeated
/// runs as a bar, the reference's own error as a dashed line. Self-contained.
std::string pareto_plot_svg(const EffectReport& effect, const PlotWords& words);
/// In the words that its unit asks for.
std::string pareto_plot_svg(const EffectReport& effect);

}  // namespace matchlight
