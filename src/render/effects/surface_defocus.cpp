// Loss of light and its mean for every class of circles; then each pixel takes its own class'.
#include "render/effects/surface_defocus.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "render/effects/defocus_kernel.h"

namespace matchlight {

namespace {

constexpr double disc_step_texels = 1.0 / 16;
constexpr GLuint first_unit = 6;  // after those that CompositePass::set_surface takes

int texel_px_of(int own_class) {
    return 1 << std::max(own_class, 0);
}

/// As surface_circle.glsl has it; -1: sharp.
int class_of(double width_px, double class_texels) {
    if (width_px < least_coc_px) return -1;
    return width_px < 2 * class_texels ? 0 : static_cast<int>(std::floor(std::log2(width_px / class_texels)));
}

}  // namespace

void SurfaceDefocusKnobs::check() const {
    if (!(class_texels >= 2 && class_texels <= 16))
        throw std::invalid_argument(fmt::format("class_texels is {}, not from 2 to 16", class_texels));
    if (texel_samples < 1 || texel_samples > 64)
        throw std::invalid_argument(fmt::format("texel_samples is {}, not from 1 to 64", texel_samples));
    if (!(smooth_bend >= 0 && smooth_bend <= 1))
        throw std::invalid_argument(fmt::format("smooth_bend is {}, not from 0 to 1", smooth_bend));
}

SurfaceDefocusKnobs surface_defocus_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.class_texels = 3, .texel_samples = 2, .smooth_bend = 0.064};
        case QualityLevel::preview:
            return {.class_texels = 4, .texel_samples = 2, .smooth_bend = 0.048};
        case QualityLevel::reference:
            return {.class_texels = 16, .texel_samples = 8, .smooth_bend = 0};
        case QualityLevel::final_:
            break;
    }
    return {};
}

double widest_surface_coc_px(int frame_width, int frame_height) {
    return 2 * std::hypot(frame_width, frame_height);
}

double surface_reach_px(double coc_px, double change, int least_class, const SurfaceDefocusKnobs& knobs) {
    const double stretch = std::min(1 / std::max(1 - change / 2, 1e-3), most_surface_stretch);
    const int texel_px = texel_px_of(std::max(class_of(std::abs(coc_px), knobs.class_texels), least_class));
    // The disc's soft rim, the extent of a texel, and that between two texels both are seen.
    return stretch * (std::abs(coc_px) / 2 + texel_px) + 2 * texel_px;
}

class SurfaceDefocus::Passes {
public:
    Passes(RenderGraph& graph, const SurfaceDefocus& shared, const CompositePass& composite,
           const SurfaceDefocusInput& input, const SurfaceDefocusKnobs& knobs)
        : graph_(graph), shared_(shared), composite_(composite), input_(input), knobs_(knobs) {
        const Region frame = graph.frame();
        largest_px_ = widest_surface_coc_px(frame.width, frame.height);
    }

    GraphTexture add() {
        int last_class = -1;
        for (const SurfaceTile& tile : input_.tiles) last_class = std::max(last_class, classes_of(tile).second);
        std::vector<ClassPicture> classes;
        for (int own_class = -1; own_class <= last_class; ++own_class) {
            ClassPicture picture{.own_class = own_class, .blurred = {}, .tiles = {}};
            Region bounds;
            for (const SurfaceTile& tile : input_.tiles) {
                const auto [first, last] = classes_of(tile);
                const bool is_shown =
                    own_class < 0 ? tile.narrowest_px < least_coc_px : first <= own_class && own_class <= last;
                const Region pixels = tile.pixels.intersected(input_.region);
                if (!is_shown || pixels.empty()) continue;
                picture.tiles.push_back({pixels, tile.least_class});
                bounds = bounds.united(pixels);
            }
            if (bounds.empty()) continue;
            if (own_class >= 0) picture.blurred = add_class(picture, bounds);
            classes.push_back(std::move(picture));
        }
        return add_shown(classes);
    }

private:
    struct ShownTile {
        Region pixels;
        int least_class = 0;
    };
    struct ClassPicture {
        int own_class = -1;
        GraphTexture blurred;
        std::vector<ShownTile> tiles;
    };

    /// The first and the last that a tile's blurred pixels are of; the last is -1 where all are sharp.
    std::pair<int, int> classes_of(const SurfaceTile& tile) const {
        if (tile.widest_px < least_coc_px) return {0, -1};
        const auto drawn = [&](double width_px) {
            return std::max(class_of(width_px, knobs_.class_texels), tile.least_class);
        };
        return {drawn(tile.narrowest_px), drawn(tile.widest_px)};
    }

    void set_surface(Program& program) const {
        composite_.set_surface(program, input_.input);
        const Focus& focus = input_.input.optics.focus;
        program.set("coc_scale_px_m", focus.coc_scale_px_m);
        program.set("focus_per_m", 1 / focus.focus_distance_m);
        program.set("focal_px", input_.focal_px);
        program.set("largest_coc_px", largest_px_);
        program.set("least_coc_px", least_coc_px);
        program.set("class_texels", knobs_.class_texels);
    }
    /// Draws a class' tiles; beside each `rim` texels that are its neighbours', too.
    static void draw_tiles(const PassRun& run, Program& program, const ClassPicture& picture, int rim) {
        program.set("drawn_class", picture.own_class);
        program.set("texel_px", texel_px_of(picture.own_class));
        glEnable(GL_SCISSOR_TEST);
        for (const ShownTile& tile : picture.tiles) {
            program.set("least_class", tile.least_class);
            const Region texels = texels_over(tile.pixels, run.scale()).grown(rim);
            const Region part = texels.intersected(run.region()).moved(-run.region().x, -run.region().y);
            glScissor(part.x, part.y, part.width, part.height);
            run.draw(program);
        }
        glDisable(GL_SCISSOR_TEST);
    }

    GraphTexture add_class(const ClassPicture& picture, const Region& bounds) {
        const int texel_px = texel_px_of(picture.own_class);
        const Region target = texels_over(bounds, texel_px).grown(1);
        GraphPass pass{.name = fmt::format("surface defocus/loss {}", picture.own_class),
                       .writes = {GL_RGBA32F},
                       .scale = texel_px,
                       .region = target.grown(shared_.taps_reach_),
                       .beyond_frame = true};
        pass.draw = [this_ = *this, texel_px](PassRun& run) {
            Program& program =
                this_.shared_.shaders_.full_screen("effects/depth_of_field/surface_loss.frag", this_.shadow_defines());
            program.use();
            this_.composite_.set_surface(program, this_.input_.input);
            program.set("texel_px", texel_px);
            program.set("samples", std::min(texel_px, this_.knobs_.texel_samples));
            run.draw(program);
        };
        const GraphTexture loss = graph_.add_pass(std::move(pass))[0];
        return add_gather(picture, loss, target);
    }

    GraphTexture add_gather(const ClassPicture& picture, GraphTexture loss, const Region& target) {
        GraphPass pass{.name = fmt::format("surface defocus/gather {}", picture.own_class),
                       .reads = {{loss}},
                       .writes = {GL_RGBA32F},
                       .scale = texel_px_of(picture.own_class),
                       .region = target,
                       .beyond_frame = true};
        pass.draw = [this_ = *this, picture, loss](PassRun& run) {
            run.target().clear_color(0, 0, 0, 0, 0);
            ShaderDefines defines = this_.shadow_defines();
            defines["TAPS"] = std::to_string(this_.shared_.taps_.size());
            Program& program =
                this_.shared_.shaders_.full_screen("effects/depth_of_field/surface_gather.frag", defines);
            program.use();
            this_.set_surface(program);
            run.bind(program, "loss", first_unit, loss);
            program.bind_texture("discs", first_unit + 1, this_.shared_.discs_);
            program.set("discs_row", picture.own_class > 0);
            program.set("discs_step", disc_step_texels);
            program.set("taps", std::span<const Eigen::Vector4f>(this_.shared_.taps_));
            program.set("most_stretch", most_surface_stretch);
            draw_tiles(run, program, picture, 1);
        };
        return graph_.add_pass(std::move(pass))[0];
    }

    ShaderDefines shadow_defines() const {
        const ContactShadow* shadow = input_.input.shadow;
        return shadow != nullptr ? shadow->defines() : ShaderDefines{};
    }

    GraphTexture add_shown(const std::vector<ClassPicture>& classes) {
        GraphPass pass{.name = "surface defocus/shadow", .writes = {GL_RGBA32F}, .region = input_.region};
        for (const ClassPicture& picture : classes) pass.reads.push_back({picture.blurred});
        pass.draw = [this_ = *this, classes](PassRun& run) {
            run.target().clear_color(0, 1, 1, 1, 1);
            Program& program =
                this_.shared_.shaders_.full_screen("effects/depth_of_field/surface_shown.frag", this_.shadow_defines());
            program.use();
            this_.set_surface(program);
            for (const ClassPicture& picture : classes) {
                run.bind(program, "blurred", first_unit, picture.blurred);
                draw_tiles(run, program, picture, 0);
            }
        };
        return graph_.add_pass(std::move(pass))[0];
    }

    RenderGraph& graph_;
    const SurfaceDefocus& shared_;
    const CompositePass& composite_;
    SurfaceDefocusInput input_;
    SurfaceDefocusKnobs knobs_;
    double largest_px_ = 0;
};

void SurfaceDefocus::make_discs(const BokehSettings& bokeh, const SurfaceDefocusKnobs& knobs) {
    if (discs_ && class_texels_ == knobs.class_texels && bokeh_ == bokeh) return;
    class_texels_ = knobs.class_texels;
    bokeh_ = bokeh;
    // The widest circle of a class is 2 · class_texels wide. Small discs are drawn wider than they are, to have a grid
    // carry their variance.
    const double largest_radius = knobs.class_texels + 1;
    constexpr int rows = 2;  // on pixels, and resampled: means and interpolation spread the same at any scale
    const ImageF table = disc_table(bokeh, largest_radius, disc_step_texels, rows);
    discs_ = Texture2D({.format = GL_RG32F, .width = table.width(), .height = table.height()});
    discs_.upload(table);
    taps_.clear();
    taps_reach_ = 0;
    for (const DiscTap& tap : disc_taps(bokeh, most_surface_stretch * (largest_radius + 1), false)) {
        taps_.emplace_back(static_cast<float>(tap.offset.x()), static_cast<float>(tap.offset.y()),
                           static_cast<float>(tap.distance), 0.0F);
        taps_reach_ = std::max(taps_reach_, tap.offset.cwiseAbs().maxCoeff());
    }
}

GraphTexture SurfaceDefocus::add(RenderGraph& graph, const CompositePass& composite, const SurfaceDefocusInput& input,
                                 const SurfaceDefocusKnobs& knobs) {
    knobs.check();
    make_discs(input.bokeh, knobs);
    return Passes(graph, *this, composite, input, knobs).add();
}

}  // namespace matchlight
