// A response as free curves, from samples of a bracketed series: Debevec & Malik's and Robertson's ways.
#pragma once

#include <array>
#include <vector>

#include "calibration/response_samples.h"

namespace matchlight {

/// Codes 0..1 at which curves are found: those of 8 bits.
inline constexpr int curve_nodes = 256;
/// Natural logarithm of light at each node, strictly increasing; only differences mean anything.
using LogCurve = std::vector<double>;

struct CurveOptions {
    double smoothness = 1e-2;   // the curve bends over about (smoothness / 255)^(1/4) of the logarithm of its code
    bool use_held_out = false;  // fit to all samples
};

/// What a place counts in a fit: 0 where its photographs contradict one another (it moved, or is no picture: a border).
std::vector<double> place_weights(const ResponseSamples& samples, int channel, const LogCurve& curve);

/// Debevec & Malik, "Recovering High Dynamic Range Radiance Maps from Photographs", 1997: least squares over the curve
/// and the radiance of every place at once, hat weights. Deviations: codes between nodes are interpolated; radiances
/// are eliminated, so that thousands of places cost no more than the curve's 256 unknowns; places that contradict
/// themselves lose their weight (Tukey's biweight); smoothness is asked against the logarithm of the code, along which
/// every power law is straight, because the curve's own second derivative, which the paper holds small, is infinite
/// at black; made monotone in the end.
/// OpenCV's CalibrateDebevec has no weight for such places, takes 70 samples in single precision unless told, and
/// keeps curves that turn back.
LogCurve debevec_curve(const ResponseSamples& samples, int channel, const CurveOptions& options);

/// Robertson, Borman & Stevenson, "Estimation-theoretic approach to dynamic range enhancement using multiple
/// exposures", 2003: radiances and curve by turns, Gaussian weights. Its curve has a free value a code; they are
/// smoothed here as above. It starts from Debevec & Malik's curve, not from a straight line, from which hundreds of
/// rounds do not get to the dark codes; places that contradict the start are left out. OpenCV's CalibrateRobertson
/// starts from the straight line, takes 30 rounds, and sums over all pixels, full ones included, whose weight is small
/// but not 0.
LogCurve robertson_curve(const ResponseSamples& samples, int channel, const CurveOptions& options);

}  // namespace matchlight
