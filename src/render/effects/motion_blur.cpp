// Ways on plate pixels, the fastest of every tile, those that reach it, and the gather.
#include "render/effects/motion_blur.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace matchlight {

namespace {

/// Side of a tile: small enough that neighbours of a turning body still move alike, large enough that looking at every
/// tile around costs less than one tap a pixel, and that a shader may look at all of a region's (llvmpipe ends loops
/// after 65,535 rounds).
int tile_side_px(const Region& region) {
    constexpr std::int64_t most_tiles = 60'000;
    int side = 16;
    while ((static_cast<std::int64_t>(region.width) / side + 2) * (region.height / side + 2) > most_tiles) side *= 2;
    return side;
}

constexpr GLuint first_blur_unit = 10;  // after those that CompositePass::set_layer takes

}  // namespace

MotionBlurKnobs motion_blur_knobs(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.most_taps = 8};
        case QualityLevel::preview:
            return {.most_taps = 16};
        case QualityLevel::reference:
            return {.most_taps = 1 << 20};
        case QualityLevel::final_:
            break;
    }
    return {};
}

GraphTexture add_plate_ways(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                            const CompositeInput& input, const Region& region) {
    return graph.add_pass({.name = "motion_blur/ways",
                           .reads = {{input.layer_drawn}},
                           .writes = {GL_RGBA32F},
                           .region = region,
                           .draw = [&shaders, &composite, input](PassRun& run) {
                               Program& program = shaders.full_screen("effects/motion_blur/plate_ways.frag");
                               program.use();
                               composite.set_layer(program, input);
                               const bool drawn = input.layer != nullptr && input.layer->ways != nullptr;
                               program.set("ways_present", drawn);
                               if (drawn) program.bind_texture("layer_ways", first_blur_unit, *input.layer->ways);
                               program.set("least_motion_px", least_motion_px);
                               run.draw(program);
                           }})[0];
}

GraphTexture add_motion_blur(RenderGraph& graph, ShaderLibrary& shaders, const MotionBlurInput& input,
                             const MotionBlurKnobs& knobs) {
    if (!input.light || !input.ways) return input.light;
    const int tile_px = tile_side_px(graph.shape(input.ways).region);
    const GraphTexture tiles = graph.add_pass({.name = "motion_blur/tiles",
                                               .reads = {{input.ways}},
                                               .writes = {GL_RG32F},
                                               .scale = tile_px,
                                               .draw = [&shaders, tile_px, input](PassRun& run) {
                                                   Program& program =
                                                       shaders.full_screen("effects/motion_blur/tiles.frag");
                                                   program.use();
                                                   run.bind(program, "ways", 0, input.ways);
                                                   program.set("tile_px", tile_px);
                                                   run.draw(program);
                                               }})[0];
    const Region& all_tiles = graph.shape(tiles).region;
    const double reach_tiles = std::ceil((input.way_px / 2 + input.soft_px) / tile_px) + 1;
    const int reach = static_cast<int>(std::min<double>(reach_tiles, std::max(all_tiles.width, all_tiles.height)));
    const GraphTexture dominant = graph.add_pass({.name = "motion_blur/dominant",
                                                  .reads = {{tiles, reach}},
                                                  .writes = {GL_RG32F},
                                                  .scale = tile_px,
                                                  .draw = [&shaders, tiles, reach, tile_px, input](PassRun& run) {
                                                      Program& program =
                                                          shaders.full_screen("effects/motion_blur/dominant.frag");
                                                      program.use();
                                                      run.bind(program, "tiles", 0, tiles);
                                                      program.set("reach", reach);
                                                      program.set("tile_px", tile_px);
                                                      program.set("soft_px", input.soft_px);
                                                      run.draw(program);
                                                  }})[0];
    return graph.add_pass({.name = "motion_blur/gather",
                           .reads = {{input.light}, {input.ways}, {dominant}},
                           .writes = {GL_RGBA32F},
                           .region = graph.shape(input.light).region,
                           .draw = [&shaders, input, dominant, tile_px, knobs](PassRun& run) {
                               Program& program = shaders.full_screen("effects/motion_blur/gather.frag");
                               program.use();
                               run.bind(program, "light", 0, input.light);
                               run.bind(program, "ways", 1, input.ways);
                               run.bind(program, "dominant", 2, dominant);
                               program.set("tile_px", tile_px);
                               program.set("most_taps", knobs.most_taps);
                               run.draw(program);
                           }})[0];
}

GraphTexture add_shadow_motion_blur(RenderGraph& graph, ShaderLibrary& shaders, const CompositePass& composite,
                                    const ShadowMotionInput& shadow, const MotionBlurKnobs& knobs) {
    const CompositeInput& input = shadow.input;
    return graph.add_pass(
        {.name = "motion_blur/shadow",
         .reads = {{shadow.ratio}},
         .writes = {GL_RGBA32F},
         .region = shadow.region,
         .draw = [&shaders, &composite, input, shadow, knobs](PassRun& run) {
             Program& program = shaders.full_screen("effects/motion_blur/shadow.frag");
             program.use();
             composite.set_layer(program, input);
             run.bind(program, "ratio", first_blur_unit, shadow.ratio);
             const RigidTransform world_from_camera = input.optics.camera_from_world.inverse();
             program.set("world_from_camera", Eigen::Matrix3f(world_from_camera.linear().cast<float>()));
             program.set("eye_world_m", Eigen::Vector3f(world_from_camera.translation().cast<float>()));
             program.set("surface_z_m", input.shadow->surface_z_m);
             program.set("opening_camera_from_world",
                         Eigen::Matrix4f(shadow.ends.opening_camera_from_world.matrix().cast<float>()));
             program.set("closing_camera_from_world",
                         Eigen::Matrix4f(shadow.ends.closing_camera_from_world.matrix().cast<float>()));
             program.set("least_motion_px", least_motion_px);
             program.set("longest_way_px", shadow.way_px);
             program.set("least_visible_loss", input.least_visible_loss);
             program.set("most_taps", knobs.most_taps);
             run.draw(program);
         }})[0];
}

}  // namespace matchlight
