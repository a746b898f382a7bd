// From a scene to its solve.
#include "tracking/track.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/version.h"
#include "lighting/probe.h"
#include "media/frame_source.h"
#include "scene/footage_options.h"
#include "tracking/clip_context.h"
#include "tracking/clip_observations.h"
#include "tracking/geometry_stage.h"
#include "tracking/lens_start.h"
#include "tracking/optics_stage.h"
#include "tracking/photometry_stage.h"
#include "tracking/plate_light.h"
#include "tracking/recovery_stage.h"
#include "tracking/track_details.h"

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
        solve_.camera = calibrated_camera(info.format.width, info.format.height);
        Camera camera = solve_.camera;
        solve_.response = footage_response(scene_.footage);
        // Read before the long work, so that a bad probe is known at once.
        std::optional<Probe> probe;
        if (scene_.probe) {
            probe = placed(load_probe(scene_.probe->path, scene_.probe->mapping, warnings_), scene_.probe->placement);
        }

        ObserveOptions observing;
        observing.first_frame = options_.first_frame;
        observing.last_frame = options_.last_frame;
        observing.level = options_.level;
        observing.corners = options_.corners;
        observing.quiet = options_.quiet;
        if (scene_.footage.solve_response) find_response(*source, observing);
        ClipObservations clip = observe_clip(*source, scene_.tags, camera, solve_.response, observing);
        if (clip.frames.empty()) throw InputError(scene_.footage.video, "has no frame in the range asked for");
        summary_.foreign_ids = clip.foreign_ids;
        check_anything_seen(clip, *source);

        const Response response = solve_.response;
        const ClipContext context{scene_, options_, info, camera, response, probe, warnings_};
        GeometrySolution geometry = solve_geometry(context, clip);
        if (scene_.footage.camera.empty()) {
            express_with(geometry.camera, camera, clip.frames);
            camera = geometry.camera;
        }
        if (options_.corners == CornerMethod::fit && recover_tags(context, *source, geometry, clip) > 0) {
            geometry = solve_geometry(context, clip);
        }
        report_geometry(context, geometry, solve_, summary_);
        solve_photometry_stage(context, clip, geometry, solve_, summary_);
        solve_optics_stage(context, clip, geometry, solve_, summary_);

        solve_.footage_file = footage_name();
        solve_.frame_count = std::max<std::int64_t>(info.frame_count, clip.frames.back().frame + 1);
        solve_.response = effective_response(solve_.response, info.format.transfer);
        solve_.provenance = fmt::format("matchlight {}, track\n{}", version, scene_.effective_toml);
        if (summary_.details != nullptr) {
            *summary_.details = {std::move(clip.frames), geometry.path.frames, std::move(clip.cards),
                                 card_expectations(context, geometry.rig), geometry.rig.world_from_tag};
        }
        return std::move(solve_);
    }

private:
    /// From a few dozen frames over the clip, ahead of all that is measured in its light.
    void find_response(FrameSource& source, ObserveOptions observing) {
        if (source.info().format.transfer != Transfer::camera) return;  // its tag says what curve it has
        constexpr std::int64_t frames = 60;
        const std::int64_t end = observing.last_frame.value_or(source.info().frame_count - 1);
        observing.every = std::max<std::int64_t>(1, (end - observing.first_frame) / frames);
        const ClipObservations sample = observe_clip(source, scene_.tags, solve_.camera, solve_.response, observing);
        solve_.response = solved_response(scene_, sample.cards, warnings_, summary_.photometry);
        source.seek(observing.first_frame);
    }

    /// The scene's, or a guess where it gives none.
    Camera calibrated_camera(int width, int height) const {
        const std::filesystem::path& file = scene_.footage.camera;
        return file.empty() ? guessed_camera(width, height) : camera_for_size(load_camera(file), width, height, file);
    }

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
