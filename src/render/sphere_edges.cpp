// Outlines first, where neighbours differ; then shares.
#include "render/sphere_edges.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

namespace matchlight {

namespace {

constexpr GLuint seen_unit = 25, outline_unit = 27, depth_unit = 28, before_unit = 16;

}  // namespace

Eigen::Matrix3d camera_from_ndc(const Eigen::Matrix3d& axes_from_world) {
    const Eigen::RowVector3d x = axes_from_world.row(0), y = axes_from_world.row(1), w = axes_from_world.row(2);
    const Eigen::RowVector3d forward = w.normalized();
    const Eigen::RowVector3d y_square = y - y.dot(forward) * forward;
    const Eigen::RowVector3d up = y_square.normalized();
    const double along_up = x.dot(up);
    const Eigen::RowVector3d x_square = x - x.dot(forward) * forward - along_up * up;
    Eigen::Matrix3d ndc_from_camera;
    ndc_from_camera << x_square.norm(), along_up, x.dot(forward), 0, y_square.norm(), y.dot(forward), 0, 0, w.norm();
    return ndc_from_camera.inverse();
}

void SphereEdges::fit(const Picture& picture) {
    if (!outline_ || outline_.width() < picture.width || outline_.height() < picture.height) {
        const Texture2D& like = *picture.drawn.front();
        outline_ = Texture2D({.format = GL_RGBA32F, .width = like.width(), .height = like.height()});
        outline_target_ = Framebuffer({outline_});
    }
    std::vector<GLuint> names;
    std::vector<Attachment> attachments;
    for (std::size_t i = 0; i < picture.drawn.size(); ++i) {
        const Texture2D& drawn = *picture.drawn[i];
        names.push_back(drawn.name());
        attachments.emplace_back(drawn);
        Texture2D& before = before_.at(i);
        if (!before || before.width() != drawn.width() || before.height() != drawn.height() ||
            before.shape().format != drawn.shape().format) {
            before = Texture2D(drawn.shape());
        }
    }
    if (names == target_names_) return;
    target_ = Framebuffer(attachments);
    target_names_ = std::move(names);
}

void SphereEdges::soften(const Picture& picture, const std::function<void(Program&)>& each) {
    assert(!picture.drawn.empty() && picture.drawn.size() <= before_.size());
    assert(picture.side >= 2 && picture.side <= most_edge_places);
    fit(picture);
    const Region region{0, 0, picture.width, picture.height};
    const Eigen::Vector2i size(picture.width, picture.height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    Program& outline = shaders_.full_screen("spheres/outline.frag");
    outline_target_.bind(region);
    outline.use();
    outline.bind_texture("seen_spheres", seen_unit, *picture.seen.id);
    outline.set("size_px", size);
    each(outline);

    Program& edges =
        shaders_.full_screen("spheres/edges.frag", {{"PICTURES", fmt::format("{}", picture.drawn.size())}});
    edges.use();
    edges.bind_texture("seen_spheres", seen_unit, *picture.seen.id);
    edges.bind_texture("seen_depth", seen_unit + 1, *picture.seen.depth_share);
    edges.bind_texture("outlines", outline_unit, outline_);
    edges.bind_texture("drawn_depth", depth_unit, *picture.depth);
    for (std::size_t i = 0; i < picture.drawn.size(); ++i) {
        glCopyImageSubData(picture.drawn[i]->name(), GL_TEXTURE_2D, 0, 0, 0, 0, before_.at(i).name(), GL_TEXTURE_2D, 0,
                           0, 0, 0, picture.width, picture.height, 1);
        edges.bind_texture(fmt::format("before_{}", i), before_unit + static_cast<GLuint>(i), before_.at(i));
    }
    edges.set("size_px", size);
    edges.set("side", picture.side);
    edges.set("near_m", picture.near_m);
    edges.set("camera_from_ndc", Eigen::Matrix3f(picture.camera_from_ndc.cast<float>()));
    target_.bind(region);
    triangle_.draw();
}

}  // namespace matchlight
