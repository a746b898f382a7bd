// Range, numbers, frame rate, and what formats lose.
#include "exchange/camera_track.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {
namespace {

bool times_ascend(const std::vector<SolvedFrame>& frames) {
    return std::ranges::adjacent_find(frames, [](const SolvedFrame& a, const SolvedFrame& b) {
               return !(a.time_s < b.time_s);
           }) == frames.end();
}

/// Largest distance of a time stamp from where an even rate would have it, in frames.
double largest_unevenness(const std::vector<SolvedFrame>& frames, double fps) {
    double largest = 0;
    for (const SolvedFrame& frame : frames) {
        const double expected = static_cast<double>(frame.frame - frames.front().frame);
        largest = std::max(largest, std::abs((frame.time_s - frames.front().time_s) * fps - expected));
    }
    return largest;
}

/// Files of other programs keep floats and 32-bit frame numbers: what lies beyond any footage is damage.
void check_within_reason(const SolvedFrame& frame, const std::filesystem::path& reported) {
    constexpr std::int64_t last_frame = 1'000'000'000;  // a year at 30 a second
    constexpr double farthest_m = 1e9, latest_s = 1e9;
    if (frame.frame > last_frame) throw InputError(reported, "counts more than a thousand million frames");
    if (std::abs(frame.time_s) > latest_s) throw InputError(reported, frame.frame, "its time stamp is absurd");
    if (frame.camera_from_world && frame.camera_from_world->inverse().translation().norm() > farthest_m) {
        throw InputError(reported, frame.frame, "the camera is farther off than any footage shows");
    }
}

}  // namespace

PinholePicture pinhole_of(const Camera& camera, bool centred) {
    if (!centred) return {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
    return {camera.width, camera.height, camera.fy, camera.fy, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0};
}

std::int64_t CameraTrack::posed() const {
    return std::ranges::count_if(frames, [](const SolvedFrame& frame) { return frame.camera_from_world.has_value(); });
}

std::optional<double> frame_rate(const std::vector<SolvedFrame>& frames) {
    if (frames.size() < 2 || !times_ascend(frames)) return std::nullopt;
    const double duration_s = frames.back().time_s - frames.front().time_s;
    const double mean = static_cast<double>(frames.back().frame - frames.front().frame) / duration_s;
    // Some containers round time stamps to a millisecond, so that the ends are each off by up to half of one.
    const double uncertainty = mean * 1e-3 / duration_s;
    double best = mean, distance = uncertainty;
    for (const double usual : {std::round(mean), std::round(mean * 1.001) / 1.001}) {
        if (usual > 0 && std::abs(usual - mean) < distance) {
            best = usual;
            distance = std::abs(usual - mean);
        }
    }
    return best;
}

CameraTrack camera_track(const Solve& solve, const CameraTrackOptions& options, const std::filesystem::path& reported,
                         Warnings& warnings) {
    CameraTrack track;
    track.source = solve.footage_file;
    track.camera = solve.camera;
    track.pinhole = pinhole_of(solve.camera, options.centred);
    track.sensor_width_mm = options.sensor_width_mm;
    track.rig = solve.rig;
    track.first_number = options.first_number;
    for (const SolvedFrame& frame : solve.frames) {
        if (frame.frame < options.first_frame || (options.last_frame && frame.frame > *options.last_frame)) continue;
        check_within_reason(frame, reported);
        track.frames.push_back(frame);
    }
    if (track.posed() == 0) {
        throw InputError(reported, "no frame of the range has a pose", "give --frames of another part of the clip");
    }
    // The whole clip's rate: a part of it would make the same clip another rate.
    const std::optional<double> measured = frame_rate(solve.frames);
    constexpr double usual_rate = 25;  // also what image sequences have unless told otherwise
    track.fps = options.fps.value_or(measured.value_or(usual_rate));
    const bool timed = measured && !options.fps;
    // A quarter of a frame: more than rounding to milliseconds makes at any usual rate.
    constexpr double even_frames = 0.25;
    if (timed && largest_unevenness(solve.frames, track.fps) > even_frames) {
        warnings.add(
            fmt::format("{}: the frame rate varies: files that count frames play at {:.6g} a second, others "
                        "keep the time stamps",
                        reported.string(), track.fps));
    } else if (!measured && !options.fps && solve.frames.size() > 1) {
        warnings.add(fmt::format("{}: its time stamps do not ascend: {} frames a second are assumed (--fps)",
                                 reported.string(), usual_rate));
    }
    for (SolvedFrame& frame : track.frames) {
        if (!timed) frame.time_s = static_cast<double>(frame.frame) / track.fps;
        frame.frame += options.first_number;
    }
    const auto missing = static_cast<std::int64_t>(track.frames.size()) - track.posed();
    if (missing > 0) warnings.add(fmt::format("{}: {} frames have no pose", reported.string(), missing));
    return track;
}

std::vector<std::string> what_is_lost(const CameraTrack& track, const CameraLimits& limits) {
    std::vector<std::string> lost;
    const PinholePicture& pinhole = track.pinhole;
    if (!limits.distortion && track.camera.has_distortion()) {
        lost.push_back(
            fmt::format("the lens' {} is not in this file: it fits the plate undistorted by --stmap undistort",
                        track.camera.lens == LensModel::fisheye ? "fisheye projection" : "distortion"));
    }
    // A hundredth of a pixel is what poses are good to.
    constexpr double visible_px = 0.01;
    const double right_px = pinhole.cx - (pinhole.width - 1) / 2.0, down_px = pinhole.cy - (pinhole.height - 1) / 2.0;
    if (!limits.offset && std::hypot(right_px, down_px) > visible_px) {
        lost.push_back(
            fmt::format("the principal point, {:+.2f} px right and {:+.2f} px down of the middle, is not in "
                        "this file: export it, and the STMaps, with --centred",
                        right_px, down_px));
    }
    if (!limits.pixel_aspect && std::abs(pinhole.fx / pinhole.fy - 1) * pinhole.width / 2 > visible_px) {
        lost.push_back(
            fmt::format("the pixels' aspect (fx {:.3f}, fy {:.3f}) is not in this file: export it, and the "
                        "STMaps, with --centred",
                        pinhole.fx, pinhole.fy));
    }
    return lost;
}

RigidTransform world_from_gl_camera(const RigidTransform& camera_from_world) {
    // From picture axes (y down, z away) to those of geometry (y up, z towards the viewer): the same half turn about x
    // as between a tag and AprilTag's library.
    const RigidTransform camera_from_gl_camera(detector_from_tag_axes());
    return camera_from_world.inverse() * camera_from_gl_camera;
}

RigidTransform in_y_up_world(const RigidTransform& world_from_thing) {
    return RigidTransform(world_from_model_axes().transpose()) * world_from_thing;
}

}  // namespace matchlight
