// Residuals against the solve's own poses, and thresholds that follow from the clip.
#include "report/solve_findings.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/median.h"

namespace matchlight {
namespace {

/// Half a pixel off is what an eye sees of an edge that stands still.
constexpr double visible_px = 0.5;
/// 7 % of light from one frame to the next: about what is seen as a flicker.
constexpr double visible_ev = 0.1;
/// Robust standard deviations beyond which a frame is not one of the clip's usual ones.
constexpr double unusual = 6;
constexpr double sigma_per_mad = 1.4826;  // of a normal distribution
constexpr double doubtful = 0.5;          // a confidence below it is said to be low

TagCorners projected(const Solve& solve, const RigidTransform& camera_from_world, const SolvedTag& tag) {
    const Eigen::Matrix<double, 3, 4> corners = camera_from_world * tag.world_from_tag * tag_corners_m(tag.size_m);
    TagCorners px;
    for (int i = 0; i < 4; ++i) px.col(i) = solve.camera.pixel_from_camera(corners.col(i));
    return px;
}

double rms_px(const TagCorners& residual_px) {
    return std::sqrt(residual_px.colwise().squaredNorm().mean());
}

FrameResiduals findings_of(const Solve& solve, const SolvedFrame& frame, const FrameObservations* seen) {
    FrameResiduals found;
    if (frame.camera_from_world && frame.covariance) {
        found.predicted_px = predicted_error_px(solve, *frame.camera_from_world, *frame.covariance);
    }
    if (seen == nullptr) return found;
    for (const TagObservation& observation : seen->tags) {
        const auto tag = std::ranges::find(solve.rig, observation.id, &SolvedTag::id);
        if (tag == solve.rig.end()) continue;
        TagResidual residual;
        residual.id = observation.id;
        residual.observed_px = observation.corners_px;
        residual.residual_px.setZero();
        if (frame.camera_from_world) {
            residual.residual_px = observation.corners_px - projected(solve, *frame.camera_from_world, *tag);
            residual.used = !frame.bridged && std::ranges::find(frame.tags, observation.id) != frame.tags.end();
        }
        // An id seen twice: the pose rests on the one nearer to where the tag is.
        const auto twin = std::ranges::find(found.tags, residual.id, &TagResidual::id);
        if (twin != found.tags.end()) {
            (rms_px(twin->residual_px) <= rms_px(residual.residual_px) ? residual : *twin).used = false;
        }
        found.tags.push_back(residual);
    }
    return found;
}

TagFindings findings_of_tag(const Solve& solve, const std::vector<FrameResiduals>& frames, int id) {
    TagFindings found{.id = id};
    double squares = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        for (const TagResidual& tag : frames[i].tags) {
            if (tag.id != id || !tag.used) continue;
            ++found.frames;
            squares += tag.residual_px.colwise().squaredNorm().mean();
            found.mean_px += tag.residual_px.rowwise().mean();
            if (const double rms = rms_px(tag.residual_px); rms > found.worst_px) {
                found.worst_px = rms;
                found.worst_frame = solve.frames[i].frame;
            }
        }
    }
    if (found.frames > 0) {
        found.rms_px = std::sqrt(squares / static_cast<double>(found.frames));
        found.mean_px /= static_cast<double>(found.frames);
    }
    return found;
}

/// Collects runs of frames for which `badness` has a value; the largest is the worst.
class Flags {
public:
    explicit Flags(const Solve& solve) : solve_(solve) {}

    using Badness = std::function<std::optional<double>(std::size_t)>;
    void add(const std::string& reason, const Badness& badness, const std::function<std::string(double)>& text) {
        std::vector<std::pair<double, FlaggedRun>> runs;
        bool open = false;
        for (std::size_t i = 0; i < solve_.frames.size(); ++i) {
            const std::optional<double> bad = badness(i);
            const std::int64_t frame = solve_.frames[i].frame;
            if (!bad) {
                open = false;
                continue;
            }
            if (!open) runs.push_back({*bad, {reason, text(*bad), frame, frame, frame}});
            open = true;
            auto& [worst, run] = runs.back();
            run.last = frame;
            if (*bad > worst) {
                worst = *bad;
                run.worst = frame;
                run.worst_value = text(*bad);
            }
        }
        std::ranges::stable_sort(runs, std::greater(), &std::pair<double, FlaggedRun>::first);
        for (auto& [bad, run] : runs) runs_.push_back(std::move(run));
    }

    std::vector<FlaggedRun> take() { return std::move(runs_); }

private:
    const Solve& solve_;
    std::vector<FlaggedRun> runs_;
};

std::optional<double> when(bool condition, double badness = 1) {
    return condition ? std::optional(badness) : std::nullopt;
}

std::string nothing(double /*badness*/) {
    return {};
}

void flag_poses(Flags& flags, const Solve& solve, const SolveFindings& found) {
    flags.add(
        "no pose", [&](std::size_t i) { return when(!solve.frames[i].camera_from_world); }, nothing);
    flags.add(
        "bridged: the pose rests on the path, not on tags of this frame",
        [&](std::size_t i) { return when(solve.frames[i].bridged, found.frames[i].predicted_px.value_or(0)); },
        [](double px) { return px > 0 ? fmt::format("predicted error {:.2f} px", px) : std::string(); });
    flags.add(
        "the pose is uncertain",
        [&](std::size_t i) {
            const double px = found.frames[i].predicted_px.value_or(0);
            return when(px > visible_px && !solve.frames[i].bridged, px);
        },
        [](double px) { return fmt::format("predicted error {:.2f} px at the tags", px); });
}

void flag_residuals(Flags& flags, const Solve& solve, SolveFindings& found) {
    std::vector<double> values, deviations;
    for (const SolvedFrame& frame : solve.frames) {
        if (frame.reprojection_px) values.push_back(*frame.reprojection_px);
    }
    if (values.empty()) return;
    const double median = upper_median(values);
    for (const double value : values) deviations.push_back(std::abs(value - median));
    const double limit = std::max(2 * median, median + unusual * sigma_per_mad * upper_median(deviations));
    found.median_reprojection_px = median;
    flags.add(
        "residuals far above the clip's",
        [&](std::size_t i) {
            const double px = solve.frames[i].reprojection_px.value_or(0);
            return when(px > limit, px);
        },
        [median](double px) { return fmt::format("{:.2f} px (median of the clip {:.3f} px)", px, median); });
}

void flag_tags(Flags& flags, const Solve& solve, const TrackDetails& details) {
    const auto path_frame = [&](std::size_t i) -> const PathFrame* {
        const auto found = std::ranges::lower_bound(details.path, solve.frames[i].frame, {}, &PathFrame::frame);
        return found != details.path.end() && found->frame == solve.frames[i].frame ? &*found : nullptr;
    };
    const auto flag = [&](const char* reason, bool PathFrame::*member) {
        flags.add(
            reason,
            [&](std::size_t i) {
                const PathFrame* frame = path_frame(i);
                return when(frame != nullptr && frame->*member, solve.frames[i].reprojection_px.value_or(0));
            },
            [](double px) { return px > 0 ? fmt::format("residuals {:.2f} px", px) : std::string(); });
    };
    flag("tags disagree by more than 2 px: one was moved, or the lens or a size is wrong", &PathFrame::disagreeing);
    flag("a tag was left out because the others contradict it", &PathFrame::outvoted);
    flag("an id is seen twice", &PathFrame::seen_twice);
    flag("no tag of 25 px or more", &PathFrame::small);
    flag("tags only under 15 degrees from the side", &PathFrame::grazing);
    flag("only tags that the frame cuts off", &PathFrame::cut_off);
}

void flag_confidence(Flags& flags, const Solve& solve) {
    const auto flag = [&](const char* reason, std::optional<double> SolvedFrame::*confidence) {
        flags.add(
            reason,
            [&](std::size_t i) {
                const double sure = (solve.frames[i].*confidence).value_or(1);
                return when(sure < doubtful && !solve.frames[i].bridged, 1 - sure);
            },
            [](double bad) { return fmt::format("confidence {:.2f}", 1 - bad); });
    };
    flag("low confidence of the pose", &SolvedFrame::pose_confidence);
    flag("low confidence of the exposure", &SolvedFrame::exposure_confidence);
    flags.add(
        "the exposure jumps",
        [&](std::size_t i) -> std::optional<double> {
            if (i == 0 || !solve.frames[i].exposure_ev || !solve.frames[i - 1].exposure_ev) return std::nullopt;
            const double step = std::abs(*solve.frames[i].exposure_ev - *solve.frames[i - 1].exposure_ev);
            return when(step > visible_ev, step);
        },
        [](double ev) { return fmt::format("{:.2f} EV from the frame before", ev); });
}

}  // namespace

std::optional<double> predicted_error_px(const Solve& solve, const RigidTransform& camera_from_world,
                                         const Eigen::Matrix<double, 6, 6>& covariance) {
    double variance_px2 = 0;
    int corners = 0;
    for (const SolvedTag& tag : solve.rig) {
        const Eigen::Matrix<double, 3, 4> places = tag.world_from_tag * tag_corners_m(tag.size_m);
        for (int i = 0; i < 4; ++i) {
            const Eigen::Vector3d world = places.col(i);
            const Eigen::Vector3d seen = camera_from_world * world;
            if (!(seen.z() > 0)) continue;
            // camera_from_world · Exp(ω, v) moves a point by R·(ω × X + v).
            Eigen::Matrix<double, 3, 6> moved;
            moved << -cross_matrix(world), Eigen::Matrix3d::Identity();
            Eigen::Matrix<double, 2, 3> px;
            px << solve.camera.fx / seen.z(), 0, -solve.camera.fx * seen.x() / (seen.z() * seen.z()),  //
                0, solve.camera.fy / seen.z(), -solve.camera.fy * seen.y() / (seen.z() * seen.z());
            const Eigen::Matrix<double, 2, 6> jacobian = px * camera_from_world.rotation() * moved;
            variance_px2 += (jacobian * covariance * jacobian.transpose()).trace();
            ++corners;
        }
    }
    if (corners == 0 || !(variance_px2 >= 0)) return std::nullopt;
    return std::sqrt(variance_px2 / corners);
}

SolveFindings find_weak_points(const Solve& solve, const TrackDetails& details) {
    SolveFindings found;
    for (const SolvedFrame& frame : solve.frames) {
        const auto seen = std::ranges::find(details.observations, frame.frame, &FrameObservations::frame);
        found.frames.push_back(findings_of(solve, frame, seen == details.observations.end() ? nullptr : &*seen));
    }
    for (const SolvedTag& tag : solve.rig) found.tags.push_back(findings_of_tag(solve, found.frames, tag.id));
    Flags flags(solve);
    flag_poses(flags, solve, found);
    flag_residuals(flags, solve, found);
    flag_tags(flags, solve, details);
    flag_confidence(flags, solve);
    found.flagged = flags.take();
    return found;
}

}  // namespace matchlight
