// A plate of noise through the composite passes, as the tests of composition need it.
#pragma once

#include <cmath>

#include "core/image.h"
#include "render/composite_pass.h"

namespace matchlight::test {

struct NoiseComposition {
    const ContactShadow* shadow = nullptr;
    bool through_light = false;       // by the light and response passes, as with effects; else code values at once
    std::optional<float> spill = {};  // plate-linear light spilled everywhere
};

/// Code values and the touched flag, 64 × 64, seen by a pinhole that looks straight down from 1 m.
inline ImageF composite_noise(ShaderLibrary& shaders, const NoiseComposition& how) {
    constexpr int size = 64;
    ImageF nodes(18, 18, 2);
    for (int j = 0; j < 18; ++j) {
        for (int i = 0; i < 18; ++i) {
            nodes.at(i, j, 0) = static_cast<float>(((i - 1) * 4 - 31.5) / 100);
            nodes.at(i, j, 1) = static_cast<float>(((j - 1) * 4 - 31.5) / 100);
        }
    }
    ImageF response(4081, 3, 1);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i <= 4080; ++i) response.at(i, c) = std::pow(static_cast<float>(i) / 4080, 2.2F);
    }
    CompositePass pass(shaders, nodes, 4, response);
    ImageF plate(size, size, 3);
    float value = 0.1F;
    for (float& sample : plate.samples()) {
        value = std::fmod(value * 7.13F + 0.37F, 1.0F);
        sample = value;
    }
    RenderGraph graph;
    graph.begin_frame(size, size);
    CompositeInput input;
    input.plate_code = &plate;
    input.region = {0, 0, size, size};
    input.runs = {input.region};
    input.shadow = how.shadow;
    input.least_visible_loss = 0.002;
    input.light = how.through_light;
    input.optics.camera_from_world.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    input.optics.camera_from_world.translation() = Eigen::Vector3d(0, 0, 1);
    input.optics.frame_width = input.optics.frame_height = size;
    const CompositePicture picture = pass.add(graph, input);
    GraphTexture code = picture.code;
    Texture2D spilled({.format = GL_RGBA16F, .width = size / 2, .height = size / 2});
    if (how.through_light) {
        ResponseInput to_code;
        to_code.plate = picture.plate;
        to_code.region = input.region;
        to_code.runs = input.runs;
        to_code.light = picture.light;
        to_code.least_visible_code = 0.5 / 255;
        if (how.spill) {
            spilled.clear(*how.spill, *how.spill, *how.spill, 0);
            to_code.spill = graph.import(&spilled, {GL_RGBA16F, {0, 0, size / 2, size / 2}, 2});
        }
        code = pass.add_response(graph, to_code).code;
    }
    graph.output(code);
    graph.run();
    return read_runs(graph.texture(code), input.region, input.runs, 4);
}

}  // namespace matchlight::test
