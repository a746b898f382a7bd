// Where camera and time are while a frame's shutter is open.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/transforms.h"
#include "core/warnings.h"
#include "scene/effects.h"
#include "scene/object_motion.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// When a frame was exposed, at the middle of its exposure.
ClipTime time_of(const SolvedFrame& frame);

/// One frame's exposure. Times count in frames from its middle, for which the solve's pose holds.
class FrameShutter {
public:
    /// `frame` has a pose. Between the neighbouring frames' poses the camera's place goes along a parabola through the
    /// three, its rotation vector likewise; with one neighbour along a line, with none it stands still. `share` of the
    /// frame's time is exposed; `frame_s` is that time where there is no neighbour to tell it.
    FrameShutter(const Solve& solve, const SolvedFrame& frame, double share, double frame_s);

    double share() const { return share_; }
    /// Of the middle: time 0.
    const RigidTransform& camera_from_world() const { return middle_camera_from_world_; }
    RigidTransform camera_from_world(double frames) const;
    ClipTime time(double frames) const;
    /// Whether neighbours tell how the camera moves.
    bool knows_motion() const { return knows_motion_; }

private:
    double share_ = 0;
    ClipTime middle_;
    double frame_s_ = 0;
    bool knows_motion_ = false;
    RigidTransform middle_camera_from_world_ = RigidTransform::Identity();
    RigidTransform world_from_camera_ = RigidTransform::Identity();
    Eigen::Vector3d velocity_m_ = Eigen::Vector3d::Zero(), acceleration_m_ = Eigen::Vector3d::Zero();  // a frame
    Eigen::Vector3d turn_ = Eigen::Vector3d::Zero(), turn_change_ = Eigen::Vector3d::Zero();  // radians, camera's axes
};

/// Share of the frame's time that the shutter is open: of the settings, of the solve (frames that do not know take
/// their nearest neighbour's), or `otherwise`; nullopt, and a warning, where nothing says so.
std::optional<double> shutter_share(const MotionBlurSettings& settings, const Solve& solve, const SolvedFrame& frame,
                                    std::optional<double> otherwise, Warnings& warnings);

/// How many times the scene is drawn at over the shutter; 1 where one picture is blurred.
int sub_frame_count(const MotionBlurSettings& settings);

/// Times of that many pictures, evenly over the shutter: from −1/2 to 1/2 of its share. `shuffled`: in an order that
/// goes with points of the lens, so that lens and shutter are covered together.
std::vector<double> shutter_times(int count, bool shuffled);

}  // namespace matchlight
