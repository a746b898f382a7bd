// Poses between frames.
#include "compositor/shutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "compositor/nearest_known.h"

namespace matchlight {

namespace {

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
    const Eigen::AngleAxisd turn(rotation);
    return turn.angle() * turn.axis();
}

}  // namespace

ClipTime time_of(const SolvedFrame& frame) {
    return {.frame = static_cast<double>(frame.frame), .time_s = frame.time_s};
}

FrameShutter::FrameShutter(const Solve& solve, const SolvedFrame& frame, double share, double frame_s)
    : share_(share),
      middle_{time_of(frame)},
      frame_s_(frame_s),
      middle_camera_from_world_(*frame.camera_from_world),
      world_from_camera_(frame.camera_from_world->inverse()) {
    const SolvedFrame* before = solve.find(frame.frame - 1);
    const SolvedFrame* after = solve.find(frame.frame + 1);
    if (before != nullptr && after != nullptr) {
        frame_s_ = (after->time_s - before->time_s) / 2;
    } else if (before != nullptr || after != nullptr) {
        frame_s_ = after != nullptr ? after->time_s - frame.time_s : frame.time_s - before->time_s;
    }
    const bool has_before = before != nullptr && before->camera_from_world;
    const bool has_after = after != nullptr && after->camera_from_world;
    knows_motion_ = has_before || has_after;
    // Steps to the neighbours, forward in time.
    Eigen::Vector3d step_in_m = Eigen::Vector3d::Zero(), step_out_m = step_in_m;
    Eigen::Vector3d turn_in = step_in_m, turn_out = step_in_m;
    if (has_before) {
        const RigidTransform world_from_before = before->camera_from_world->inverse();
        step_in_m = world_from_camera_.translation() - world_from_before.translation();
        turn_in = -rotation_vector(world_from_camera_.linear().transpose() * world_from_before.linear());
    }
    if (has_after) {
        const RigidTransform world_from_after = after->camera_from_world->inverse();
        step_out_m = world_from_after.translation() - world_from_camera_.translation();
        turn_out = rotation_vector(world_from_camera_.linear().transpose() * world_from_after.linear());
    }
    if (has_before && has_after) {
        velocity_m_ = (step_in_m + step_out_m) / 2;
        acceleration_m_ = step_out_m - step_in_m;
        turn_ = (turn_in + turn_out) / 2;
        turn_change_ = turn_out - turn_in;
    } else if (knows_motion_) {
        velocity_m_ = has_after ? step_out_m : step_in_m;
        turn_ = has_after ? turn_out : turn_in;
    }
}

RigidTransform FrameShutter::camera_from_world(double frames) const {
    const double half_square = frames * frames / 2;
    const Eigen::Vector3d turned = frames * turn_ + half_square * turn_change_;
    RigidTransform world_from_camera = world_from_camera_;
    world_from_camera.translation() += frames * velocity_m_ + half_square * acceleration_m_;
    if (const double angle = turned.norm(); angle > 0) {
        world_from_camera.linear() = world_from_camera_.linear() * Eigen::AngleAxisd(angle, turned / angle);
    }
    return world_from_camera.inverse();
}

ClipTime FrameShutter::time(double frames) const {
    return {.frame = middle_.frame + frames, .time_s = middle_.time_s + frames * frame_s_};
}

std::optional<double> shutter_share(const MotionBlurSettings& settings, const Solve& solve, const SolvedFrame& frame,
                                    std::optional<double> otherwise, Warnings& warnings) {
    if (settings.shutter) return settings.shutter;
    if (const auto solved = known_near(solve, frame, &SolvedFrame::shutter_fraction)) return solved;
    if (!otherwise) {
        warnings.add(
            "motion blur is left out: the solve does not say how long the shutter is open; give shutter in "
            "[effects.motion_blur]");
    }
    return otherwise;
}

std::vector<double> shutter_times(int count, bool shuffled) {
    std::vector<int> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    if (shuffled) {
        // Points of the lens advance by the golden section in angle and evenly in area; the fraction of √2 is apart
        // from both (a Kronecker sequence), and its ranks are even in time.
        const auto place = [](int i) { return std::fmod(i * std::numbers::sqrt2, 1.0); };
        std::ranges::sort(order, {}, place);
    }
    std::vector<double> times(order.size());
    for (std::size_t rank = 0; rank < order.size(); ++rank) {
        times[static_cast<std::size_t>(order[rank])] = (static_cast<double>(rank) + 0.5) / count - 0.5;
    }
    return times;
}

int sub_frame_count(const MotionBlurSettings& settings) {
    // Enough that the steps of what moves by a hundred pixels are below the pixel.
    constexpr int of_reference = 128;
    switch (settings.level) {
        case MotionBlurLevel::sub_frames:
            return settings.sub_frames;
        case MotionBlurLevel::reference:
            return of_reference;
        case MotionBlurLevel::gather:
            break;
    }
    return 1;
}

}  // namespace matchlight
