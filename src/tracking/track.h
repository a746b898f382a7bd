// The solve of a clip: pose, exposure and white balance of every frame, from the tags in it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// How much is done for the pose. `fast` keeps up with footage; `final_` is what a render deserves.
enum class TrackLevel { fast, normal, final_ };

/// Where a tag's corners come from: AprilTag's library, on linear light, or the fit of the tag's known image.
enum class CornerMethod { apriltag, fit };

struct TrackOptions {
    TrackLevel level = TrackLevel::final_;
    CornerMethod corners = CornerMethod::fit;
    std::int64_t first_frame = 0;
    std::optional<std::int64_t> last_frame;  // included
    bool strict = false;                     // damaged footage is an error
    bool quiet = false;                      // no progress
};

/// What the tags told as grey cards, beside what the solve holds.
struct PhotometrySummary {
    std::int64_t measured = 0, interpolated = 0;  // frames
    double exposure_range_ev = 0;                 // over which unclipped paper was seen
    bool response_solved = false;                 // chosen by the clip, sRGB included
    std::optional<double> vignette_corner_sigma;
    std::optional<double> noise_neighbour_correlation, noise_relative_error;
    int tags_in_probe = 0;
};

struct TrackDetails;

/// What the blur of the tags told.
struct OpticsSummary {
    std::optional<double> coc_scale_px_m, coc_scale_sigma;
    std::vector<double> focus_m;  // of the frames where it is known
    std::string focus_unknown;    // why, where it is not
    std::optional<double> shutter_fraction, shutter_sigma;
    std::string shutter_unknown;
    std::optional<double> softness_px;
};

/// What was found, beside the solve itself.
struct TrackSummary {
    std::int64_t frames = 0, posed = 0, bridged = 0, missing = 0;
    double mean_reprojection_px = 0, worst_reprojection_px = 0;
    std::optional<double> leave_one_out_px;  // median RMS of tags that the others of their frame predict
    std::map<int, std::int64_t> frames_by_tag;
    std::map<int, std::int64_t> foreign_ids;
    bool exposure_from_probe = false;
    PhotometrySummary photometry;
    TrackDetails* details = nullptr;  // filled where given
    std::vector<std::string> notes;   // what the solve decided by itself, a sentence each
    OpticsSummary optics;
};

/// Throws InputError: footage, camera, response or probe cannot be read, no tag in any frame, a stop was requested.
Solve track_footage(const Scene& scene, const TrackOptions& options, Warnings& warnings, TrackSummary& summary);

}  // namespace matchlight
