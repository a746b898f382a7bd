// Stiff cases of spheres that let light through: opacities of 0 and 1 and next to them, many at one place, fields that
// are no numbers; each pixel against all layers in double precision.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "render/transparency_bound.h"
#include "report/sphere_reference.h"
#include "report/sphere_stage.h"
#include "report/stability_cases.h"
#include "report/stability_sphere_views.h"
#include "scene/sphere_builder.h"

namespace matchlight {
namespace {

struct Peeling {
    TransparencyMethod method = TransparencyMethod::lists;
    double residual = 1e-6;  // hardly any
};

/// The largest difference from every sphere of `expected` in order in double precision, in light over black and in what
/// is covered, of 1, off silhouettes and seams.
double transparency_error(const SphereSet& set, const Peeling& peeling, const SphereSet& expected) {
    const ReferenceView view = view_from({0.3, -2, 0.4}, {0, 0, 0}, 1.2 * sphere_case_side_px, 0.01);
    SphereStage stage(set);
    constexpr int most_layers = 1000;
    stage.set_peeling(peeling.residual, most_layers, peeling.method);
    stage.draw(view, {});
    const ImageF drawn = stage.picture();
    SphereCaster rays;
    rays.add_set(expected);
    const auto light_of = [&](const SpherePoint& point) { return stage.light_of(point); };
    double largest = 0;
    for (int y = 0; y < sphere_case_side_px; y += 3) {
        for (int x = 0; x < sphere_case_side_px; x += 3) {
            const auto layers = reference_layers(rays, view.ray_through(x, y), light_of);
            // Floats may meet a sphere that a ray only grazes, and so may a pixel's neighbours.
            if (layers.size() != reference_layers(rays, view.ray_through(x + 0.02, y + 0.02), light_of).size())
                continue;
            if (layers.size() != reference_layers(rays, view.ray_through(x - 0.02, y - 0.02), light_of).size())
                continue;
            const PeeledLight exact = peeled(layers, layers.size());
            const auto off = [&](int channel, double exact_value) {
                const double error = std::abs(static_cast<double>(drawn.at(x, y, channel)) - exact_value);
                largest = std::isfinite(error) ? std::max(largest, error) : error;
            };
            for (int c = 0; c < 3; ++c) off(c, exact.light[c]);
            off(3, 1 - exact.transmittance);
        }
    }
    return largest;
}

/// Half floats, and the light of a probe by float harmonics.
constexpr double rounding = 2e-3;

bool keeps_order(TransparencyMethod method) {
    return method == TransparencyMethod::lists || method == TransparencyMethod::peeling ||
           method == TransparencyMethod::dual_peeling;
}

/// What keeps the order is exact at any opacity, the others where there is none or hardly any.
void add_opacity_cases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const std::string& name, TransparencyMethod method, const std::function<float(int)>& opacity) {
        cases.push_back(
            {"spheres", name, "largest difference from layers in order, of 1", {0, rounding}, {}, [method, opacity] {
                 SphereSet set = cloud();
                 for (int i = 0; i < static_cast<int>(set.size()); ++i) set.opacities.push_back(opacity(i));
                 return StabilityOutcome{transparency_error(set, {.method = method}, set)};
             }});
    };
    for (const auto& [name, method] :
         {std::pair("lists", TransparencyMethod::lists), std::pair("peeling", TransparencyMethod::peeling),
          std::pair("dual peeling", TransparencyMethod::dual_peeling),
          std::pair("weighted sum", TransparencyMethod::weighted_sum),
          std::pair("weighted blended", TransparencyMethod::weighted_blended),
          std::pair("moments", TransparencyMethod::moments)}) {
        for (const float opacity : {0.0F, 1e-4F})
            add(fmt::format("opacity {:g}, {}", opacity, name), method, [opacity](int) { return opacity; });
        if (!keeps_order(method)) continue;
        add(fmt::format("opacities 0, 1e-4, 0.5 and 1 together, {}", name), method, [](int i) {
            return std::array{0.0F, 1e-4F, 0.5F, 1.0F}.at(static_cast<std::size_t>(i % 4));
        });
    }
}

constexpr double tolerance_codes = 8;

/// All at one depth in every pixel, of an opacity whose 32nd layer leaves just what the tolerance may lose.
void add_coincident_cases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const char* name, TransparencyMethod method) {
        cases.push_back({"spheres",
                         fmt::format("200 upon each other peeled to a tolerance of 8 codes, {}", name),
                         "largest error, codes linear in light",
                         {0, tolerance_codes / 2 + 255 * rounding},
                         {},
                         [method] {
                             SphereSet set = set_of(std::vector<Sphere>(200, sphere_at({0.1, 0.2, 0.1}, 0.5)));
                             const double residual = residual_of_tolerance(tolerance_codes);
                             set.opacity = static_cast<float>(opacity_of_layers(32, residual));
                             return StabilityOutcome{
                                 255 * transparency_error(set, {.method = method, .residual = residual}, set)};
                         }});
    };
    add("lists", TransparencyMethod::lists);
    add("peeling", TransparencyMethod::peeling);
    add("dual peeling", TransparencyMethod::dual_peeling);
}

/// Of each kind of field some are no number or infinite: what has no place is left out, what is left is repaired.
StabilityOutcome odd_fields() {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    const SphereSettings settings;
    Warnings warnings;
    warnings.set_quiet(true);
    SphereBuilder builder("fields", settings, warnings);
    const SphereValues radius = builder.claim("radius"), opacity = builder.claim("opacity"), red = builder.claim("red"),
                       green = builder.claim("green"), blue = builder.claim("blue");
    builder.begin({});
    SphereSet expected = cloud();
    // Of those at one place the reference does not tell which is before.
    const auto is_there = [](const Sphere& a, const Sphere& b) { return a.centre_m == b.centre_m; };
    expected.spheres.erase(std::unique(expected.spheres.begin(), expected.spheres.end(), is_there),
                           expected.spheres.end());
    for (int i = 0; i < static_cast<int>(expected.size()); ++i) {
        const Sphere& sphere = expected.spheres[static_cast<std::size_t>(i)];
        SphereRecord record;
        for (std::size_t axis = 0; axis < 3; ++axis) record.centre[axis] = sphere.centre_m[axis];
        record.put(radius, sphere.radius_m);
        const bool is_odd = i % 5 == 1;
        record.put(opacity, is_odd ? nan : 0.5);
        expected.opacities.push_back(is_odd ? 1 : 0.5F);
        record.put(red, std::array{nan, infinite, 120.0}.at(static_cast<std::size_t>(i % 3)));
        record.put(green, 200);
        record.put(blue, 90);
        const std::uint8_t repaired = std::array<std::uint8_t, 3>{0, 255, 120}.at(static_cast<std::size_t>(i % 3));
        expected.colors.push_back({repaired, 200, 90, 255});
        builder.add(record);
        record.centre.at(static_cast<std::size_t>(i % 3)) = i % 2 == 0 ? nan : infinite;
        builder.add(record);  // the same with no place
    }
    const SphereSet read = builder.finish();
    const double difference = transparency_error(read, {}, expected);
    const bool is_told = warnings.total() == 3;  // places, opacities, colours
    // The stage draws all of one grey.
    return {is_told && read.colors == expected.colors ? difference : nan,
            {},
            {},
            {{"left out", static_cast<double>(2 * expected.size() - read.size())}}};
}

}  // namespace

void add_sphere_layer_cases(std::vector<StabilityCase>& cases) {
    add_opacity_cases(cases);
    add_coincident_cases(cases);
    cases.push_back({"spheres",
                     "places, opacities and colours that are no numbers",
                     "largest difference from those that are, of 1",
                     {0, rounding},
                     {},
                     odd_fields});
}

}  // namespace matchlight
