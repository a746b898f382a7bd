// The pyramid down, then the lookup.
#include "render/effects/defocus_mipmap.h"

#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/defocus_circles.h"
#include "render/effects/defocus_taps.h"

namespace matchlight {

namespace {

struct Level {
    GraphTexture light, shares;
};

/// Texels of the next level that the texels of `region` send light to by [1 3 3 1].
Region reduced(const Region& region) {
    const int left = (region.x - 1) >> 1, top = (region.y - 1) >> 1;  // rounds down below 0 too
    return {left, top, ((region.x + region.width) >> 1) + 1 - left, ((region.y + region.height) >> 1) + 1 - top};
}

Level add_reduction(RenderGraph& graph, ShaderLibrary& shaders, const Level& finer, int level) {
    ShaderDefines defines;
    if (level == 1) defines["FROM_PIXELS"] = "1";
    Program& program = shaders.full_screen("effects/depth_of_field/mip_reduce.frag", defines);
    GraphPass pass;
    pass.name = fmt::format("depth of field/level {}", level);
    pass.reads = {{finer.light, 1}, {finer.shares, 1}};
    pass.writes = {GL_RGBA32F, GL_RGBA32F};
    pass.scale = 1 << level;
    pass.region = reduced(graph.shape(finer.light).region);
    pass.beyond_frame = true;  // what a step carries over the frame's edge comes back with the lookup
    pass.draw = [&program, finer, level](PassRun& run) {
        program.use();
        run.bind(program, "light", 0, finer.light);
        run.bind(program, "shares", 1, finer.shares);
        program.set("full_circle_px", full_circle_of_level_px(level));
        run.draw(program);
    };
    const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
    return {written[0], written[1]};
}

}  // namespace

void MipmapKnobs::check() const {
    if (levels < 1 || levels > 7) throw std::invalid_argument(fmt::format("levels is {}, not from 1 to 7", levels));
}

MipmapKnobs mipmap_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.levels = 4};
        case QualityLevel::preview:
            return {.levels = 5};
        case QualityLevel::final_:
        case QualityLevel::reference:
            break;
    }
    return {};
}

GraphTexture add_mipmap_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                const MipmapKnobs& knobs) {
    knobs.check();
    int count = 1;
    while (count < knobs.levels && circle_of_level_px(count) < input.range.widest_px()) ++count;
    const GraphTexture circles = add_circles(graph, shaders, input);
    std::vector<Level> levels{{input.light, circles}};
    for (int level = 1; level <= count; ++level) {
        levels.push_back(add_reduction(graph, shaders, levels.back(), level));
    }
    Program& program =
        shaders.full_screen("effects/depth_of_field/mip_lookup.frag", {{"LEVELS", std::to_string(count)}});
    GraphPass pass;
    pass.name = "depth of field/lookup";
    for (const Level& level : levels) {
        pass.reads.push_back({level.light});
        pass.reads.push_back({level.shares});
    }
    pass.writes = {GL_RGBA32F};
    pass.region = graph.shape(input.light).region;
    pass.draw = [&program, levels](PassRun& run) {
        program.use();
        run.bind(program, "light", 0, levels.front().light);
        run.bind(program, "circles", 1, levels.front().shares);
        for (std::size_t i = 1; i < levels.size(); ++i) {
            const auto unit = static_cast<GLuint>(2 * i);
            program.bind_texture(fmt::format("weighted[{}]", i - 1), unit, run.texture(levels[i].light));
            program.bind_texture(fmt::format("shares[{}]", i - 1), unit + 1, run.texture(levels[i].shares));
            const Region& region = run.shape(levels[i].light).region;
            program.set(fmt::format("level_region[{}]", i - 1),
                        Eigen::Vector4i(region.x, region.y, region.width, region.height));
        }
        program.set("least_coc_px", least_coc_px);
        program.set("least_full_px", full_circle_of_level_px(1));
        run.draw(program);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
