// Scheduling, texture reuse and drawing of a frame's passes.
#include "render/graph.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "core/work.h"
#include "gl/bandwidth.h"
#include "gl/context.h"
#include "gl/timer.h"

namespace matchlight {

struct RenderGraph::Node {
    GraphShape shape;
    const Texture2D* texture = nullptr;  // imported, or from the pool while it is in use
    Texture2D* pool_texture = nullptr;   // the same, where the graph owns it
    std::optional<std::size_t> writer;   // pass
    bool pooled = false;
};

struct RenderGraph::Scheduled {
    GraphPass pass;
    std::vector<GraphTexture> written;
    Region region;
    PassReport report;
    bool run = false;
};

/// Textures in steps of 64 texels a side, so that a region that grows from frame to frame seldom needs a new one.
class RenderGraph::TexturePool {
public:
    Texture2D* take(const GraphShape& shape) {
        constexpr int step = 64;
        const int width = (shape.region.width + step - 1) / step * step;
        const int height = (shape.region.height + step - 1) / step * step;
        const auto fits = [&](const Entry& entry) {
            const TextureShape& has = entry.texture->shape();
            return entry.free && has.format == shape.format && has.width == width && has.height == height;
        };
        auto found = std::find_if(entries_.begin(), entries_.end(), fits);
        if (found == entries_.end()) {
            entries_.push_back(
                {std::make_unique<Texture2D>(TextureShape{.format = shape.format, .width = width, .height = height})});
            found = entries_.end() - 1;
        }
        found->free = false;
        found->idle_frames = 0;
        return found->texture.get();
    }

    void give_back(const Texture2D* texture) {
        for (Entry& entry : entries_) {
            if (entry.texture.get() == texture) entry.free = true;
        }
    }

    /// All are free again; those that no frame wanted for a while go.
    void begin_frame() {
        constexpr int longest_idle_frames = 16;
        std::erase_if(entries_, [](const Entry& entry) { return entry.idle_frames > longest_idle_frames; });
        for (Entry& entry : entries_) {
            entry.free = true;
            ++entry.idle_frames;
        }
    }

private:
    struct Entry {
        std::unique_ptr<Texture2D> texture;
        bool free = true;
        int idle_frames = 0;
    };
    std::vector<Entry> entries_;
};

namespace {

int divided_down(int value, int by) {
    return value >= 0 ? value / by : -((-value + by - 1) / by);
}

double bytes_per_texel(GLenum format) {
    switch (format) {
        case GL_NONE:
            return 0;
        case GL_R8:
            return 1;
        case GL_R16F:
            return 2;
        case GL_RGBA8:
        case GL_R32F:
        case GL_R32UI:
        case GL_RG16F:
            return 4;
        case GL_RGB16F:
            return 6;
        case GL_RG32F:
        case GL_RGBA16F:
            return 8;
        case GL_RGB32F:
            return 12;
        default:
            return 16;
    }
}

}  // namespace

Region texels_over(const Region& pixels, int scale) {
    if (pixels.empty()) return {};
    const int left = divided_down(pixels.x, scale);
    const int top = divided_down(pixels.y, scale);
    return {left, top, divided_down(pixels.x + pixels.width - 1, scale) + 1 - left,
            divided_down(pixels.y + pixels.height - 1, scale) + 1 - top};
}

double GraphShape::bytes() const {
    return bytes_per_texel(format) * region.width * region.height;
}

RenderGraph::RenderGraph()
    : pool_(std::make_unique<TexturePool>()), zero_(TextureShape{.format = GL_RGBA16F, .width = 1, .height = 1}) {
    zero_.clear(0, 0, 0, 0);
}

RenderGraph::~RenderGraph() = default;

void RenderGraph::begin_frame(int width, int height) {
    width_ = width;
    height_ = height;
    nodes_.clear();
    passes_.clear();
    outputs_.clear();
    left_out_.clear();
    order_.clear();
    watched_.reset();
    pool_->begin_frame();
}

GraphTexture RenderGraph::import(const Texture2D* texture, const GraphShape& shape) {
    nodes_.push_back({.shape = shape, .texture = texture, .writer = std::nullopt});
    return {static_cast<int>(nodes_.size()) - 1};
}

Region RenderGraph::reached(const PassInput& input, int scale) const {
    if (!input.texture) return {};
    const Region region = texels_over(shape(input.texture).frame_pixels(), scale);
    if (region.empty()) return {};
    return region.grown(input.reach).intersected(frame(scale));
}

Region RenderGraph::frame(int scale) const {
    return texels_over({0, 0, width_, height_}, scale);
}

const GraphShape& RenderGraph::shape(GraphTexture texture) const {
    return nodes_.at(static_cast<std::size_t>(texture.id)).shape;
}

const Texture2D& RenderGraph::texture(GraphTexture texture) const {
    if (!texture) return zero_;
    const Texture2D* held = nodes_.at(static_cast<std::size_t>(texture.id)).texture;
    assert(held != nullptr);
    return *held;
}

std::vector<GraphTexture> RenderGraph::add_pass(GraphPass pass) {
    Region region;
    if (pass.region) {
        region = pass.beyond_frame ? *pass.region : pass.region->intersected(frame(pass.scale));
    } else {
        for (const PassInput& input : pass.reads) region = region.united(reached(input, pass.scale));
    }
    std::vector<GraphTexture> written(pass.writes.size());
    if (region.empty() && !pass.writes.empty()) {
        leave_out(std::move(pass.name), "its inputs are empty");
        return written;
    }
    const std::size_t index = passes_.size();
    for (std::size_t i = 0; i < pass.writes.size(); ++i) {
        written[i] = import(nullptr, {pass.writes[i], region, pass.scale});
        nodes_.back().writer = index;
        nodes_.back().pooled = true;
    }
    for (const GraphTexture provided : pass.provides) nodes_.at(static_cast<std::size_t>(provided.id)).writer = index;
    passes_.push_back({.pass = std::move(pass), .written = written, .region = region, .report = {}});
    return written;
}

void RenderGraph::leave_out(std::string name, std::string why) {
    left_out_.push_back({.name = std::move(name), .drawn = false, .why = std::move(why), .frame_pixels = {}});
}

void RenderGraph::output(GraphTexture texture) {
    if (texture) outputs_.push_back(texture);
}

void RenderGraph::forget_kept(const std::string& name) {
    kept_.erase(name);
}

/// Depth first from the outputs: a pass follows what it reads, and a texture's readers follow it soon.
std::vector<std::size_t> RenderGraph::schedule() const {
    std::vector<std::size_t> order;
    std::vector<bool> seen(passes_.size());
    const auto visit = [&](const auto& self, GraphTexture texture) -> void {
        if (!texture) return;
        const auto& writer = nodes_[static_cast<std::size_t>(texture.id)].writer;
        if (!writer || seen[*writer] || passes_[*writer].run) return;
        seen[*writer] = true;
        for (const PassInput& input : passes_[*writer].pass.reads) self(self, input.texture);
        order.push_back(*writer);
    };
    for (const GraphTexture output : outputs_) visit(visit, output);
    return order;
}

void RenderGraph::run(bool timed) {
    const std::vector<std::size_t> order = schedule();
    // A pooled texture's last reader gives it back; outputs are kept.
    std::vector<std::size_t> last_reader(nodes_.size(), 0);
    for (std::size_t place = 0; place < order.size(); ++place) {
        const Scheduled& scheduled = passes_[order[place]];
        for (const GraphTexture texture : scheduled.written) last_reader[static_cast<std::size_t>(texture.id)] = place;
        for (const PassInput& input : scheduled.pass.reads) {
            if (input.texture) last_reader[static_cast<std::size_t>(input.texture.id)] = place;
        }
    }
    for (const GraphTexture texture : outputs_) last_reader[static_cast<std::size_t>(texture.id)] = order.size();
    for (std::size_t place = 0; place < order.size(); ++place) {
        draw_pass(passes_[order[place]], timed);
        if (!watched_pass_.empty() && passes_[order[place]].pass.name == watched_pass_) look_at(passes_[order[place]]);
        order_.push_back(order[place]);
        for (std::size_t node = 0; node < nodes_.size(); ++node) {
            if (nodes_[node].pooled && nodes_[node].texture != nullptr && last_reader[node] == place) {
                pool_->give_back(nodes_[node].texture);
            }
        }
    }
}

void RenderGraph::draw_pass(Scheduled& scheduled, bool timed) {
    const GraphPass& pass = scheduled.pass;
    PassReport& report = scheduled.report;
    scheduled.run = true;
    report.name = pass.name;
    report.frame_pixels = GraphShape{GL_NONE, scheduled.region, pass.scale}.frame_pixels();
    report.bytes = pass.bytes;
    for (const GraphTexture texture : pass.provides) {
        report.frame_pixels = report.frame_pixels.united(shape(texture).frame_pixels());
    }
    if (const auto kept = kept_.find(pass.name); pass.once && kept != kept_.end()) {
        report.why = "made once for " + pass.once_for;
        if (kept->second > 0) report.why += fmt::format(", in {:.1f} ms", kept->second);
        return;
    }
    stop_if_given_up();
    tell_work(pass.name);
    for (const PassInput& input : pass.reads) {
        if (input.texture) report.bytes += shape(input.texture).bytes();
    }
    for (const GraphTexture texture : scheduled.written) {
        Node& node = nodes_[static_cast<std::size_t>(texture.id)];
        node.pool_texture = pool_->take(node.shape);
        node.texture = node.pool_texture;
        report.bytes += node.shape.bytes();
    }
    std::vector<Attachment> attachments;
    if (pass.raster) {
        for (const GraphTexture texture : scheduled.written) attachments.emplace_back(this->texture(texture));
    }
    const Framebuffer target =
        attachments.empty() ? Framebuffer() : Framebuffer(std::span<const Attachment>(attachments));
    if (pass.sets != nullptr) pass.sets->set(!leaves_out_);

    PassRun run;
    run.graph_ = this;
    run.pass_ = &pass;
    run.target_ = &target;
    run.written_ = scheduled.written;
    run.region_ = scheduled.region;
    run.scale_ = pass.scale;
    std::optional<GpuTimer> timer;
    if (timed) {
        glFinish();
        timer.emplace().start();
    }
    if (target) target.bind({0, 0, scheduled.region.width, scheduled.region.height});
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    if (pass.sets != nullptr) pass.sets->bind_for_shaders();
    pass.draw(run);
    if (timer) {
        report.ms = timer->stop();
        report.bandwidth_bounds = report.bytes > 0 ? report.ms * 1e-3 * copy_bytes_per_second() / report.bytes : 0;
    }
    report.drawn = true;
    if (pass.once) {
        kept_.emplace(pass.name, report.ms);
        report.why = "once for " + pass.once_for;
    }
    check_no_gl_error("pass " + pass.name);
}

void RenderGraph::look_at(const Scheduled& scheduled) {
    const GpuCondition* needs = scheduled.pass.needs;
    if (needs != nullptr && !needs->is_met()) return;
    std::vector<GraphTexture> textures = scheduled.written;
    textures.insert(textures.end(), scheduled.pass.provides.begin(), scheduled.pass.provides.end());
    for (const GraphTexture texture : textures) {
        const Node& node = nodes_[static_cast<std::size_t>(texture.id)];
        if (node.texture == nullptr || node.texture->shape().samples > 0 || node.texture->bounds().empty()) continue;
        GLint depth_bits = 0, type = GL_NONE;
        glGetTextureLevelParameteriv(node.texture->name(), 0, GL_TEXTURE_DEPTH_SIZE, &depth_bits);
        glGetTextureLevelParameteriv(node.texture->name(), 0, GL_TEXTURE_RED_TYPE, &type);
        if (type == GL_INT || type == GL_UNSIGNED_INT) continue;
        // The pool's textures may be larger than what a pass writes.
        const Region& region = node.shape.region;
        const Region written = Region{0, 0, region.width, region.height}.intersected(node.texture->bounds());
        const Region all = node.pooled ? written : node.texture->bounds();
        if (all.empty()) continue;
        watched_ =
            WatchedTexture{scheduled.pass.name, node.shape, node.texture->read<float>(all, depth_bits > 0 ? 1 : 4)};
        return;
    }
}

std::vector<PassReport> RenderGraph::reports() const {
    std::vector<PassReport> reports;
    for (const std::size_t index : order_) {
        PassReport report = passes_[index].report;
        const GpuCondition* needs = passes_[index].pass.needs;
        if (report.drawn && needs != nullptr && !needs->is_met()) {
            report.drawn = false;
            report.why = needs->unmet();
        }
        reports.push_back(std::move(report));
    }
    for (std::size_t index = 0; index < passes_.size(); ++index) {
        if (std::find(order_.begin(), order_.end(), index) != order_.end()) continue;
        reports.push_back({.name = passes_[index].pass.name, .why = "nothing needs it", .frame_pixels = {}});
    }
    reports.insert(reports.end(), left_out_.begin(), left_out_.end());
    return reports;
}

const Texture2D& PassRun::written(std::size_t index) const {
    return graph_->texture(written_.at(index));
}

const Texture2D& PassRun::texture(GraphTexture texture) const {
    return graph_->texture(texture);
}

const GraphShape& PassRun::shape(GraphTexture texture) const {
    return graph_->shape(texture);
}

void PassRun::bind(Program& program, const std::string& sampler, GLuint unit, GraphTexture texture) const {
    program.bind_texture(sampler, unit, graph_->texture(texture));
    const GraphShape shape = texture ? graph_->shape(texture) : GraphShape{GL_NONE, {}, 1};
    const Region& region = shape.region;
    program.set(sampler + "_region", Eigen::Vector4i(region.x, region.y, region.width, region.height));
    program.set(sampler + "_scale", shape.scale);
    const Region frame = graph_->frame(shape.scale);
    program.set(sampler + "_frame", Eigen::Vector4i(frame.x, frame.y, frame.width, frame.height));
}

void PassRun::upload(const Region& part, std::span<const float> samples) const {
    graph_->nodes_.at(static_cast<std::size_t>(written_.at(0).id)).pool_texture->upload(part, samples);
}

void PassRun::draw(Program& program) const {
    if (pass_->needs != nullptr) return draw_if(*pass_->needs, program);
    program.set("target_region", Eigen::Vector4i(region_.x, region_.y, region_.width, region_.height));
    graph_->triangle_.draw();
}

void PassRun::draw_quads(Program& program, int count) const {
    program.set("target_region", Eigen::Vector4i(region_.x, region_.y, region_.width, region_.height));
    graph_->triangle_.draw_quads(count);
}

void PassRun::draw_if(const GpuCondition& condition, Program& program) const {
    program.set("target_region", Eigen::Vector4i(region_.x, region_.y, region_.width, region_.height));
    condition.draw_if_met(graph_->triangle_);
}

}  // namespace matchlight
