// A probe from the photographs of a mirror ball: every direction from the views that show it best.
#include "lighting/ball_probe.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/transfer.h"
#include "lighting/ball_depth.h"
#include "lighting/ball_table.h"
#include "lighting/ball_unwrap.h"
#include "lighting/latlong_fill.h"
#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

using std::numbers::pi;
constexpr int coarse_depth_rows = 64, full_depth_rows = 256;

/// What a direction shows that lies in pixel (x, y) of the map.
using DirectionLight = std::function<Gathered(const Eigen::Vector3d& towards, int x, int y)>;

/// Every pixel of the map, of those where `of_pixel` says so, by its samples, which count alike.
void gather(BallProbe& probe, const MapSamples& samples, const DirectionLight& light_of,
            const std::function<bool(int x, int y)>& of_pixel) {
    const int width = probe.radiance.width(), height = probe.radiance.height();
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            if (!of_pixel(x, y)) continue;
            Gathered sum;
            double met = 0;
            for (const auto& [across, down] : samples) {
                const Gathered one = light_of(latlong_direction(x + across, y + down, width, height), x, y);
                if (one.weight <= 0) continue;
                sum.add(one, 1 / one.weight);
                met += 1.0 / samples.size();
            }
            probe.seen.at(x, y) = static_cast<float>(met);
            probe.clipped.at(x, y) = 0;
            if (sum.weight <= 0) continue;
            const Eigen::Vector3d light = sum.light / sum.weight;
            for (int c = 0; c < 3; ++c) probe.radiance.at(x, y, c) = static_cast<float>(light[c]);
            const double bright = luminance_rec709(light.x(), light.y(), light.z());
            probe.sigma.at(x, y) = bright > 0 ? static_cast<float>(std::sqrt(sum.variance) / sum.weight / bright) : 1.F;
            probe.clipped.at(x, y) = static_cast<float>(sum.clipped / sum.weight);
        }
    });
}

/// The mean over a pixel's samples of one over how far away is what they show.
ImageF nearness_map(int height, const MapSamples& samples,
                    const std::function<double(const Eigen::Vector3d& towards, int x, int y)>& nearness_of) {
    const int width = 2 * height;
    ImageF map(width, height, 1);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (const auto& [across, down] : samples) {
                sum += nearness_of(latlong_direction(x + across, y + down, width, height), x, y);
            }
            map.at(x, y) = static_cast<float>(sum / samples.size());
        }
    });
    return map;
}

/// Shares of the sphere that are seen and clipped; what hardly is seen is not.
void summarize(BallProbe& probe) {
    const int width = probe.radiance.width(), height = probe.radiance.height();
    const LatlongGrid grid(width, height);
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
}

}  // namespace

double finest_pixel(const BallView& view, const MirrorBall& ball) {
    const double distance_m = (view.eye_m() - ball.centre_m).norm() - ball.radius_m;
    const double ratio = reflected_solid_angle_ratio(ball, distance_m, 1);
    return std::sqrt(ratio / (view.camera.fx * view.camera.fy));
}

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
    const BallUnwrap unwrap(scene, options);
    BallProbe probe{ImageF(width, height, 3),
                    ImageF(width, height, 1),
                    ImageF(width, height, 1),
                    ImageF(width, height, 1),
                    {},
                    0,
                    0};
    const MapSamples samples = map_samples(options.samples_a_side);
    std::optional<BallDepth> depth;
    const int depth_rows = std::min({height, natural_height(views, scene.ball),
                                     options.parallax == BallParallax::coarse ? coarse_depth_rows : full_depth_rows});
    if (options.parallax != BallParallax::off && nearness_scale(scene, depth_rows).tells()) {
        depth.emplace(scene, options.place_m, unwrap, depth_rows);
    }
    const auto parallax_nearness = [&](int x, int y) {
        return depth ? depth->nearness(x * depth->height() / height, y * depth->height() / height) : 0;
    };
    const auto light_of = [&](const Eigen::Vector3d& towards, int x, int y) {
        if (!depth) return unwrap.far_light(towards);
        const double nearness = parallax_nearness(x, y);
        std::vector<double> visible;
        // Never quite 0: what no view shows is guessed better by what hides it than by what lies around.
        for (std::size_t v = 0; v < views.size(); ++v)
            visible.push_back(std::max(1e-4, depth->visible(v, towards, nearness)));
        return unwrap.near_light({options.place_m, towards, nearness}, visible);
    };
    gather(probe, samples, light_of, [](int, int) { return true; });

    std::optional<BallTable> table;
    if (scene.plane && scene.plane->height_m(options.place_m) > 0) {
        ImageF first = probe.radiance;
        fill_unseen(first, probe.seen);
        table.emplace(scene, options, unwrap, first);
        const auto take_table = [&] {
            gather(
                probe, samples,
                [&](const Eigen::Vector3d& towards, int x, int y) {
                    const auto place_m = table->place(towards);
                    return place_m ? table->light(towards, *place_m, y) : light_of(towards, x, y);
                },
                [&](int x, int y) {
                    return std::ranges::any_of(samples, [&](const auto& sample) {
                        return table->place(latlong_direction(x + sample.first, y + sample.second, width, height))
                            .has_value();
                    });
                });
            table->draw_print(probe);
        };
        take_table();
        ImageF found = probe.radiance;
        fill_unseen(found, probe.seen);
        table->follow_reflections(found);
        take_table();
    }
    if (table || depth) {
        probe.nearness = nearness_map(height, samples, [&](const Eigen::Vector3d& towards, int x, int y) {
            const auto place_m = table ? table->place(towards) : std::nullopt;
            return place_m ? 1 / (*place_m - options.place_m).norm() : parallax_nearness(x, y);
        });
    }
    fill_unseen(probe.radiance, probe.seen);
    summarize(probe);
    return probe;
}

}  // namespace matchlight
