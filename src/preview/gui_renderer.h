// Draws the controls that Dear ImGui lays out, with the shader library and the objects of src/gl.
#pragma once

#include "gl/framebuffer.h"
#include "gl/shader_library.h"

struct ImDrawData;

namespace matchlight {

class GuiRenderer {
public:
    /// Takes the glyphs of ImGui's current context: again where its fonts change.
    void make_glyphs();
    /// Over what the framebuffer holds of `part`. Textures that ImGui draws are `const Texture2D*`; null are the
    /// glyphs.
    void draw(const ImDrawData& data, const Framebuffer& target, const Region& part);

private:
    ShaderLibrary shaders_;
    Texture2D glyphs_;
    Buffer corners_, indices_;
    VertexArray vertices_;
};

}  // namespace matchlight
