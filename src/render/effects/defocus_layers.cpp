// Slice by slice, from the farthest: cut out, blur, put before the rest.
#include "render/effects/defocus_layers.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/defocus_circles.h"
#include "render/effects/defocus_taps.h"

namespace matchlight {

namespace {

constexpr int tile_texels = 8;  // as wide as the circles of `final`: nine tiles tell what one can reach

class Slices {
public:
    Slices(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input, const LayersKnobs& knobs)
        : graph_(graph),
          shaders_(shaders),
          input_(input),
          knobs_(knobs),
          circles_(add_circles(graph, shaders, input)) {}

    GraphTexture add() {
        GraphTexture behind;
        for (const DefocusSlice& slice :
             defocus_slices(input_.range.nearest_px, input_.range.farthest_px, knobs_.slices)) {
            behind = add_slice_over(graph_, shaders_,
                                    {.before = add_blurred(slice),
                                     .behind = behind,
                                     .region_of = input_.light,
                                     .disjoint = knobs_.disjoint});
        }
        return behind;
    }

private:
    GraphTexture add_blurred(const DefocusSlice& slice) {
        const double radius_px = std::abs(slice.circle_px) / 2;
        // No coarser than the frame, which a circle may be wider than.
        const int largest_scale = std::max(graph_.frame().width, graph_.frame().height);
        int scale = 1;
        while (scale < largest_scale && radius_px > knobs_.radius_texels * scale) scale *= 2;
        const GraphTexture cut = add_cut(slice, scale);
        if (radius_px == 0) return cut;
        double radius = radius_px / scale;
        // The mean over a texel and the way back to pixels have a variance of a quarter texel², as 1 texel of radius
        // has.
        if (scale > 1) radius = std::sqrt(radius * radius - 1);
        // What is wider than the frame is flat.
        const double widest = std::hypot(graph_.frame(scale).width, graph_.frame(scale).height);
        return add_disc(cut, bokeh_taps(input_.bokeh, std::min(radius, widest), slice.circle_px < 0));
    }

    GraphTexture add_cut(const DefocusSlice& slice, int scale) {
        Program& program = shaders_.full_screen("effects/depth_of_field/slice.frag");
        GraphPass pass = new_pass("slice", scale);
        pass.reads = {{input_.light}, {circles_}};
        pass.draw = [&program, light = input_.light, circles = circles_, slice](PassRun& run) {
            program.use();
            run.bind(program, "light", 0, light);
            run.bind(program, "circles", 1, circles);
            program.set("slice", Eigen::Vector2f(static_cast<float>(slice.from_px), static_cast<float>(slice.to_px)));
            program.set("target_scale", run.scale());
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    GraphTexture add_tiles(GraphTexture slice) {
        Program& program = shaders_.full_screen("effects/depth_of_field/slice_tiles.frag");
        GraphPass pass = new_pass("slice tiles", graph_.shape(slice).scale * tile_texels);
        pass.reads = {{slice}};
        pass.writes = {GL_R8};
        pass.draw = [&program, slice](PassRun& run) {
            program.use();
            run.bind(program, "slice", 0, slice);
            program.set("tile", tile_texels);
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    GraphTexture add_disc(GraphTexture slice, const std::vector<DefocusTap>& taps) {
        Program& program = shaders_.full_screen("effects/depth_of_field/slice_blur.frag");
        const auto buffer = std::make_shared<Buffer>(std::span<const DefocusTap>(taps));
        int reach = 0;
        for (const DefocusTap& tap : taps) reach = std::max({reach, std::abs(tap.x), std::abs(tap.y)});
        const GraphTexture tiles = add_tiles(slice);
        GraphPass pass = new_pass("slice blurred", graph_.shape(slice).scale);
        pass.reads = {{slice}, {tiles}};
        pass.draw = [&program, slice, tiles, buffer, reach, count = taps.size()](PassRun& run) {
            program.use();
            run.bind(program, "slice", 0, slice);
            run.bind(program, "tiles", 1, tiles);
            program.set("tile", tile_texels);
            program.set("reach_tiles", (reach + tile_texels - 1) / tile_texels);
            buffer->bind(GL_SHADER_STORAGE_BUFFER, 0);
            program.set("tap_count", static_cast<int>(count));
            run.draw(program);
        };
        return graph_.add_pass(std::move(pass)).front();
    }

    GraphPass new_pass(const char* name, int scale) const {
        GraphPass pass;
        pass.name = fmt::format("depth of field/{}", name);
        pass.writes = {GL_RGBA32F};
        pass.scale = scale;
        pass.region = scale == 1 ? graph_.shape(input_.light).region : graph_.reached({input_.light}, scale);
        return pass;
    }

    RenderGraph& graph_;
    ShaderLibrary& shaders_;
    const DefocusInput& input_;
    const LayersKnobs& knobs_;
    GraphTexture circles_;
};

}  // namespace

void LayersKnobs::check() const {
    if (slices < 1 || slices > 1024)
        throw std::invalid_argument(fmt::format("slices is {}, not from 1 to 1024", slices));
    if (!(radius_texels >= 2 && radius_texels <= 16384))
        throw std::invalid_argument(fmt::format("radius_texels is {}, not from 2 to 16384", radius_texels));
}

LayersKnobs layers_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.slices = 4, .radius_texels = 4};
        case QualityLevel::preview:
            return {.slices = 8, .radius_texels = 6};
        case QualityLevel::reference:
            return {.slices = 32, .radius_texels = 32};
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_layers_defocus(RenderGraph& graph, ShaderLibrary& shaders, const DefocusInput& input,
                                const LayersKnobs& knobs) {
    knobs.check();
    return Slices(graph, shaders, input, knobs).add();
}

GraphTexture add_slice_over(RenderGraph& graph, ShaderLibrary& shaders, const SliceOver& slices) {
    return graph.add_pass({.name = "depth of field/slice over",
                           .reads = {{slices.before}, {slices.behind}},
                           .writes = {GL_RGBA32F},
                           .region = graph.shape(slices.region_of).region,
                           .draw = [&shaders, slices](PassRun& run) {
                               Program& program = shaders.full_screen("effects/depth_of_field/slice_over.frag");
                               program.use();
                               run.bind(program, "slice", 0, slices.before);
                               run.bind(program, "behind", 1, slices.behind);
                               program.set("disjoint", slices.disjoint);
                               run.draw(program);
                           }})[0];
}

}  // namespace matchlight
