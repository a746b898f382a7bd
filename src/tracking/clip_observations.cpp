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
#include "tracking/tag_fit.h"

namespace matchlight {

namespace {

Region whole_frame(const PlateFrame& frame) {
    return {0, 0, frame.format().width, frame.format().height};
}

struct FrameFindings {
    FrameObservations observations;
    std::vector<CardReading> cards;
    std::vector<int> foreign_ids;
    std::int64_t decoys = 0;
};

/// Tags found in light, and those that only show when shadows are lifted; the fit corrects the latter's corners. The
/// second search is made only when a wanted tag is missing.
std::vector<TagDetection> detect_all(const TagDetector& detector, const ImageF& light, const std::set<int>& wanted) {
    std::vector<TagDetection> detections = detector.detect(detection_image(light));
    const auto is_found = [&, count = detections.size()](int id) {
        return std::any_of(detections.begin(), detections.begin() + static_cast<std::ptrdiff_t>(count),
                           [&](const TagDetection& detection) { return detection.id == id; });
    };
    if (std::ranges::all_of(wanted, is_found)) return detections;
    for (const TagDetection& detection : detector.detect(detection_image(light, DetectionScale::perceptual))) {
        if (!is_found(detection.id)) detections.push_back(detection);
    }
    return detections;
}

FrameFindings examine(const PlateFrame& frame, const TagDetector& detector, const std::set<int>& wanted,
                      const PlateLight& plate_light, const LensGrid& lens) {
    FrameFindings findings;
    findings.observations.frame = frame.index();
    findings.observations.time_s = frame.time_s();
    const ImageF light = plate_light.gray(frame, whole_frame(frame));
    for (const TagDetection& detection : detect_all(detector, light, wanted)) {
        if (!wanted.contains(detection.id)) {
            findings.foreign_ids.push_back(detection.id);
            continue;
        }
        const TagPattern pattern = detector.family().pattern(detection.id);
        const std::optional<TagImageFit> fit = fit_tag(light, plate_light.clipped_light(1), lens, pattern, detection);
        if (!fit) {
            ++findings.decoys;
            continue;
        }
        findings.observations.tags.push_back(fit->observation);
        if (!fit->observation.refined) continue;
        if (const auto reading = read_card(frame, plate_light, lens, pattern, *fit)) findings.cards.push_back(*reading);
    }
    return findings;
}

}  // namespace

ClipObservations observe_clip(FrameSource& source, const TagSettings& tags, const Camera& camera,
                              const Response& response, const ObserveOptions& options) {
    const PlateLight plate_light(response, source.info().format.transfer);
    const LensGrid lens(camera);
    std::set<int> wanted;
    for (const RigTag& tag : tags.rig) wanted.insert(tag.id);

    const std::int64_t end =
        options.last_frame ? std::min(*options.last_frame + 1, source.info().frame_count) : source.info().frame_count;
    Progress progress("track", std::max<std::int64_t>(0, end - options.first_frame), options.quiet);
    if (options.first_frame > 0) source.seek(options.first_frame);

    std::mutex source_mutex, findings_mutex;
    std::map<std::int64_t, FrameFindings> by_frame;
    bool ended = false;
    const auto take_frame = [&]() -> std::optional<PlateFrame> {
        const std::lock_guard lock(source_mutex);
        if (ended) return std::nullopt;
        ended = true;  // also when decoding throws: the other workers stop
        if (stop_requested()) throw InputError(source.info().path, "stopped on request");
        std::optional<PlateFrame> frame = source.next();
        if (frame && options.last_frame && frame->index() > *options.last_frame) frame.reset();
        ended = !frame;
        return frame;
    };
    const int workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    parallel_for(workers, [&](int) {
        const TagDetector detector(tags.family, {options.decimation});
        while (const std::optional<PlateFrame> frame = take_frame()) {
            FrameFindings findings = examine(*frame, detector, wanted, plate_light, lens);
            const std::lock_guard lock(findings_mutex);
            by_frame.emplace(frame->index(), std::move(findings));
            progress.advance();
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
