// How the camera that took the probe differs from the film camera, as the tags in the footage tell.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "lighting/probe.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"
#include "tracking/track_details.h"

namespace matchlight {

/// One tag's light against what probe and frame exposures make of it.
struct CalibratedTag {
    int id = 0;
    std::int64_t frames = 0;             // in which its paper was read
    std::array<double, 3> deviation_ev;  // by channel, mean over frames
    double mean_deviation_ev = 0;
    double scatter_ev = 0;        // standard deviation over frames, mean of the channels
    double sigma_ev = 0;          // what may be expected of a tag that is as it should be
    bool shown_in_probe = false;  // measured in the probe, instead of an albedo under its irradiance
    bool out_of_line = false;     // deviates by more than three sigmas
};

/// Film light = probe light · 2^exposure_ev · white_balance.
struct ProbeCalibration {
    double exposure_ev = 0;
    std::array<double, 3> white_balance{1, 1, 1};
    std::array<double, 3> channel_ev{};     // exposure and white balance together
    std::array<double, 3> channel_sigma{};  // by the tags' disagreement, or by what one tag may be off
    std::int64_t frames = 0;                // that were measured
    double least_ev = 0, most_ev = 0;       // exposure over these frames
    std::vector<CalibratedTag> tags;
};

/// The calibration of `frame`, or of the frames' median where none is asked for; nullopt where no tag could be read (in
/// that frame).
std::optional<ProbeCalibration> calibrate_probe(const Solve& solve, const TrackDetails& details,
                                                std::optional<std::int64_t> frame);

/// A turn of the light, counter-clockwise seen from above, after which the probe shows tags where they are.
struct ProbeTurn {
    double turn_deg = 0;
    int tags_shown = 0;  // then
};

/// The turn at which the probe, as placed by the scene, shows most tags where the solve has them; nullopt where it
/// shows as many as it stands, or none at any turn. A probe whose place is not known shows none.
std::optional<ProbeTurn> better_turn(const Scene& scene, const Probe& probe, const TrackDetails& details);

}  // namespace matchlight
