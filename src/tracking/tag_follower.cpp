// Prediction, fits from it, and the searches that take over where it fails.
#include "tracking/tag_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace matchlight {

namespace {

Region whole_frame(const PlateFrame& frame) {
    return {0, 0, frame.format().width, frame.format().height};
}

std::size_t pixels_of_fit(TrackLevel level) {
    switch (level) {
        case TrackLevel::fast:
            return 600;
        case TrackLevel::normal:
            return 1500;
        case TrackLevel::final_:
            break;
    }
    return TagFitOptions{}.most_pixels;
}

Eigen::Vector2d centre_of(const std::array<Eigen::Vector2d, 4>& corners) {
    return (corners[0] + corners[1] + corners[2] + corners[3]) / 4;
}

double mean_side(const std::array<Eigen::Vector2d, 4>& corners) {
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += (corners[i] - corners[(i + 1) % 4]).norm() / 4;
    return sum;
}

std::array<Eigen::Vector2d, 4> corners_of(const TagObservation& tag) {
    return {tag.corners_px.col(0), tag.corners_px.col(1), tag.corners_px.col(2), tag.corners_px.col(3)};
}

/// One print seen twice: by the prediction and by the search, or by two predictions that met.
bool is_same_print(const TagObservation& tag, int id, const Eigen::Vector2d& centre_px) {
    return tag.id == id && (tag.corners_px.rowwise().mean() - centre_px).norm() < 0.5 * tag.side_px;
}

bool is_known(const FrameFindings& findings, int id, const Eigen::Vector2d& centre_px) {
    return std::ranges::any_of(findings.observations.tags,
                               [&](const TagObservation& tag) { return is_same_print(tag, id, centre_px); });
}

Region region_around(const std::array<Eigen::Vector2d, 4>& corners, double margin_px) {
    Eigen::Vector2d low = corners[0], high = corners[0];
    for (const Eigen::Vector2d& corner : corners) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    const int x = static_cast<int>(std::floor(low.x() - margin_px));
    const int y = static_cast<int>(std::floor(low.y() - margin_px));
    return {x, y, static_cast<int>(std::ceil(high.x() + margin_px)) - x + 1,
            static_cast<int>(std::ceil(high.y() + margin_px)) - y + 1};
}

}  // namespace

TagFollower::Prediction TagFollower::predict(const Followed& tag) {
    Prediction prediction{tag.last, mean_side(tag.last.corners_px), 0};
    double speed_px = 0;
    if (tag.velocity_px) {
        for (std::size_t i = 0; i < 4; ++i) {
            prediction.detection.corners_px[i] += (*tag.velocity_px)[i];
            speed_px = std::max(speed_px, (*tag.velocity_px)[i].norm());
        }
        // A hand's shake keeps its velocity within a part of itself from frame to frame.
        prediction.error_px = 2 + 0.5 * speed_px;
    } else {
        constexpr double usual_speed_px = 12;  // of footage that is not panned, at any size between VGA and 4K
        prediction.error_px = std::max(usual_speed_px, 0.2 * prediction.side_px);
    }
    return prediction;
}

bool TagFollower::should_be_in_view(const Prediction& prediction) const {
    const Camera& camera = context_.lens.camera();
    return std::ranges::all_of(prediction.detection.corners_px, [&](const Eigen::Vector2d& corner) {
        return corner.x() > 0 && corner.y() > 0 && corner.x() < camera.width - 1 && corner.y() < camera.height - 1;
    });
}

std::optional<TagImageFit> TagFollower::follow(const PlateFrame& frame, const Prediction& prediction) const {
    // A cell of white lies around the corners, and the detector wants to see some of what lies beyond.
    const double margin_px = 0.3 * prediction.side_px + prediction.error_px + 4;
    const Region region = region_around(prediction.detection.corners_px, margin_px).intersected(whole_frame(frame));
    if (region.empty()) return std::nullopt;
    const ImageF light = context_.plate_light.gray(frame, region);
    const FitSource source{light, region.x, region.y, context_.lens, context_.plate_light.clipped_light(1)};
    const TagPattern pattern = context_.detector.family().pattern(prediction.detection.id);
    TagFitOptions options{pixels_of_fit(context_.level), prediction.error_px, context_.level != TrackLevel::fast};
    // A start that is off by a cell ends in a local minimum, which correlates less.
    constexpr double certain_correlation = 0.9;
    std::optional<TagImageFit> fit = fit_tag(source, pattern, prediction.detection, options);
    if (fit && fit->observation.refined && fit->observation.correlation > certain_correlation) return fit;

    options.start_error_px = 0;
    const Eigen::Vector2d predicted = centre_of(prediction.detection.corners_px);
    std::vector<TagDetection> found = context_.detector.detect(detection_image(light));
    std::erase_if(found, [&](const TagDetection& detection) { return detection.id != prediction.detection.id; });
    if (found.empty()) return std::nullopt;
    TagDetection nearest = *std::ranges::min_element(found, {}, [&](const TagDetection& detection) {
        Corners corners = detection.corners_px;
        for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(region.x, region.y);
        return (centre_of(corners) - predicted).norm();
    });
    for (Eigen::Vector2d& corner : nearest.corners_px) corner += Eigen::Vector2d(region.x, region.y);
    return fit_tag(source, pattern, nearest, options);
}

void TagFollower::search_everywhere(const PlateFrame& frame, FrameFindings& findings) {
    const ImageF light = context_.plate_light.gray(frame, whole_frame(frame));
    std::vector<TagDetection> detections = context_.detector.detect(detection_image(light));
    const auto is_found = [&, count = detections.size()](int id) {
        return std::any_of(detections.begin(), detections.begin() + static_cast<std::ptrdiff_t>(count),
                           [&](const TagDetection& detection) { return detection.id == id; });
    };
    // Tags that only show when shadows are lifted; the fit corrects their corners.
    const bool enough =
        context_.level == TrackLevel::fast ? !detections.empty() : std::ranges::all_of(context_.wanted, is_found);
    if (!enough) {
        for (const TagDetection& detection :
             context_.detector.detect(detection_image(light, DetectionScale::perceptual))) {
            if (!is_found(detection.id)) detections.push_back(detection);
        }
    }
    const FitSource source{light, 0, 0, context_.lens, context_.plate_light.clipped_light(1)};
    for (const TagDetection& detection : detections) {
        if (!context_.wanted.contains(detection.id)) {
            findings.foreign_ids.push_back(detection.id);
            continue;
        }
        if (is_known(findings, detection.id, centre_of(detection.corners_px))) continue;
        std::optional<TagImageFit> fit;
        if (context_.corners == CornerMethod::apriltag) {
            fit = detected_corners(context_.lens, context_.detector.family().pattern(detection.id), detection);
        } else {
            fit = fit_tag(source, context_.detector.family().pattern(detection.id), detection,
                          {pixels_of_fit(context_.level), 0, context_.level != TrackLevel::fast});
        }
        if (fit) {
            take(frame, *fit, findings);
        } else {
            ++findings.decoys;
        }
    }
}

void TagFollower::take(const PlateFrame& frame, const TagImageFit& fit, FrameFindings& findings) {
    findings.observations.tags.push_back(fit.observation);
    if (!fit.observation.refined && context_.corners == CornerMethod::fit) return;
    const TagPattern pattern = context_.detector.family().pattern(fit.observation.id);
    if (const auto reading = read_card(frame, context_.plate_light, context_.lens, pattern, fit)) {
        findings.cards.push_back(*reading);
    }
}

void TagFollower::remember(const FrameFindings& findings) {
    std::vector<Followed> next;
    for (const TagObservation& tag : findings.observations.tags) {
        Followed& followed = next.emplace_back();
        followed.last.id = tag.id;
        followed.last.decision_margin = tag.decision_margin;
        followed.last.corners_px = corners_of(tag);
        const Followed* before = nullptr;
        double nearest_px = 0;
        for (const Followed& old : followed_) {
            if (old.last.id != tag.id) continue;
            const double distance_px = (centre_of(old.last.corners_px) - centre_of(followed.last.corners_px)).norm();
            if (before && distance_px >= nearest_px) continue;
            before = &old;
            nearest_px = distance_px;
        }
        if (!before) continue;
        followed.velocity_px.emplace();
        for (std::size_t i = 0; i < 4; ++i) {
            (*followed.velocity_px)[i] = followed.last.corners_px[i] - before->last.corners_px[i];
        }
    }
    followed_ = std::move(next);
}

FrameFindings TagFollower::examine(const PlateFrame& frame) {
    FrameFindings findings;
    findings.observations.frame = frame.index();
    findings.observations.time_s = frame.time_s();
    bool lost = false;
    if (context_.corners == CornerMethod::fit) {
        for (const Followed& tag : followed_) {
            const Prediction prediction = predict(tag);
            const std::optional<TagImageFit> fit = follow(frame, prediction);
            if (!fit) {
                lost = lost || should_be_in_view(prediction);
            } else if (!is_known(findings, fit->observation.id, fit->observation.corners_px.rowwise().mean())) {
                take(frame, *fit, findings);
            }
        }
    }
    const auto& tags = findings.observations.tags;
    const bool complete = std::ranges::all_of(
        context_.wanted, [&](int id) { return std::ranges::count(tags, id, &TagObservation::id) > 0; });
    const bool search = !started_ || tags.empty() || (context_.level == TrackLevel::normal && lost) ||
                        (context_.level == TrackLevel::final_ && !complete);
    if (search) search_everywhere(frame, findings);
    started_ = true;
    std::ranges::stable_sort(findings.observations.tags, {}, &TagObservation::id);
    remember(findings);
    return findings;
}

}  // namespace matchlight
