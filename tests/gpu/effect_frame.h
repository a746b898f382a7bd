// A frame's light made up on the CPU, and what an effect makes of it.
#pragma once

#include <functional>

#include "gl/shader_library.h"
#include "render/frame_light.h"
#include "report/bright_reference.h"

namespace matchlight::test {

/// Light with objects (RGBA) and without (RGB, may be empty); `region` is the part of a frame that it covers.
struct LightOnCpu {
    ImageF after, before;
    Region frame;
    int left = 0, top = 0;

    LightOnCpu(int width, int height) : after(width, height, 4), frame(after.bounds()) {}

    void set(int x, int y, float value, float coverage = 1) {
        for (int c = 0; c < 3; ++c) after.at(x, y, c) = value;
        after.at(x, y, 3) = coverage;
    }
};

using AddEffect = std::function<GraphTexture(RenderGraph&, const FrameLight&, GpuCondition&)>;

struct EffectResult {
    bool is_empty = true;  // no texture came
    bool met = false;      // the condition
    GraphShape shape;
    ImageD light;  // RGB texels over shape.region
    std::vector<PassReport> reports;

    /// Over the frame: texels times the pixels that each stands for.
    double sum(int channel = 0) const {
        double total = 0;
        for (int y = 0; y < light.height(); ++y) {
            for (int x = 0; x < light.width(); ++x) total += light.at(x, y, channel);
        }
        return total * shape.scale * shape.scale;
    }
    /// As a compositor reads it: bilinear between texel centres.
    ImageD at_full_size(const Region& frame) const {
        ImageD full(frame.width, frame.height, 3);
        const auto texel = [&](int x, int y, int c) {
            x -= shape.region.x;
            y -= shape.region.y;
            return light.bounds().contains(x, y) ? light.at(x, y, c) : 0.0;
        };
        for (int y = 0; y < frame.height; ++y) {
            for (int x = 0; x < frame.width; ++x) {
                const double u = (x + 0.5) / shape.scale - 0.5, v = (y + 0.5) / shape.scale - 0.5;
                const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
                for (int c = 0; c < 3; ++c) {
                    const double above = texel(left, top, c) * (1 - (u - left)) + texel(left + 1, top, c) * (u - left);
                    const double below =
                        texel(left, top + 1, c) * (1 - (u - left)) + texel(left + 1, top + 1, c) * (u - left);
                    full.at(x, y, c) = above * (1 - (v - top)) + below * (v - top);
                }
            }
        }
        return full;
    }
};

/// Runs an effect on a frame of its own graph.
inline EffectResult run_effect(const LightOnCpu& on_cpu, const AddEffect& add) {
    const auto upload = [](const ImageF& image) {
        Texture2D texture(TextureShape{.format = GL_RGBA32F, .width = image.width(), .height = image.height()});
        texture.upload(image);
        return texture;
    };
    const Region region{on_cpu.left, on_cpu.top, on_cpu.after.width(), on_cpu.after.height()};
    const Texture2D after = upload(on_cpu.after);
    Texture2D before;
    RenderGraph graph;
    graph.begin_frame(on_cpu.frame.width, on_cpu.frame.height);
    FrameLight light{graph.import(&after, {GL_RGBA32F, region, 1}), {}};
    if (!on_cpu.before.empty()) {
        before = upload(on_cpu.before);
        light.before = graph.import(&before, {GL_RGBA32F, region, 1});
    }
    GpuCondition bright("no light above the threshold");
    const GraphTexture made = add(graph, light, bright);
    graph.output(made);
    graph.run();
    EffectResult result;
    result.reports = graph.reports();
    result.met = bright.is_met();
    result.is_empty = !made;
    if (!made) return result;
    result.shape = graph.shape(made);
    const int width = result.shape.region.width, height = result.shape.region.height;
    const ImageF texels = graph.texture(made).read<float>({0, 0, width, height}, 3);
    result.light = ImageD(width, height, 3);
    std::copy(texels.samples().begin(), texels.samples().end(), result.light.samples().begin());
    return result;
}

}  // namespace matchlight::test
