// When front depth peeling may stop: what the layers behind can still change, in code values.
#pragma once

#include <functional>

#include <Eigen/Core>

namespace matchlight {

/// The transmittance at which peeling stops where codes are linear in light: t / (2 · 255), which leaves half the
/// tolerance t (in codes of 255) as error.
double residual_of_tolerance(double tolerance_codes);
/// The fewest layers of at least this opacity that let no more through than `residual`; 1 where the opacity is 1,
/// `most_peeled_layers` where it is 0 or so small that more would be needed.
inline constexpr int most_peeled_layers = 1 << 20;
int layers_of_opacity(double least_opacity, double residual);
/// The least opacity for which so many layers suffice.
double opacity_of_layers(int layers, double residual);

/// From scene-linear light of a channel (0..2) to its code, 0..1: the response after exposure. Never falls.
using CodeOfChannel = std::function<double(double light, int channel)>;

/// The codes (of 255) in which a peeled pixel may still change: the largest of 255·(R(C + T·L) − R(C)) over the
/// channels, where C is the premultiplied light so far, T what is let through, and L no less than any light behind.
/// Infinite for what is not finite.
double residual_codes(const CodeOfChannel& code_of, const Eigen::Vector3d& light, double transmittance,
                      const Eigen::Vector3d& most_light);
/// residual_codes() at most half the tolerance, which is then the most that the picture errs, whatever stands in for
/// the light behind, if it is no more than `most_light`. For codes linear in light and L = 1 this is
/// T ≤ residual_of_tolerance(t).
bool may_stop(const CodeOfChannel& code_of, const Eigen::Vector3d& light, double transmittance,
              const Eigen::Vector3d& most_light, double tolerance_codes);

/// The greatest transmittance for which residual_codes() keeps to the tolerance whatever has been gathered before
/// (0 ≤ C ≤ L): the layer bound for one limit of a whole picture. Found to 1e-6 of itself, from below.
double residual_of_tolerance(const CodeOfChannel& code_of, const Eigen::Vector3d& most_light, double tolerance_codes);

}  // namespace matchlight
