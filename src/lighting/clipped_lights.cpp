// The energy of lamps that no photograph could hold, from the paper that they light.
#include "lighting/clipped_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lighting/ball_shadow.h"

namespace matchlight {
namespace {

/// Irradiance of a lamp on the plane at a place: what the ball does not block, and what it reflects down.
Eigen::Vector3d lamp_irradiance(const ClippedPart& lamp, const BallScene& scene, const Eigen::Vector3d& place_m) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const ClippedPart::Pixel& pixel : lamp.pixels) {
        const double cosine = pixel.towards.dot(scene.plane->normal);
        if (cosine > 0 && !hit_ball(scene.ball, place_m, pixel.towards)) sum += cosine * pixel.light;
    }
    const auto hit = hit_reflecting_direction(scene.ball, place_m, lamp.light.direction);
    if (!hit) return sum;
    const Eigen::Vector3d way = hit->point_m - place_m;
    const double cosine = way.normalized().dot(scene.plane->normal);
    if (cosine <= 0) return sum;
    const double shrunk = reflected_solid_angle_ratio(scene.ball, way.norm(), hit->cosine);
    for (const ClippedPart::Pixel& pixel : lamp.pixels) {
        for (int c = 0; c < 3; ++c) {
            sum[c] += fresnel_reflectance(scene.reflectance[c], hit->cosine) * pixel.light[c] * cosine / shrunk;
        }
    }
    return sum;
}

}  // namespace

std::vector<ClippedLight> solve_clipped_lights(BallProbe& probe, const BallScene& scene, double white_albedo) {
    std::vector<ClippedPart> lamps = clipped_parts(probe);
    if (lamps.empty()) return {};
    const BallShadow shadow(light_without(probe, lamps), *scene.plane, scene.ball, scene.reflectance);
    std::erase_if(
        lamps, [&](const ClippedPart& lamp) { return lamp.bound() < 1e-4 * shadow.irradiance_without_ball().sum(); });
    if (lamps.empty()) return {};

    Eigen::Vector3d unshadowed = shadow.irradiance_without_ball() / std::numbers::pi;
    for (const ClippedPart& lamp : lamps) {
        for (const ClippedPart::Pixel& pixel : lamp.pixels) {
            unshadowed += std::max(0.0, pixel.towards.dot(scene.plane->normal)) * pixel.light / std::numbers::pi;
        }
    }
    std::vector<LitPatch> papers;
    for (const PlacedSheet& sheet : scene.rig->sheets) {
        for (int i = 0; i < sheet.printed.cells * sheet.printed.cells; ++i) {
            const int x = i % sheet.printed.cells, y = i / sheet.printed.cells;
            if (sheet.printed.at(x, y) != TagPattern::white) continue;
            const Eigen::Vector3d place_m = sheet.world_from_tag * sheet.sheet_from_grid({x + 0.5, y + 0.5});
            const auto radiance = direct_radiance(scene.views, scene.ball, place_m);
            if (!radiance || radiance->minCoeff() <= 0) continue;
            const Eigen::Vector3d gain = shadow.unshadowed_over_seen(place_m);
            if (gain.maxCoeff() > 3) continue;  // under the ball
            LitPatch paper;
            paper.radiance = *radiance;
            paper.rest = shadow.irradiance_without_ball().cwiseQuotient(gain) / std::numbers::pi;
            Eigen::Vector3d whole = paper.rest;
            for (const ClippedPart& lamp : lamps) {
                paper.parts.push_back(lamp_irradiance(lamp, scene, place_m) / std::numbers::pi);
                whole += paper.parts.back();
            }
            // Print, gloss and what is near the table make paper uneven by a twentieth. In a shadow what the ball and
            // things close by throw back, of which only a part is known, makes up more of the light.
            for (int c = 0; c < 3; ++c)
                paper.relative_sigma[c] = std::hypot(0.05, 0.5 * (1 - whole[c] / unshadowed[c]));
            papers.push_back(std::move(paper));
        }
    }
    if (papers.size() >= 8) {
        // Neighbouring cells share most of their errors. Paper keeps to one albedo within a twentieth.
        solve_gains(lamps, papers, AlbedoPrior{Eigen::Vector3d::Constant(white_albedo), 0.05}, 5);
    } else {
        for (ClippedPart& lamp : lamps) lamp.light.sigma.setOnes();
    }
    return apply_gains(probe, lamps);
}

}  // namespace matchlight
