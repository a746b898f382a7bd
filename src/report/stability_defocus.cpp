// Cases of the post-process methods of depth of field, each with the artefact that it is known for.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "render/effects/defocus_diffusion.h"
#include "render/effects/defocus_layers.h"
#include "render/effects/defocus_mipmap.h"
#include "render/effects/defocus_one_pass.h"
#include "render/effects/defocus_two_pass.h"
#include "report/defocus_trial.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

struct Method {
    const char* name;
    Bound beside_disc;
    std::optional<Bound> energy;
    AddDefocus add;
};

std::vector<Method> methods() {
    constexpr QualityLevel level = QualityLevel::final_;
    constexpr Bound kept{0.999, 1.001};
    constexpr double in_corners = 1 - std::numbers::pi / 4;  // of a square, beside the disc in it
    return {
        {"two_pass",
         {in_corners - 0.01, in_corners + 0.01},
         kept,
         [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
             return add_two_pass_defocus(graph, shaders, input, two_pass_knobs(level));
         }},
        // Rings meet a point by chance: how many do is no promise.
        {"one_pass",
         {0, 1},
         {},
         [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
             return add_one_pass_defocus(graph, shaders, input, one_pass_knobs(level));
         }},
        // Half a slice's width, of 32/12 px, along the rim.
        {"layers",
         {0, 0.1},
         kept,
         [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
             return add_layers_defocus(graph, shaders, input, layers_knobs(level));
         }},
        // A disc's variance in other shapes: 0.30 for the Gaussian, more for a peak.
        {"mipmap",
         {0, 0.45},
         kept,
         [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
             return add_mipmap_defocus(graph, shaders, input, mipmap_knobs(level));
         }},
        {"diffusion",
         {0, 0.45},
         kept,
         [](RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input) {
             return add_diffusion_defocus(graph, shaders, input, diffusion_knobs(level));
         }},
    };
}

StabilityCase point_case(const Method& method) {
    return {fmt::format("depth of field, {}", method.name),
            "one pixel of 1e5, a circle of 32 px",
            "share of its light beside the disc",
            method.beside_disc,
            method.energy,
            [add = method.add] {
                constexpr double coc_px = 32;
                DefocusImages images(161, 161);
                images.set(80, 80, 1e5, coc_px);
                ShaderLibrary shaders;
                const ImageF picture = run_defocus(shaders, images, add);
                double energy = 0;
                for (int y = 0; y < 161; ++y) {
                    for (int x = 0; x < 161; ++x) energy += picture.at(x, y) / 1e5;
                }
                return StabilityOutcome{.value = share_beside_disc(picture, 80, 80, coc_px), .energy_kept = energy};
            }};
}

StabilityCase seam_case(int slices, bool disjoint) {
    return {"depth of field, layers",
            fmt::format("a slope from circles of 4 px to 20 px through {} slices that {}", slices,
                        disjoint ? "add up" : "cover each other"),
            "most of the plate that shines through",
            // What cover each other without knowing of it leave: 1/4 of two straight edges, 1/e of many.
            {0, 1 / std::numbers::e},
            {},
            [slices, disjoint] {
                DefocusImages images(240, 40);
                for (int y = 0; y < 40; ++y) {
                    for (int x = 0; x < 240; ++x) images.set(x, y, 0.5, 4 + std::round(64 * x / 15.0) / 64);
                }
                ShaderLibrary shaders;
                const ImageF picture = run_defocus(
                    shaders, images, [=](RenderGraph& graph, ShaderLibrary& library, const DefocusInput& input) {
                        return add_layers_defocus(graph, library, input, {.slices = slices, .disjoint = disjoint});
                    });
                double most = 0;
                for (int x = 0; x < 240; ++x) most = std::max(most, 1.0 - picture.at(x, 20, 3));
                return StabilityOutcome{.value = most};
            }};
}

StabilityCase conductivity_case(double conductivity) {
    return {"depth of field, diffusion",
            fmt::format("conductivity {:g}, points of 1e5 on something holed", conductivity),
            "largest change of all light and coverage",
            {0, 1e-5},
            {},
            [conductivity] {
                const double coc_px = -std::sqrt(32 * conductivity);
                DefocusImages images(500, 37);
                for (int y = 0; y < 37; ++y) {
                    for (int x = 0; x < 500; ++x) {
                        if ((x + 3 * y) % 7 < 5) images.set(x, y, (x + y) % 97 == 0 ? 1e5 : 0.5, coc_px);
                    }
                }
                ShaderLibrary shaders;
                const ImageF picture = run_defocus(
                    shaders, images, [](RenderGraph& graph, ShaderLibrary& library, const DefocusInput& input) {
                        return add_diffusion_defocus(graph, library, input, {});
                    });
                double worst = 0;
                for (const int channel : {0, 3}) {
                    double before = 0, after = 0;
                    for (int y = 0; y < 37; ++y) {
                        for (int x = 0; x < 500; ++x) {
                            before += images.light.at(x, y, channel);
                            after += picture.at(x, y, channel);
                        }
                    }
                    const double change = std::abs(after / before - 1);
                    if (!std::isfinite(change)) return StabilityOutcome{.value = change};
                    worst = std::max(worst, change);
                }
                return StabilityOutcome{.value = worst};
            }};
}

}  // namespace

std::vector<StabilityCase> defocus_cases() {
    std::vector<StabilityCase> cases;
    for (const Method& method : methods()) cases.push_back(point_case(method));
    for (const int slices : {2, 8, 64}) {
        for (const bool disjoint : {false, true}) cases.push_back(seam_case(slices, disjoint));
    }
    for (const double conductivity : {1.0, 1e6, 1e8, 1e12}) cases.push_back(conductivity_case(conductivity));
    return cases;
}

}  // namespace matchlight
