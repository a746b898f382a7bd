// Decodes the plate where a lens without distortion looks.
#include "compositor/plate_behind.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"

namespace matchlight {

namespace {

/// Where a direction is in the footage's frame; nullopt where that does not show it.
std::optional<Eigen::Vector2d> shown_pixel(const PlateBehind::Source& source, const Eigen::Vector2d& normalized) {
    const Camera& camera = source.camera;
    if (!source.lens_map.normalized_bounds.contains(normalized)) return std::nullopt;
    const Eigen::Vector2d pixel = camera.pixel_from_normalized(normalized);
    // Far beyond the frame a lens model may fold back into it.
    const Eigen::Vector2d back = source.lens_map.normalized(pixel.x(), pixel.y());
    if (!((back - normalized).norm() * camera.fx < 1)) return std::nullopt;
    const Eigen::Vector2d least(source.shown.x, source.shown.y);
    const Eigen::Vector2d most = least + Eigen::Vector2d(source.shown.width - 1, source.shown.height - 1);
    if ((pixel.array() < least.array()).any() || (pixel.array() > most.array()).any()) return std::nullopt;
    return pixel;
}

/// Plate-linear light between four pixels.
Eigen::Vector3d light_at(const PlateBehind::Source& source, const Eigen::Vector2d& pixel) {
    const auto corner = [&](double at, int size) {
        return std::clamp(static_cast<int>(std::floor(at)), 0, std::max(size - 2, 0));
    };
    const int x = corner(pixel.x(), source.code.width()), y = corner(pixel.y(), source.code.height());
    const double s = pixel.x() - x, t = pixel.y() - y;
    const auto light = [&](int column, int row) { return source.light_from_code(source.code.pixel(column, row)); };
    const int right = std::min(x + 1, source.code.width() - 1), below = std::min(y + 1, source.code.height() - 1);
    return (1 - t) * ((1 - s) * light(x, y) + s * light(right, y)) +
           t * ((1 - s) * light(x, below) + s * light(right, below));
}

}  // namespace

ImageF undistorted_light(const PlateBehind::Source& source) {
    const Camera& camera = source.camera;
    const FrameOptics& optics = source.optics;
    const Eigen::Vector2d centre((optics.frame_width - 1) / 2.0, (optics.frame_height - 1) / 2.0);
    const double corner_px = std::hypot(optics.frame_width, optics.frame_height) / 2 / optics.corner_ratio;
    ImageF picture(camera.width, camera.height, 4);
    parallel_for(picture.height(), [&](int y) {
        for (int x = 0; x < picture.width(); ++x) {
            const auto pixel = shown_pixel(source, {(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy});
            if (!pixel) continue;
            const double r2 = (*pixel - centre).squaredNorm() / (corner_px * corner_px);
            const double falloff = 1 + optics.vignette[0] * r2 + optics.vignette[1] * r2 * r2;
            const Eigen::Vector3d light = light_at(source, *pixel) * optics.plate_gain / falloff;
            for (int c = 0; c < 3; ++c)
                picture.at(x, y, c) = static_cast<float>(std::max(light[c], 0.0) / optics.gain[c]);
            picture.at(x, y, 3) = 1;
        }
    });
    return picture;
}

PlateBehind::PlateBehind(const Source& source) {
    take(undistorted_light(source), source.camera, source.optics.camera_from_world);
}

PlateBehind::PlateBehind(const ImageF& background, const Camera& camera, const RigidTransform& camera_from_world) {
    ImageF picture(background.width(), background.height(), 4);
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            std::copy_n(background.pixel(x, y), 3, picture.pixel(x, y));
            picture.at(x, y, 3) = 1;
        }
    }
    take(picture, camera, camera_from_world);
}

void PlateBehind::take(const ImageF& picture, const Camera& camera, const RigidTransform& camera_from_world) {
    picture_ = Texture2D({.format = GL_RGBA16F, .width = picture.width(), .height = picture.height(), .levels = 0});
    picture_.upload(picture);
    picture_.make_mipmaps();
    picture_.set_filter(TextureFilter{});
    Eigen::Matrix4d picture_from_camera = Eigen::Matrix4d::Identity();
    // Shares of the picture's size, whose pixels count from their middle.
    picture_from_camera.row(0) << camera.fx / camera.width, 0, (camera.cx + 0.5) / camera.width, 0;
    picture_from_camera.row(1) << 0, camera.fy / camera.height, (camera.cy + 0.5) / camera.height, 0;
    picture_from_world_ = (picture_from_camera * camera_from_world.matrix()).cast<float>();
}

void PlateBehind::bind(Program& program) const {
    program.bind_texture("plate_behind", unit, picture_);
    program.set("plate_behind_present", true);
    program.set("plate_behind_from_world", picture_from_world_);
}

}  // namespace matchlight
