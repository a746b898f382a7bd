// One gather, and the way back to pixels.
#include "render/effects/background_defocus.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "render/effects/defocus_kernel.h"
#include "render/effects/defocus_taps.h"

namespace matchlight {

namespace {

/// Along the axes on average, texels².
double variance_of(const std::vector<DefocusTap>& taps) {
    double area = 0, moment = 0;
    for (const DefocusTap& tap : taps) {
        area += tap.area_px2;
        moment += tap.area_px2 * (tap.x * tap.x + tap.y * tap.y) / 2.0;
    }
    return moment / area;
}

/// What the opening covers of each texel, of an opening as wide as spreads light so far.
std::vector<DefocusTap> taps_of_variance(const BokehSettings& bokeh, double variance) {
    // Areas add a texel's own variance where discs are wider than texels.
    const double wide = std::sqrt(std::max(variance - 1.0 / 12, 0.0) / bokeh_variance(bokeh));
    constexpr double narrow = 3;  // texels of radius: below, areas are found by trying
    if (wide >= narrow) return bokeh_taps(bokeh, wide, false);
    double low = 0, high = narrow + 1;
    constexpr int halvings = 12;
    for (int i = 0; i < halvings; ++i) {
        const double middle = (low + high) / 2;
        (variance_of(bokeh_taps(bokeh, middle, false)) < variance ? low : high) = middle;
    }
    return bokeh_taps(bokeh, high, false);
}

}  // namespace

void BackgroundDefocusKnobs::check() const {
    // Uniform arrays of any driver hold the taps of 32 texels' diameter.
    if (!(disc_texels >= 2 && disc_texels <= 16))
        throw std::invalid_argument(fmt::format("disc_texels is {}, not from 2 to 16", disc_texels));
}

BackgroundDefocusKnobs background_defocus_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.disc_texels = 3};
        case QualityLevel::preview:
            return {.disc_texels = 5};
        case QualityLevel::reference:
            return {.disc_texels = 16};
        case QualityLevel::final_:
            break;
    }
    return {};
}

EvenDisc even_disc(const BokehSettings& bokeh, double coc_px, const Region& frame,
                   const BackgroundDefocusKnobs& knobs) {
    knobs.check();
    EvenDisc disc;
    if (coc_px < least_coc_px) {
        disc.taps.emplace_back(0.0F, 0.0F, 1.0F, 0.0F);
        return disc;
    }
    const double width_px = std::min(coc_px, 2 * std::hypot(frame.width, frame.height));
    while (width_px >= 2 * knobs.disc_texels * disc.texel_px) disc.texel_px *= 2;
    // The mean over a coarse texel, and linear interpolation between them, have a variance of a quarter texel².
    const double radius = width_px / 2 / disc.texel_px;
    const double wanted = radius * radius * bokeh_variance(bokeh) - (disc.texel_px > 1 ? 0.25 : 0);
    const std::vector<DefocusTap> taps = taps_of_variance(bokeh, wanted);
    double area = 0;
    for (const DefocusTap& tap : taps) area += tap.area_px2;
    for (const DefocusTap& tap : taps) {
        disc.taps.emplace_back(static_cast<float>(tap.x), static_cast<float>(tap.y),
                               static_cast<float>(tap.area_px2 / area), 0.0F);
        disc.reach = std::max({disc.reach, std::abs(tap.x), std::abs(tap.y)});
    }
    return disc;
}

GraphTexture add_background_defocus(RenderGraph& graph, ShaderLibrary& shaders, const AddFarLight& add_light,
                                    const EvenDisc& disc) {
    const bool is_coarse = disc.texel_px > 1;
    // Pixels at the frame's edge lie between its texels and those beyond.
    const Region texels = is_coarse ? graph.frame(disc.texel_px).grown(1) : graph.frame();
    const GraphTexture light = add_light(texels.grown(disc.reach), disc.texel_px);
    GraphPass gather{.name = "background defocus/gather",
                     .reads = {{light}},
                     .writes = {GL_RGBA32F},
                     .scale = disc.texel_px,
                     .region = texels,
                     .beyond_frame = true};
    gather.draw = [&shaders, light, disc](PassRun& run) {
        Program& program =
            shaders.full_screen("effects/depth_of_field/even_disc.frag", {{"TAPS", std::to_string(disc.taps.size())}});
        program.use();
        run.bind(program, "light", 0, light);
        program.set("taps", std::span<const Eigen::Vector4f>(disc.taps));
        run.draw(program);
    };
    const GraphTexture blurred = graph.add_pass(std::move(gather))[0];
    if (!is_coarse) return blurred;
    return graph.add_pass({.name = "background defocus/pixels",
                           .reads = {{blurred}},
                           .writes = {GL_RGBA32F},
                           .region = graph.frame(),
                           .draw = [&shaders, blurred, texel_px = disc.texel_px](PassRun& run) {
                               Program& program = shaders.full_screen("effects/depth_of_field/even_pixels.frag");
                               program.use();
                               run.bind(program, "blurred", 0, blurred);
                               program.set("texel_px", texel_px);
                               run.draw(program);
                           }})[0];
}

}  // namespace matchlight
