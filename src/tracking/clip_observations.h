// Everything the pixels of a clip say about its tags, gathered in one pass.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera.h"
#include "calibration/response.h"
#include "core/warnings.h"
#include "media/frame_source.h"
#include "scene/scene_file.h"
#include "tracking/grey_card.h"
#include "tracking/rig_solve.h"
#include "tracking/track.h"

namespace matchlight {

struct ObserveOptions {
    std::int64_t first_frame = 0;
    std::optional<std::int64_t> last_frame;  // included
    TrackLevel level = TrackLevel::final_;
    CornerMethod corners = CornerMethod::fit;
    int decimation = 0;      // TagDetectorOptions
    std::int64_t every = 1;  // frames whose number it divides are examined
    bool quiet = false;
};

struct ClipObservations {
    std::vector<FrameObservations> frames;        // every frame that was decoded, in order
    std::vector<std::vector<CardReading>> cards;  // parallel to `frames`
    std::map<int, std::int64_t> foreign_ids;      // ids outside the rig, and in how many places they were seen
    std::int64_t decoys = 0;                      // decoded by the library, but the pixels are not that tag's
};

/// Decodes in order, works groups of frames (TagFollower) on all cores, and keeps no pictures. What is found in a frame
/// depends on it and on those before it in its group of eight, counted in the clip. Throws InputError; a request to
/// stop is one.
ClipObservations observe_clip(FrameSource& source, const TagSettings& tags, const Camera& camera,
                              const Response& response, const ObserveOptions& options);

/// Which ids of which families a few frames of the clip show, for the message that says why nothing was found:
/// "tag25h9: 3, 4; tag16h5: 0", or empty.
std::string families_in_view(FrameSource& source, const Response& response);

}  // namespace matchlight
