// Passes of every class, then their composition.
#include "render/effects/defocus_gather.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "render/effects/defocus_kernel.h"

namespace matchlight {

namespace {

constexpr int mask_tile_px = 16;
constexpr int tile_texels = 8;
/// After those of any pass.
constexpr GLuint tile_unit = 15;
constexpr double disc_step_texels = 1.0 / 16;

/// 0: sharp; 1: narrower than the first class; then doubling (circles.glsl).
int class_of(double coc_px, double first_class_px) {
    const double width = std::abs(coc_px);
    if (width < least_coc_px) return 0;
    if (width < first_class_px) return 1;
    return 2 + static_cast<int>(std::floor(std::log2(width / first_class_px)));
}

int texel_px_of(int own_class, const GatherKnobs& knobs) {
    return 1 << std::max(std::abs(own_class) - knobs.fine_classes, 0);
}

/// Radius of the widest disc of a class, drawn.
double widest_disc_texels(int own_class, const GatherInput& input, const GatherKnobs& knobs) {
    const double widest_px = std::ldexp(knobs.first_class_px, std::abs(own_class) - 1);
    return input.magnification * widest_px / texel_px_of(own_class, knobs) / 2;
}

struct ClassPicture {
    GraphTexture light, required;
    int own_class = 0;
    int scale = 1;
};

}  // namespace

void GatherKnobs::check() const {
    if (!(first_class_px >= 2 && first_class_px <= 16))
        throw std::invalid_argument(fmt::format("gather first_class_px is {}, not from 2 to 16", first_class_px));
    if (!(fine_classes >= 1 && fine_classes <= 4))
        throw std::invalid_argument(fmt::format("gather fine_classes is {}, not from 1 to 4", fine_classes));
}

GatherKnobs gather_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.fine_classes = 1, .hidden = false, .reflections = false};
        case QualityLevel::preview:
            return {.first_class_px = 5, .fine_classes = 2};
        case QualityLevel::reference:
            return {.full_float = true};
        case QualityLevel::final_:
            break;
    }
    // Half floats, of which light passes three, each cut by up to 2^-10, would cost as much as the mean energy may be
    // off.
    return {.full_float = true};
}

double widest_gathered_coc_px(int frame_width, int frame_height) {
    return 2 * std::hypot(frame_width, frame_height);
}

double gathered_reach_px(double coc_px, const GatherKnobs& knobs) {
    const int own_class = class_of(coc_px, knobs.first_class_px);
    if (own_class <= knobs.fine_classes) return coc_px / 2;
    // From a pixel to the middle of its texel, from the last texel that the disc covers in part to where the next one's
    // share ends.
    constexpr double resampled_texels = 0.5 + 1.5;
    return coc_px / 2 + resampled_texels * texel_px_of(own_class, knobs);
}

class GatherDefocus::Passes {
public:
    Passes(RenderGraph& graph, ShaderLibrary& shaders, const Texture2D& discs, const GatherInput& input,
           const GatherKnobs& knobs)
        : graph_(graph), shaders_(shaders), discs_(discs), input_(input), knobs_(knobs) {
        const Region frame = graph.frame();
        largest_px_ = widest_gathered_coc_px(frame.width, frame.height);
        near_classes_ = input.range.nearest_px < 0 ? classes_to(input.range.nearest_px) : 0;
        far_classes_ = input.range.farthest_px > 0 ? classes_to(input.range.farthest_px) : 0;
        class_count_ = std::max(near_classes_, far_classes_);
    }

    GraphTexture add() {
        add_resolved();
        add_tiles();
        std::vector<ClassPicture> before, beyond;  // each from the nearest to the farthest
        for (int k = near_classes_; k >= 1; --k) before.push_back(add_class(-k));
        for (int k = 1; k <= far_classes_; ++k) beyond.push_back(add_class(k));
        return add_composition(before, beyond);
    }

private:
    int classes_to(double coc_px) const {
        return class_of(std::clamp(coc_px, -largest_px_, largest_px_), knobs_.first_class_px);
    }
    /// How far a texel's light can go, and a texel for who magnifies the class.
    int reach_texels(int own_class) const {
        return static_cast<int>(std::ceil(widest_disc_texels(own_class, input_, knobs_))) + 2;
    }
    int reach_px(int own_class) const { return (reach_texels(own_class) + 2) * texel_px_of(own_class, knobs_); }

    void set_classes(Program& program) const {
        program.set("least_coc_px", least_coc_px);
        program.set("first_class_px", knobs_.first_class_px);
        program.set("class_count", class_count_);
    }

    void add_resolved() {
        const Region spread = input_.region.grown(class_count_ > 0 ? reach_px(class_count_) : 0);
        const GLenum wide = knobs_.full_float ? GL_RGBA32F : GL_RGBA16F;
        const std::vector<GraphTexture> resolved = graph_.add_pass(
            {.name = "defocus/resolve",
             .reads = {{input_.layer_drawn}},
             .writes = {GL_RGBA32F, wide, wide, wide},
             .region = spread,
             .beyond_frame = true,
             .draw = [this_ = *this](PassRun& run) {
                 ShaderDefines defines = this_.input_.layer_defines;
                 if (this_.knobs_.hidden) defines["HIDDEN"] = "1";
                 if (this_.input_.is_transparent) defines["TRANSPARENT"] = "1";
                 Program& program = this_.shaders_.full_screen("effects/depth_of_field/gather_resolve.frag", defines);
                 program.use();
                 this_.input_.bind_layer(program);
                 this_.set_classes(program);
                 program.set("coc_scale_px_m", this_.input_.focus.coc_scale_px_m);
                 program.set("focus_per_m", 1 / this_.input_.focus.focus_distance_m);
                 program.set("largest_coc_px", this_.largest_px_);
                 program.set("layer_density", this_.input_.layer_density);
                 const Region frame = this_.graph_.frame();
                 program.set("frame_px",
                             Eigen::Vector2f(static_cast<float>(frame.width), static_cast<float>(frame.height)));
                 run.draw(program);
             }});
        sharp_ = resolved[0];
        front_ = resolved[1];
        back_ = resolved[2];
        circles_ = resolved[3];
    }

    /// Which classes each tile shows, and which reach it.
    void add_tiles() {
        const Region tiles = texels_over(graph_.shape(circles_).region, mask_tile_px);
        const auto add_tile_pass = [&](const char* name, GraphTexture source, std::function<void(PassRun&)> draw) {
            return graph_.add_pass({.name = name,
                                    .reads = {{source}},
                                    .writes = {GL_R32UI},
                                    .scale = mask_tile_px,
                                    .region = tiles,
                                    .beyond_frame = true,
                                    .draw = std::move(draw)})[0];
        };
        reached_ = add_tile_pass("defocus/mask", circles_, [this_ = *this](PassRun& run) {
            Program& program = this_.shaders_.full_screen("effects/depth_of_field/gather_mask.frag");
            program.use();
            run.bind(program, "circles", 0, this_.circles_);
            this_.set_classes(program);
            program.set("tile_px", mask_tile_px);
            run.draw(program);
        });
        if (class_count_ == 0) return;
        for (const Eigen::Vector2i& axis : {Eigen::Vector2i(1, 0), Eigen::Vector2i(0, 1)}) {
            reached_ = add_tile_pass("defocus/reach", reached_, [this_ = *this, source = reached_, axis](PassRun& run) {
                Program& program = this_.shaders_.full_screen("effects/depth_of_field/gather_reach.frag");
                program.use();
                run.bind(program, "classes", 0, source);
                this_.set_classes(program);
                program.set("axis", axis);
                program.set("tile_px", mask_tile_px);
                program.set("first_reach_px", static_cast<double>(this_.reach_px(1)));
                program.set("farthest_tiles", this_.reach_px(this_.class_count_) / mask_tile_px + 1);
                run.draw(program);
            });
        }
    }

    /// Of a class with others in its tile.
    enum class Company { any, alone, others };

    /// Draws where the class reaches, and nothing elsewhere.
    void draw_reached(PassRun& run, const std::string& fragment_file, const ShaderDefines& defines, int own_class,
                      const std::function<void(Program&)>& set, Company company = Company::any) const {
        // Tiles of whole texels, or, of coarser ones, everything: there is little of it.
        const bool by_tiles = run.scale() <= mask_tile_px;
        Program& program = by_tiles ? shaders_.program({{GL_VERTEX_SHADER, "effects/depth_of_field/gather_tile.vert"},
                                                        {GL_FRAGMENT_SHADER, fragment_file}},
                                                       defines)
                                    : shaders_.full_screen(fragment_file, defines);
        program.use();
        set(program);
        if (!by_tiles) return run.draw(program);
        run.bind(program, "reached", tile_unit, reached_);
        program.set("wanted_bit", 1U << static_cast<unsigned>(own_class + class_count_));
        program.set("wanted_company", static_cast<int>(company));
        program.set("quad_texels", mask_tile_px / run.scale());
        const Region& tiles = graph_.shape(reached_).region;
        run.draw_quads(program, tiles.width * tiles.height);
    }
    static void clear(const PassRun& run, int targets) {
        for (int i = 0; i < targets; ++i) run.target().clear_color(i, 0, 0, 0, 0);
    }

    ClassPicture add_class(int own_class) {
        const int texel_px = texel_px_of(own_class, knobs_);
        const std::string name = fmt::format("defocus/{} {}", own_class < 0 ? "near" : "far", std::abs(own_class));
        const Region target = texels_over(input_.region, texel_px).grown(1);
        const GLenum wide = knobs_.full_float ? GL_RGBA32F : GL_RGBA16F;
        const std::vector<GraphTexture> sorted = graph_.add_pass(
            {.name = name + " sorted",
             .reads = {{front_}, {back_}, {circles_}, {reached_}},
             .writes = {wide, wide},
             .scale = texel_px,
             .region = target.grown(reach_texels(own_class)),
             .beyond_frame = true,
             .draw = [this_ = *this, own_class, texel_px](PassRun& run) {
                 clear(run, 2);
                 // As a constant where loops over it are short enough to be unrolled.
                 constexpr int longest_unrolled = 4;
                 ShaderDefines defines;
                 if (texel_px <= longest_unrolled) defines["TEXEL_PX"] = fmt::format("{}", texel_px);
                 this_.draw_reached(run, "effects/depth_of_field/gather_sort.frag", defines, own_class,
                                    [&](Program& program) {
                                        run.bind(program, "front", 0, this_.front_);
                                        run.bind(program, "back", 1, this_.back_);
                                        run.bind(program, "circles", 2, this_.circles_);
                                        program.bind_texture("kernels", 3, this_.discs_);
                                        this_.set_classes(program);
                                        program.set("own_class", own_class);
                                        program.set("texel_px", texel_px);
                                        program.set("kernel_step", disc_step_texels);
                                        program.set("kernel_row", static_cast<int>(std::lround(std::log2(texel_px))));
                                    });
             }});
        const GraphTexture discs = sorted[1];
        const Region tiles = texels_over(graph_.shape(discs).region, tile_texels);
        // Of each tile, then of each with those around it, as far as a disc covers whole texels' middles.
        const int farthest_texels = static_cast<int>(std::floor(widest_disc_texels(own_class, input_, knobs_) + 0.5));
        const int tiles_around = (farthest_texels + tile_texels - 1) / tile_texels;
        const auto add_widest = [&](GraphTexture of, int texels, int margin) {
            return graph_.add_pass({.name = name + " tiles",
                                    .reads = {{of}},
                                    .writes = {GL_R16F},
                                    .scale = texel_px * tile_texels,
                                    .region = tiles,
                                    .beyond_frame = true,
                                    .draw = [&shaders = shaders_, of, texels, margin](PassRun& run) {
                                        Program& program =
                                            shaders.full_screen("effects/depth_of_field/gather_tiles.frag");
                                        program.use();
                                        run.bind(program, "discs", 0, of);
                                        program.set("tile_texels", texels);
                                        program.set("margin_texels", margin);
                                        run.draw(program);
                                    }})[0];
        };
        const GraphTexture widest = add_widest(add_widest(discs, tile_texels, 0), 1, tiles_around);
        std::vector<Eigen::Vector4f> taps;
        for (const DiscTap& tap :
             disc_taps(input_.bokeh, widest_disc_texels(own_class, input_, knobs_), own_class < 0)) {
            taps.emplace_back(static_cast<float>(tap.offset.x()), static_cast<float>(tap.offset.y()),
                              static_cast<float>(tap.distance), 0.0F);
        }
        const std::vector<GraphTexture> gathered = graph_.add_pass(
            {.name = name,
             .reads = {{sorted[0]}, {discs}, {widest}, {reached_}},
             .writes = {wide, GL_RG16F},
             .scale = texel_px,
             .region = target,
             .beyond_frame = true,
             .draw = [this_ = *this, own_class, light_share = sorted[0], discs, widest, taps](PassRun& run) {
                 clear(run, 2);
                 this_.draw_reached(run, "effects/depth_of_field/gather.frag",
                                    {{"TAPS", fmt::format("{}", taps.size())}}, own_class, [&](Program& program) {
                                        run.bind(program, "light_share", 0, light_share);
                                        run.bind(program, "discs", 1, discs);
                                        run.bind(program, "widest", 2, widest);
                                        program.set("tile_texels", tile_texels);
                                        program.set("is_far", own_class > 0);
                                        program.set("taps", std::span<const Eigen::Vector4f>(taps));
                                        program.set("tap_count", static_cast<int>(taps.size()));
                                    });
             }});
        return {gathered[0], gathered[1], own_class, texel_px};
    }

    /// Each class over those behind it, from the nearest to the farthest, in the tiles that it reaches.
    GraphTexture add_composition(const std::vector<ClassPicture>& before, const std::vector<ClassPicture>& beyond) {
        std::vector<ClassPicture> all = before;
        all.push_back({.light = sharp_, .required = {}, .own_class = 0, .scale = 0});
        all.insert(all.end(), beyond.begin(), beyond.end());
        GraphPass pass{
            .name = "defocus/over", .reads = {{reached_}}, .writes = {GL_RGBA32F, GL_RG16F}, .region = input_.region};
        for (const ClassPicture& one : all) pass.reads.insert(pass.reads.end(), {{one.light}, {one.required}});
        pass.draw = [this_ = *this, all](PassRun& run) {
            clear(run, 2);
            for (const ClassPicture& one : all) {
                ShaderDefines defines{{"CLASS_SCALE", fmt::format("{}", one.scale)}};
                const auto set = [&](Program& program) {
                    run.bind(program, "light_behind", 0, one.light);
                    run.bind(program, "required_behind", 1, one.required);
                    program.bind_texture("nearer", 2, run.written(0));
                    program.bind_texture("nearer_required", 3, run.written(1));
                };
                // Each class reads in its place what those before it wrote there.
                glTextureBarrier();
                this_.draw_reached(run, "effects/depth_of_field/gather_combine.frag", defines, one.own_class, set,
                                   Company::others);
                defines["ALONE"] = "1";
                this_.draw_reached(run, "effects/depth_of_field/gather_combine.frag", defines, one.own_class, set,
                                   Company::alone);
            }
        };
        return graph_.add_pass(std::move(pass))[0];
    }

    RenderGraph& graph_;
    ShaderLibrary& shaders_;
    const Texture2D& discs_;
    GatherInput input_;
    GatherKnobs knobs_;
    double largest_px_ = 0;
    int near_classes_ = 0, far_classes_ = 0, class_count_ = 0;
    GraphTexture sharp_, front_, back_, circles_, reached_;
};

GraphTexture GatherDefocus::add(RenderGraph& graph, const GatherInput& input, const GatherKnobs& knobs) {
    knobs.check();
    const double radius = widest_disc_texels(knobs.fine_classes, input, knobs);
    constexpr int rows = 16;  // texels of 2^15 pixels: wider than any frame
    if (!discs_ || discs_radius_ != radius || discs_bokeh_ != input.bokeh) {
        const ImageF table = disc_table(input.bokeh, radius, disc_step_texels, rows);
        discs_ = Texture2D({.format = GL_RG32F, .width = table.width(), .height = table.height()});
        discs_.upload(table);
        discs_radius_ = radius;
        discs_bokeh_ = input.bokeh;
    }
    return Passes(graph, shaders_, discs_, input, knobs).add();
}

}  // namespace matchlight
