// Stiff cases of sphere sets: radii of all sizes, cameras within, spheres upon each other, one and none; each pixel
// against the ray in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>

#include <fmt/format.h>

#include "gl/shader_library.h"
#include "render/sphere_sets.h"
#include "report/sphere_reference.h"
#include "report/stability_cases.h"
#include "report/stability_sphere_views.h"

namespace matchlight {
namespace {

/// What the GPU sees against what rays meet, off silhouettes and seams.
struct Seen {
    int wrong = 0;           // pixels that see something where nothing is, or nothing where something is
    int covered = 0;         // pixels that see something
    double depth_error = 0;  // the largest, over the depth
};

/// Pixels that are left out of the comparison.
using LeftOut = std::function<bool(const SphereCaster&, const ReferenceView&, int x, int y)>;

/// A fiftieth of a pixel is what float rays may miss.
bool is_edge(const SphereCaster& rays, const ReferenceView& view, int x, int y) {
    return is_sphere_edge(rays, view, x, y, {.side = 4, .margin_px = 0.02});
}

Seen seen_of(const SphereSet& set, const ReferenceView& view, const LeftOut& left_out = is_edge) {
    ShaderLibrary shaders;
    SphereSets sets(shaders);
    PlacedSpheres placed;
    placed.set = sets.add(set);
    placed.clip_from_world = clip_from_camera(view.pinhole) * view.camera_from_world.matrix();
    const SeenSpheres gpu = sets.see(std::span(&placed, 1), sphere_case_side_px, sphere_case_side_px);
    const auto id = gpu.id->read<std::uint32_t>({0, 0, sphere_case_side_px, sphere_case_side_px}, 1);
    const auto share = gpu.depth_share->read<float>({0, 0, sphere_case_side_px, sphere_case_side_px}, 1);
    SphereCaster rays;
    rays.add_set(set);
    const SpherePicture expected = reference_picture(rays, view);
    Seen seen;
    for (int y = 0; y < sphere_case_side_px; ++y) {
        for (int x = 0; x < sphere_case_side_px; ++x) {
            const bool is_seen = id.at(x, y) != 0, is_met = expected.ids.at(x, y) != no_sphere;
            seen.covered += is_seen ? 1 : 0;
            if (left_out(rays, view, x, y)) continue;
            if (is_seen != is_met) ++seen.wrong;
            if (!is_seen || !is_met) continue;
            const double depth_m = view.pinhole.near_m / static_cast<double>(share.at(x, y));
            seen.depth_error =
                std::max(seen.depth_error, std::abs(depth_m - expected.depth_m.at(x, y)) / expected.depth_m.at(x, y));
        }
    }
    return seen;
}

/// One sphere for each pixel, a metre away, far smaller than it: hit in its middle, near its rim, or just missed.
Seen fine_dust(double radius_m) {
    const ReferenceView view = view_from({0.48, -0.6, 0.64}, {0, 0, 0}, sphere_case_side_px, 0.01);
    SphereSet set;
    for (int i = 0; i < sphere_case_side_px * sphere_case_side_px; ++i) {
        const int x = i % sphere_case_side_px, y = i / sphere_case_side_px;
        const SphereRay ray = view.ray_through(x, y);
        const Eigen::Vector3d along = ray.direction.normalized();
        const double off = std::array{0.0, 0.7, 1.3}.at(static_cast<std::size_t>(i % 3));
        const Eigen::AngleAxisd turned(2.399963 * i, along);
        set.spheres.push_back(
            sphere_at(ray.origin_m + along + off * radius_m * (turned * along.unitOrthogonal()), radius_m));
    }
    set.update_bounds();
    // Off their rims by a third of their radius, and rounded to floats, which takes 1e-7 m.
    return seen_of(set, view, [](const SphereCaster&, const ReferenceView&, int, int) { return false; });
}

StabilityCase wrong_case(std::string name, const std::function<Seen()>& see) {
    return {"spheres", std::move(name), "pixels that see wrongly", {0, 0}, {}, [see] {
                const Seen seen = see();
                return StabilityOutcome{
                    static_cast<double>(seen.wrong),
                    {},
                    {},
                    {{"seen", static_cast<double>(seen.covered)}, {"depth error", seen.depth_error}}};
            }};
}

StabilityCase depth_case(std::string name, double most, const std::function<Seen()>& see) {
    return {"spheres", std::move(name), "largest error of depth, relative", {0, most}, {}, [see] {
                const Seen seen = see();
                return StabilityOutcome{seen.covered > 0 ? seen.depth_error : std::numeric_limits<double>::quiet_NaN()};
            }};
}

}  // namespace

std::vector<StabilityCase> sphere_cases() {
    std::vector<StabilityCase> cases;
    for (const double radius_m : {1e-6, 1e-5, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6}) {
        const auto see = [radius_m] {
            const OneSphere one = one_sphere(radius_m);
            return seen_of(one.set, one.view);
        };
        cases.push_back(wrong_case(fmt::format("radius {:g} of the distance", radius_m), see));
        // Floats of the ray's direction and of the depth buffer.
        cases.push_back(depth_case(fmt::format("radius {:g} of the distance", radius_m), 1e-5, see));
    }
    for (const double radius_m : {1e-6, 1e-5, 1e-4}) {
        cases.push_back(wrong_case(fmt::format("dust of {:g} of the distance, a grain a pixel", radius_m),
                                   [radius_m] { return fine_dust(radius_m); }));
    }
    for (const double radius_m : {0.02, 1.0, 1e6}) {
        const auto see = [radius_m] {
            // Off the middle, so that its sides are near and far.
            const Eigen::Vector3d eye = 0.5 * radius_m * Eigen::Vector3d(0.48, -0.6, 0.64);
            return seen_of(
                set_of({sphere_at(Eigen::Vector3d::Zero(), radius_m)}),
                view_from(eye, Eigen::Vector3d(radius_m, radius_m, 0), sphere_case_side_px, 1e-3 * radius_m));
        };
        cases.push_back(wrong_case(fmt::format("camera inside a sphere of {:g} m", radius_m), see));
        cases.push_back(depth_case(fmt::format("camera inside a sphere of {:g} m", radius_m), 1e-5, see));
    }
    cases.push_back(wrong_case("the near plane cuts a sphere open", [] {
        return seen_of(set_of({sphere_at(Eigen::Vector3d::Zero(), 0.5)}),
                       view_from({0.2, -0.8, 0.1}, Eigen::Vector3d::Zero(), sphere_case_side_px, 0.45));
    }));
    cases.push_back(wrong_case("5,000 spheres upon each other", [] {
        return seen_of(set_of(std::vector<Sphere>(5000, sphere_at({0.1, 0.2, 0.3}, 0.4))),
                       view_from({0.2, -2, 0.1}, {0.1, 0.2, 0.3}, sphere_case_side_px, 0.01));
    }));
    cases.push_back(wrong_case("radii of 1e-5 to 1 together", [] {
        std::vector<Sphere> spheres;
        for (int i = 0; i < 1000; ++i) {
            const double turn = 2.399963 * i, radius_m = std::pow(10, -5.0 * i / 999);
            spheres.push_back(sphere_at(
                {std::cos(turn) * (1.5 - radius_m), std::sin(turn) * (1.5 - radius_m), 0.001 * i - 0.5}, radius_m));
        }
        return seen_of(set_of(std::move(spheres)), view_from({1, -6, 3}, {0, 0, 0}, 1.5 * sphere_case_side_px, 0.01));
    }));
    cases.push_back({"spheres", "none", "pixels that see something", {0, 0}, {}, [] {
                         const Seen seen = seen_of({}, view_from({0, -2, 0}, {0, 0, 0}, sphere_case_side_px, 0.01));
                         return StabilityOutcome{static_cast<double>(seen.covered)};
                     }});
    add_sphere_layer_cases(cases);
    add_sphere_light_cases(cases);
    return cases;
}

}  // namespace matchlight
