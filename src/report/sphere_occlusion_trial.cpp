// The maps are made before a frame is timed: light and spheres that stay need them once.
#include "report/sphere_occlusion_trial.h"

#include <algorithm>
#include <string>
#include <vector>

#include <epoxy/gl.h>
#include <fmt/format.h>

#include "core/parallel.h"
#include "lighting/octahedral_directions.h"
#include "report/experiment.h"
#include "report/run_time.h"
#include "report/srgb_picture.h"

namespace matchlight {
namespace {

using Occlusion = SphereStage::Occlusion;

int directions_of(const Occlusion& occlusion) {
    return octahedral_counts.at(static_cast<std::size_t>(occlusion.divisions));
}

void draw_occluded(SphereStage& stage, const ReferenceView& view, const Occlusion& occlusion) {
    stage.set_occlusion(occlusion);
    stage.draw(view, {});
    stage.set_occlusion({});
}

/// At the middles of a view's pixels, over black.
ImageF exact_light(const SphereStage& stage, const SphereCaster& rays, const ReferenceView& view, int side) {
    ImageF light(view.width(), view.height(), 3);
    parallel_for(view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            const SphereRay ray = view.ray_through(x, y);
            const auto hit = rays.nearest(ray);
            if (!hit) continue;
            const Eigen::Vector3d sent = stage.occluded_light_of(rays, point_of(rays, ray, *hit), side);
            for (int c = 0; c < 3; ++c) light.at(x, y, c) = static_cast<float>(sent[c]);
        }
    });
    return light;
}

ImageF light_in(const ImageF& drawn, const Region& region) {
    ImageF light(region.width, region.height, 3);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x)
            std::copy_n(drawn.pixel(region.x + x, region.y + y), 3, light.pixel(x, y));
    }
    return light;
}

}  // namespace

SpherePart occlusion_part(SphereStage& stage, bool quick) {
    SpherePart part{.name = "maps", .ways = {}};
    part.ways.push_back({"no maps", [&stage](const ReferenceView& view) { stage.draw(view, {}); }});
    for (int divisions = 0; divisions <= (quick ? 2 : most_octahedral_divisions); ++divisions) {
        const Occlusion occlusion{.divisions = divisions};
        part.ways.push_back(
            {fmt::format("{} maps", directions_of(occlusion)),
             [&stage, occlusion](const ReferenceView& view) { draw_occluded(stage, view, occlusion); }});
    }
    return part;
}

EffectReport measure_sphere_occlusion(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view) {
    const int side = std::min({view.view.width(), view.view.height(), view.quick ? 48 : 128});
    const int reference_side = view.quick ? 24 : 48;
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.region = {(view.view.width() - side) / 2, (view.view.height() - side) / 2, side, side};
    report.what = fmt::format(
        "Light between spheres: a map of the nearest sphere along each direction to a corner of a divided octahedron, "
        "opposite ones drawn at once, looked at once a pixel: a whole frame of {}×{} pixels, its maps made before.",
        view.view.width(), view.view.height());
    report.reference = fmt::format(
        "{0}×{0} rays over the hemisphere above the middle of each pixel in double precision", reference_side);
    const ReferenceView middle = cropped(view.view, report.region);
    experiment.reference = exact_light(stage, rays, middle, reference_side);
    experiment.coarse_reference = exact_light(stage, rays, middle, reference_side / 2);
    std::vector<Occlusion> ways;
    for (int divisions = 0; divisions <= (view.quick ? 3 : most_octahedral_divisions); ++divisions) {
        ways.push_back({.divisions = divisions});
        if (!view.quick && divisions >= 2 && divisions < most_octahedral_divisions)
            ways.push_back({.divisions = divisions, .resolution = 512});
    }
    for (const Occlusion& way : ways) {
        const auto draw = [&stage, &view, way] { draw_occluded(stage, view.view, way); };
        // Neither the picture nor, after the first time, the compiler.
        const std::vector<std::function<void()>> works{[&stage, way] {
            stage.forget_maps();
            stage.make_maps(way);
        }};
        const RunTime making = time_in_turn(works, Stopwatch::wall, {.repeats = 1}).front();
        Candidate& candidate = experiment.candidates.emplace_back();
        candidate.point.level = fmt::format("{} maps of {}", directions_of(way), way.resolution);
        candidate.point.precision = "32F";
        constexpr double bytes_a_texel = 4, mib = 1024.0 * 1024.0;
        const double texels = static_cast<double>(way.resolution) * way.resolution;
        candidate.point.knobs = {{"directions", static_cast<double>(directions_of(way))},
                                 {"maps_ms", making.median_ms},
                                 {"maps_mib", directions_of(way) * texels * bytes_a_texel / mib}};
        candidate.work = draw;
        candidate.picture = [draw, &stage, region = report.region] {
            draw();
            return light_in(stage.picture(), region);
        };
    }
    EffectReport measured = run_experiment(experiment, srgb_picture, view.timing);
    stage.forget_maps();
    return measured;
}

}  // namespace matchlight
