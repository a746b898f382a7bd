// Exact truth of a made clip (groundtruth.json), and how far a solve is from it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "calibration/camera.h"
#include "core/transforms.h"
#include "report/track_report.h"
#include "tracking/solve_file.h"

namespace matchlight {

struct TrueFrame {
    RigidTransform camera_from_world = RigidTransform::Identity();  // at mid-exposure
    std::optional<double> exposure_ev, focus_distance_m;
};

struct TrackTruth {
    std::map<std::int64_t, TrueFrame> frames;
    std::optional<std::array<double, 3>> white_balance;
    std::optional<double> shutter_fraction, coc_scale_px_m;
};

/// Reads {"poses": [{"frame": 0, "cam_from_world": [[4x4]], "ev": .., "focus_m": ..}], "white_balance": [r, g, b],
/// "shutter": .., "fx": .., "lens_mm": .., "fstop": ..}; all but frame and cam_from_world may be absent. Throws
/// InputError: not such a file, a pose that is not rigid, a number that is not finite.
TrackTruth load_track_truth(const std::filesystem::path& path);

/// What poses are scored with: the true camera and the corners of the object volume, m.
struct ScoredVolume {
    Camera camera;
    std::vector<Eigen::Vector3d> corners_m;
};
/// A box around the world's origin, as wide as the largest tag to every side and as high: where objects stand.
ScoredVolume scored_volume(const Camera& camera, double largest_tag_m);

/// What is scored: poses, and the lens they go with.
struct ScoredPath {
    const std::vector<SolvedFrame>& frames;
    const Camera& camera;
};

/// Fills errors and error_px of the point; of frames that the truth does not know nothing is said. Throws InputError
/// (naming `reported`) when they have no frame in common.
void score(const ScoredPath& path, const TrackTruth& truth, const ScoredVolume& volume,
           const std::filesystem::path& reported, TrackPoint& point);

}  // namespace matchlight
