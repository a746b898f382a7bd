// The passes of one frame: what each reads and writes, in which order they run, where, and which are left out.
//
// A pass is added with the textures it reads, and gets textures to write; nothing is drawn until run(). Then the graph
// - keeps the passes that an output needs, and orders them so that each follows what it reads;
// - gives every written texture the region that the light of its inputs can reach, from a pool in which a texture is
//   free again as soon as its last reader is done;
// - lets the GPU skip what a condition found there rules out, and does not ask for the answer;
// - draws what outlives the frame (`once`) a single time.
// After Filament's FrameGraph (Google, 2018): passes declare, the graph culls.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/image.h"
#include "gl/condition.h"
#include "gl/framebuffer.h"
#include "gl/program.h"

namespace matchlight {

/// A texture of this frame, by number; false where the pass that would write it was left out: it reads as zero.
struct GraphTexture {
    int id = -1;
    explicit operator bool() const { return id >= 0; }
};

/// What part of the frame a texture holds. Its texel (0, 0) is `region`'s first; regions count texels of `scale` frame
/// pixels a side, from the frame's corner.
struct GraphShape {
    GLenum format = GL_RGBA16F;
    Region region;
    int scale = 1;

    Region frame_pixels() const {
        return {region.x * scale, region.y * scale, region.width * scale, region.height * scale};
    }
    double bytes() const;
};

/// Something a pass reads. Its light travels up to `reach` texels of what the pass writes.
struct PassInput {
    GraphTexture texture;
    int reach = 0;
};

class PassRun;

struct GraphPass {
    std::string name;  // "bloom/down 2"
    std::vector<PassInput> reads = {};
    std::vector<GLenum> writes = {};          // formats of textures from the pool, all over one region
    std::vector<GraphTexture> provides = {};  // imported textures that it fills by its own means
    int scale = 1;                            // frame pixels along a side of a texel that it writes
    std::optional<Region> region = {};        // in texels of `scale`, instead of what the inputs reach
    bool beyond_frame = false;                // `region` holds as it is, even where it leaves the frame
    GpuCondition* sets = nullptr;             // unmet when the pass begins; its shader may meet it
    const GpuCondition* needs = nullptr;      // drawn only where this is met
    bool once = false;                        // what it provides outlives the frame: drawn the first time only
    std::string once_for = "the clip";        // until when, for reports
    bool raster = true;                       // false: it writes by upload or compute shader, and gets no framebuffer
    double bytes = 0;                         // moved, where the textures it reads and writes do not tell
    std::function<void(PassRun&)> draw = {};
};

/// What became of a pass.
struct PassReport {
    std::string name;
    bool drawn = false;
    std::string why;  // it was left out, or drawn
    Region frame_pixels;
    double ms = 0;       // 0 unless timed
    bool raster = true;  // false: it writes by upload or compute shader, and gets no framebuffer
    double bytes = 0;
    double bandwidth_bounds = 0;  // ms as a multiple of moving the bytes once
};

/// A texture as a pass left it, for a look inside.
struct WatchedTexture {
    std::string pass;
    GraphShape shape;
    ImageF texels;  // of one channel (depth) or four
};

/// Texels of `scale` along a side that hold the pixels of a region; those of nothing are nothing.
Region texels_over(const Region& pixels, int scale);

class RenderGraph {
public:
    RenderGraph();
    ~RenderGraph();

    /// Forgets the last frame's passes; textures stay in the pool.
    void begin_frame(int width, int height);

    /// A texture from elsewhere, which outlives run(); or (`texture` null) what a pass provides by its own means.
    GraphTexture import(const Texture2D* texture, const GraphShape& shape);
    /// Returns one texture for each of `writes`: all empty where the inputs reach nothing.
    std::vector<GraphTexture> add_pass(GraphPass pass);
    /// Notes a pass that this frame is known not to need.
    void leave_out(std::string name, std::string why);
    /// False: conditions on the GPU are met from the start, and whoever adds passes should add those, too, that could
    /// be left out: to measure what that saves, and to prove that it changes nothing.
    void set_leaves_out(bool leaves_out) { leaves_out_ = leaves_out; }
    bool leaves_out() const { return leaves_out_; }
    /// What is wanted of the frame: stays until the next begin_frame().
    void output(GraphTexture texture);

    /// The frame in texels of `scale`.
    Region frame(int scale = 1) const;
    /// The region that light from `input` reaches in texels of `scale`, cut to the frame.
    Region reached(const PassInput& input, int scale) const;
    const GraphShape& shape(GraphTexture texture) const;
    /// Of an output after run(), or of an imported texture.
    const Texture2D& texture(GraphTexture texture) const;

    /// Draws what was not drawn yet: passes may be added, and run, after a first run of the frame. `timed` waits for
    /// the GPU before and after every pass, for reports(). Throws InputError where GL fails.
    void run(bool timed = false);
    /// In the order of drawing, then those left out. Asks the GPU for its conditions: call it after run().
    std::vector<PassReport> reports() const;

    /// From the next run on, what the last pass of that name writes (or has, where it was made before) is read back,
    /// the first of its textures that holds numbers to be seen; "": nothing is.
    void watch(std::string pass) { watched_pass_ = std::move(pass); }
    /// Of the last frame; nullopt where no such pass was drawn.
    const std::optional<WatchedTexture>& watched() const { return watched_; }

    /// Lets `once` passes draw again: what they depend on has changed.
    void forget_kept(const std::string& name);
    void forget_kept() { kept_.clear(); }

private:
    friend class PassRun;
    struct Node;       // a texture of this frame
    struct Scheduled;  // a pass and what became of it
    class TexturePool;

    std::vector<std::size_t> schedule() const;
    void draw_pass(Scheduled& scheduled, bool timed);
    void look_at(const Scheduled& scheduled);

    bool leaves_out_ = true;
    int width_ = 0, height_ = 0;
    std::vector<Node> nodes_;
    std::vector<Scheduled> passes_;
    std::vector<GraphTexture> outputs_;
    std::vector<PassReport> left_out_;
    std::vector<std::size_t> order_;
    std::map<std::string, double, std::less<>> kept_;  // name, ms it took
    std::unique_ptr<TexturePool> pool_;
    std::string watched_pass_;
    std::optional<WatchedTexture> watched_;
    FullScreenTriangle triangle_;
    Texture2D zero_;
};

/// What a pass's draw function is given. Its framebuffer is bound to what the pass writes; depth test and blending are
/// off.
class PassRun {
public:
    /// What is written, in texels of scale().
    const Region& region() const { return region_; }
    int scale() const { return scale_; }
    const Framebuffer& target() const { return *target_; }
    /// One of the textures that the pass writes, for compute shaders (bind_image).
    const Texture2D& written(std::size_t index = 0) const;
    /// Fills a part of the first texture that the pass writes; `part` counts from region()'s first texel.
    void upload(const Region& part, std::span<const float> samples) const;
    /// One that it reads.
    const Texture2D& texture(GraphTexture texture) const;
    const GraphShape& shape(GraphTexture texture) const;

    /// Binds an input; sets the sampler, `SAMPLER_region`, `SAMPLER_frame` and `SAMPLER_scale` (common/graph.glsl).
    void bind(Program& program, const std::string& sampler, GLuint unit, GraphTexture texture) const;
    /// Sets `target_region` and draws one triangle over region(), where the pass's condition (or the one given) allows
    /// it.
    void draw(Program& program) const;
    void draw_if(const GpuCondition& condition, Program& program) const;
    /// As often as `count` a strip of four vertices, which the program's vertex shader places: parts of region().
    void draw_quads(Program& program, int count) const;

private:
    friend class RenderGraph;
    const RenderGraph* graph_ = nullptr;
    const GraphPass* pass_ = nullptr;
    const Framebuffer* target_ = nullptr;
    std::vector<GraphTexture> written_;
    Region region_;
    int scale_ = 1;
};

}  // namespace matchlight
