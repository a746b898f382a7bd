// Stiff cases of the light of sphere sets: codes and covered shares of lone spheres of all sizes, what maps of
// occlusion and halos leave of it; each pixel against the ray in double precision.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "report/sphere_stage.h"
#include "report/sphere_trial.h"
#include "report/stability_sphere_views.h"

namespace matchlight {
namespace {

using MakeSphere = std::function<OneSphere()>;

/// A camera within a sphere, off its middle.
OneSphere from_inside() {
    return {set_of({sphere_at(Eigen::Vector3d::Zero(), 1)}),
            view_from({0.24, -0.3, 0.32}, {1, 1, 0}, sphere_case_side_px, 1e-3)};
}

OneSphere upon_each_other() {
    OneSphere many = one_sphere(0.3);
    many.set.spheres.resize(50, many.set.spheres.front());
    return many;
}

OneSphere nothing() {
    return {{}, one_sphere(0.3).view};
}

OneSphere crowd() {
    return {cloud(), view_from({0.3, -2, 0.4}, {0, 0, 0}, 1.2 * sphere_case_side_px, 0.01)};
}

SphereCheckRow checked(const OneSphere& one) {
    SphereStage stage(one.set);
    SphereCaster rays;
    rays.add_set(one.set);
    const auto drawn = [&](const ReferenceView& view) {
        constexpr int places = 8;
        stage.set_edge_places(places);
        stage.draw(view, {});
        return stage.picture();
    };
    const auto light = [&](const SpherePoint& point) { return stage.light_of(point); };
    return check_against_rays(rays, std::span(&one.view, 1), drawn, light, {.stride_px = 2});
}

void add_light_cases(std::vector<StabilityCase>& cases, const std::string& name, const MakeSphere& make) {
    cases.push_back({"spheres, light", name, "largest difference off edges, codes of 255", {0, 1}, {}, [make] {
                         const SphereCheckRow row = checked(make());
                         return StabilityOutcome{row.largest_codes,
                                                 {},
                                                 {},
                                                 {{"edge pixels", static_cast<double>(row.edge_pixels)},
                                                  {"coverage off", row.largest_coverage}}};
                     }});
    cases.push_back({"spheres, light", name, "largest difference of coverage at edges", {0, 1.0 / 16}, {}, [make] {
                         return StabilityOutcome{checked(make()).largest_coverage};
                     }});
}

/// The largest difference, of the light that all spheres send at the most, off silhouettes and seams.
double light_error(const SphereStage& stage, const SphereCaster& rays, const ReferenceView& view, const ImageF& drawn,
                   const std::function<double(const SpherePoint&, int x, int y)>& expected) {
    double largest = 0;
    for (int y = 0; y < view.height(); y += 2) {
        for (int x = 0; x < view.width(); x += 2) {
            if (is_sphere_edge(rays, view, x, y, {.side = 4, .margin_px = 0.02})) continue;
            const SphereRay ray = view.ray_through(x, y);
            const auto hit = rays.nearest(ray);
            const double light = hit ? expected(point_of(rays, ray, *hit), x, y) : 0;
            const double error = std::abs(static_cast<double>(drawn.at(x, y, 0)) - light) / stage.most_light();
            largest = std::isfinite(error) ? std::max(largest, error) : std::numeric_limits<double>::quiet_NaN();
            if (std::isnan(largest)) return largest;
        }
    }
    return largest;
}

/// A lone sphere hides half of the sky from each of its points, and nothing more; from within all of it.
void add_occlusion_case(std::vector<StabilityCase>& cases, const std::string& name, double most,
                        const MakeSphere& make) {
    cases.push_back(
        {"spheres, occlusion", name, "largest error of light past 66 maps, of the most light", {0, most}, {}, [make] {
             const OneSphere one = make();
             SphereStage stage(one.set);
             SphereCaster rays;
             rays.add_set(one.set);
             stage.set_occlusion(SphereStage::Occlusion{});
             stage.draw(one.view, {});
             constexpr int side = 24;
             return StabilityOutcome{
                 light_error(stage, rays, one.view, stage.picture(), [&](const SpherePoint& point, int, int) {
                     if (point.normal.dot(point.toward_eye) < 0) return 0.0;  // from within
                     return stage.occluded_light_of(rays, point, side).x();
                 })};
         }});
}

/// What is drawn of halos is what every pixel around each says.
void add_halo_case(std::vector<StabilityCase>& cases, const std::string& name, const SphereHalo& halo,
                   const MakeSphere& make) {
    cases.push_back({"spheres, halos", name, "largest error of light, of the most light", {0, 2e-3}, {}, [make, halo] {
                         const OneSphere one = make();
                         SphereStage stage(one.set);
                         SphereCaster rays;
                         rays.add_set(one.set);
                         stage.set_halo(halo, 1);
                         stage.draw(one.view, {});
                         const Image<double> left = reference_halos(rays, one.view, halo);
                         return StabilityOutcome{light_error(stage, rays, one.view, stage.picture(),
                                                             [&](const SpherePoint& point, int x, int y) {
                                                                 return left.at(x, y) * stage.light_of(point).x();
                                                             })};
                     }});
}

}  // namespace

void add_sphere_light_cases(std::vector<StabilityCase>& cases) {
    for (const double radius_m : {1e-6, 1e-4, 1e-2, 1.0, 1e3, 1e6}) {
        add_light_cases(cases, fmt::format("radius {:g} of the distance", radius_m),
                        [radius_m] { return one_sphere(radius_m); });
    }
    add_light_cases(cases, "camera inside", from_inside);
    add_light_cases(cases, "50 spheres upon each other", upon_each_other);
    add_light_cases(cases, "none", nothing);
    // Half floats, and the reference's 576 directions.
    constexpr double rounding = 5e-3;
    for (const double radius_m : {1e-6, 1e-2, 1.0, 1e6}) {
        add_occlusion_case(cases, fmt::format("radius {:g} of the distance", radius_m), rounding,
                           [radius_m] { return one_sphere(radius_m); });
    }
    add_occlusion_case(cases, "camera inside", rounding, from_inside);
    add_occlusion_case(cases, "50 spheres upon each other", rounding, upon_each_other);
    add_occlusion_case(cases, "none", 0, nothing);
    for (const double depth_m : {1e-6, 0.1, 1e6}) {
        add_halo_case(cases, fmt::format("dark {:g} m behind", depth_m),
                      {.strength = 1, .width_deg = 2, .depth_m = depth_m}, crowd);
    }
    add_halo_case(cases, "narrower than a pixel", {.strength = 1, .width_deg = 0.01, .depth_m = 0.1}, crowd);
    add_halo_case(cases, "wider than the picture", {.strength = 1, .width_deg = 45, .depth_m = 0.1}, crowd);
    // Depths are floats, good for a ten-millionth of the distance.
    add_halo_case(cases, "radius 1e-06 of the distance", {.strength = 1, .width_deg = 1e-5, .depth_m = 1e-3},
                  [] { return one_sphere(1e-6); });
    add_halo_case(cases, "camera inside", {.strength = 1, .width_deg = 2, .depth_m = 0.1}, from_inside);
    add_halo_case(cases, "50 spheres upon each other", {.strength = 1, .width_deg = 2, .depth_m = 0.1},
                  upon_each_other);
    add_halo_case(cases, "none", {.strength = 1, .width_deg = 2, .depth_m = 0.1}, nothing);
}

}  // namespace matchlight
