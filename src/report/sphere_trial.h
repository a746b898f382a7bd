// Times ways to draw a sphere set over an orbit, and holds opaque pictures against the ray caster.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "report/sphere_orbit.h"
#include "report/sphere_study.h"

namespace matchlight {

/// One way to draw a set.
struct SphereWay {
    std::string name;
    std::function<void(const ReferenceView&)> draw;  // what is timed
    std::function<std::vector<Knob>()> beside = {};  // of the last draw; may be empty
};

/// Ways that are compared with each other.
struct SpherePart {
    std::string name;
    std::vector<SphereWay> ways;
};

/// Draws every way once untimed, then all in turn at each view, `repeats` times; of repeats a view's median counts. The
/// rows lack only what they are of. Needs a current context. Throws InputError when stopped.
std::vector<SphereStudyRow> time_over_views(const SpherePart& part, std::span<const ReferenceView> views, int repeats);

/// An opaque picture: scene-linear, premultiplied, RGBA with coverage.
using DrawnSpheres = std::function<ImageF(const ReferenceView&)>;

struct SphereCheckOptions {
    int stride_px = 4;       // every so many pixels of every so many rows are compared
    int coverage_side = 16;  // places a pixel, squared
    /// Pixels this near to an edge count as on it: what float rounding of a ray may miss.
    double margin_px = 0.02;
};
/// The row lacks only what it is of. Codes are sRGB's.
SphereCheckRow check_against_rays(const SphereCaster& spheres, std::span<const ReferenceView> views,
                                  const DrawnSpheres& drawn, const SphereLight& light,
                                  const SphereCheckOptions& options);

}  // namespace matchlight
