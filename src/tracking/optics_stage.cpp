// Readings of blur with their depths and motions, and what their solution is worth.
#include "tracking/optics_stage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "tracking/optics_solve.h"

namespace matchlight {

namespace {

/// The camera before and after a frame, and the frames between.
struct Neighbours {
    const RigidTransform* before = nullptr;
    const RigidTransform* after = nullptr;
    double frames = 1;
};

/// Poses that rest on tags of their own frame.
const RigidTransform* measured_pose(const CameraPath& path, std::size_t frame) {
    if (frame >= path.frames.size()) return nullptr;
    const PathFrame& at = path.frames[frame];
    return at.pose && !at.bridged ? &at.pose->camera_from_world : nullptr;
}

std::optional<Neighbours> neighbours_of(const CameraPath& path, std::size_t frame) {
    const RigidTransform* now = measured_pose(path, frame);
    Neighbours around{frame > 0 ? measured_pose(path, frame - 1) : nullptr, measured_pose(path, frame + 1), 0};
    for (const RigidTransform** side : {&around.before, &around.after}) {
        if (*side)
            around.frames += 1;
        else
            *side = now;
    }
    if (around.frames == 0 && path.frames.size() > 1) return std::nullopt;
    around.frames = std::max(1.0, around.frames);  // a single picture is taken to stand still
    return around;
}

class ReadingCollector {
public:
    explicit ReadingCollector(const GeometrySolution& geometry) : geometry_(geometry) {}

    std::optional<TagBlurReadings> collect(const TagObservation& seen, std::size_t frame,
                                           const Neighbours& around) const {
        const auto place = geometry_.rig.world_from_tag.find(seen.id);
        if (!seen.refined || seen.edge_blur.edges.empty() || place == geometry_.rig.world_from_tag.end()) {
            return std::nullopt;
        }
        const RigidTransform& camera_from_world = *measured_pose(geometry_.path, frame);
        const RigidTransform camera_from_tag = camera_from_world * place->second;
        TagBlurReadings readings;
        readings.frame = frame;
        readings.id = seen.id;
        readings.covariance = seen.edge_blur.covariance;
        for (const EdgeBlur& edge : seen.edge_blur.edges) {
            const Eigen::Vector3d ray = edge.normalized.homogeneous();
            const Eigen::Vector3d normal = camera_from_tag.linear().col(2);
            const double depth = normal.dot(camera_from_tag.translation()) / normal.dot(ray);
            if (!(depth > 0)) return std::nullopt;
            const Eigen::Vector3d world = camera_from_world.inverse() * (depth * ray);
            const Eigen::Vector2d motion = (geometry_.camera.pixel_from_camera(*around.after * world) -
                                            geometry_.camera.pixel_from_camera(*around.before * world)) /
                                           around.frames;
            BlurReading reading;
            reading.place = geometry_.camera.pixel_from_normalized(edge.normalized) / geometry_.camera.width;
            reading.inverse_depth = 1 / depth;
            reading.normal = edge.normal;
            reading.motion_px = motion.dot(edge.normal);
            reading.variance_px2 = edge.variance_px2;
            // Beyond a quarter of a cell (standard deviation) neighbouring edges run into each other; beyond a dozen
            // pixels of motion a hand is no longer steady over an exposure.
            constexpr double most_cells = 0.25, most_motion_px = 12;
            const double most_variance = std::pow(most_cells * seen.edge_blur.cell_px, 2);
            if (!(reading.variance_px2 < most_variance) || !(motion.norm() < most_motion_px)) return std::nullopt;
            readings.readings.push_back(reading);
        }
        return readings;
    }

private:
    const GeometrySolution& geometry_;
};

std::vector<TagBlurReadings> collect_readings(const ClipObservations& clip, const GeometrySolution& geometry) {
    const ReadingCollector collector(geometry);
    std::vector<TagBlurReadings> readings;
    for (std::size_t f = 0; f < clip.frames.size(); ++f) {
        if (!measured_pose(geometry.path, f)) continue;
        const std::optional<Neighbours> around = neighbours_of(geometry.path, f);
        if (!around) continue;
        std::map<int, int> times_seen;
        for (const TagObservation& seen : clip.frames[f].tags) ++times_seen[seen.id];
        for (const TagObservation& seen : clip.frames[f].tags) {
            if (times_seen[seen.id] > 1) continue;
            if (auto tag = collector.collect(seen, f, *around)) readings.push_back(std::move(*tag));
        }
    }
    return readings;
}

/// 1 where the error is small beside what an eye would notice, ½ where it is as large.
double confidence_of(double sigma, double noticeable) {
    return 1 / (1 + std::pow(sigma / noticeable, 2));
}

void take_focus(const OpticsSolution& optics, Solve& solve, OpticsSummary& summary) {
    constexpr double most_coc_error = 0.25;  // of its value
    const Estimate& scale = optics.coc_scale;
    if (!optics.defocus_seen) {
        summary.focus_unknown = "the tags' blur does not change with depth";
        return;
    }
    if (!(scale.sigma < most_coc_error * scale.value)) {
        summary.focus_unknown = "the tags' blur changes too little with depth";
        return;
    }
    summary.coc_scale_px_m = scale.value;
    summary.coc_scale_sigma = scale.sigma;
    for (std::size_t f = 0; f < solve.frames.size(); ++f) {
        const Estimate& focus = optics.focus[f];
        // An error of a pixel, or of a quarter, of the circle of confusion shows; beyond infinity there is nothing.
        constexpr double noticeable_px = 1, most_focus_error = 0.25, farthest_m = 1000;
        const double error_px = scale.value * focus.sigma;
        if (!(error_px < noticeable_px) && !(focus.sigma < most_focus_error * focus.value)) continue;
        SolvedFrame& frame = solve.frames[f];
        frame.focus_distance_m = 1 / std::max(focus.value, 1 / farthest_m);
        frame.coc_scale_px_m = scale.value;
        const double share = std::hypot(scale.sigma / scale.value, focus.sigma / std::max(focus.value, 1 / farthest_m));
        frame.focus_confidence =
            std::max(confidence_of(error_px, noticeable_px), confidence_of(share, most_focus_error));
        summary.focus_m.push_back(*frame.focus_distance_m);
    }
}

void take_shutter(const OpticsSolution& optics, Solve& solve, OpticsSummary& summary) {
    // From the square, whose errors are the normal ones; two standard deviations tell it from a shutter that is closed
    // at once.
    constexpr double noticeable = 0.1;
    const double square = std::max(0.0, optics.shutter2.value), sigma = optics.shutter2.sigma;
    const bool is_open = square > 2 * sigma;
    const double fraction = is_open ? std::sqrt(square) : 0;
    const double error = is_open ? sigma / (2 * fraction) : std::sqrt(square + sigma);
    constexpr double most_error = 1.5 * noticeable;
    if (!(error < (is_open ? most_error : 2 * noticeable))) {
        summary.shutter_unknown = "the picture moves too little";
        return;
    }
    if (fraction > 1 + 2 * error) {
        summary.shutter_unknown = "blur and motion contradict each other";
        return;
    }
    summary.shutter_fraction = std::min(1.0, fraction);
    summary.shutter_sigma = error;
    for (SolvedFrame& frame : solve.frames) {
        frame.shutter_fraction = summary.shutter_fraction;
        frame.shutter_confidence = confidence_of(error, noticeable);
    }
}

}  // namespace

void solve_optics_stage(const ClipContext& context, const ClipObservations& clip, const GeometrySolution& geometry,
                        Solve& solve, TrackSummary& summary) {
    OpticsSummary& found = summary.optics;
    if (context.options.level == TrackLevel::fast) {
        found.focus_unknown = found.shutter_unknown = "not looked for at this level";
        return;
    }
    const std::vector<TagBlurReadings> readings = collect_readings(clip, geometry);
    constexpr std::size_t fewest = 2;
    if (readings.size() < fewest) {
        found.focus_unknown = found.shutter_unknown = "no tag is large and sharp enough";
        return;
    }
    const OpticsSolution optics = solve_optics(readings, clip.frames.size());
    take_focus(optics, solve, found);
    take_shutter(optics, solve, found);
    // Blur that is the same at every depth is softness only where it is small: it might be a lens out of focus.
    constexpr double most_softness_px2 = 1;
    const bool is_softness = found.coc_scale_px_m || optics.softness_px2.value < most_softness_px2;
    if (is_softness && optics.softness_px2.value > 0) {
        solve.softness_px = found.softness_px = std::sqrt(optics.softness_px2.value);
    }
}

}  // namespace matchlight
