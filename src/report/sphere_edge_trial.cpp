// Each way draws the whole view; its error is taken over the middle.
#include "report/sphere_edge_trial.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/experiment.h"
#include "report/srgb_picture.h"

namespace matchlight {
namespace {

constexpr int reference_side = 16;

struct Way {
    int places = 0;         // at edges
    int supersampling = 1;  // of the whole picture
    double detail_px = 0;
};

std::string name_of(const Way& way) {
    if (way.detail_px > 0) return fmt::format("radii of {:g} px", way.detail_px);
    std::string name = way.supersampling > 1 ? fmt::format("{0}×{0} pixels", way.supersampling) : "";
    if (way.places > 0) return name + fmt::format("{0}×{0} places", way.places);
    return name.empty() ? "middles" : name;
}

/// The mean of `times` × `times` pixels, of a region of the coarser picture: RGBA.
ImageF box_mean(const ImageF& fine, const Region& region, int times) {
    ImageF mean(region.width, region.height, 4);
    const auto count = static_cast<float>(times * times);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            for (int i = 0; i < times * times; ++i) {
                const float* const from =
                    fine.pixel(times * (region.x + x) + i % times, times * (region.y + y) + i / times);
                for (int c = 0; c < 4; ++c) mean.at(x, y, c) += from[c] / count;
            }
        }
    }
    return mean;
}

ImageF light_of(const ImageF& rgba) {
    ImageF light(rgba.width(), rgba.height(), 3);
    for (int y = 0; y < rgba.height(); ++y) {
        for (int x = 0; x < rgba.width(); ++x) std::copy_n(rgba.pixel(x, y), 3, light.pixel(x, y));
    }
    return light;
}

/// Differences of the covered share: the largest, and the mean over pixels that are covered in part.
std::vector<Knob> coverage_off(const ImageF& exact, const ImageF& drawn) {
    double largest = 0, sum = 0;
    int edges = 0;
    for (int y = 0; y < exact.height(); ++y) {
        for (int x = 0; x < exact.width(); ++x) {
            const double expected = exact.at(x, y, 3);
            const double off = std::abs(expected - static_cast<double>(drawn.at(x, y, 3)));
            largest = std::max(largest, off);
            if (expected <= 0 || expected >= 1) continue;
            sum += off;
            ++edges;
        }
    }
    return {{"largest_coverage_error", largest}, {"mean_coverage_error", sum / std::max(edges, 1)}};
}

/// Lacks its name and what it is.
EffectReport measure_ways(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view,
                          std::span<const Way> ways) {
    const int side = std::min({view.view.width(), view.view.height(), view.quick ? 64 : 192});
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.region = {(view.view.width() - side) / 2, (view.view.height() - side) / 2, side, side};
    report.reference = fmt::format("the mean of {0}×{0} rays a pixel in double precision", reference_side);
    const ReferenceView middle = cropped(view.view, report.region);
    const auto light = [&](const SpherePoint& point) { return stage.light_of(point); };
    const ImageF exact = reference_opaque(rays, middle, reference_side, light);
    experiment.reference = light_of(exact);
    experiment.coarse_reference = light_of(reference_opaque(rays, middle, reference_side / 2, light));
    for (const Way& way : ways) {
        const auto draw = [&stage, &view, way] {
            stage.set_edge_places(way.places);
            stage.set_detail_px(way.detail_px);
            stage.draw(finer(view.view, way.supersampling), {});
            stage.set_edge_places(0);
            stage.set_detail_px(0);
        };
        const auto drawn = [draw, &stage, way, region = report.region] {
            draw();
            return box_mean(stage.picture(), region, way.supersampling);
        };
        Candidate& candidate = experiment.candidates.emplace_back();
        candidate.point.level = name_of(way);
        candidate.point.precision = "32F";
        candidate.point.knobs = coverage_off(exact, drawn());
        for (const Knob& knob : stage.drawn_spheres()) candidate.point.knobs.push_back(knob);
        candidate.work = draw;
        candidate.picture = [drawn] { return light_of(drawn()); };
    }
    return run_experiment(experiment, srgb_picture, view.timing);
}

}  // namespace

EffectReport measure_sphere_edges(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view) {
    std::vector<Way> ways{{}, {.supersampling = 2}, {.supersampling = 4}, {.places = 2}, {.places = 4}, {.places = 8}};
    if (!view.quick) ways.push_back({.places = 4, .supersampling = 2});
    EffectReport report = measure_ways(stage, rays, view, ways);
    report.what = fmt::format(
        "Edges of spheres: places along a pixel's side at which the outlines of what it and its neighbours show are "
        "met again, or whole pictures of more pixels: a whole frame of {}×{} pixels, lit.",
        view.view.width(), view.view.height());
    return report;
}

EffectReport measure_sphere_detail(SphereStage& stage, const SphereCaster& rays, const SphereTrialView& view) {
    std::vector<Way> ways{{}};
    for (const double radius_px : {0.25, 0.5, 1.0, 2.0}) ways.push_back({.detail_px = radius_px});
    EffectReport report = measure_ways(stage, rays, view, ways);
    report.what = fmt::format(
        "Levels of detail: some of the spheres that are smaller than a radius, enlarged up to it, in place of all: a "
        "whole frame of {}×{} pixels, lit, by pixels' middles.",
        view.view.width(), view.view.height());
    return report;
}

}  // namespace matchlight
