// Draws what stands for real things: shapes that hide what is virtual behind them.
#include <algorithm>

#include "gl/context.h"
#include "render/surface_object.h"

namespace matchlight {

bool SurfaceRenderer::is_holdout(std::size_t index) const {
    return objects_.at(index).is_holdout;
}

bool SurfaceRenderer::any_holdout() const {
    return std::ranges::any_of(objects_, &Object::is_holdout);
}

ShaderDefines SurfaceRenderer::view_defines(const SurfaceView& view) {
    ShaderDefines defines;
    if (view.lens) defines["LENS"] = "1";
    if (view.parts_coverage) defines["COVERAGE"] = view.lens ? "2" : "1";
    return defines;
}

void SurfaceRenderer::draw_real(Program& program, const SurfaceView& view, Drawn drawn,
                                const PlaceMore& place_more) const {
    // Transparent meshes come before what draw() left in the depth buffer.
    if (drawn == Drawn::transparent_light || !any_holdout()) return;
    const bool is_light = drawn == Drawn::light || drawn == Drawn::opaque_light || drawn == Drawn::hidden_light;
    Program& used = is_light ? shaders_.program({{GL_VERTEX_SHADER, "surface/surface.vert"},
                                                 {GL_FRAGMENT_SHADER, "surface/holdout.frag"}},
                                                view_defines(view))
                             : program;
    used.use();
    // How real things move tells what is hidden when; else only their depth counts.
    if (drawn == Drawn::layers) glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    if (is_light && !view.parts_coverage) glColorMaski(0, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    // They have no inside to see from: both sides hide.
    glDisable(GL_CULL_FACE);
    for (const Object& object : objects_) {
        if (!object.is_holdout) continue;
        place(used, view, object, place_more);
        for (const Mesh& mesh : object.meshes) {
            object.material_of(mesh).bind(used);
            mesh.geometry.draw();
        }
    }
    // Where only depth is drawn the caller has masked the colour already.
    if (drawn != Drawn::hidden_depth) glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    program.use();
}

}  // namespace matchlight
