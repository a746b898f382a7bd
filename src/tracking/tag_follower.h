// The tags of consecutive frames: sought once, then followed to where they are predicted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "media/plate.h"
#include "tracking/grey_card.h"
#include "tracking/lens_grid.h"
#include "tracking/plate_light.h"
#include "tracking/rig_solve.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_fit.h"
#include "tracking/track.h"

namespace matchlight {

/// What one frame shows.
struct FrameFindings {
    FrameObservations observations;
    std::vector<CardReading> cards;
    std::vector<int> foreign_ids;
    std::int64_t decoys = 0;
};

/// What a search rests on, for a whole clip.
struct SearchContext {
    const TagDetector& detector;  // of this thread
    const std::set<int>& wanted;
    const PlateLight& plate_light;
    const LensGrid& lens;
    TrackLevel level = TrackLevel::final_;
    CornerMethod corners = CornerMethod::fit;
};

/// Takes consecutive frames. A full search costs more than all the rest, so tags are looked for where their corners and
/// velocity predict them: the fit itself finds them there, or the detector on a small piece of the frame. The whole
/// frame is searched at first, and then
///   fast:   when no tag is left;
///   normal: when one that should be in view was lost;
///   final:  when any wanted tag is missing.
class TagFollower {
public:
    explicit TagFollower(const SearchContext& context) : context_(context) {}

    FrameFindings examine(const PlateFrame& frame);

private:
    using Corners = std::array<Eigen::Vector2d, 4>;

    struct Followed {
        TagDetection last;
        std::optional<Corners> velocity_px;  // a frame; nullopt when seen once
    };

    struct Prediction {
        TagDetection detection;
        double side_px = 0;
        double error_px = 0;  // what it may be off
    };

    static Prediction predict(const Followed& tag);
    bool should_be_in_view(const Prediction& prediction) const;
    std::optional<TagImageFit> follow(const PlateFrame& frame, const Prediction& prediction) const;
    void search_everywhere(const PlateFrame& frame, FrameFindings& findings);
    void take(const PlateFrame& frame, const TagImageFit& fit, FrameFindings& findings);
    void remember(const FrameFindings& findings);

    SearchContext context_;
    std::vector<Followed> followed_;
    bool started_ = false;
};

}  // namespace matchlight
