// RFC 4180, numbers only: nothing needs quotes.
#include "exchange/camera_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace matchlight {
namespace {

std::string cell(const std::optional<double>& value) {
    return value ? fmt::format(",{}", *value) : ",";
}

}  // namespace

std::string camera_table_csv(const CameraTrack& track) {
    std::string text =
        "frame,time_s,x_m,y_m,z_m,qw,qx,qy,qz,bridged,pose_confidence,reprojection_px,tags,exposure_ev,"
        "white_balance_r,white_balance_g,white_balance_b,exposure_confidence,focus_distance_m,coc_scale_px_m,"
        "focus_confidence,shutter_fraction,shutter_confidence\r\n";
    for (const SolvedFrame& frame : track.frames) {
        text += fmt::format("{},{}", frame.frame, frame.time_s);
        if (frame.camera_from_world) {
            const RigidTransform world_from_camera = frame.camera_from_world->inverse();
            const Eigen::Vector3d& place = world_from_camera.translation();
            const Eigen::Quaterniond turn(world_from_camera.rotation());
            text += fmt::format(",{},{},{},{},{},{},{},{}", place.x(), place.y(), place.z(), turn.w(), turn.x(),
                                turn.y(), turn.z(), frame.bridged ? 1 : 0);
        } else {
            text += ",,,,,,,,";
        }
        text += cell(frame.pose_confidence) + cell(frame.reprojection_px);
        text += fmt::format(",{}", fmt::join(frame.tags, " "));
        text += cell(frame.exposure_ev);
        for (std::size_t c = 0; c < 3; ++c) {
            text += cell(frame.white_balance ? std::optional((*frame.white_balance)[c]) : std::nullopt);
        }
        text += cell(frame.exposure_confidence) + cell(frame.focus_distance_m) + cell(frame.coc_scale_px_m) +
                cell(frame.focus_confidence) + cell(frame.shutter_fraction) + cell(frame.shutter_confidence) + "\r\n";
    }
    return text;
}

}  // namespace matchlight
