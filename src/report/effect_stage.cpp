// A graph of one effect.
#include "report/effect_stage.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace matchlight {
namespace {

Texture2D uploaded(const ImageF& image, GLenum format) {
    if (image.empty()) return {};
    Texture2D texture({.format = format, .width = image.width(), .height = image.height()});
    texture.upload(image);
    return texture;
}

}  // namespace

EffectStage::EffectStage(const FrameLightImages& light)
    : region_(light.region),
      frame_width_(light.frame_width),
      frame_height_(light.frame_height),
      after_(uploaded(light.after, GL_RGBA32F)),
      before_(uploaded(light.before, GL_RGB32F)) {}

void EffectStage::draw(const AddEffect& add, const Options& options) {
    graph_.set_leaves_out(options.leaves_out);
    graph_.begin_frame(frame_width_, frame_height_);
    FrameLight light;
    if (after_) light.after = graph_.import(&after_, {GL_RGBA32F, region_, 1});
    if (before_) light.before = graph_.import(&before_, {GL_RGB32F, region_, 1});
    bright_.set(false);
    made_ = add(graph_, light, bright_);
    graph_.output(made_);
    graph_.run(options.timed);
}

ImageF EffectStage::texels() const {
    const GraphShape& shape = graph_.shape(made_);
    return graph_.texture(made_).read<float>({0, 0, shape.region.width, shape.region.height}, 3);
}

ImageF EffectStage::added() const {
    if (!made_) return {};
    ImageF full(frame_width_, frame_height_, 3);
    if (!found()) return full;
    const GraphShape shape = graph_.shape(made_);
    const ImageF light = texels();
    const auto texel = [&](int x, int y, int c) {
        x -= shape.region.x;
        y -= shape.region.y;
        return light.bounds().contains(x, y) ? static_cast<double>(light.at(x, y, c)) : 0.0;
    };
    // As linear_in_frame of common/graph.glsl: bilinear between texel centres, and on to the frame's edge.
    const Region frame = graph_.frame(shape.scale);
    const Region all = frame.united(shape.region);
    parallel_for(frame_height_, [&](int y) {
        for (int x = 0; x < frame_width_; ++x) {
            const double u = std::clamp<double>((x + 0.5) / shape.scale - 0.5, all.x, all.x + all.width - 1);
            const double v = std::clamp<double>((y + 0.5) / shape.scale - 0.5, all.y, all.y + all.height - 1);
            const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
            for (int c = 0; c < 3; ++c) {
                const double above = std::lerp(texel(left, top, c), texel(left + 1, top, c), u - left);
                const double below = std::lerp(texel(left, top + 1, c), texel(left + 1, top + 1, c), u - left);
                full.at(x, y, c) = static_cast<float>(std::lerp(above, below, v - top));
            }
        }
    });
    return full;
}

double EffectStage::energy() const {
    if (!made_ || !found()) return 0;
    const ImageF light = texels();
    double sum = 0;
    for (int y = 0; y < light.height(); ++y) {
        double row = 0;
        for (const float value : light.row(y)) row += value;
        sum += row;
    }
    const int scale = graph_.shape(made_).scale;
    return sum / 3 * scale * scale;
}

double EffectStage::bytes() const {
    double bytes = 0;
    for (const PassReport& report : graph_.reports()) bytes += report.drawn ? report.bytes : 0;
    return bytes;
}

}  // namespace matchlight
