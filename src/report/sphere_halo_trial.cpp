// Light of the middle of a frame, with the halos of the whole set.
#include "report/sphere_halo_trial.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/parallel.h"
#include "report/experiment.h"
#include "report/srgb_picture.h"

namespace matchlight {
namespace {

/// Halos of what is around the region reach into it.
ImageF exact_light(const SphereStage& stage, const SphereCaster& rays, const ReferenceView& view, const Region& region,
                   const SphereHalo& halo) {
    const Image<double> left = reference_halos(rays, view, halo);
    ImageF light(region.width, region.height, 3);
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const SphereRay ray = view.ray_through(region.x + x, region.y + y);
            const auto hit = rays.nearest(ray);
            if (!hit) continue;
            const Eigen::Vector3d sent =
                left.at(region.x + x, region.y + y) * stage.light_of(point_of(rays, ray, *hit));
            for (int c = 0; c < 3; ++c) light.at(x, y, c) = static_cast<float>(sent[c]);
        }
    });
    return light;
}

}  // namespace

EffectReport measure_sphere_halos(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view) {
    const int side = std::min({view.view.width(), view.view.height(), view.quick ? 64 : 192});
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.region = {(view.view.width() - side) / 2, (view.view.height() - side) / 2, side, side};
    // As dark as half at a silhouette in front of what is a twentieth of the distance behind it.
    const Eigen::Vector3d eye_m = view.view.camera_from_world.inverse().translation();
    const SphereHalo halo{.strength = 0.5, .width_deg = 0.3, .depth_m = 0.05 * std::max(eye_m.norm(), 1e-6)};
    report.what = fmt::format(
        "Halos, {:g}° wide: places around a pixel at every so many pixels that may lie before it: a whole frame of "
        "{}×{} pixels, lit.",
        halo.width_deg, view.view.width(), view.view.height());
    report.reference = "every pixel around each, by rays in double precision";
    experiment.reference = exact_light(stage, rays, view.view, report.region, halo);
    for (const int step_px : {0, 4, 3, 2, 1}) {
        const bool has_halo = step_px > 0;
        const auto draw = [&stage, &view, step_px, shown = has_halo ? halo : SphereHalo{}] {
            stage.set_halo(shown, std::max(step_px, 1));
            stage.draw(view.view, {});
            stage.set_halo({}, 1);
        };
        Candidate& candidate = experiment.candidates.emplace_back();
        candidate.point.level = has_halo ? fmt::format("every {} px", step_px) : "no halos";
        candidate.point.precision = "32F";
        candidate.point.knobs = {{"step_px", static_cast<double>(step_px)}};
        candidate.work = draw;
        candidate.picture = [draw, &stage, region = report.region] {
            draw();
            const ImageF drawn = stage.picture();
            ImageF light(region.width, region.height, 3);
            for (int y = 0; y < region.height; ++y) {
                for (int x = 0; x < region.width; ++x)
                    std::copy_n(drawn.pixel(region.x + x, region.y + y), 3, light.pixel(x, y));
            }
            return light;
        };
    }
    return run_experiment(experiment, srgb_picture, view.timing);
}

}  // namespace matchlight
