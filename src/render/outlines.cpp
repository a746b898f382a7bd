// First where edges are, then lines as wide as each object's.
#include "render/outlines.h"

#include <Eigen/LU>

namespace matchlight {

namespace {

/// × (pixel, 1): the ray, one metre along the camera's z, in world axes.
Eigen::Matrix3d world_from_pixel(const Eigen::Matrix4d& clip_from_world, int width, int height) {
    Eigen::Matrix3d ndc_from_world, ndc_from_pixel;
    ndc_from_world << clip_from_world.row(0).head<3>(), clip_from_world.row(1).head<3>(),
        clip_from_world.row(3).head<3>();
    ndc_from_pixel << 2.0 / width, 0, -1, 0, -2.0 / height, 1, 0, 0, 1;
    return ndc_from_world.inverse() * ndc_from_pixel;
}

}  // namespace

void ObjectOutlines::draw(const Input& input) {
    if (!edges_ || edges_.width() < input.width || edges_.height() < input.height) {
        edges_ = Texture2D({.format = GL_R8, .width = input.width, .height = input.height});
        edge_target_ = Framebuffer({edges_});
    }
    const Region region{0, 0, input.width, input.height};
    const Eigen::Vector2i size(input.width, input.height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    Program& edges = shaders_.full_screen("effects/outlines/edges.frag");
    edge_target_.bind(region);
    edges.use();
    edges.bind_texture("layer_depth_m", 0, input.depth_m);
    edges.bind_texture("layer_normal", 1, input.normal);
    edges.bind_texture("layer_object_id", 2, input.object_id);
    edges.set("picture_size", size);
    edges.set("world_from_pixel",
              Eigen::Matrix3f(world_from_pixel(input.clip_from_world, input.width, input.height).cast<float>()));
    triangle_.draw();

    ShaderDefines defines;
    if (input.bind_depth_cue) defines["DEPTH_CUE"] = "1";
    Program& lines = shaders_.full_screen("effects/outlines/draw.frag", defines);
    input.target.bind(region);
    lines.use();
    if (input.bind_depth_cue) {
        input.bind_depth_cue(lines);
        lines.bind_texture("layer_depth_m", 2, input.depth_m);
    }
    lines.bind_texture("edges", 0, edges_);
    lines.bind_texture("layer_object_id", 1, input.object_id);
    lines.set("picture_size", size);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_DST_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    for (const ObjectOutline& object : input.objects) {
        lines.set("object_id", static_cast<unsigned>(object.id));
        lines.set("width_px", object.width_px);
        lines.set("outline_color", Eigen::Vector3f(object.color.cast<float>()));
        triangle_.draw();
    }
    glDisable(GL_BLEND);
}

}  // namespace matchlight
