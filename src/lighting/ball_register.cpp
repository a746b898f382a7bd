// Views of a mirror ball that share no tags, turned onto each other by the light that both reflect.
#include "lighting/ball_register.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "core/transforms.h"
#include "lighting/ball_probe.h"
#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

/// The camera looking along world +y with the ball, where its outline says, in the origin.
RigidTransform photographer(const BallView& view, double ball_radius_m) {
    const Eigen::Vector3d centre = view.outline.centre_camera_m(ball_radius_m);
    const RigidTransform upright =
        camera_looking_along(-centre.norm() * Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitY());
    const Eigen::Quaterniond aside = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), view.outline.axis);
    return RigidTransform(aside) * upright;
}

/// An unwrapped view: logarithm of light, and where it is known.
struct Picture {
    ImageF log_light, known;

    double light(const Eigen::Vector3d& direction, double& weight) const {
        const Eigen::Vector2d at = latlong_pixel(direction, log_light.width(), log_light.height());
        const int x = (static_cast<int>(std::lround(at.x())) + log_light.width()) % log_light.width();
        const int y = std::clamp(static_cast<int>(std::lround(at.y())), 0, log_light.height() - 1);
        weight = known.at(x, y);
        return log_light.at(x, y);
    }
};

Picture picture_of(const BallView& view, double ball_radius_m, int height) {
    std::vector<BallView> one{view};
    BallProbeOptions options;
    options.height = height;
    options.camera_deg = 0;
    const BallScene scene{one, {Eigen::Vector3d::Zero(), ball_radius_m}, Eigen::Vector3d::Ones(), {}, nullptr};
    const BallProbe probe = probe_from_balls(scene, options);
    const Eigen::Vector3d eye = view.eye_m().normalized();
    Picture picture{ImageF(2 * height, height, 1), ImageF(2 * height, height, 1)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Eigen::Vector3d rgb = Eigen::Map<const Eigen::Vector3f>(probe.radiance.pixel(x, y)).cast<double>();
            picture.log_light.at(x, y) = static_cast<float>(std::log2(std::max(rgb.sum() / 3, 1e-9)));
            const Eigen::Vector3d direction = latlong_direction(x, y, 2 * height, height);
            // Round itself a view shows its own camera, behind the ball its rim.
            const double turned = direction.dot(eye);
            picture.known.at(x, y) = turned < 0.95 && turned > -0.8 ? probe.seen.at(x, y) : 0;
        }
    }
    return picture;
}

/// Correlation of the second picture, turned, with the first over what both show; −1 where that is little.
double agreement(const Picture& first, const Picture& second, const Eigen::Matrix3d& first_from_second, int stride) {
    const int height = first.log_light.height(), width = first.log_light.width();
    double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    for (int y = stride / 2; y < height; y += stride) {
        const double row = std::sin((y + 0.5) / height * std::numbers::pi);
        for (int x = stride / 2; x < width; x += stride) {
            if (first.known.at(x, y) <= 0.5F) continue;
            double weight = 0;
            const Eigen::Vector3d towards = latlong_direction(x, y, width, height);
            const double other = second.light(first_from_second.transpose() * towards, weight);
            if (weight <= 0.5) continue;
            const double own = first.log_light.at(x, y);
            n += row, a += row * own, b += row * other;
            aa += row * own * own, bb += row * other * other, ab += row * own * other;
        }
    }
    const double all = 2.0 / std::numbers::pi * width * height / (stride * stride);
    if (n < 0.3 * all) return -1;
    const double spread = (aa - a * a / n) * (bb - b * b / n);
    return spread > 0 ? (ab - a * b / n) / std::sqrt(spread) : -1;
}

struct Turn {
    double correlation = -1;
    Eigen::Matrix3d first_from_second = Eigen::Matrix3d::Identity();
};

/// Photographers stand upright, roughly: all the way round, and 60° of tilt either way.
Turn best_turn(const Picture& first, const Picture& second) {
    constexpr double step = 6 * std::numbers::pi / 180;
    constexpr int around = 60, tilts = 10;
    std::vector<Turn> found(around);
    const auto turned = [](double azimuth, double pitch, double roll) {
        return Eigen::Matrix3d(Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
                               Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitY()));
    };
    parallel_for(around, [&](int i) {
        Turn& best = found[static_cast<std::size_t>(i)];
        for (int j = -tilts; j <= tilts; ++j) {
            for (int k = -2; k <= 2; ++k) {
                const Eigen::Matrix3d rotation = turned(i * step, j * step, k * step);
                const double value = agreement(first, second, rotation, 4);
                if (value > best.correlation) best = {value, rotation};
            }
        }
    });
    std::ranges::stable_sort(found, std::greater<>(), &Turn::correlation);
    found.resize(4);
    parallel_for(static_cast<int>(found.size()), [&](int i) {
        Turn& turn = found[static_cast<std::size_t>(i)];
        turn.correlation = agreement(first, second, turn.first_from_second, 1);
        for (double angle = step / 2; angle > 1e-3; angle /= 2) {
            for (bool moved = true; moved;) {
                moved = false;
                for (int k = 0; k < 6; ++k) {
                    const Eigen::AngleAxisd by(k % 2 == 0 ? angle : -angle, Eigen::Vector3d::Unit(k / 2));
                    const Eigen::Matrix3d next = by.toRotationMatrix() * turn.first_from_second;
                    const double value = agreement(first, second, next, 1);
                    if (value > turn.correlation) turn = {value, next}, moved = true;
                }
            }
        }
    });
    return *std::ranges::max_element(found, {}, &Turn::correlation);
}

}  // namespace

void register_views(std::vector<BallView>& views, double ball_radius_m, Warnings& warnings) {
    for (BallView& view : views) view.camera_from_world = photographer(view, ball_radius_m);
    if (views.size() < 2) return;
    constexpr int rows = 96;
    const Picture first = picture_of(views.front(), ball_radius_m, rows);
    for (std::size_t v = 1; v < views.size(); ++v) {
        const Picture second = picture_of(views[v], ball_radius_m, rows);
        const Turn turn = best_turn(first, second);
        // Rooms agree by chance to a third: ceilings are bright and floors are dark.
        constexpr double least = 0.5;
        if (turn.correlation < least) {
            throw InputError(views[v].name,
                             fmt::format("no turn brings its reflections onto those of {}: correlation {:.2f} at best",
                                         views.front().name.string(), turn.correlation),
                             "put tags beside the ball and give --rig, or leave the view out");
        }
        RigidTransform world_from_own = RigidTransform::Identity();
        world_from_own.linear() = turn.first_from_second;
        *views[v].camera_from_world = *views[v].camera_from_world * world_from_own.inverse();
        warnings.add(fmt::format("{}: turned onto the first view by its reflections, correlation {:.2f}",
                                 views[v].name.string(), turn.correlation));
    }
}

}  // namespace matchlight
