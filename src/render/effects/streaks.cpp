// From bright light to streaks: the scale, the softening, line by line; and the study's square.
#include "render/effects/streaks.h"

#include <bit>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/bright_pass.h"
#include "render/effects/gaussian_blur.h"
#include "render/effects/squeezed_square.h"
#include "render/effects/streak_lines.h"

namespace matchlight {
namespace {

/// Beyond this another pass of four taps comes before it. A long last pass ends nearer to where the streak should: its
/// last tap stands for what is left of a stride.
constexpr int most_taps_of_a_pass = 16;

/// Variance across a streak that drawing it brings by itself, in texels²: the mean over a texel's pixels, linear
/// interpolation between texels, and the shifts to a slanted line's rows and back: |f|(1 − |f|) each, 1/6 on average.
double variance_had(int scale, const std::vector<StreakLine>& lines) {
    const double pixel = 1.0 / (scale * scale);
    const double texels = (1 - pixel) / 12 + (scale == 1 ? 0 : (2 + pixel) / 12);
    double shifts = 0;
    for (const StreakLine& line : lines) {
        if (!line.is_whole()) shifts += 2.0 / 6 / (line.length_of_step() * line.length_of_step());
    }
    return texels + shifts / static_cast<double>(lines.size());
}

GraphTexture add_softened(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture light,
                          const std::vector<float>& taps, const StreakPasses& passes) {
    if (taps.size() == 1) return light;
    const Region lit = graph.shape(light).region;
    AxisBlur blur;
    blur.taps = taps;
    blur.full_float = passes.full_float;
    blur.needs = passes.needs;
    const int radius = static_cast<int>(blur.taps.size()) - 1;
    blur.name = "glare/soften across";
    blur.region = lit.grown(radius).intersected({passes.bounds.x, lit.y, passes.bounds.width, lit.height});
    const GraphTexture across = add_axis_blur(graph, shaders, light, blur);
    blur.name = "glare/soften down";
    blur.axis = BlurAxis::down;
    blur.region = lit.grown(radius).intersected(passes.bounds);
    return add_axis_blur(graph, shaders, across, blur);
}

/// `streaks` from the line's rows, and what earlier lines came to.
GraphTexture add_gathered(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture streaks, GraphTexture earlier,
                          const StreakLine& line, const StreakPasses& passes) {
    if (!earlier && line.is_whole()) return streaks;
    const GraphShape shape = graph.shape(streaks);
    GraphPass pass;
    pass.name = passes.name + " gather";
    pass.reads = {{streaks, 1}};
    Region region = shape.region.grown(line.is_whole() ? 0 : 1).intersected(passes.bounds);
    ShaderDefines defines{{"MAJOR", line.is_steep ? "y" : "x"}, {"MINOR", line.is_steep ? "x" : "y"}};
    if (line.is_whole()) defines["WHOLE"] = "1";
    if (earlier) {
        defines["EARLIER"] = "1";
        pass.reads.push_back({earlier});
        region = region.united(graph.shape(earlier).region);
    }
    // Where many lines are added up, half floats would lose a little with each.
    pass.writes = {earlier ? GLenum{GL_RGBA32F} : shape.format};
    pass.scale = shape.scale;
    pass.region = region;
    pass.beyond_frame = true;
    pass.needs = passes.needs;
    Program& program = shaders.full_screen("effects/streaks/gather.frag", defines);
    pass.draw = [&program, streaks, earlier, slope = line.slope](PassRun& run) {
        program.use();
        run.bind(program, "streaks", 0, streaks);
        if (earlier) run.bind(program, "earlier", 1, earlier);
        program.set("slope", slope);
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

GraphTexture add_classic_streaks(RenderGraph& graph, ShaderLibrary& shaders, GraphTexture bright_light,
                                 const GlareSettings& settings, const StreakKnobs& knobs, const GpuCondition& bright) {
    const SqueezePass squeeze{.name = "glare/squeeze", .full_float = knobs.full_float, .needs = &bright};
    SqueezedSquare square = add_squeezed(graph, shaders, bright_light, classic_streak_size, squeeze);
    StreakPasses passes{.taps = StreakTaps::of_passes(settings.passes, settings.attenuation),
                        .bounds = square.bounds(),
                        .weight = settings.strength / 4,
                        .full_float = knobs.full_float,
                        .needs = &bright,
                        .name = {}};
    GraphTexture sum;
    for (const double slope : {-1.0, 1.0}) {
        const StreakLine diagonal{.is_steep = false, .slope = slope, .forward = true, .backward = true};
        passes.name = fmt::format("glare/diagonal {}", slope < 0 ? 1 : 2);
        const GraphTexture streaks = add_streaks_along(graph, shaders, square.texture, diagonal, passes);
        sum = add_gathered(graph, shaders, streaks, sum, diagonal, passes);
    }
    square.texture = sum;
    return add_magnified(graph, shaders, {square}, 1,
                         {.name = "glare/magnify", .full_float = knobs.full_float, .needs = &bright});
}

}  // namespace

void StreakKnobs::check() const {
    if (largest_scale < 1 || largest_scale > 64 || !std::has_single_bit(static_cast<unsigned>(largest_scale))) {
        throw std::invalid_argument(fmt::format("streaks' largest_scale is {}, not 1, 2, 4, … 64", largest_scale));
    }
    if (!(sigma_texels >= 0.125 && sigma_texels <= 16)) {
        throw std::invalid_argument(fmt::format("streaks' sigma_texels is {}, not from 0.125 to 16", sigma_texels));
    }
    if (!(cut_sigmas >= 1 && cut_sigmas <= 8)) {
        throw std::invalid_argument(fmt::format("streaks' cut_sigmas is {}, not from 1 to 8", cut_sigmas));
    }
}

StreakKnobs streak_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.sigma_texels = 0.125};
        case QualityLevel::preview:
            return {.sigma_texels = 0.25};
        case QualityLevel::reference:
            return {.sigma_texels = 2, .cut_sigmas = 5, .full_float = true};
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_streaks(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                         const GlareSettings& settings, const StreakKnobs& knobs, const StreakSource& source,
                         GpuCondition& bright) {
    knobs.check();
    if (settings.strength == 0 || (source.share == BrightShare::objects && source.object_strength == 0)) {
        graph.leave_out("glare", "its strength is 0");
        return {};
    }
    const bool is_classic = settings.level == GlareLevel::classic;
    const Region frame = graph.frame();
    const StreakShape shape = streak_shape(settings, frame.height);
    int scale = 1;
    if (is_classic) {
        // At least two by two of these to a texel of the square.
        while (std::min(frame.width, frame.height) >= 4 * scale * classic_streak_size) scale *= 2;
    } else {
        while (scale < knobs.largest_scale && shape.sigma_px >= knobs.sigma_texels * scale * 2) scale *= 2;
    }
    BrightPassSettings drawn_out = streak_light(settings, source.share, source.object_strength);
    drawn_out.full_float = knobs.full_float;
    const GraphTexture bright_light = add_bright_pass(graph, shaders, light, drawn_out, scale, bright);
    if (!bright_light) return {};
    if (is_classic) return add_classic_streaks(graph, shaders, bright_light, settings, knobs, bright);

    const std::vector<StreakLine> lines = streak_lines(streak_angles(settings));
    const double wanted = shape.sigma_px * shape.sigma_px / (scale * scale) - variance_had(scale, lines);
    const std::vector<float> taps = gaussian_taps(std::max(wanted, 0.0), knobs.cut_sigmas);
    // Light softened over the frame's edge streaks back into it; and who magnifies interpolates a texel beyond.
    StreakPasses passes{.taps = {},
                        .bounds = graph.frame(scale).grown(static_cast<int>(taps.size())),
                        .weight = settings.strength / settings.directions,
                        .full_float = knobs.full_float,
                        .needs = &bright,
                        .name = {}};
    const GraphTexture softened = add_softened(graph, shaders, bright_light, taps, passes);
    GraphTexture sum;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double texel_px = scale * lines[i].length_of_step();
        const double attenuation = std::pow(shape.attenuation, texel_px / shape.step_px);
        // Tap i stands for what lies from i − ½ to i + ½.
        passes.taps = StreakTaps::of_length(shape.length_px / texel_px + 0.5, attenuation, most_taps_of_a_pass);
        passes.source_too_much = StreakTaps::source_too_much(attenuation);
        passes.name = fmt::format("glare/streaks {}", i + 1);
        const GraphTexture streaks = add_streaks_along(graph, shaders, softened, lines[i], passes);
        sum = add_gathered(graph, shaders, streaks, sum, lines[i], passes);
    }
    return sum;
}

}  // namespace matchlight
