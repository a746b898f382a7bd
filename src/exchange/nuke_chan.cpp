// Euler angles without jumps, and the lines.
#include "exchange/nuke_chan.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace matchlight {
namespace {

constexpr double deg_per_rad = 180 / std::numbers::pi;

double nearest_turn(double angle_deg, double near_deg) {
    return angle_deg + 360 * std::round((near_deg - angle_deg) / 360);
}

}  // namespace

Eigen::Vector3d zxy_angles_deg(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& near_deg) {
    // R = Ry·Rx·Rz has R12 = −sin x, R02 = cos x sin y, R22 = cos x cos y.
    const double cos_x = std::hypot(rotation(0, 2), rotation(2, 2));
    // Below it the direction of (R02, R22) is rounding noise, of R's own precision.
    constexpr double locked = 1e-9;
    const double x = std::atan2(-rotation(1, 2), cos_x);
    const double y = cos_x > locked ? std::atan2(rotation(0, 2), rotation(2, 2)) : near_deg.y() / deg_per_rad;
    // z from what is left when the other two are taken away: exact however small cos x is.
    const auto z_of = [&](double about_x, double about_y) {
        const Eigen::Matrix3d rest = (Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()))
                                         .toRotationMatrix()
                                         .transpose() *
                                     rotation;
        return std::atan2(rest(1, 0), rest(0, 0));
    };
    Eigen::Vector3d best;
    double distance = -1;
    // The same rotation has two sets of angles: x, and 180° − x with half a turn of the others.
    for (const bool other : {false, true}) {
        const double about_x = other ? std::numbers::pi - x : x;
        const double about_y = other ? y + std::numbers::pi : y;
        const Eigen::Vector3d angles = Eigen::Vector3d(about_x, about_y, z_of(about_x, about_y)) * deg_per_rad;
        const Eigen::Vector3d turned = angles.binaryExpr(near_deg, &nearest_turn);
        if (distance < 0 || (turned - near_deg).norm() < distance) {
            distance = (turned - near_deg).norm();
            best = turned;
        }
    }
    return best;
}

std::string nuke_chan_text(const CameraTrack& track) {
    const double vertical_fov_deg = 2 * std::atan2(track.pinhole.height / 2.0, track.pinhole.fy) * deg_per_rad;
    std::string text;
    Eigen::Vector3d angles_deg = Eigen::Vector3d::Zero();
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        const RigidTransform pose = in_y_up_world(world_from_gl_camera(*frame.camera_from_world));
        angles_deg = zxy_angles_deg(pose.rotation(), angles_deg);
        const Eigen::Vector3d& place = pose.translation();
        text += fmt::format("{} {} {} {} {} {} {} {}\n", frame.frame, place.x(), place.y(), place.z(), angles_deg.x(),
                            angles_deg.y(), angles_deg.z(), vertical_fov_deg);
    }
    return text;
}

}  // namespace matchlight
