// White noise from a hash, smoothed across and down.
#include "render/effects/grain.h"

#include <algorithm>
#include <vector>

#include "render/effects/gaussian_blur.h"

namespace matchlight {

GrainNoise::GrainNoise(ShaderLibrary& shaders)
    : shaders_(shaders), quantiles_({.format = GL_R32F, .width = 1 << grain_quantile_bits, .height = 1}) {
    ImageF values(1 << grain_quantile_bits, 1, 1);
    std::ranges::copy(grain_quantiles(), values.row(0).begin());
    quantiles_.upload(values);
}

GraphTexture GrainNoise::add(RenderGraph& graph, const GrainModel& model, const Region& region) {
    const std::vector<float> taps = grain_taps(model.correlation_px);
    const int radius = static_cast<int>(taps.size()) - 1;
    const Region beside{region.x - radius, region.y, region.width + 2 * radius, region.height};
    const Region around{beside.x, region.y - radius, beside.width, region.height + 2 * radius};
    const GraphTexture white = graph.add_pass({.name = "grain/white",
                                               .writes = {GL_RGBA32F},
                                               .region = around,
                                               .beyond_frame = true,
                                               .draw = [this, model](PassRun& run) {
                                                   Program& program = shaders_.full_screen("effects/grain/white.frag");
                                                   program.use();
                                                   program.bind_texture("quantiles", 0, quantiles_);
                                                   program.set("quantile_bits", grain_quantile_bits);
                                                   program.set("frame", model.frame);
                                                   program.set("seed", model.seed);
                                                   run.draw(program);
                                               }})[0];
    if (radius == 0) return white;
    const GraphTexture across = add_axis_blur(graph, shaders_, white,
                                              {.name = "grain/across",
                                               .axis = BlurAxis::across,
                                               .taps = taps,
                                               .region = {region.x, around.y, region.width, around.height},
                                               .full_float = true});
    return add_axis_blur(
        graph, shaders_, across,
        {.name = "grain/down", .axis = BlurAxis::down, .taps = taps, .region = region, .full_float = true});
}

void set_grain(const PassRun& run, Program& program, GLuint unit, const FrameGrain& grain) {
    run.bind(program, "grain_noise", unit, grain.noise);
    const GrainModel& model = grain.model;
    program.set("grain_read2", model.read * model.read);
    program.set("grain_shot", model.shot);
    program.set("grain_strength", model.strength);
    program.set("grain_brightest", model.brightest);
    program.set("grain_least_deviation", grain.least_deviation);
}

}  // namespace matchlight
