// What every stage of the solve works from: the scene, the options, and what was loaded for them.
#pragma once

#include <optional>
#include <string>

#include "calibration/camera.h"
#include "calibration/response.h"
#include "core/warnings.h"
#include "lighting/probe.h"
#include "media/frame_source.h"
#include "scene/scene_file.h"
#include "tracking/track.h"

namespace matchlight {

struct ClipContext {
    const Scene& scene;
    const TrackOptions& options;
    const FootageInfo& footage;
    const Camera& camera;               // as calibrated, at the footage's size
    const Response& response;           // as the scene gives it
    const std::optional<Probe>& probe;  // placed in the world
    Warnings& warnings;

    /// "clip.mp4: 3 frames …", where there are any.
    void warn(const std::string& text, std::int64_t count) const {
        if (count > 0) warnings.add(scene.footage.video.string() + ": " + std::to_string(count) + " " + text);
    }
    void warn(const std::string& text) const { warnings.add(scene.footage.video.string() + ": " + text); }
};

}  // namespace matchlight
