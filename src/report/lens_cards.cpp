// Planes that stand upright before a camera at the origin.
#include "report/lens_cards.h"

#include <algorithm>

#include "compositor/compositor.h"
#include "media/blank_source.h"

namespace matchlight {

LensCardShot lens_card_shot(const ThinLensView& view, const std::optional<DepthOfFieldSettings>& settings) {
    LensCardShot shot;
    Solve& solve = shot.solve;
    solve.footage_file = "cards";
    solve.frame_count = 1;
    Camera& camera = solve.camera;
    camera.width = view.width;
    camera.height = view.height;
    camera.fx = camera.fy = std::max(view.width, view.height);
    camera.cx = (view.width - 1) / 2.0;
    camera.cy = (view.height - 1) / 2.0;
    SolvedFrame frame;
    frame.camera_from_world = camera_looking_along(Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY());
    frame.exposure_ev = 0;
    solve.frames.push_back(frame);

    Scene& scene = shot.scene;
    scene.path = "cards";
    scene.surface.present = false;
    for (const LensCard& card : view.cards) {
        ObjectSettings plane;
        plane.shape = "plane";
        plane.rotate_deg.x() = 90;
        const double px_m = card.depth_m / camera.fx;
        plane.scale = {(card.right_px - card.left_px) * px_m, (card.bottom_px - card.top_px) * px_m, 1};
        plane.translate_m = {((card.left_px + card.right_px) / 2 - camera.cx) * px_m, card.depth_m,
                             -((card.top_px + card.bottom_px) / 2 - camera.cy) * px_m};
        // Reflects nothing of the even light that a scene without a probe has.
        plane.material.diffuse = plane.material.specular = {0, 0, 0};
        plane.material.emissive = {card.light[0], card.light[1], card.light[2]};
        scene.objects.push_back(plane);
    }
    if (settings) {
        DepthOfFieldSettings& lens = scene.effects.depth_of_field.emplace(*settings);
        lens.focus_on = FocusTarget::distance;
        lens.focus_distance_m = view.focus.focus_distance_m;
        lens.coc_scale_px_m = view.focus.coc_scale_px_m;
        lens.bokeh = view.bokeh;
    }
    return shot;
}

namespace {

/// One of the frame's layers, 0 where it does not reach.
ImageF drawn_layer(GlContext& context, const LensCardShot& shot, const Quality& quality, ImageF FrameLayers::*layer) {
    Warnings warnings;
    warnings.set_quiet(true);
    Compositor compositor(context, shot.scene, shot.solve, {.settings = without_rays(quality), .layers = true},
                          warnings);
    const Camera& camera = shot.solve.camera;
    BlankSource source({.path = "cards", .width = camera.width, .height = camera.height, .frames = 1, .fps = 25});
    const CompositedFrame frame = compositor.composite(*source.next());
    if (!frame.layers) return {};
    const ImageF& drawn = (*frame.layers).*layer;
    const Region& region = frame.layers->region;
    ImageF whole(camera.width, camera.height, drawn.channels());
    for (int y = 0; y < region.height; ++y) {
        std::ranges::copy(drawn.row(y), whole.pixel(region.x, region.y + y));
    }
    return whole;
}

}  // namespace

ImageF composited_cards(GlContext& context, const LensCardShot& shot, const Quality& quality) {
    return drawn_layer(context, shot, quality, &FrameLayers::virtual_rgba);
}

ImageF composited_frame(GlContext& context, const LensCardShot& shot, const Quality& quality) {
    return drawn_layer(context, shot, quality, &FrameLayers::beauty);
}

}  // namespace matchlight
