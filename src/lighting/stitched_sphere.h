// Pictures that each show a part of the sphere, blended into one lat-long map that says what was seen.
#pragma once

#include <functional>
#include <span>

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/mappings.h"

namespace matchlight {

/// Where a direction falls in a picture, and how much the picture counts there; 0: it does not show it.
struct ViewPoint {
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
    double weight = 0;
};

struct SphereView {
    const ImageF* light = nullptr;    // scene-linear RGB
    const ImageF* clipped = nullptr;  // 1 channel, of the same size: 1 where the light is a lower bound
    Eigen::Matrix3d view_from_world = Eigen::Matrix3d::Identity();
    std::function<ViewPoint(const Eigen::Vector3d& view_direction)> look;
    bool wraps = false;            // the last column's neighbour is the first
    bool black_is_unseen = false;  // pixels that hold no light at all are holes in the picture
    double px_per_radian = 0;      // at its finest
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();
};

struct StitchedSphere {
    ImageF latlong;         // four channels: RGB, and which share of the pixel was seen; RGB is 0 where that is 0
    double seen_share = 0;  // of the whole sphere
    ImageF clipped;         // 1 channel: which share of what was seen is a lower bound; empty where no view tells
};

/// Each pixel is the mean over the part of its solid angle that was seen. Nothing is filled in.
StitchedSphere stitched_sphere(std::span<const SphereView> views, int height);

/// Its map in another layout: RGB, which share was seen, and, where views tell, which share of that is clipped. Light
/// is weighted by how much of a pixel was seen.
ImageF resampled(const StitchedSphere& sphere, const ProbeLayout& from, const ProbeLayout& to);

/// Some channels of an image, from `first` on.
ImageF channels_of(const ImageF& image, int first, int count);

/// The light of a view at a point, interpolated between its pixels.
Eigen::Vector3d light_at(const SphereView& view, const Eigen::Vector2d& px);

}  // namespace matchlight
