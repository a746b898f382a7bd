// Camera model, poses, and tracks of the tags' corners.
#include "exchange/colmap_text.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

constexpr double centre = 0.5;  // of COLMAP's first pixel; Matchlight's is at 0

/// A model without distortion for a centred picture.
std::string pinhole_line(const PinholePicture& picture) {
    return fmt::format("1 PINHOLE {} {} {} {} {} {}\n", picture.width, picture.height, picture.fx, picture.fy,
                       picture.cx + centre, picture.cy + centre);
}

std::string camera_line(const Camera& camera, const std::filesystem::path& reported) {
    if (!camera.has_distortion()) return pinhole_line(pinhole_of(camera, false));
    const auto k = [&](std::size_t i) { return i < camera.distortion.size() ? camera.distortion[i] : 0.0; };
    const std::string common = fmt::format("{} {} {} {} {} {} {} {} {} {}", camera.width, camera.height, camera.fx,
                                           camera.fy, camera.cx + centre, camera.cy + centre, k(0), k(1), k(2), k(3));
    if (camera.lens == LensModel::fisheye) return fmt::format("1 OPENCV_FISHEYE {}\n", common);
    for (std::size_t i = 8; i < camera.distortion.size(); ++i) {
        if (camera.distortion[i] != 0) {
            throw InputError(reported, "no camera model of COLMAP holds thin-prism or tilt coefficients",
                             "export with --centred for plates undistorted by --stmap undistort --centred");
        }
    }
    if (k(4) == 0 && k(5) == 0 && k(6) == 0 && k(7) == 0) return fmt::format("1 OPENCV {}\n", common);
    return fmt::format("1 FULL_OPENCV {} {} {} {} {}\n", common, k(4), k(5), k(6), k(7));
}

struct CornerPoint {
    Eigen::Vector3d place_m;
    double error_px_sum = 0;
    std::string track;
    int seen = 0;
};

Eigen::Vector2d pixel_of(const CameraTrack& track, bool distorted, const Eigen::Vector3d& camera_m) {
    if (distorted) return track.camera.pixel_from_camera(camera_m);
    const PinholePicture& p = track.pinhole;
    return {p.fx * camera_m.x() / camera_m.z() + p.cx, p.fy * camera_m.y() / camera_m.z() + p.cy};
}

}  // namespace

std::vector<std::string> colmap_file_names() {
    return {"cameras.txt", "images.txt", "points3D.txt"};
}

std::vector<std::string> colmap_texts(const CameraTrack& track, const std::filesystem::path& image_names,
                                      const std::filesystem::path& reported) {
    const PinholePicture as_filmed = pinhole_of(track.camera, false);
    // --centred asks for another picture than the footage's: an undistorted one.
    const bool distorted =
        as_filmed.fx == track.pinhole.fx && as_filmed.cx == track.pinhole.cx && as_filmed.cy == track.pinhole.cy;
    const std::string cameras = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n" +
                                (distorted ? camera_line(track.camera, reported) : pinhole_line(track.pinhole));
    std::vector<CornerPoint> points;
    std::map<int, std::size_t> first_point;
    for (const SolvedTag& tag : track.rig) {
        first_point[tag.id] = points.size();
        const Eigen::Matrix<double, 3, 4> corners = tag.world_from_tag * tag_corners_m(tag.size_m);
        for (int i = 0; i < 4; ++i) points.push_back({corners.col(i), 0, "", 0});
    }
    std::string images =
        "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME (camera from world)\n# POINTS2D[] as X Y POINT3D_ID, the tags' "
        "corners projected\n";
    std::int64_t image_id = 0;
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        ++image_id;
        const Eigen::Quaterniond q(frame.camera_from_world->rotation());
        const Eigen::Vector3d& t = frame.camera_from_world->translation();
        images += fmt::format("{} {} {} {} {} {} {} {} 1 {}\n", image_id, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                              t.z(), numbered(image_names, frame.frame).string());
        int point_in_image = 0;
        for (const int id : frame.tags) {
            const auto first = first_point.find(id);
            if (first == first_point.end()) continue;
            for (std::size_t i = first->second; i < first->second + 4; ++i) {
                const Eigen::Vector3d camera_m = *frame.camera_from_world * points[i].place_m;
                if (camera_m.z() <= 0) continue;
                const Eigen::Vector2d px = pixel_of(track, distorted, camera_m);
                images +=
                    fmt::format("{}{} {} {}", point_in_image > 0 ? " " : "", px.x() + centre, px.y() + centre, i + 1);
                points[i].track += fmt::format(" {} {}", image_id, point_in_image++);
                points[i].error_px_sum += frame.reprojection_px.value_or(0);
                ++points[i].seen;
            }
        }
        images += "\n";
    }
    std::string points_text = "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n";
    for (std::size_t i = 0; i < points.size(); ++i) {
        const CornerPoint& point = points[i];
        points_text += fmt::format("{} {} {} {} 128 128 128 {}{}\n", i + 1, point.place_m.x(), point.place_m.y(),
                                   point.place_m.z(), point.error_px_sum / std::max(1, point.seen), point.track);
    }
    return {cameras, images, points_text};
}

}  // namespace matchlight
