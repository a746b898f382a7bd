// From a scene to its solve.
#include "tracking/track.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/version.h"
#include "lighting/probe.h"
#include "media/frame_source.h"
#include "scene/footage_options.h"
#include "tracking/camera_path.h"
#include "tracking/clip_observations.h"
#include "tracking/photometry.h"
#include "tracking/plate_light.h"
#include "tracking/rig_solve.h"

namespace matchlight {

namespace {

class Tracker {
public:
    Tracker(const Scene& scene, const TrackOptions& options, Warnings& warnings, TrackSummary& summary)
        : scene_(scene), options_(options), warnings_(warnings), summary_(summary) {}

    Solve run() {
        check_rig();
        const std::unique_ptr<FrameSource> source =
            FrameSource::open(scene_.footage.video, footage_options(scene_.footage, options_.strict), warnings_);
        const FootageInfo& info = source->info();
        solve_.camera = camera_for_size(load_camera(scene_.footage.camera), info.format.width, info.format.height,
                                        scene_.footage.camera);
        if (scene_.footage.response) solve_.response = Response::load(*scene_.footage.response);
        // Read before the long work, so that a bad probe is known at once.
        std::optional<Probe> probe;
        if (scene_.probe) {
            probe = placed(load_probe(scene_.probe->path, scene_.probe->mapping, warnings_), scene_.probe->placement);
        }

        const ClipObservations clip = observe_clip(*source, scene_.tags, solve_.camera, solve_.response,
                                                   {options_.first_frame, options_.last_frame, 0, options_.quiet});
        if (clip.frames.empty()) throw InputError(scene_.footage.video, "has no frame in the range asked for");
        summary_.foreign_ids = clip.foreign_ids;
        check_anything_seen(clip, *source);

        const RigSolution rig = solve_rig(scene_.tags.rig, clip.frames);
        warn_of_rig(rig);
        const CameraPath path = solve_path(scene_.tags.rig, rig.world_from_tag, clip.frames, solve_.camera);
        take_path(path, rig);
        take_photometry(clip, rig, probe);

        solve_.footage_file = footage_name();
        solve_.frame_count = std::max<std::int64_t>(info.frame_count, clip.frames.back().frame + 1);
        solve_.response = effective_response(solve_.response, info.format.transfer);
        solve_.provenance = fmt::format("matchlight {}, track\n{}", version, scene_.effective_toml);
        return std::move(solve_);
    }

private:
    std::string footage_name() const {
        return scene_.footage.video.lexically_proximate(scene_.path.parent_path()).generic_string();
    }

    void check_rig() const {
        if (scene_.tags.rig.empty()) {
            throw InputError(scene_.path, "names no tag to track",
                             "list the tags in [tags] rig = [ {id = 0, size = 0.08} ]");
        }
        const TagFamily family(scene_.tags.family);
        for (const RigTag& tag : scene_.tags.rig) {
            if (tag.id < 0 || tag.id >= family.id_count()) {
                throw InputError(scene_.path, fmt::format("{} has no id {}", scene_.tags.family, tag.id),
                                 fmt::format("its ids run from 0 to {}", family.id_count() - 1));
            }
        }
    }

    void check_anything_seen(const ClipObservations& clip, FrameSource& source) const {
        const bool any = std::ranges::any_of(clip.frames, [](const auto& frame) { return !frame.tags.empty(); });
        if (any) return;
        std::vector<int> ids;
        for (const RigTag& tag : scene_.tags.rig) ids.push_back(tag.id);
        std::string cure;
        if (!clip.foreign_ids.empty()) {
            std::vector<int> foreign;
            for (const auto& [id, count] : clip.foreign_ids) foreign.push_back(id);
            cure = fmt::format("{} ids that were seen: {}", scene_.tags.family, fmt::join(foreign, ", "));
        } else {
            const std::string others = families_in_view(source, solve_.response);
            cure = others.empty() ? "no tag of any known family was seen: is the print sharp, with its white margin, "
                                    "and not mirrored?"
                                  : "what was seen: " + others;
        }
        throw InputError(scene_.footage.video,
                         fmt::format("no tag in any of {} frames; looked for {} ids {}", clip.frames.size(),
                                     scene_.tags.family, fmt::join(ids, ", ")),
                         cure);
    }

    void warn(const std::string& text, std::int64_t count) const {
        if (count > 0) warnings_.add(fmt::format("{}: {} {}", scene_.footage.video.string(), count, text));
    }

    void warn_of_rig(const RigSolution& rig) const {
        if (!rig.unplaced.empty()) {
            warnings_.add(fmt::format("{}: tags {} are never seen together with a tag whose place is known: left out",
                                      scene_.footage.video.string(), fmt::join(rig.unplaced, ", ")));
        }
        constexpr double inconsistent = 5;  // standard deviations
        if (rig.rms > inconsistent) {
            warnings_.add(
                fmt::format("{}: the tags do not keep one rigid arrangement, or a size or the lens is wrong "
                            "(residuals {:.0f} times their expected spread)",
                            scene_.footage.video.string(), rig.rms));
        }
    }

    void take_path(const CameraPath& path, const RigSolution& rig) {
        for (const RigTag& tag : scene_.tags.rig) {
            const auto place = rig.world_from_tag.find(tag.id);
            if (place != rig.world_from_tag.end()) solve_.rig.push_back({tag.id, tag.size_m, place->second});
        }
        std::int64_t small = 0, grazing = 0, cut_off = 0, disagreeing = 0, twice = 0, outvoted = 0, measured = 0;
        for (const PathFrame& frame : path.frames) {
            SolvedFrame& solved = solve_.frames.emplace_back();
            solved.frame = frame.frame;
            solved.time_s = frame.time_s;
            solved.tags = frame.tags;
            twice += frame.seen_twice;
            outvoted += frame.outvoted;
            for (const int id : frame.tags) ++summary_.frames_by_tag[id];
            if (!frame.pose) continue;
            solved.camera_from_world = frame.pose->camera_from_world;
            solved.covariance = frame.pose->covariance;
            solved.pose_confidence = frame.confidence;
            ++summary_.posed;
            if (frame.bridged) continue;
            solved.reprojection_px = frame.reprojection_px;
            ++measured;
            summary_.mean_reprojection_px += frame.reprojection_px;
            summary_.worst_reprojection_px = std::max(summary_.worst_reprojection_px, frame.reprojection_px);
            small += frame.small;
            grazing += frame.grazing;
            cut_off += frame.cut_off;
            disagreeing += frame.disagreeing;
        }
        summary_.frames = static_cast<std::int64_t>(path.frames.size());
        summary_.bridged = path.bridged;
        summary_.missing = path.missing;
        if (measured > 0) summary_.mean_reprojection_px /= static_cast<double>(measured);
        warn("frames without a tag were bridged from their neighbours", path.bridged);
        warn("frames without a tag have no pose: objects are left out there", path.missing);
        warn("frames show no tag of 25 px or more: the pose is uncertain", small);
        warn("frames show tags only under 15 degrees from the side: the pose is uncertain", grazing);
        warn("frames show only tags that the frame cuts off: the pose is uncertain", cut_off);
        warn("frames have tags that disagree by more than 2 px: one was moved, or the lens or a size is wrong",
             disagreeing);
        warn("frames have a tag that the others outvote: it was moved, or smeared by motion", outvoted);
        warn("frames show an id twice: the one that fits the others was kept", twice);
    }

    /// What each tag would send to the camera under the probe, tags nearest its place weighing most.
    std::map<int, CardExpectation> expectations(const RigSolution& rig, const std::optional<Probe>& probe) const {
        std::map<int, CardExpectation> expected;
        const double albedo_difference = scene_.tags.white_albedo - scene_.tags.black_albedo;
        for (const auto& [id, place] : rig.world_from_tag) {
            CardExpectation card;
            if (probe) {
                const Eigen::Vector3d light = irradiance(*probe, place.linear() * Eigen::Vector3d::UnitZ());
                for (std::size_t c = 0; c < 3; ++c) {
                    const double reflected = light[static_cast<Eigen::Index>(c)] / std::numbers::pi;
                    card.difference[c] = albedo_difference * reflected;
                    card.ink[c] = scene_.tags.black_albedo * reflected;
                }
                if (scene_.probe->place_m) {
                    constexpr double near_m = 0.05;  // closer than this, the probe's own size blurs the difference
                    const double distance = (place.translation() - *scene_.probe->place_m).norm();
                    card.weight = 1 / (distance * distance + near_m * near_m);
                }
            }
            expected[id] = card;
        }
        return expected;
    }

    void take_photometry(const ClipObservations& clip, const RigSolution& rig, const std::optional<Probe>& probe) {
        const ClipPhotometry photometry = solve_photometry(clip.cards, expectations(rig, probe), !probe);
        summary_.exposure_from_probe = probe.has_value();
        bool any = false;
        for (std::size_t f = 0; f < solve_.frames.size(); ++f) {
            const std::optional<FramePhotometry>& frame = photometry.frames[f];
            if (!frame) continue;
            any = true;
            solve_.frames[f].exposure_ev = frame->exposure_ev;
            solve_.frames[f].white_balance = frame->white_balance;
            solve_.frames[f].exposure_confidence = frame->confidence;
        }
        const std::string file = scene_.footage.video.string();
        if (!any) {
            warnings_.add(file +
                          ": no tag is large and unclipped enough to serve as a grey card: exposure is not known");
        } else if (!photometry.white_balance_known) {
            warnings_.add(file + ": red or blue is clipped on the tags in every frame: white balance is not known");
        }
    }

    const Scene& scene_;
    const TrackOptions& options_;
    Warnings& warnings_;
    TrackSummary& summary_;
    Solve solve_;
};

}  // namespace

Solve track_footage(const Scene& scene, const TrackOptions& options, Warnings& warnings, TrackSummary& summary) {
    return Tracker(scene, options, warnings, summary).run();
}

}  // namespace matchlight
