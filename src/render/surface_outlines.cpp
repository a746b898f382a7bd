// Which objects have outlines, and what of their picture tells where.
#include "render/outlines.h"
#include "render/surface_object.h"
#include "render/surface_targets.h"

namespace matchlight {

void SurfaceRenderer::draw_outlines(const SurfaceView& view, const SurfaceShading& shading) {
    std::vector<ObjectOutline> outlined;
    for (const Object& object : objects_) {
        if (object.is_holdout || object.materials.empty()) continue;
        const ClassicShading& drawing = object.materials.front().shading;
        if (drawing.outline_px > 0) {
            outlined.push_back({.id = object.id,
                                .width_px = drawing.outline_px * view.density,
                                .color = Eigen::Vector3d(drawing.outline_color.data())});
        }
    }
    if (outlined.empty()) return;
    const SurfacePicture layers = draw_layers(view);
    outlines_->draw({.objects = outlined,
                     .depth_m = *layers.depth_m,
                     .normal = *layers.normal,
                     .object_id = *layers.object_id,
                     .width = view.width,
                     .height = view.height,
                     .clip_from_world = view.clip_from_world,
                     .target = targets_->resolved,
                     .bind_depth_cue = shading.fades_with_depth ? shading.bind : nullptr});
}

}  // namespace matchlight
