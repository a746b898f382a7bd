// A drag over the height of the picture is half a turn; a shift keeps what is looked at under the pointer.
#include "preview/flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <imgui.h>

#include "preview/free_view.h"
#include "preview/picking.h"

namespace matchlight {

void toggle_flight(Session& session) {
    if (session.free_view()) return session.set_free_view({});
    const bool knows_place = session.picture() && session.picture()->camera_from_world;
    if (!knows_place) return;
    const ShotPicture& picture = *session.picture();
    const Camera& camera = picture.camera;
    constexpr double usual_m = 1, farthest_m = 100;  // a table's; towards the horizon there is no end
    double distance_m = usual_m;
    const auto ray = ray_of_pixel(camera, *picture.camera_from_world, {camera.width / 2.0, camera.height / 2.0});
    const auto met = ray ? meet(*ray, level_plane(session.scene().surface.z_m)) : std::nullopt;
    if (met) distance_m = std::min(farthest_m, (*met - ray->origin_m).norm());
    session.set_free_view(view_of_pose(*picture.camera_from_world, distance_m));
}

void lay_out_flight(const Region& area, const Canvas& canvas, bool hand_holds, Session& session) {
    if (!session.free_view() || !session.picture()) return;
    CameraView view = *session.free_view();
    const ImGuiIO& io = ImGui::GetIO();
    const bool turns = canvas.hand_is_free() && !hand_holds && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0);
    const CanvasMotion& motion = canvas.motion();
    const double half_turns = std::numbers::pi / std::max(1, area.height);
    if (turns) view = turned(view, io.MouseDelta.x * half_turns, io.MouseDelta.y * half_turns);
    if (!motion.drag_px.isZero()) {
        const double distance_m = (view.eye_m - view.target_m).norm();
        const double metres = distance_m / (session.picture()->camera.fx * canvas.zoom(area));
        view = shifted(view, -motion.drag_px.x() * metres, motion.drag_px.y() * metres);
    }
    constexpr double wheel_factor = 0.85;  // a step
    if (motion.wheel != 0) view = at_distance(view, std::pow(wheel_factor, motion.wheel));
    const bool stays = view.eye_m == session.free_view()->eye_m && view.target_m == session.free_view()->target_m;
    if (!stays) session.set_free_view(view);
}

}  // namespace matchlight
