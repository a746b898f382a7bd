// From the plate's code values to the light that the plane sends out.
#include "compositor/surface_frames.h"

#include <algorithm>
#include <cmath>

#include "compositor/nearest_known.h"
#include "compositor/plane_grid.h"

namespace matchlight {

namespace {

constexpr double largest_code = 65535;  // of Image16
/// No surface is quite matt, and exposures are known to a few hundredths.
constexpr double model_deviation = 0.05;
/// Of where a frame's pose and lens put a point: what solves of clips reach, with margin.
constexpr double pose_deviation_px = 0.2;

}  // namespace

std::vector<const SolvedFrame*> spread_frames(const Solve& solve, int most) {
    std::vector<const SolvedFrame*> posed;
    for (const SolvedFrame& frame : solve.frames) {
        if (frame.camera_from_world) posed.push_back(&frame);
    }
    const auto count = static_cast<std::size_t>(std::max(most, 2));
    if (posed.size() <= count) return posed;
    std::vector<const SolvedFrame*> spread;
    for (std::size_t i = 0; i < count; ++i) spread.push_back(posed[i * (posed.size() - 1) / (count - 1)]);
    return spread;
}

SurfaceClip::SurfaceClip(const Solve& the_solve, const std::array<double, 2>& the_vignette, const PlateFormat& format)
    : solve(the_solve),
      lens_map(make_lens_map(the_solve.camera)),
      light(the_solve.response, format.transfer),
      vignette(the_vignette),
      code_step(1.0 / ((1 << format.bit_depth) - 1)) {}

SurfaceFrame::SurfaceFrame(const SurfaceClip& clip, const PlateFrame& plate, const SolvedFrame& solved)
    : clip_(clip),
      camera_from_world_(*solved.camera_from_world),
      eye_m_(camera_from_world_.inverse().translation()),
      gain_(gain_near(clip.solve, solved)),
      code_(plate.rgb16({0, 0, plate.format().width, plate.format().height})) {
    if (clip.holdouts != nullptr) hidden_ = clip.holdouts->before_surface(solved, clip.lens_map);
    focus_.coc_scale_px_m = known_near(clip.solve, solved, &SolvedFrame::coc_scale_px_m).value_or(0);
    if (const auto distance_m = known_near(clip.solve, solved, &SolvedFrame::focus_distance_m))
        focus_.focus_distance_m = *distance_m;
}

std::optional<SurfaceSample> SurfaceFrame::sample(const Eigen::Vector3d& point_m, double texel_m) const {
    const Camera& camera = clip_.solve.camera;
    const PlanePixel plane = plane_pixel(point_m, eye_m_, camera.fx);
    if (!plane.seen) return std::nullopt;
    // As many points as pixels lie across the texel, within reason.
    const int across = std::clamp(static_cast<int>(std::lround(texel_m / plane.across_m)), 1, 4);
    SurfaceSample sum;
    double depth_m = 0;
    for (int i = 0; i < across * across; ++i) {
        const double column = i % across, row = (i - column) / across;
        const Eigen::Vector3d offset((column + 0.5) / across - 0.5, (row + 0.5) / across - 0.5, 0);
        const Eigen::Vector3d in_camera = camera_from_world_ * (point_m + texel_m * offset);
        depth_m = in_camera.z();
        if (!(depth_m > 0)) return std::nullopt;
        const Eigen::Vector2d normalized = in_camera.head<2>() / depth_m;
        if (!clip_.lens_map.normalized_bounds.contains(normalized)) return std::nullopt;
        const Eigen::Vector2d pixel = camera.pixel_from_normalized(normalized);
        // Far beyond the frame a lens model may fold back into it.
        const Eigen::Vector2d back = clip_.lens_map.normalized(pixel.x(), pixel.y());
        if (!((back - normalized).norm() * camera.fx < 1) || !add_taps(pixel, sum)) return std::nullopt;
    }
    const double coc_m = signed_coc_px(focus_, depth_m) * plane.across_m;
    // A picture twice as coarse holds a quarter of the points, each with four times the neighbours mixed in: its word
    // counts by the square of its area. Noise that grows with light has, in probe units, the variance 1 / gain.
    const double area_m2 = std::max(plane.across_m * plane.along_m, texel_m * texel_m) + coc_m * coc_m;
    sum.weight = gain_.y() / (area_m2 * area_m2);
    const double taps = across * across;
    for (std::size_t c = 0; c < 3; ++c) {
        sum.radiance[c] /= taps;
        sum.deviation[c] = std::hypot(std::sqrt(sum.deviation[c]) / taps, model_deviation * sum.radiance[c]);
    }
    if (!std::isfinite(sum.weight)) return std::nullopt;
    return sum;
}

bool SurfaceFrame::add_taps(const Eigen::Vector2d& pixel, SurfaceSample& sum) const {
    const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
    if (x < 0 || y < 0 || x + 1 >= code_.width() || y + 1 >= code_.height()) return false;
    if (!hidden_.empty() && hidden_.at(x, y) != 0) return false;
    const double s = pixel.x() - x, t = pixel.y() - y;
    const Camera& camera = clip_.solve.camera;
    const Eigen::Vector2d centre((camera.width - 1) / 2.0, (camera.height - 1) / 2.0);
    const double r2 = 4 * (pixel - centre).squaredNorm() / Eigen::Vector2d(camera.width, camera.height).squaredNorm();
    const double falloff = 1 + clip_.vignette[0] * r2 + clip_.vignette[1] * r2 * r2;
    const std::array<double, 2> noise = clip_.solve.noise.value_or(std::array<double, 2>{});
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        const double codes[] = {code_.at(x, y, c) / largest_code, code_.at(x + 1, y, c) / largest_code,
                                code_.at(x, y + 1, c) / largest_code, code_.at(x + 1, y + 1, c) / largest_code};
        double light[4];
        for (int i = 0; i < 4; ++i) {
            light[i] = clip_.light.light_from_code(static_cast<float>(codes[i]), c);
            sum.clipped[channel] = sum.clipped[channel] || codes[i] >= PlateLight::clipped_code;
        }
        const double seen = (1 - t) * ((1 - s) * light[0] + s * light[1]) + t * ((1 - s) * light[2] + s * light[3]);
        const auto [least, most] = std::minmax({light[0], light[1], light[2], light[3]});
        const double code = *std::ranges::max_element(codes);
        const double step = most - clip_.light.light_from_code(static_cast<float>(code - clip_.code_step), c);
        const double gain = gain_[c] * falloff;
        const double displaced = pose_deviation_px * (most - least);
        const double variance =
            noise[0] * noise[0] + noise[1] * std::max(seen, 0.0) + step * step + displaced * displaced;
        sum.radiance[channel] += seen / gain;
        sum.deviation[channel] += variance / (gain * gain);
    }
    return true;
}

}  // namespace matchlight
