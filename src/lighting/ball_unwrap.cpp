// What one direction or one place looks like in the views of a mirror ball, each by how finely it shows it.
#include "lighting/ball_unwrap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/transfer.h"

namespace matchlight {
namespace {

using std::numbers::pi;
/// Where the ball takes more than this of the light, what is left comes from the ball's own underside and the plane,
/// back and forth, which is not followed.
constexpr double deepest_shadow = 5;

/// 0 at `from`, 1 at `to`, smooth between.
double ramp(double value, double from, double to) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

double luminance(const Eigen::Vector3d& rgb) {
    return luminance_rec709(rgb.x(), rgb.y(), rgb.z());
}

double sigma_at(const BallView& view, const Eigen::Vector2d& pixel) {
    return view.sigma.empty() ? 0 : luminance(sample_rgb(view.sigma, pixel));
}

bool bound_at(const BallView& view, const Eigen::Vector2d& pixel) {
    if (view.clipped.empty()) return false;
    return view.clipped.at(std::clamp(static_cast<int>(std::lround(pixel.x())), 0, view.clipped.width() - 1),
                           std::clamp(static_cast<int>(std::lround(pixel.y())), 0, view.clipped.height() - 1)) != 0;
}

}  // namespace

MapSamples map_samples(int a_side) {
    MapSamples samples;
    for (int k = 0; k < a_side * a_side; ++k) {
        const int column = k % a_side, row = k / a_side;
        samples.emplace_back((column + 0.5) / a_side - 0.5, (row + 0.5) / a_side - 0.5);
    }
    return samples;
}

BallUnwrap::BallUnwrap(const BallScene& scene, const BallProbeOptions& options) : scene_(scene), options_(options) {
    for (const BallView& view : scene.views) {
        Eye eye;
        eye.place_m = view.eye_m();
        eye.towards = (eye.place_m - scene.ball.centre_m).normalized();
        const double distance_m = (eye.place_m - scene.ball.centre_m).norm();
        eye.radius_px = view.camera.fx * scene.ball.radius_m / distance_m;
        eyes_.push_back(eye);
    }
}

double BallUnwrap::pixel_solid_angle(std::size_t v, const BallHit& hit) const {
    const Camera& camera = scene_.views[v].camera;
    const double distance_m = (hit.point_m - eyes_[v].place_m).norm();
    return reflected_solid_angle_ratio(scene_.ball, distance_m, hit.cosine) / (camera.fx * camera.fy);
}

double BallUnwrap::clearness(std::size_t v, const BallHit& hit, const Eigen::Vector3d& towards) const {
    const Eye& eye = eyes_[v];
    // The outermost pixels hold the ball's edge; a small ball's are few, so that a tenth is left out at most.
    const double from_rim_px = (1 - std::sqrt(std::max(0.0, 1 - hit.cosine * hit.cosine))) * eye.radius_px;
    const double inner_px = std::min(4.0, 0.1 * eye.radius_px);
    const double rim = ramp(from_rim_px, 0.4 * inner_px, inner_px);
    if (rim <= 0 || !scene_.views[v].in_frame(scene_.views[v].pixel(hit.point_m))) return 0;
    const double from_camera = std::acos(std::clamp(towards.dot(eye.towards), -1.0, 1.0));
    const double camera = options_.camera_deg * pi / 180;
    // Never quite 0: a single view's own camera is better than nothing.
    const double clear = camera > 0 ? std::max(1e-4, ramp(from_camera, camera, 2 * camera)) : 1;
    return rim * clear;
}

void BallUnwrap::add_reflection(std::size_t v, const BallHit& hit, const Eigen::Vector3d& towards, double share,
                                Gathered& into) const {
    const double clear = clearness(v, hit, towards);
    if (clear <= 0) return;
    const BallView& view = scene_.views[v];
    const Eigen::Vector2d pixel = view.pixel(hit.point_m);
    Eigen::Vector3d light = sample_rgb(view.radiance, pixel);
    for (int c = 0; c < 3; ++c) light[c] /= fresnel_reflectance(scene_.reflectance[c], hit.cosine);
    const double solid_angle = pixel_solid_angle(v, hit);
    into.add(light, sigma_at(view, pixel), share * clear / (solid_angle * solid_angle), bound_at(view, pixel));
}

Gathered BallUnwrap::far_light(const Eigen::Vector3d& towards) const {
    Gathered result;
    for (std::size_t v = 0; v < eyes_.size(); ++v) {
        const auto hit = hit_reflecting_direction(scene_.ball, eyes_[v].place_m, towards);
        if (hit) add_reflection(v, *hit, towards, 1, result);
    }
    return result;
}

Gathered BallUnwrap::near_light(const NearRay& ray, const std::vector<double>& visible) const {
    Gathered result;
    for (std::size_t v = 0; v < eyes_.size(); ++v) {
        if (visible[v] <= 0) continue;
        const auto hit = ray.nearness > 0 ? hit_reflecting_place(scene_.ball, eyes_[v].place_m,
                                                                 ray.from_m + ray.towards / ray.nearness)
                                          : hit_reflecting_direction(scene_.ball, eyes_[v].place_m, ray.towards);
        if (hit) add_reflection(v, *hit, ray.towards, visible[v], result);
    }
    return result;
}

Gathered BallUnwrap::plane_light(const Eigen::Vector3d& place_m, double solid_angle,
                                 const Eigen::Vector3d& gain) const {
    Gathered result;
    if (gain.maxCoeff() > deepest_shadow) return result;
    Gathered reflected;
    double finest = 0;
    for (std::size_t v = 0; v < eyes_.size(); ++v) {
        const auto hit = hit_reflecting_place(scene_.ball, eyes_[v].place_m, place_m);
        if (!hit) continue;
        const double before = reflected.weight;
        add_reflection(v, *hit, (place_m - scene_.ball.centre_m).normalized(), 1, reflected);
        if (reflected.weight > before) finest = std::max(finest, solid_angle / pixel_solid_angle(v, *hit));
    }
    // The ball sees gloss as the probe's place does; the cameras see details that the ball is too coarse for.
    const double trusted = ramp(finest, 0.02, 0.1);
    if (trusted > 0) result.add(reflected, trusted / reflected.weight);
    for (std::size_t v = 0; v < eyes_.size(); ++v) add_direct(v, place_m, 1 - trusted, result);
    if (result.weight > 0) {
        result.light = result.light.cwiseProduct(gain);
        result.variance *= gain.y() * gain.y();
    }
    return result;
}

void BallUnwrap::add_direct(std::size_t v, const Eigen::Vector3d& place_m, double share, Gathered& into) const {
    const BallView& view = scene_.views[v];
    if (share <= 0) return;
    const auto pixel = direct_pixel(view, scene_.ball, place_m, 1.04);
    if (!pixel) return;
    into.add(sample_rgb(view.radiance, *pixel), sigma_at(view, *pixel), share, bound_at(view, *pixel));
}

}  // namespace matchlight
