// A probe from the photographs of a mirror ball: every direction from the views that show it best.
#include "lighting/ball_probe.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "core/parallel.h"
#include "core/transfer.h"
#include "lighting/ball_shadow.h"
#include "lighting/latlong_grid.h"

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

/// Weighted light with what is known of it.
struct Gathered {
    Eigen::Vector3d light = Eigen::Vector3d::Zero();
    double variance = 0;  // of luminance, times weight squared
    double weight = 0;
    double clipped = 0;  // weight of lower bounds

    void add(const Eigen::Vector3d& radiance, double sigma, double w, bool bound) {
        light += w * radiance;
        variance += w * w * sigma * sigma;
        weight += w;
        if (bound) clipped += w;
    }
    void add(const Gathered& other, double w) {
        light += w * other.light;
        variance += w * w * other.variance;
        weight += w * other.weight;
        clipped += w * other.clipped;
    }
};

double luminance(const Eigen::Vector3d& rgb) {
    return luminance_rec709(rgb.x(), rgb.y(), rgb.z());
}

class Unwrapper {
public:
    Unwrapper(const BallScene& scene, const BallProbeOptions& options) : scene_(scene), options_(options) {
        for (const BallView& view : scene.views) {
            Eye eye;
            eye.place_m = view.eye_m();
            eye.towards = (eye.place_m - scene.ball.centre_m).normalized();
            const double distance_m = (eye.place_m - scene.ball.centre_m).norm();
            eye.radius_px = view.camera.fx * scene.ball.radius_m / distance_m;
            eyes_.push_back(eye);
        }
    }

    /// Steradians that a pixel of the view holds at a hit.
    double pixel_solid_angle(std::size_t v, const BallHit& hit) const {
        const Camera& camera = scene_.views[v].camera;
        const double distance_m = (hit.point_m - eyes_[v].place_m).norm();
        return reflected_solid_angle_ratio(scene_.ball, distance_m, hit.cosine) / (camera.fx * camera.fy);
    }

    /// What the view's reflection at `hit` says; weight by how fine it is, in pixels a square radian.
    void add_reflection(std::size_t v, const BallHit& hit, const Eigen::Vector3d& towards, double share,
                        Gathered& into) const {
        const BallView& view = scene_.views[v];
        const Eye& eye = eyes_[v];
        // The outermost pixels hold the ball's edge; a small ball's are few, so that a tenth is left out at most.
        const double from_rim_px = (1 - std::sqrt(std::max(0.0, 1 - hit.cosine * hit.cosine))) * eye.radius_px;
        const double inner_px = std::min(4.0, 0.1 * eye.radius_px);
        const double rim = ramp(from_rim_px, 0.4 * inner_px, inner_px);
        if (rim <= 0) return;
        const double from_camera = std::acos(std::clamp(towards.dot(eye.towards), -1.0, 1.0));
        const double camera = options_.camera_deg * pi / 180;
        // Never quite 0: a single view's own camera is better than nothing.
        const double clear = camera > 0 ? std::max(1e-4, ramp(from_camera, camera, 2 * camera)) : 1;
        const Eigen::Vector2d pixel = view.pixel(hit.point_m);
        if (!view.in_frame(pixel)) return;
        Eigen::Vector3d light = sample_rgb(view.radiance, pixel);
        for (int c = 0; c < 3; ++c) light[c] /= fresnel_reflectance(scene_.reflectance[c], hit.cosine);
        const double solid_angle = pixel_solid_angle(v, hit);
        into.add(light, sigma_at(view, pixel), share * rim * clear / (solid_angle * solid_angle),
                 bound_at(view, pixel));
    }

    Gathered far_light(const Eigen::Vector3d& towards) const {
        Gathered result;
        for (std::size_t v = 0; v < eyes_.size(); ++v) {
            const auto hit = hit_reflecting_direction(scene_.ball, eyes_[v].place_m, towards);
            if (hit) add_reflection(v, *hit, towards, 1, result);
        }
        return result;
    }

    /// Light of a place on the plane, as it would be without the ball: times `gain` (BallShadow). `solid_angle` is that
    /// of the output's pixel. Nothing where the place is hidden, or seen in so deep a shadow that the gain would be a
    /// guess.
    Gathered plane_light(const Eigen::Vector3d& place_m, double solid_angle, const Eigen::Vector3d& gain) const {
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

private:
    struct Eye {
        Eigen::Vector3d place_m, towards;
        double radius_px = 0;
    };

    static double sigma_at(const BallView& view, const Eigen::Vector2d& pixel) {
        return view.sigma.empty() ? 0 : luminance(sample_rgb(view.sigma, pixel));
    }
    static bool bound_at(const BallView& view, const Eigen::Vector2d& pixel) {
        if (view.clipped.empty()) return false;
        return view.clipped.at(std::clamp(static_cast<int>(std::lround(pixel.x())), 0, view.clipped.width() - 1),
                               std::clamp(static_cast<int>(std::lround(pixel.y())), 0, view.clipped.height() - 1)) != 0;
    }

    void add_direct(std::size_t v, const Eigen::Vector3d& place_m, double share, Gathered& into) const {
        const BallView& view = scene_.views[v];
        if (share <= 0) return;
        const auto pixel = direct_pixel(view, scene_.ball, place_m, 1.04);
        if (!pixel) return;
        into.add(sample_rgb(view.radiance, *pixel), sigma_at(view, *pixel), share, bound_at(view, *pixel));
    }

    const BallScene& scene_;
    const BallProbeOptions& options_;
    std::vector<Eye> eyes_;
};

/// Fills pixels of weight 0 from those around them: means over ever larger pixels, then back (pull-push; Gortler et al.
/// 1996, "The Lumigraph", §3.4), over the lat-long map with its seam closed.
void fill_unseen(ImageF& radiance, const ImageF& known) {
    std::vector<cv::Mat> light, weight;
    cv::Mat whole(radiance.height(), radiance.width(), CV_32FC3, radiance.samples().data());
    const cv::Mat mask(known.height(), known.width(), CV_32F, const_cast<float*>(known.samples().data()));
    weight.push_back(mask.clone());
    cv::Mat three;
    cv::merge(std::array{mask, mask, mask}, three);
    light.push_back(whole.mul(three));
    while (light.back().rows > 1) {
        cv::Mat smaller, smaller_weight;
        const cv::Size half(std::max(1, light.back().cols / 2), std::max(1, light.back().rows / 2));
        cv::resize(light.back(), smaller, half, 0, 0, cv::INTER_AREA);
        cv::resize(weight.back(), smaller_weight, half, 0, 0, cv::INTER_AREA);
        light.push_back(smaller);
        weight.push_back(smaller_weight);
    }
    cv::Mat coarse;
    for (std::size_t level = light.size(); level-- > 0;) {
        cv::Mat finer = light[level].clone();
        for (int y = 0; y < finer.rows; ++y) {
            for (int x = 0; x < finer.cols; ++x) {
                auto& value = finer.at<cv::Vec3f>(y, x);
                const float w = weight[level].at<float>(y, x);
                if (w > 0) {
                    value /= w;
                } else if (!coarse.empty()) {
                    value = coarse.at<cv::Vec3f>(y, x);
                }
            }
        }
        if (level == 0) {
            finer.copyTo(whole);
            return;
        }
        // A column on each side from the other, so that the seam is smooth.
        cv::Mat wide;
        cv::copyMakeBorder(finer, wide, 0, 0, 1, 1, cv::BORDER_WRAP);
        const double scale = static_cast<double>(light[level - 1].cols) / finer.cols;
        const int border = static_cast<int>(std::lround(scale));
        cv::resize(wide, wide, {light[level - 1].cols + 2 * border, light[level - 1].rows}, 0, 0, cv::INTER_LINEAR);
        coarse = wide(cv::Rect(border, 0, light[level - 1].cols, light[level - 1].rows)).clone();
    }
}

/// Radians of the surroundings across a pixel in the middle of the ball, where it shows most.
double finest_pixel(const BallView& view, const MirrorBall& ball) {
    const double distance_m = (view.eye_m() - ball.centre_m).norm() - ball.radius_m;
    const double ratio = reflected_solid_angle_ratio(ball, distance_m, 1);
    return std::sqrt(ratio / (view.camera.fx * view.camera.fy));
}

/// The view at half its size, every pixel the mean of four; an odd last row or column is left out.
BallView halved(const BallView& view) {
    const int width = view.radiance.width() / 2, height = view.radiance.height() / 2;
    const auto half = [&](const ImageF& image) {
        ImageF small(width, height, image.channels());
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                for (int c = 0; c < image.channels(); ++c) {
                    small.at(x, y, c) = (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) +
                                         image.at(2 * x, 2 * y + 1, c) + image.at(2 * x + 1, 2 * y + 1, c)) /
                                        4;
                }
            }
        }
        return small;
    };
    BallView result;
    result.name = view.name;
    result.outline = view.outline;
    result.camera_from_world = view.camera_from_world;
    result.radiance = half(view.radiance);
    if (!view.sigma.empty()) result.sigma = half(view.sigma);
    if (!view.clipped.empty()) {
        result.clipped = Image8(width, height, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                result.clipped.at(x, y) =
                    std::max({view.clipped.at(2 * x, 2 * y), view.clipped.at(2 * x + 1, 2 * y),
                              view.clipped.at(2 * x, 2 * y + 1), view.clipped.at(2 * x + 1, 2 * y + 1)});
            }
        }
    }
    result.camera = view.camera;
    result.camera.width = width;
    result.camera.height = height;
    // Centres at whole numbers: pixel 0 of the half is the middle of pixels 0 and 1.
    result.camera.fx /= 2, result.camera.fy /= 2;
    result.camera.cx = (view.camera.cx - 0.5) / 2;
    result.camera.cy = (view.camera.cy - 0.5) / 2;
    return result;
}

}  // namespace

int natural_height(const std::vector<BallView>& views, const MirrorBall& ball) {
    // Finer than any light or reflection in a frame of video needs.
    constexpr unsigned most = 1024;
    double finest = pi;
    for (const BallView& view : views) finest = std::min(finest, finest_pixel(view, ball));
    const auto rows = static_cast<unsigned>(std::ceil(pi / finest));
    return static_cast<int>(std::clamp(std::bit_ceil(rows), 32U, most));
}

BallProbe probe_from_balls(const BallScene& whole_scene, const BallProbeOptions& options) {
    const int height = options.height > 0 ? options.height : natural_height(whole_scene.views, whole_scene.ball);
    // Four samples a pixel find every lamp only where the photographs' pixels are not much finer than the map's.
    std::vector<BallView> views = whole_scene.views;
    for (BallView& view : views) {
        while (finest_pixel(view, whole_scene.ball) < pi / height / 2 && view.camera.width >= 64) view = halved(view);
    }
    const BallScene scene{views, whole_scene.ball, whole_scene.reflectance, whole_scene.plane, whole_scene.rig};
    const int width = 2 * height;
    const Unwrapper unwrapper(scene, options);
    const LatlongGrid grid(width, height);
    BallProbe probe{
        ImageF(width, height, 3), ImageF(width, height, 1), ImageF(width, height, 1), ImageF(width, height, 1), 0, 0};

    // Four samples a pixel: the ball's pixels are about as fine as the map's.
    constexpr std::array<double, 2> inside = {-0.25, 0.25};
    const auto gather = [&](const auto& sample) {
        parallel_for(height, [&](int y) {
            for (int x = 0; x < width; ++x) {
                Gathered sum;
                double met = 0;
                for (const double down : inside) {
                    for (const double across : inside) {
                        const Gathered one = sample(latlong_direction(x + across, y + down, width, height), x, y);
                        if (one.weight <= 0) continue;
                        sum.add(one, 1 / one.weight);
                        met += 0.25;
                    }
                }
                probe.seen.at(x, y) = static_cast<float>(met);
                probe.clipped.at(x, y) = 0;
                if (sum.weight <= 0) continue;
                const Eigen::Vector3d light = sum.light / sum.weight;
                for (int c = 0; c < 3; ++c) probe.radiance.at(x, y, c) = static_cast<float>(light[c]);
                const double bright = luminance(light);
                probe.sigma.at(x, y) =
                    bright > 0 ? static_cast<float>(std::sqrt(sum.variance) / sum.weight / bright) : 1.F;
                probe.clipped.at(x, y) = static_cast<float>(sum.clipped / sum.weight);
            }
        });
    };
    gather([&](const Eigen::Vector3d& towards, int, int) { return unwrapper.far_light(towards); });

    if (scene.plane && scene.plane->height_m(options.place_m) > 0) {
        ImageF filled = probe.radiance;
        fill_unseen(filled, probe.seen);
        const BallShadow shadow(Probe{filled}, *scene.plane, scene.ball, scene.reflectance);
        // Farther than a hundred radii the plane is as good as at infinity.
        const double farthest_m = 100 * scene.ball.radius_m;
        const auto place_of = [&](const Eigen::Vector3d& towards) {
            auto place = scene.plane->meets(options.place_m, towards);
            if (place && (*place - options.place_m).norm() > farthest_m) place.reset();
            return place;
        };
        // Of each sheet: light of ink and of paper without the ball, where it is seen.
        struct Inks {
            std::array<Eigen::Vector3d, 2> light = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
            std::array<double, 2> weight = {0, 0};
        };
        const std::size_t sheets = scene.rig != nullptr ? scene.rig->sheets.size() : 0;
        std::vector<std::vector<Inks>> rows(static_cast<std::size_t>(height), std::vector<Inks>(sheets));
        // Shadows of a lamp's size vary little within a pixel.
        ImageF gains(width, height, 3, 1.F);
        parallel_for(height, [&](int y) {
            for (int x = 0; x < width; ++x) {
                const auto place = place_of(latlong_direction(x, y, width, height));
                if (!place) continue;
                const Eigen::Vector3d gain = shadow.unshadowed_over_seen(*place);
                for (int c = 0; c < 3; ++c) gains.at(x, y, c) = static_cast<float>(gain[c]);
            }
        });
        gather([&](const Eigen::Vector3d& towards, int x, int y) {
            const auto place = place_of(towards);
            if (!place) return unwrapper.far_light(towards);
            const Eigen::Vector3d gain = Eigen::Map<const Eigen::Vector3f>(gains.pixel(x, y)).cast<double>();
            const Gathered light = unwrapper.plane_light(*place, grid.solid_angle(y), gain);
            if (light.weight > 0 && sheets > 0) {
                if (const auto print = print_at(*scene.rig, *place)) {
                    Inks& inks = rows[static_cast<std::size_t>(y)][print->sheet];
                    const std::size_t kind = print->paper ? 1 : 0;
                    // What was hardly shadowed tells more.
                    const double weight = 1 / gain.squaredNorm();
                    inks.light[kind] += weight * light.light / light.weight;
                    inks.weight[kind] += weight;
                }
            }
            return light;
        });
        if (sheets > 0) {
            std::vector<Inks> all(sheets);
            for (const auto& row : rows) {
                for (std::size_t s = 0; s < sheets; ++s) {
                    for (std::size_t k = 0; k < 2; ++k) {
                        all[s].light[k] += row[s].light[k];
                        all[s].weight[k] += row[s].weight[k];
                    }
                }
            }
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    if (probe.seen.at(x, y) >= 1) continue;
                    Gathered sum;
                    for (const double down : inside) {
                        for (const double across : inside) {
                            const auto place = place_of(latlong_direction(x + across, y + down, width, height));
                            const auto print = place ? print_at(*scene.rig, *place) : std::nullopt;
                            if (!print) continue;
                            const std::size_t kind = print->paper ? 1 : 0;
                            const Inks& inks = all[print->sheet];
                            if (inks.weight[kind] <= 0) continue;
                            sum.add(inks.light[kind] / inks.weight[kind], 0, 0.25, false);
                        }
                    }
                    const double seen = probe.seen.at(x, y);
                    if (sum.weight < 1 - seen - 0.01) continue;
                    for (int c = 0; c < 3; ++c) {
                        const double before = probe.radiance.at(x, y, c);
                        const double drawn = sum.light[c] / sum.weight;
                        probe.radiance.at(x, y, c) = static_cast<float>(seen * before + (1 - seen) * drawn);
                    }
                    // Drawn, not filled in from around: a hair above 0 keeps it from being filled.
                    if (seen <= 0) probe.seen.at(x, y) = 1e-3F;
                }
            }
        }
    }
    fill_unseen(probe.radiance, probe.seen);
    double whole = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (probe.seen.at(x, y) < 0.01F) probe.seen.at(x, y) = 0, probe.sigma.at(x, y) = 1;
            whole += grid.solid_angle(y);
            probe.coverage += grid.solid_angle(y) * probe.seen.at(x, y);
            probe.clipped_share += grid.solid_angle(y) * probe.clipped.at(x, y);
        }
    }
    probe.coverage /= whole;
    probe.clipped_share /= whole;
    return probe;
}

}  // namespace matchlight
