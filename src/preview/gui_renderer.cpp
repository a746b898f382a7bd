// One buffer of corners and one of indices a list; parts of a list are cut to their rectangles.
#include "preview/gui_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

#include "gl/context.h"

namespace matchlight {

namespace {

/// Buffers have a fixed size: where one is too small, one of twice the need takes its place.
template <class Element>
bool fill(Buffer& buffer, std::span<const Element> elements) {
    const bool grows = buffer.bytes() < elements.size_bytes();
    if (grows) buffer = Buffer(2 * elements.size_bytes());
    buffer.upload(elements);
    return grows;
}

/// What of it lies in a part of the window.
Region cut(const ImDrawCmd& drawn, const Region& part) {
    if (drawn.ElemCount == 0) return {};
    const int left = static_cast<int>(std::floor(drawn.ClipRect.x)),
              top = static_cast<int>(std::floor(drawn.ClipRect.y));
    const int right = static_cast<int>(std::ceil(drawn.ClipRect.z)),
              bottom = static_cast<int>(std::ceil(drawn.ClipRect.w));
    return Region{left, top, right - left, bottom - top}.intersected(part);
}

}  // namespace

void GuiRenderer::make_glyphs() {
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    glyphs_ = Texture2D({.format = GL_RGBA8, .width = width, .height = height});
    glyphs_.upload(glyphs_.bounds(), std::span<const std::uint8_t>(pixels, std::size_t{4} * width * height));
    glyphs_.set_filter(Filter::linear);
}

void GuiRenderer::draw(const ImDrawData& data, const Framebuffer& target, const Region& part) {
    static_assert(sizeof(ImDrawIdx) == 2 || sizeof(ImDrawIdx) == 4);
    target.bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_SCISSOR_TEST);
    Program& program =
        shaders_.program({{GL_VERTEX_SHADER, "preview/gui.vert"}, {GL_FRAGMENT_SHADER, "preview/gui.frag"}});
    program.use();
    program.set("window_px", Eigen::Vector2f(static_cast<float>(target.width()), static_cast<float>(target.height())));
    program.set("glyphs", 0);
    for (const ImDrawList* list : std::span(data.CmdLists, static_cast<std::size_t>(data.CmdListsCount))) {
        if (std::ranges::none_of(list->CmdBuffer, [&](const ImDrawCmd& cmd) { return !cut(cmd, part).empty(); }))
            continue;
        const std::vector<std::uint32_t> indices(list->IdxBuffer.begin(), list->IdxBuffer.end());
        const bool corners_grew =
            fill(corners_, std::span<const ImDrawVert>(list->VtxBuffer.Data, list->VtxBuffer.size()));
        const bool indices_grew = fill(indices_, std::span<const std::uint32_t>(indices));
        if (corners_grew) {
            const std::array<VertexArray::Attribute, 3> attributes{{{0, 2, offsetof(ImDrawVert, pos)},
                                                                    {1, 2, offsetof(ImDrawVert, uv)},
                                                                    {2, 1, offsetof(ImDrawVert, col), true}}};
            vertices_.set_vertex_buffer(0, corners_, sizeof(ImDrawVert), attributes);
        }
        if (indices_grew) vertices_.set_index_buffer(indices_);
        vertices_.bind();
        for (const ImDrawCmd& drawn : list->CmdBuffer) {
            const Region seen = cut(drawn, part);
            if (seen.empty()) continue;
            glScissor(seen.x, seen.y, seen.width, seen.height);
            const auto* texture = static_cast<const Texture2D*>(drawn.GetTexID());
            (texture != nullptr ? *texture : glyphs_).bind(0);
            glDrawElementsBaseVertex(GL_TRIANGLES, static_cast<GLsizei>(drawn.ElemCount), GL_UNSIGNED_INT,
                                     reinterpret_cast<const void*>(std::size_t{4} * drawn.IdxOffset),  // NOLINT
                                     static_cast<GLint>(drawn.VtxOffset));
        }
    }
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_BLEND);
    check_no_gl_error("drawing the controls");
}

}  // namespace matchlight
