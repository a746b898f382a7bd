// Error against run time of tracking a scene's footage: the levels of the solve, and other libraries' poses.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "core/warnings.h"
#include "report/track_report.h"
#include "scene/scene_file.h"

namespace matchlight {

struct TrackExperimentOptions {
    int repeats = 3;                             // timed runs of each way
    std::optional<std::filesystem::path> truth;  // groundtruth.json
    std::function<void()> advance = [] {};       // after every run
};

/// How often `advance` is called.
std::int64_t track_experiment_steps(const TrackExperimentOptions& options);

/// Every way runs once before another runs again, so that what else the machine does hits all alike. The other
/// libraries get the places of the tags from the solve at its best. Throws InputError: as track_footage does, or a
/// truth that cannot be read or has no frame of the footage.
TrackReport run_track_experiment(const Scene& scene, const TrackExperimentOptions& options, Warnings& warnings);

}  // namespace matchlight
