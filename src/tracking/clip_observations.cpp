// Workers that take frames from one decoder.
#include "tracking/clip_observations.h"

#include <algorithm>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/stop.h"
#include "tracking/plate_light.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_follower.h"

namespace matchlight {

namespace {

Region whole_frame(const PlateFrame& frame) {
    return {0, 0, frame.format().width, frame.format().height};
}

/// Frames are worked in groups of so many, by their number in the clip: few enough that a group of 4K frames fits in
/// memory for every core, enough that the full search at a group's start is a small part of the work.
constexpr std::int64_t group_length = 8;

/// Hands out groups of frames from one decoder, in order.
class GroupSource {
public:
    GroupSource(FrameSource& source, std::optional<std::int64_t> last_frame, std::int64_t every)
        : source_(source), last_frame_(last_frame), every_(every) {}

    /// Empty at the end.
    std::vector<PlateFrame> next() {
        const std::lock_guard lock(mutex_);
        std::vector<PlateFrame> group;
        if (!pending_) pending_ = decode();
        while (pending_ &&
               (group.empty() || group.front().index() / group_length == pending_->index() / group_length)) {
            group.push_back(*std::exchange(pending_, std::nullopt));  // nothing is left where decoding throws
            pending_ = decode();
        }
        return group;
    }

private:
    std::optional<PlateFrame> decode() {
        if (ended_) return std::nullopt;
        ended_ = true;  // also when decoding throws: the other workers stop
        if (stop_requested()) throw InputError(source_.info().path, "stopped on request");
        std::optional<PlateFrame> frame = source_.next();
        while (frame && frame->index() % every_ != 0) frame = source_.next();
        ended_ = !frame || (last_frame_ && frame->index() > *last_frame_);
        if (ended_) return std::nullopt;
        return frame;
    }

    FrameSource& source_;
    std::optional<std::int64_t> last_frame_;
    std::int64_t every_;
    std::mutex mutex_;
    std::optional<PlateFrame> pending_;
    bool ended_ = false;
};

}  // namespace

ClipObservations observe_clip(FrameSource& source, const TagSettings& tags, const Camera& camera,
                              const Response& response, const ObserveOptions& options) {
    const PlateLight plate_light(response, source.info().format.transfer);
    const LensGrid lens(camera);
    std::set<int> wanted;
    for (const RigTag& tag : tags.rig) wanted.insert(tag.id);

    const std::int64_t end =
        options.last_frame ? std::min(*options.last_frame + 1, source.info().frame_count) : source.info().frame_count;
    Progress progress("track", std::max<std::int64_t>(0, end - options.first_frame) / options.every, options.quiet);
    // A group is worked from its beginning also where the range begins within it, so that a frame is seen alike.
    if (options.first_frame > 0) source.seek(options.first_frame / group_length * group_length);

    GroupSource groups(source, options.last_frame, options.every);
    std::mutex findings_mutex;
    std::map<std::int64_t, FrameFindings> by_frame;
    const int workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    parallel_for(workers, [&](int) {
        const TagDetector detector(tags.family, {options.decimation});
        for (std::vector<PlateFrame> group = groups.next(); !group.empty(); group = groups.next()) {
            TagFollower follower({detector, wanted, plate_light, lens, options.level, options.corners});
            for (const PlateFrame& frame : group) {
                FrameFindings findings = follower.examine(frame);
                if (frame.index() < options.first_frame) continue;
                const std::lock_guard lock(findings_mutex);
                by_frame.emplace(frame.index(), std::move(findings));
                progress.advance();
            }
        }
    });

    ClipObservations clip;
    for (auto& [index, findings] : by_frame) {
        clip.frames.push_back(std::move(findings.observations));
        clip.cards.push_back(std::move(findings.cards));
        clip.decoys += findings.decoys;
        for (const int id : findings.foreign_ids) ++clip.foreign_ids[id];
    }
    return clip;
}

std::string families_in_view(FrameSource& source, const Response& response) {
    const PlateLight plate_light(response, source.info().format.transfer);
    constexpr std::int64_t looks = 6;
    const std::int64_t step = std::max<std::int64_t>(1, source.info().frame_count / looks);
    std::map<std::string, std::set<int>> seen;
    source.seek(0);
    std::int64_t looked = 0;
    while (const std::optional<PlateFrame> frame = source.next()) {
        if (looked >= looks || stop_requested()) break;
        if (frame->index() % step != 0) continue;
        ++looked;
        const Image8 light8 =
            detection_image(plate_light.gray(*frame, whole_frame(*frame)), DetectionScale::perceptual);
        for (const std::string& family : TagFamily::names()) {
            const TagDetector detector(family, {});
            for (const TagDetection& detection : detector.detect(light8)) {
                // Sixteen bits spell some code by chance in any texture: only clear ones are worth a hint.
                constexpr double clear_margin = 30;
                if (detection.hamming == 0 && detection.decision_margin > clear_margin) {
                    seen[family].insert(detection.id);
                }
            }
        }
    }
    std::vector<std::string> parts;
    for (const auto& [family, ids] : seen) parts.push_back(fmt::format("{}: {}", family, fmt::join(ids, ", ")));
    return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace matchlight
