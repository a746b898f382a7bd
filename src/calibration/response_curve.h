// A response as free curves, from samples of a bracketed series: Debevec & Malik's and Robertson's ways.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/response_samples.h"

namespace matchlight {

/// Codes 0..1 at which curves are found: those of 8 bits.
inline constexpr int curve_nodes = 256;
/// Natural logarithm of light at each node, strictly increasing; only differences mean anything.
using LogCurve = std::vector<double>;

/// A quadratic form whose minimum, with smoothness added, is the curve.
struct CurveEquations {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd right;
};

/// The minimum, made monotone. `smoothness`: the curve bends over about (smoothness / 255)^(1/4) of the logarithm of
/// its code. It is asked against that logarithm, along which every power law is straight; Debevec & Malik ask it
/// against the code, along which every camera's curve bends infinitely at black.
LogCurve smooth_curve(const CurveEquations& equations, double smoothness);

/// What each place counts, from a fit that settles it in rounds: 0 where its photographs contradict one another (it
/// moved, or is no picture: a border), by Tukey's biweight.
std::vector<double> place_weights(const ResponseSamples& samples, int channel);

/// Which places a fit may use.
enum class Places { fitted, all };

/// Debevec & Malik, "Recovering High Dynamic Range Radiance Maps from Photographs", 1997: least squares over the curve
/// and the radiance of every place at once, hat weights. Deviations: codes between nodes are interpolated; radiances
/// are eliminated, so that thousands of places cost no more than the curve's 256 unknowns; places have weights.
/// OpenCV's CalibrateDebevec has none, takes 70 places in single precision unless told, and keeps curves that turn
/// back.
CurveEquations debevec_equations(const ResponseSamples& samples, int channel, const std::vector<double>& weights,
                                 Places places);

/// Robertson, Borman & Stevenson, "Estimation-theoretic approach to dynamic range enhancement using multiple
/// exposures", 2003: radiances and curve by turns, Gaussian weights; a free value a code, to be smoothed. It starts
/// from Debevec & Malik's curve, not from a straight line, from which hundreds of rounds do not get to the dark codes.
/// OpenCV's CalibrateRobertson starts from the straight line, takes 30 rounds, and sums over all pixels, full ones
/// included, whose weight is small but not 0.
CurveEquations robertson_equations(const ResponseSamples& samples, int channel, const std::vector<double>& weights,
                                   Places places);

}  // namespace matchlight
