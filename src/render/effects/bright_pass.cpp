// Chooses the shader's variant and its region.
#include "render/effects/bright_pass.h"

#include <cassert>

#include <fmt/format.h>

namespace matchlight {

GraphTexture add_bright_pass(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                             const BrightPassSettings& settings, int scale, GpuCondition& bright) {
    assert(scale >= 1 && (!light.after || graph.shape(light.after).scale == 1));
    assert(!settings.firefly_safe || firefly_block_px % scale == 0 || scale % firefly_block_px == 0);
    static constexpr const char* names[] = {"bright pass", "bright pass (objects)", "bright pass (rest)"};
    const std::string name = names[static_cast<int>(settings.share)];
    if (!light.after) {
        graph.leave_out(name, "nothing virtual is seen");
        return {};
    }
    const bool takes_away = light.before && settings.share != BrightShare::objects;
    ShaderDefines defines{{"SCALE", std::to_string(scale)}};
    if (takes_away) defines["TAKES_AWAY"] = "1";
    if (settings.firefly_safe) {
        defines["FIREFLY_LIMIT"] = fmt::format("{:.1f}", firefly_limit_plate_linear);
        defines["BLOCK"] = std::to_string(firefly_block_px);
    }
    Program& program = shaders.full_screen("effects/bright_pass/bright_pass.frag", defines);
    GraphPass pass;
    pass.name = name;
    pass.reads = {{light.after}};
    if (takes_away) pass.reads.push_back({light.before});
    pass.writes = {settings.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
    pass.scale = scale;
    // Outside of `after` nothing was added or taken away, whatever `before` holds there.
    pass.region = graph.reached({light.after}, scale);
    pass.sets = &bright;
    pass.draw = [&program, light, settings, takes_away](PassRun& run) {
        program.use();
        run.target().clear_color(0, 0, 0, 0, 0);
        run.bind(program, "after", 0, light.after);
        if (takes_away) run.bind(program, "before", 1, light.before);
        program.set("threshold", settings.threshold);
        program.set("knee_half_width", settings.knee * settings.threshold);
        // The share of `after` that counts is share.x + a · share.y.
        const auto strength = static_cast<float>(settings.object_strength);
        const Eigen::Vector2f share = settings.share == BrightShare::all    ? Eigen::Vector2f(1, strength - 1)
                                      : settings.share == BrightShare::rest ? Eigen::Vector2f(1, -1)
                                                                            : Eigen::Vector2f(0, strength);
        program.set("share", share);
        program.set("measure_luminance", settings.measure == BrightMeasure::luminance ? 1.F : 0.F);
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
