// Runs one camera effect on a frame's light, apart from the frame: for measuring.
#pragma once

#include <functional>
#include <vector>

#include "core/image.h"
#include "gl/condition.h"
#include "gl/objects.h"
#include "render/frame_light.h"

namespace matchlight {

/// Light on the CPU as an effect meets it, over `region` of a frame.
struct FrameLightImages {
    ImageF after;   // RGBA: with the objects; a is the share that they send
    ImageF before;  // RGB: without; empty where all light is virtual
    Region region;
    int frame_width = 0, frame_height = 0;
};

/// Adds an effect's passes; `bright` is the condition that they are drawn under.
using AddEffect = std::function<GraphTexture(RenderGraph& graph, const FrameLight& light, GpuCondition& bright)>;

class EffectStage {
public:
    explicit EffectStage(const FrameLightImages& light);

    struct Options {
        bool timed = false;      // each pass, for reports()
        bool leaves_out = true;  // false: draws what the condition would leave out
    };
    void draw(const AddEffect& add, const Options& options);
    void draw(const AddEffect& add) { draw(add, Options()); }

    /// What the effect last drawn adds, RGB over the whole frame, bilinear between its texels as the compositor reads
    /// it; empty where it was left out for good (no texture).
    ImageF added() const;
    /// Sum over the texels of the effect last drawn times the frame pixels that each stands for, mean of channels.
    double energy() const;
    /// Whether the effect found anything to do.
    bool found() const { return bright_.is_met(); }
    std::vector<PassReport> reports() const { return graph_.reports(); }
    /// Moved by the passes that were drawn.
    double bytes() const;

private:
    ImageF texels() const;

    Region region_;
    int frame_width_, frame_height_;
    Texture2D after_, before_;
    RenderGraph graph_;
    GpuCondition bright_{"no light above the threshold"};
    GraphTexture made_;
};

}  // namespace matchlight
