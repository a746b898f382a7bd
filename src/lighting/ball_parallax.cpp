// How far away what each view of a mirror ball shows is, by its parallax against the other views, which meet the same
// light on other parts of the ball.
#include "lighting/ball_parallax.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "core/parallel.h"
#include "lighting/latlong_grid.h"
#include "lighting/latlong_lookup.h"
#include "lighting/latlong_regions.h"
#include "lighting/probe.h"

namespace matchlight {
namespace {

/// Stops: past a factor of two views contradict each other, and by how much tells only how bright a lamp is that lies
/// in the one's pixel and not in the other's.
constexpr float most_ev = 1;
/// Costs are means over three pixels each way: one that is stretched over more has nothing around it to be compared.
constexpr double most_stretched = 3;
/// Cost where no other view shows a place: neither a match nor a contradiction.
constexpr float unknown_cost = most_ev / 2;
/// What the nearest costs more than the farthest, less than views differ by that show the same: where parallax tells
/// nothing, things are far.
constexpr float nearness_cost = sure_ev / 2;
/// A slope of half a pixel of parallax a pixel is as good as views that show the same; a jump is worth one pixel that
/// contradicts, and half of that where the picture has an edge of half a stop, as dark things before light ones have.
constexpr LabelPenalties penalties = {sure_ev, most_ev, most_ev / 2};

Eigen::Vector3d vector_at(const ImageF& image, int x, int y) {
    return Eigen::Map<const Eigen::Vector3f>(image.pixel(x, y)).cast<double>();
}

BallDepthMap unwrapped(const BallScene& scene, const BallUnwrap& unwrap, std::size_t v, int height) {
    const int width = 2 * height;
    BallDepthMap map{ImageF(width, height, 3), ImageF(width, height, 3), ImageF(width, height, 1),
                     ImageF(width, height, 1), LabelCosts(0, 0, 0)};
    const Eigen::Vector3d eye_m = scene.views[v].eye_m();
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d towards = latlong_direction(x, y, width, height);
            const auto hit = hit_reflecting_direction(scene.ball, eye_m, towards);
            if (!hit) continue;
            Gathered light;
            unwrap.add_reflection(v, *hit, towards, 1, light);
            // Towards the rim pixels are stretched, by one over the cosine: their edges lie a pixel anywhere.
            const bool fine = hit->cosine > 1 / most_stretched;
            map.known.at(x, y) = fine && unwrap.clearness(v, *hit, towards) > 0.5 ? 1.F : 0.F;
            for (int c = 0; c < 3; ++c) {
                map.point_m.at(x, y, c) = static_cast<float>(hit->point_m[c]);
                if (light.weight > 0) map.light.at(x, y, c) = static_cast<float>(light.light[c] / light.weight);
            }
        }
    });
    return map;
}

/// Light becomes its logarithm. What is darker than a hundredth of the median is noise as much as light.
void take_logarithms(std::vector<BallDepthMap>& maps) {
    std::vector<float> greens;
    for (const BallDepthMap& map : maps) {
        for (int y = 0; y < map.light.height(); ++y) {
            for (int x = 0; x < map.light.width(); ++x) {
                if (map.known.at(x, y) > 0) greens.push_back(map.light.at(x, y, 1));
            }
        }
    }
    if (greens.empty()) return;
    const auto middle = greens.begin() + static_cast<std::ptrdiff_t>(greens.size() / 2);
    std::nth_element(greens.begin(), middle, greens.end());
    const float floor = std::max(0.01F * *middle, 1e-20F);
    for (BallDepthMap& map : maps) {
        for (float& value : map.light.samples()) value = std::log2(std::max(value, 0.F) + floor);
    }
}

class Matcher {
public:
    Matcher(const BallScene& scene, const NearnessScale& scale, const std::vector<BallDepthMap>& maps)
        : scene_(scene), scale_(scale), maps_(maps) {
        for (const BallView& view : scene.views) eyes_.push_back(view.eye_m());
    }

    /// How much the other views differ from view `v` at every nearness of a pixel; the plane's at what lies below it.
    void cost(std::size_t v, int x, int y, float* cost) const {
        const BallDepthMap& map = maps_[v];
        const int labels = scale_.steps + 1;
        const Eigen::Vector3d towards = latlong_direction(x, y, map.known.width(), map.known.height());
        const Eigen::Vector3d from_m = vector_at(map.point_m, x, y);
        const double farthest = std::max(plane_nearness(scene_, from_m, towards), scale_.farthest);
        std::vector<float> differences(static_cast<std::size_t>(labels), 0.F);
        std::vector<int> counts(static_cast<std::size_t>(labels), 0);
        for (std::size_t u = 0; map.known.at(x, y) > 0 && u < eyes_.size(); ++u) {
            if (u == v) continue;
            Eigen::Vector3d normal = (from_m - scene_.ball.centre_m) / scene_.ball.radius_m;
            for (int l = 0; l < labels; ++l) {
                const double nearness = std::max(l * scale_.step, farthest);
                // From one step to the next the point moves little.
                const SeenPlace seen =
                    seen_place(scene_.ball, eyes_[u], from_m + towards / nearness, l == 0 ? 6 : 2, normal);
                const auto light = light_of(u, seen.towards);
                if (!light) continue;
                const double difference = (*light - vector_at(map.light, x, y)).cwiseAbs().mean();
                differences[static_cast<std::size_t>(l)] += static_cast<float>(std::min<double>(most_ev, difference));
                ++counts[static_cast<std::size_t>(l)];
            }
        }
        // Where no other view shows what may be far, nothing speaks against its being far.
        float unknown = 0;
        for (int l = 0; l < labels; ++l) {
            const auto i = static_cast<std::size_t>(l);
            if (counts[i] > 0) unknown = unknown_cost;
            cost[l] = counts[i] > 0 ? differences[i] / static_cast<float>(counts[i]) : unknown;
            cost[l] += nearness_cost * static_cast<float>(l) / static_cast<float>(labels);
        }
    }

private:
    std::optional<Eigen::Vector3d> light_of(std::size_t u, const Eigen::Vector3d& towards) const {
        const BallDepthMap& map = maps_[u];
        const LatlongTaps at(towards, map.known.width(), map.known.height());
        if (map.known.at(at.nearest_x(), at.nearest_y()) <= 0) return std::nullopt;
        Eigen::Vector3d light = Eigen::Vector3d::Zero();
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) light += at.share(i, j) * vector_at(map.light, at.x[i], at.y[j]);
        }
        return light;
    }

    const BallScene& scene_;
    const NearnessScale& scale_;
    const std::vector<BallDepthMap>& maps_;
    std::vector<Eigen::Vector3d> eyes_;
};

/// The least, to a part of a label by the parabola through its neighbours.
double best_label(const float* sums, int labels) {
    const auto best = static_cast<int>(std::min_element(sums, sums + labels) - sums);
    if (best == 0 || best + 1 == labels) return best;
    const double before = sums[best - 1], after = sums[best + 1];
    const double bend = before - 2.0 * sums[best] + after;
    return bend > 0 ? best + 0.5 * (before - after) / bend : best;
}

/// How far apart the points of the ball lie in which two of its views show the same: halfway between eye and direction,
/// so that eyes at an angle a about the ball see it a half of a apart, as seen from the ball's middle, give or take.
double widest_apart_m(const BallScene& scene) {
    double widest = 0;
    for (const BallView& one : scene.views) {
        const Eigen::Vector3d first = (one.eye_m() - scene.ball.centre_m).normalized();
        for (const BallView& other : scene.views) {
            const Eigen::Vector3d second = (other.eye_m() - scene.ball.centre_m).normalized();
            const double angle = std::atan2(first.cross(second).norm(), first.dot(second));
            widest = std::max(widest, 2 * scene.ball.radius_m * std::sin(angle / 4));
        }
    }
    return widest;
}

}  // namespace

NearnessScale nearness_scale(const BallScene& scene, int height) {
    const double radius_m = scene.ball.radius_m;
    const double apart_m = widest_apart_m(scene);
    NearnessScale scale;
    if (!(apart_m > 0)) return scale;
    double pixel = std::numbers::pi / height;
    scale.step = 0.5 * pixel / apart_m;
    scale.farthest = 1e-6 / radius_m;
    // Nothing but the plane comes closer than this: closer things would hide the ball from its cameras.
    constexpr double closest_radii = 2.5;
    scale.steps = static_cast<int>(std::ceil(1 / (closest_radii * radius_m) / scale.step));
    // A lamp of a pixel or less is drawn wherever in the pixel of each of two views it falls: a pixel off in each.
    for (const BallView& view : scene.views) pixel = std::max(pixel, finest_pixel(view, scene.ball));
    scale.far = 2 * pixel / apart_m;
    scale.least_sr = 9 * pixel * pixel;
    return scale;
}

SeenPlace seen_place(const MirrorBall& ball, const Eigen::Vector3d& eye_m, const Eigen::Vector3d& place_m, int rounds,
                     Eigen::Vector3d& normal) {
    SeenPlace seen;
    for (int round = 0; round <= rounds; ++round) {
        seen.point_m = ball.centre_m + ball.radius_m * normal;
        const Eigen::Vector3d way = place_m - seen.point_m;
        seen.nearness = 1 / way.norm();
        seen.towards = way * seen.nearness;
        normal = ((eye_m - seen.point_m).normalized() + seen.towards).normalized();
    }
    return seen;
}

double plane_nearness(const BallScene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards) {
    const auto meets = scene.plane ? scene.plane->meets(from_m, towards) : std::nullopt;
    return meets ? 1 / (*meets - from_m).norm() : 0;
}

ImageF median_of(const ImageF& latlong, int reach) {
    ImageF result = latlong;
    const int width = latlong.width(), height = latlong.height();
    parallel_for(height, [&](int y) {
        std::vector<float> around;
        for (int x = 0; x < width; ++x) {
            around.clear();
            for (int dy = -reach; dy <= reach; ++dy) {
                for (int dx = -reach; dx <= reach; ++dx) {
                    around.push_back(latlong.at((x + dx + width) % width, std::clamp(y + dy, 0, height - 1)));
                }
            }
            const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
            std::nth_element(around.begin(), middle, around.end());
            result.at(x, y) = *middle;
        }
    });
    return result;
}

void drop_specks(ImageF& nearness, const NearnessScale& scale, const std::function<double(int x, int y)>& plane) {
    const LatlongGrid grid(nearness.width(), nearness.height());
    const auto regions = latlong_regions(nearness.width(), nearness.height(),
                                         [&](int x, int y) { return nearness.at(x, y) > plane(x, y) + scale.step; });
    for (const LatlongRegion& region : regions) {
        double solid_angle_sr = 0;
        for (const auto& [x, y] : region) solid_angle_sr += grid.solid_angle(y);
        if (solid_angle_sr >= scale.least_sr) continue;
        for (const auto& [x, y] : region) nearness.at(x, y) = static_cast<float>(plane(x, y));
    }
}

std::vector<BallDepthMap> ball_depth_maps(const BallScene& scene, const BallUnwrap& unwrap, const NearnessScale& scale,
                                          int height) {
    const int width = 2 * height, labels = scale.steps + 1;
    std::vector<BallDepthMap> maps;
    for (std::size_t v = 0; v < scene.views.size(); ++v) maps.push_back(unwrapped(scene, unwrap, v, height));
    take_logarithms(maps);
    const Matcher matcher(scene, scale, maps);
    for (std::size_t v = 0; v < maps.size(); ++v) {
        LabelCosts costs(width, height, labels);
        parallel_for(height, [&](int y) {
            for (int x = 0; x < width; ++x) matcher.cost(v, x, y, costs.at(x, y));
        });
        BallDepthMap& map = maps[v];
        ImageF guide(width, height, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) guide.at(x, y) = map.light.at(x, y, 1);
        }
        const auto plane = [&](int x, int y) {
            return plane_nearness(scene, vector_at(map.point_m, x, y), latlong_direction(x, y, width, height));
        };
        map.costs = smoothed(costs);
        const LabelCosts sums = semi_global_sums(map.costs, guide, penalties);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double nearness = best_label(sums.at(x, y), labels) * scale.step;
                map.nearness.at(x, y) = static_cast<float>(std::max(nearness < scale.far ? 0 : nearness, plane(x, y)));
            }
        }
        map.nearness = median_of(map.nearness, 2);
        drop_specks(map.nearness, scale, plane);
    }
    return maps;
}

}  // namespace matchlight
