// Starts of several focal lengths, each followed to its end on a few frames.
#include "tracking/lens_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "tracking/bundle.h"
#include "tracking/camera_path.h"

namespace matchlight {

namespace {

/// ∂pixel/∂normalised at a point, by central differences: the lens is smooth over far more than the step.
Eigen::Matrix2d lens_jacobian(const Camera& camera, const Eigen::Vector2d& normalized) {
    constexpr double step = 1e-5;
    Eigen::Matrix2d jacobian;
    for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d offset = step * Eigen::Vector2d::Unit(axis);
        jacobian.col(axis) =
            (camera.pixel_from_normalized(normalized + offset) - camera.pixel_from_normalized(normalized - offset)) /
            (2 * step);
    }
    return jacobian;
}

/// Frames with the most tags of each of a few dozen stretches.
std::vector<FrameObservations> telling_frames(const std::vector<FrameObservations>& frames) {
    constexpr std::size_t most = 40;
    const std::size_t stretches = std::min(most, frames.size());
    std::vector<FrameObservations> result;
    for (std::size_t i = 0; i < stretches; ++i) {
        const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(i * frames.size() / stretches);
        const auto end = frames.begin() + static_cast<std::ptrdiff_t>((i + 1) * frames.size() / stretches);
        const auto best =
            std::max_element(begin, end, [](const auto& a, const auto& b) { return a.tags.size() < b.tags.size(); });
        if (!best->tags.empty()) result.push_back(*best);
    }
    return result;
}

struct Attempt {
    Camera camera;
    double half_cost = std::numeric_limits<double>::infinity();
};

Attempt attempt(const std::vector<RigTag>& rig, std::vector<FrameObservations> frames, const Camera& start,
                const Camera& guess) {
    express_with(start, guess, frames);
    const RigSolution places = solve_rig(rig, frames);
    const CameraPath path = solve_path(rig, places.world_from_tag, frames, start);
    ClipModel model;
    model.camera = start;
    for (const RigTag& tag : rig) {
        const auto place = places.world_from_tag.find(tag.id);
        if (place == places.world_from_tag.end()) continue;
        ModelTag& known = model.tags[tag.id];
        known.size_m = tag.size_m;
        known.world_from_tag = place->second;
        known.held = tag.world_from_tag || places.origin == tag.id;
    }
    std::vector<BundleFrame> bundle;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        if (!path.frames[f].pose) continue;
        BundleFrame& frame = bundle.emplace_back();
        frame.camera_from_world = path.frames[f].pose->camera_from_world;
        // All sightings count, also those that this lens outvotes: costs of different lenses are compared.
        for (const TagObservation& seen : frames[f].tags) {
            const bool once = std::ranges::count(frames[f].tags, seen.id, &TagObservation::id) == 1;
            if (once && model.tags.contains(seen.id)) frame.views.push_back(bundle_view(seen, start));
        }
    }
    ModelFreedom freedom;
    freedom.lens.fill(true);
    freedom.prior = uncalibrated_prior(start);
    freedom.noise_floor_px = 0.1;  // a rough lens and rough places leave more than the corners' own noise
    const BundleResult result = adjust_bundle(model, freedom, bundle);
    Attempt found;
    if (result.usable && model.camera.fx > 0 && model.camera.fy > 0) found = {model.camera, result.half_cost};
    return found;
}

}  // namespace

Camera guessed_camera(int width, int height) {
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = camera.fy = std::max(width, height);
    camera.cx = (width - 1) / 2.0;
    camera.cy = (height - 1) / 2.0;
    camera.distortion.assign(5, 0.0);
    return camera;
}

LensPrior uncalibrated_prior(const Camera& camera) {
    LensPrior prior;
    const Camera middle = guessed_camera(camera.width, camera.height);
    prior.mean = lens_vector(middle);
    prior.mean.head<2>() = lens_vector(camera).head<2>();
    const double anything = 100.0 * middle.fx, axis = 0.005 * middle.fx;
    prior.sigma << anything, anything, axis, axis, 0.2, 0.2;
    prior.aspect_sigma = 1e-3;
    return prior;
}

void express_with(const Camera& camera, const Camera& observed_with, std::vector<FrameObservations>& frames) {
    for (FrameObservations& frame : frames) {
        for (TagObservation& seen : frame.tags) {
            TagCorners corners;
            TagCovariance change = TagCovariance::Zero();
            for (int i = 0; i < 4; ++i) {
                corners.col(i) = camera.normalized_from_pixel(seen.corners_px.col(i));
                change.block<2, 2>(2 * i, 2 * i) = lens_jacobian(camera, corners.col(i)).inverse() *
                                                   lens_jacobian(observed_with, seen.corners_normalized.col(i));
            }
            seen.corners_normalized = corners;
            seen.covariance = change * seen.covariance * change.transpose();
        }
        // Corners that the lens does not reach say nothing.
        std::erase_if(frame.tags, [](const TagObservation& seen) {
            return !seen.corners_normalized.allFinite() || !seen.covariance.allFinite();
        });
    }
}

Camera find_lens(const std::vector<RigTag>& rig, const std::vector<FrameObservations>& frames, const Camera& guess) {
    const std::vector<FrameObservations> telling = telling_frames(frames);
    Attempt best;
    // From 90° to 14° across the picture, each within reach of its neighbours.
    for (const double widths : {0.5, 0.75, 1.1, 1.6, 2.4, 4.0}) {
        Camera start = guess;
        start.fx = start.fy = widths * std::max(guess.width, guess.height);
        const Attempt found = attempt(rig, telling, start, guess);
        if (found.half_cost < best.half_cost) best = found;
    }
    return std::isfinite(best.half_cost) ? best.camera : guess;
}

}  // namespace matchlight
