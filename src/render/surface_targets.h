// The textures that SurfaceRenderer draws into.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/objects.h"
#include "render/surface.h"

namespace matchlight {

/// Clears obey the scissor: the targets may be much larger than the view.
inline void begin_clearing(const Region& region) {
    glEnable(GL_SCISSOR_TEST);
    glScissor(region.x, region.y, region.width, region.height);
}

/// Empties the part of the target that the view takes, and draws there.
inline void begin_drawing(const Framebuffer& target, const Region& region, int colors, bool clears_depth = true) {
    target.bind(region);
    begin_clearing(region);
    for (int i = 0; i < colors; ++i) target.clear_color(i, 0, 0, 0, 0);
    if (clears_depth) target.clear_depth();
    glDisable(GL_SCISSOR_TEST);
}

/// Of the depths of what draw() found nearest: after those of the environment, the material and the shading.
inline constexpr GLuint nearest_depth_unit = 15;
/// Of what was drawn before what transmits: beyond those of materials.
inline constexpr GLuint backdrop_unit = 40;

/// What draws go into; grown to the largest view met, so that views whose size changes do not allocate every time.
struct SurfaceRenderer::Targets {
    /// One picture that is not multisampled.
    struct ColorAndDepth {
        Texture2D color, depth;
        Framebuffer target;
    };
    /// Beside a picture, how the lens focuses it; into the picture's own colour and depth.
    struct WithFocus {
        Texture2D focus_share;
        Framebuffer target;
        GLuint color = 0, depth = 0;  // what the target holds besides
    };
    /// Beside a picture, which of it is virtual.
    struct WithCoverage {
        Texture2D coverage;
        Framebuffer target;
        std::array<GLuint, 3> beside{};  // what the target holds besides: colour, focus, depth
    };
    Texture2D multisampled_color, multisampled_depth;
    Framebuffer multisampled;
    Texture2D edge_depth;  // of one of several samples
    Framebuffer edge_depth_target;
    Texture2D color, depth;  // depth only where nothing is multisampled
    Framebuffer resolved;
    ColorAndDepth hidden;
    std::array<ColorAndDepth, 3> ways;  // by WayPicture
    ColorAndDepth parts;                // multisampled
    Texture2D transparent_color;
    Texture2D backdrop;  // of what transmits, with all its levels
    Framebuffer backdrop_target;
    WithFocus focused, hidden_focused, transparent;
    WithCoverage covered, multisampled_covered, hidden_covered, transparent_covered;
    Texture2D layer_depth_m, layer_normal, layer_id, layer_depth;
    Framebuffer layers;

    /// Copies what was drawn, and blurs it.
    void take_backdrop(const Framebuffer& drawn, const SurfaceView& view) {
        if (!holds(backdrop, view, 0)) {
            TextureShape shape = shape_for(backdrop, view);
            shape.format = color_format;
            shape.levels = 0;
            backdrop = Texture2D(shape);
            backdrop.set_filter(TextureFilter{});
            backdrop_target = Framebuffer({backdrop});
        }
        backdrop_target.clear_color(0, 0, 0, 0, 0);
        drawn.resolve_color_to(backdrop_target, {0, 0, view.width, view.height});
        backdrop.make_mipmaps();
    }

    static constexpr GLenum color_format = GL_RGBA16F;
    static constexpr GLenum depth_format = GL_DEPTH_COMPONENT32F;

    static bool holds(const Texture2D& texture, const SurfaceView& view, int samples) {
        return texture && texture.width() >= view.width && texture.height() >= view.height &&
               texture.shape().samples == samples;
    }
    /// A view's size in whole steps, not below what was there.
    static TextureShape shape_for(const Texture2D& before, const SurfaceView& view) {
        constexpr int step = 64;
        const auto rounded = [](int size) { return (size + step - 1) / step * step; };
        TextureShape shape;
        shape.width = std::max(rounded(view.width), before ? before.width() : 0);
        shape.height = std::max(rounded(view.height), before ? before.height() : 0);
        return shape;
    }

    void fit_color(const SurfaceView& view, int samples) {
        const bool needs_depth = samples == 1;
        if (!holds(color, view, 0) || (needs_depth && !depth)) {
            TextureShape shape = shape_for(color, view);
            shape.format = color_format;
            color = Texture2D(shape);
            shape.format = depth_format;
            depth = needs_depth ? Texture2D(shape) : Texture2D();
            resolved = needs_depth ? Framebuffer({color}, depth) : Framebuffer({color});
        }
        if (samples > 1 && !holds(multisampled_color, view, samples)) {
            TextureShape shape = shape_for(multisampled_color, view);
            shape.samples = samples;
            shape.format = color_format;
            multisampled_color = Texture2D(shape);
            shape.format = depth_format;
            multisampled_depth = Texture2D(shape);
            multisampled = Framebuffer({multisampled_color}, multisampled_depth);
        }
    }
    /// One depth a pixel, of those of several samples.
    void fit_edge_depth() {
        const Texture2D& like = multisampled_depth;
        if (edge_depth && edge_depth.width() == like.width() && edge_depth.height() == like.height()) return;
        edge_depth = Texture2D({.format = depth_format, .width = like.width(), .height = like.height()});
        edge_depth_target = Framebuffer({}, edge_depth);
    }
    void fit_layers(const SurfaceView& view) {
        if (holds(layer_depth_m, view, 0)) return;
        TextureShape shape = shape_for(layer_depth_m, view);
        shape.format = GL_R32F;
        layer_depth_m = Texture2D(shape);
        shape.format = GL_RGBA16F;
        layer_normal = Texture2D(shape);
        shape.format = GL_R32UI;
        layer_id = Texture2D(shape);
        shape.format = depth_format;
        layer_depth = Texture2D(shape);
        layers = Framebuffer({layer_depth_m, layer_normal, layer_id}, layer_depth);
    }
    static void fit(WithFocus& focused, const Texture2D& color, const Texture2D& depth) {
        if (focused.focus_share && focused.focus_share.width() == color.width() &&
            focused.focus_share.height() == color.height() && focused.color == color.name() &&
            focused.depth == depth.name())
            return;
        TextureShape shape;
        shape.width = color.width();
        shape.height = color.height();
        shape.format = GL_R32F;
        focused = {.focus_share = Texture2D(shape), .target = {}, .color = color.name(), .depth = depth.name()};
        focused.target = Framebuffer({color, focused.focus_share}, depth);
    }
    /// `focus` and `depth` may be null.
    static void fit(WithCoverage& covered, const Texture2D& color, const Texture2D* focus, const Texture2D* depth) {
        const std::array<GLuint, 3> beside{color.name(), focus != nullptr ? focus->name() : 0,
                                           depth != nullptr ? depth->name() : 0};
        if (covered.coverage && covered.beside == beside && covered.coverage.width() == color.width() &&
            covered.coverage.height() == color.height())
            return;
        covered = {.coverage = Texture2D(color.shape()), .target = {}, .beside = beside};
        std::vector<Attachment> colors{color};
        if (focus != nullptr) colors.emplace_back(*focus);
        colors.emplace_back(covered.coverage);
        covered.target = Framebuffer(colors, depth != nullptr ? Attachment(*depth) : Attachment());
    }
    static void fit(ColorAndDepth& pair, const SurfaceView& view, GLenum format, int samples = 0) {
        if (holds(pair.color, view, samples)) return;
        TextureShape shape = shape_for(pair.color, view);
        shape.samples = samples;
        shape.format = format;
        pair.color = Texture2D(shape);
        shape.format = depth_format;
        pair.depth = Texture2D(shape);
        pair.target = Framebuffer({pair.color}, pair.depth);
    }
};

}  // namespace matchlight
