// Cases of light probes: suns in the worst places of every mapping, black and tiny probes, light beyond half floats.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/warnings.h"
#include "lighting/dominant_lights.h"
#include "lighting/latlong_grid.h"
#include "lighting/probe_comparison.h"
#include "lighting/probe_file.h"
#include "lighting/resample.h"
#include "report/scratch_probe.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

using std::numbers::pi;
constexpr int height = 64;

struct Flux {
    double power = 0;
    Vector3d vector = Vector3d::Zero();
};

/// Of the light above even walls.
Flux flux_above(const Probe& probe, double walls) {
    const LatlongGrid grid(probe.latlong.width(), probe.latlong.height());
    Flux flux;
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            const double light = probe.latlong.at(x, y, 1) - walls;
            flux.power += light * grid.solid_angle(y);
            flux.vector +=
                light * Vector3d(grid.row(y).sin2 * grid.column(x).sine, grid.row(y).sin2 * grid.column(x).cosine,
                                 grid.row(y).sin1_cos1 * grid.azimuth_step());
        }
    }
    return flux;
}

Probe there_and_back(const Probe& probe, const ProbeLayout& layout) {
    return probe_from_image(image_from_probe(probe, layout), layout, probe.latlong.height());
}

double angle_between(const Vector3d& a, const Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

std::vector<ProbeLayout> layouts() {
    std::vector<ProbeLayout> result = {layout_of_size(ProbeMapping::latlong, height / 2)};
    for (const auto mapping : {ProbeMapping::angular, ProbeMapping::mirrorball, ProbeMapping::cube}) {
        result.push_back(layout_of_size(mapping, size_for_latlong(mapping, height)));
    }
    return result;
}

void add_sun_cases(std::vector<StabilityCase>& cases) {
    struct Place {
        const char* name;
        Vector3d direction;
    };
    const Place places[] = {{"at the pole of a lat-long map", {0.001, 0.001, 1}},
                            {"on its seam, the rim of a disc", {0.001, -1, 0.01}},
                            {"in the corner of a cube", {1, 1, 1}},
                            {"on the edge of a cube", {1, 1, 0.3}}};
    for (const ProbeLayout& layout : layouts()) {
        for (const Place& place : places) {
            cases.push_back({"probe mapping",
                             fmt::format("{} and back, a one-pixel sun a million times the walls {}",
                                         name_of(layout.mapping), place.name),
                             "angle it is off over the reach of its pixel",
                             {0, 1},
                             Bound{0.999, 1.001},
                             [layout, direction = place.direction] {
                                 const float walls = 0.1F;
                                 Probe probe{ImageF(2 * height, height, 3, walls)};
                                 const auto at =
                                     nearest_pixel(layout_of_size(ProbeMapping::latlong, height), direction);
                                 for (int c = 0; c < 3; ++c) probe.latlong.at(at.x(), at.y(), c) = 1e6F * walls;
                                 const Flux before = flux_above(probe, walls);
                                 const Flux after = flux_above(there_and_back(probe, layout), walls);
                                 return StabilityOutcome{angle_between(after.vector, before.vector) /
                                                             (reach_of_pixel(layout, before.vector) + pi / height),
                                                         after.power / before.power};
                             }});
        }
        for (const double even : {0.0, 1e-8, 1.0, 1e9}) {
            cases.push_back({"probe mapping",
                             fmt::format("{} and back, even light of {:g}", name_of(layout.mapping), even),
                             "largest error, relative",
                             {0, 1e-6},
                             {},
                             [layout, even] {
                                 const auto light = static_cast<float>(even);
                                 const Probe back = there_and_back({ImageF(2 * height, height, 3, light)}, layout);
                                 double worst = 0;
                                 for (const float sample : back.latlong.samples()) {
                                     const double error = std::abs(sample - light) / (even > 0 ? even : 1);
                                     worst = std::isfinite(error) ? std::max(worst, error)
                                                                  : std::numeric_limits<double>::infinity();
                                 }
                                 return StabilityOutcome{worst, {}};
                             }});
        }
    }
}

void add_extreme_probes(std::vector<StabilityCase>& cases) {
    cases.push_back(
        {"probe", "all black: lamps, range, parts of a median cut", "numbers that are not 0", {0, 0}, {}, [] {
             const Probe black{ImageF(2 * height, height, 3)};
             const ProbeStatistics statistics = probe_statistics(black);
             double bad = static_cast<double>(dominant_lights(black).size());
             bad += static_cast<double>(sample_directions(black, 16, -1, false).size());
             bad += statistics.dynamic_range_ev() != 0 || statistics.mean_luminance != 0 ? 1 : 0;
             bad += static_cast<double>(clipped_pixels(black.latlong));
             return StabilityOutcome{bad, {}};
         }});
    cases.push_back({"probe", "all black against itself", "numbers that are not finite or not 0", {0, 0}, {}, [] {
                         const Probe black{ImageF(2 * height, height, 3)};
                         const ProbeComparison same = compare_probes(black, black);
                         double bad = 0;
                         for (const double value :
                              {same.irradiance_rmse, same.worst_irradiance, same.brightest_angle_deg,
                               same.median_abs_ev, same.mean_ev, same.ball_rms_ev, same.black_share}) {
                             bad += value == 0 ? 0 : 1;
                         }
                         return StabilityOutcome{bad, {}};
                     }});
    // Eight pixels around: a furnace of them sends π but for the pixels that the horizon cuts, (π/4)²/4 of it at most.
    cases.push_back({"probe",
                     "4 pixels high, even light: irradiance from any direction",
                     "largest error over π",
                     {0, pi * pi / 64},
                     {},
                     [] {
                         const Probe tiny{ImageF(8, 4, 3, 1.0F)};
                         double worst = 0;
                         for (const Vector3d& normal : even_directions(100)) {
                             worst = std::max(worst, std::abs(irradiance(tiny, normal).x() / pi - 1));
                         }
                         return StabilityOutcome{worst, {}};
                     }});
    cases.push_back({"probe",
                     "4 pixels high, a lamp of one pixel, to a cube of 2 × 2 faces and back",
                     "samples that are no light",
                     {0, 0},
                     Bound{0.999, 1.001},
                     [] {
                         Probe tiny{ImageF(8, 4, 3)};
                         tiny.latlong.at(7, 0, 1) = 1e6F;
                         const Probe back = there_and_back(tiny, layout_of_size(ProbeMapping::cube, 2));
                         double bad = 0;
                         for (const float sample : back.latlong.samples()) {
                             bad += std::isfinite(sample) && sample >= 0 ? 0 : 1;
                         }
                         return StabilityOutcome{bad, flux_above(back, 0).power / flux_above(tiny, 0).power};
                     }});
}

void add_file_cases(std::vector<StabilityCase>& cases) {
    for (const double sun : {65504.0, 65520.0, 1e6, 1e30}) {
        cases.push_back({"probe file",
                         fmt::format("a sun of {:g}, written and read", sun),
                         "its light over what was written",
                         {1 - 1e-6, 1 + 1e-6},
                         {},
                         [sun] {
                             ImageF light(2 * height, height, 3, 0.5F);
                             light.at(20, 10, 1) = static_cast<float>(sun);
                             const ScratchProbe file(light);
                             write_probe_image(file.path(), light, layout_of_size(ProbeMapping::latlong, height), {});
                             Warnings warnings;
                             warnings.set_quiet(true);
                             const Probe back = load_probe(file.path(), std::nullopt, warnings);
                             return StabilityOutcome{back.latlong.at(20, 10, 1) / sun, {}};
                         }});
    }
}

}  // namespace

std::vector<StabilityCase> probe_cases() {
    std::vector<StabilityCase> cases;
    add_sun_cases(cases);
    add_extreme_probes(cases);
    add_file_cases(cases);
    return cases;
}

}  // namespace matchlight
