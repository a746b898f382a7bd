// Every tolerance by the study's form and by the one that holds after the response.
#include "report/sphere_layers.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/parallel.h"
#include "core/transfer.h"
#include "render/transparency_bound.h"
#include "report/experiment.h"
#include "report/flip.h"
#include "report/flip_colors.h"
#include "report/srgb_picture.h"

namespace matchlight {
namespace {

constexpr int to_the_end = 4096;
/// A sixteenth of a code in the darkest part of the sRGB curve.
constexpr double hardly_any = 1.0 / (16 * 255 * 12.92);

double srgb_code(double light, int) {
    return srgb_code_from_linear(light);
}

/// Over black.
ImageF light_over(const ImageF& drawn, const Region& region) {
    ImageF light(region.width, region.height, 3);
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            for (int c = 0; c < 3; ++c) light.at(x, y, c) = drawn.at(region.x + x, region.y + y, c);
        }
    }
    return light;
}

/// Over black, in double precision.
ImageF exact_light(const SphereStage& stage, const SphereCaster& rays, const ReferenceView& view,
                   const Region& region) {
    ImageF light(region.width, region.height, 3);
    const auto light_of = [&](const SpherePoint& point) { return stage.light_of(point); };
    parallel_for(region.height, [&](int y) {
        for (int x = 0; x < region.width; ++x) {
            const auto layers = reference_layers(rays, view.ray_through(region.x + x, region.y + y), light_of);
            const Eigen::Vector3d sum = composite_in_order(layers, Eigen::Vector3d::Zero());
            for (int c = 0; c < 3; ++c) light.at(x, y, c) = static_cast<float>(sum[c]);
        }
    });
    return light;
}

struct Peeling {
    std::string name;
    double tolerance = 0, residual = 0;
    int most_layers = to_the_end;
    TransparencyMethod method = TransparencyMethod::peeling;
};

SpherePart part_of(SphereStage& stage, const char* name, std::span<const Peeling> peelings) {
    SpherePart part{.name = name, .ways = {}};
    for (const Peeling& peeling : peelings) {
        part.ways.push_back({peeling.name,
                             [&stage, peeling](const ReferenceView& view) {
                                 stage.set_peeling(peeling.residual, peeling.most_layers, peeling.method);
                                 stage.draw(view, {});
                             },
                             [&stage] {
                                 const int layers = stage.peeled_layers();
                                 if (layers == 0) return std::vector<Knob>{};
                                 return std::vector<Knob>{{"layers", static_cast<double>(layers)}};
                             }});
    }
    return part;
}

/// Largest differences of a whole picture from the one peeled to the end, in codes of 255.
std::vector<Knob> left_out(const ImageF& whole, const ImageF& stopped) {
    double linear = 0, srgb = 0;
    for (std::size_t i = 0; i < whole.samples().size(); ++i) {
        const auto a = static_cast<double>(whole.samples()[i]), b = static_cast<double>(stopped.samples()[i]);
        linear = std::max(linear, 255 * std::abs(a - b));
        srgb = std::max(srgb, 255 * std::abs(srgb_code_from_linear(a) - srgb_code_from_linear(b)));
    }
    return {{"linear_codes_left", linear}, {"srgb_codes_left", srgb}};
}

std::vector<Peeling> peelings_by_tolerance(const SphereStage& stage, bool quick) {
    std::vector<Peeling> peelings{{"to the end", 0, hardly_any, to_the_end, TransparencyMethod::peeling},
                                  {"dual, to the end", 0, hardly_any, to_the_end, TransparencyMethod::dual_peeling},
                                  {"lists, to the end", 0, hardly_any, to_the_end, TransparencyMethod::lists}};
    const Eigen::Vector3d most_light = Eigen::Vector3d::Constant(stage.most_light());
    for (const double tolerance : {2.0, 8.0, 30.0}) {
        if (quick && tolerance != 8) continue;
        const double srgb = residual_of_tolerance(srgb_code, most_light, tolerance);
        const double linear = residual_of_tolerance(tolerance);
        for (const auto& [by, method] :
             {std::pair("", TransparencyMethod::peeling), std::pair("dual, ", TransparencyMethod::dual_peeling),
              std::pair("lists, ", TransparencyMethod::lists)}) {
            peelings.push_back({fmt::format("{}t = {:g}", by, tolerance), tolerance, srgb, to_the_end, method});
            peelings.push_back(
                {fmt::format("{}t = {:g}, linear codes", by, tolerance), tolerance, linear, to_the_end, method});
        }
    }
    for (const auto& [name, method] : {std::pair("weighted sum", TransparencyMethod::weighted_sum),
                                       std::pair("weighted blended", TransparencyMethod::weighted_blended),
                                       std::pair("moments", TransparencyMethod::moments)})
        peelings.push_back({name, 0, hardly_any, to_the_end, method});
    return peelings;
}

}  // namespace

double studied_opacity() {
    return opacity_of_layers(32, residual_of_tolerance(8));
}

LayerStudy measure_layers(SphereStage& stage, const SphereCaster& rays, std::span<const ReferenceView> views,
                          int repeats, bool quick) {
    LayerStudy study;
    std::vector<Peeling> by_layers;
    for (const int layers : {1, 2, 4, 8, 16, 32}) {
        if (quick && layers != 1 && layers != 8) continue;
        by_layers.push_back({fmt::format("{} layer{}", layers, layers == 1 ? "" : "s"), 0, hardly_any, layers,
                             TransparencyMethod::peeling});
    }
    study.rows = time_over_views(part_of(stage, "layers", by_layers), views, repeats);
    const std::vector<Peeling> by_tolerance = peelings_by_tolerance(stage, quick);
    const SpherePart part = part_of(stage, "peeling", by_tolerance);
    std::vector<SphereStudyRow> rows = time_over_views(part, views, repeats);

    const ReferenceView& view = views.front();
    const int side = std::min({view.width(), view.height(), quick ? 64 : 256});
    EffectReport& effect = study.effect;
    effect.region = {(view.width() - side) / 2, (view.height() - side) / 2, side, side};
    effect.what = fmt::format(
        "Spheres of opacity {:.6f}, peeled off from the front until no pixel lets more through than the tolerance t in "
        "codes of 255 allows, or summed without an order: a whole frame of {}×{} pixels. \"Linear codes\": as if codes "
        "were linear in light.",
        studied_opacity(), view.width(), view.height());
    effect.reference = "every sphere along the ray of each pixel's middle, in order, in double precision";
    const ImageF exact = exact_light(stage, rays, view, effect.region);
    effect.reference_picture = srgb_picture(exact);
    ImageF whole;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        part.ways[i].draw(view);
        const ImageF drawn = stage.picture();
        if (i == 0) whole = drawn;
        for (const Knob& knob : left_out(whole, drawn)) rows[i].beside.push_back(knob);
        EffectPoint& point = effect.points.emplace_back();
        point.level = by_tolerance[i].name;
        point.knobs = rows[i].beside;
        point.precision = "32F";
        point.time = rows[i].time;
        const ImageF light = light_over(drawn, effect.region);
        point.errors = errors_of(exact, light, srgb_picture);
        point.picture = srgb_picture(light);
        point.flip_map = flip_colors(flip_error_map(effect.reference_picture, point.picture));
        study.rows.push_back(std::move(rows[i]));
    }
    return study;
}

}  // namespace matchlight
