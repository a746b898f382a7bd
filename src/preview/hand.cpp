// Handles go before objects, objects before the surface.
#include "preview/hand.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <imgui.h>

#include "compositor/scene_objects.h"
#include "core/error.h"
#include "preview/object_keys.h"

namespace matchlight {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double ring_px = 70, knob_reach_px = 10, ring_reach_px = 7;  // at scale 1
constexpr int ring_points = 64;
constexpr float knob_px = 5;

/// What of an object decides which triangles and spheres it has.
ObjectSettings shape_of(const ObjectSettings& object) {
    ObjectSettings shape;
    shape.model = object.model;
    shape.shape = object.shape;
    shape.spheres = object.spheres;
    shape.sphere = object.sphere;
    shape.animation = object.animation;
    return shape;
}

double distance_to_segment(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
    const Vector2d along = to - from;
    const double length = along.squaredNorm();
    const double share = length > 0 ? std::clamp((point - from).dot(along) / length, 0.0, 1.0) : 0;
    return (from + share * along - point).norm();
}

ImVec2 at(const Vector2d& place) {
    return {static_cast<float>(place.x()), static_cast<float>(place.y())};
}

std::vector<double> list_of(const Vector3d& xyz) {
    return {xyz.begin(), xyz.end()};
}

Vector3d to_tenths_of_a_millimetre(const Vector3d& metres) {
    constexpr double steps = 1e4;
    return (metres * steps).array().round() / steps;
}

const char* verb_of(Grip grip) {
    switch (grip) {
        case Grip::turn:
            return "turn";
        case Grip::size:
            return "scale";
        case Grip::lift:
            return "lift";
        default:
            return "move";
    }
}

}  // namespace

struct Hand::Sight {
    const Session& session;
    const Scene& scene;
    const Solve& solve;
    const ShotPicture& picture;
    const Canvas& canvas;
    Region area;
    double scale;
    Vector2d pointer_px;
    bool on_picture;  // the pointer, and on nothing else

    ClipTime time() const { return {static_cast<double>(picture.frame), picture.time_s}; }
    std::optional<PixelRay> ray() const {
        return ray_of_pixel(picture.camera, *picture.camera_from_world, canvas.pixel_at(pointer_px, area));
    }
    std::optional<Vector2d> window_of(const Vector3d& point_m) const {
        const std::optional<Vector2d> pixel = pixel_of_point(picture.camera, *picture.camera_from_world, point_m);
        if (!pixel) return std::nullopt;
        return canvas.window_at(*pixel, area);
    }
    /// Those of them that can be seen.
    std::vector<Vector2d> window_line(const std::vector<Vector3d>& points_m) const {
        std::vector<Vector2d> places;
        for (const Vector3d& point_m : points_m) {
            if (const auto place = window_of(point_m)) places.push_back(*place);
        }
        return places;
    }
};

void Hand::keep_targets(const Scene& scene) {
    if (loading_.valid()) {
        if (loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        try {
            targets_ = loading_.get();
        } catch (const InputError&) {
            targets_ = {};  // the drawing thread tells what is wrong with it
        }
    }
    std::vector<ObjectSettings> shapes;
    for (const ObjectSettings& object : scene.objects) shapes.push_back(shape_of(object));
    if (shapes == of_targets_) return;
    of_targets_ = std::move(shapes);
    loading_ = std::async(std::launch::async, [scene, targets = std::move(targets_)]() mutable {
        targets.set_scene(scene);
        return std::move(targets);
    });
    targets_ = {};
}

std::optional<Handles> Hand::handles_of(const Sight& sight, std::size_t object) const {
    const ObjectSettings& settings = sight.scene.objects[object];
    Handles handles;
    handles.world_from_parent = world_from_parent(settings, sight.solve, sight.scene.path);
    handles.centre_m = handles.world_from_parent * placing_at(settings, sight.picture.frame).translate_m;
    const double depth_m = (*sight.picture.camera_from_world * handles.centre_m).z();
    const double zoom = sight.canvas.zoom(sight.area);
    handles.radius_m = ring_px * sight.scale / zoom * depth_m / sight.picture.camera.fx;
    if (!(depth_m > 0) || !(handles.radius_m > 0)) return std::nullopt;
    return handles;
}

Hand::Under Hand::under(const Sight& sight) const {
    const auto near = [&](const Vector3d& point_m, double reach_px) {
        const std::optional<Vector2d> place = sight.window_of(point_m);
        return place && (*place - sight.pointer_px).norm() <= reach_px * sight.scale;
    };
    if (const std::optional<std::size_t> chosen = sight.session.chosen()) {
        if (const std::optional<Handles> handles = handles_of(sight, *chosen)) {
            const auto by = [&](Grip grip) { return Under{chosen, {grip, handles->centre_m}}; };
            if (near(handles->size_knob(), knob_reach_px)) return by(Grip::size);
            if (near(handles->lift_knob(), knob_reach_px)) return by(Grip::lift);
            if (near(handles->centre_m, knob_reach_px)) return by(Grip::move);
            const std::vector<Vector2d> ring = sight.window_line(handles->ring(ring_points));
            for (std::size_t i = 1; i < ring.size(); ++i) {
                const double away_px = distance_to_segment(sight.pointer_px, ring[i - 1], ring[i]);
                if (away_px <= ring_reach_px * sight.scale) return by(Grip::turn);
            }
        }
    }
    const std::optional<PixelRay> ray = sight.ray();
    if (!ray) return {};
    const auto placements = placements_of(sight.scene, sight.solve, sight.time());
    const std::optional<Pick> pick = targets_.first_object(*ray, placements);
    return pick ? Under{pick->object, {Grip::move, pick->point_m}} : Under{};
}

void Hand::grab(const Sight& sight, Session& session) {
    const Under taken = under(sight);
    session.choose(taken.object);
    held_.reset();
    if (!taken.object) return;
    const std::optional<PixelRay> ray = sight.ray();
    const std::optional<Handles> handles = handles_of(sight, *taken.object);
    if (!ray || !handles) return;
    const ObjectSettings& object = sight.scene.objects[*taken.object];
    const Placing before = placing_at(object, sight.picture.frame);
    if (auto drag = HandleDrag::begin(taken.grab, before, *handles, *ray)) {
        held_ = Held{*taken.object, *drag};
    }
}

void Hand::drag_on(const Sight& sight, Session& session) {
    const std::optional<PixelRay> ray = sight.ray();
    const std::optional<Placing> placing = ray ? held_->drag.to(*ray) : std::nullopt;
    if (!placing) return;
    const Grip grip = held_->drag.grip();
    session.change(
        [&](SceneText& text) {
            set_placing(text, fmt::format("object[{}]", held_->object), sight.scene.objects[held_->object],
                        sight.picture.frame, grip, *placing);
        },
        fmt::format("{} object[{}]", verb_of(grip), held_->object), verb_of(grip));
}

void Hand::focus(const Sight& sight, Session& session) const {
    const std::optional<PixelRay> ray = sight.ray();
    if (!ray) return;
    const auto placements = placements_of(sight.scene, sight.solve, sight.time());
    const std::optional<Pick> pick = targets_.first(*ray, placements, sight.scene.surface);
    if (!pick) return;
    // A point of the world stays sharp wherever the camera goes.
    const Vector3d point_m = to_tenths_of_a_millimetre(pick->point_m);
    session.change(
        [&](SceneText& text) {
            const std::string key = "effects.depth_of_field";
            text.set(key + ".point", list_of(point_m));
            text.set(key + ".focus_on", std::string("point"));
            text.remove(key + ".object");
        },
        "focus", "focus");
}

void Hand::draw(const Sight& sight, const Under& under) const {
    const std::optional<std::size_t> chosen = sight.session.chosen();
    const std::optional<Handles> handles = chosen ? handles_of(sight, *chosen) : std::nullopt;
    if (!handles) return;
    const auto scale = static_cast<float>(sight.scale);
    const ImU32 usual = IM_COL32(255, 255, 255, 210), lit = IM_COL32(255, 200, 60, 255), dark = IM_COL32(0, 0, 0, 140);
    const auto color_of = [&](Grip grip) {
        const bool is_held = held_ && held_->drag.grip() == grip;
        const bool is_under = !held_ && sight.on_picture && under.object == chosen && under.grab.grip == grip;
        return is_held || is_under ? lit : usual;
    };
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    const Region& area = sight.area;
    list->PushClipRect({static_cast<float>(area.x), static_cast<float>(area.y)},
                       {static_cast<float>(area.x + area.width), static_cast<float>(area.y + area.height)});
    const auto line = [&](const std::vector<Vector3d>& points_m, ImU32 color) {
        std::vector<ImVec2> places;
        for (const Vector2d& place : sight.window_line(points_m)) places.push_back(at(place));
        const int count = static_cast<int>(places.size());
        list->AddPolyline(places.data(), count, dark, 0, 4 * scale);
        list->AddPolyline(places.data(), count, color, 0, 1.8f * scale);
    };
    const auto knob = [&](const Vector3d& point_m, Grip grip, bool round) {
        const std::optional<Vector2d> place = sight.window_of(point_m);
        if (!place) return;
        const ImVec2 middle = at(*place);
        const float half = knob_px * scale;
        if (round) {
            list->AddCircleFilled(middle, half + scale, dark);
            list->AddCircleFilled(middle, half, color_of(grip));
        } else {
            list->AddRectFilled({middle.x - half - scale, middle.y - half - scale},
                                {middle.x + half + scale, middle.y + half + scale}, dark);
            list->AddRectFilled({middle.x - half, middle.y - half}, {middle.x + half, middle.y + half}, color_of(grip));
        }
    };
    line(handles->ring(ring_points), color_of(Grip::turn));
    line({handles->centre_m, handles->size_knob()}, color_of(Grip::size));
    line({handles->centre_m, handles->lift_knob()}, color_of(Grip::lift));
    knob(handles->centre_m, Grip::move, true);
    knob(handles->lift_knob(), Grip::lift, true);
    knob(handles->size_knob(), Grip::size, false);
    list->PopClipRect();
}

std::string Hand::told(const Sight& sight, const Under& under) const {
    const auto name_of = [&](std::size_t object) { return sight.scene.objects[object].name; };
    if (focuses_) {
        const auto& depth_of_field = sight.scene.effects.depth_of_field;
        if (!depth_of_field) return "";
        return fmt::format("focus on {:.4g} m", fmt::join(depth_of_field->focus_point_m, ", "));
    }
    if (held_ && held_->object < sight.scene.objects.size()) {
        const ObjectSettings& object = sight.scene.objects[held_->object];
        const Placing placing = placing_at(object, sight.picture.frame);
        switch (held_->drag.grip()) {
            case Grip::turn:
                return fmt::format("{}: turned to {:.4g}°", object.name, placing.rotate_deg.z());
            case Grip::size:
                return fmt::format("{}: scaled by {:.4g}", object.name, placing.scale.x());
            default:
                return fmt::format("{}: at {:.4g} m", object.name, fmt::join(list_of(placing.translate_m), ", "));
        }
    }
    if (!sight.on_picture || !under.object) return "";
    const bool has_keys = !sight.scene.objects[*under.object].keys.empty();
    return fmt::format("{}: drag to {} it{}", name_of(*under.object), verb_of(under.grab.grip),
                       has_keys ? fmt::format(" at frame {}", sight.picture.frame) : "");
}

void Hand::lay_out(const Region& area, float scale, const Canvas& canvas, Session& session) {
    says_.clear();
    if (session.facts() == nullptr || !session.picture() || !session.picture()->camera_from_world) return;
    keep_targets(session.scene());
    const ImGuiIO& io = ImGui::GetIO();
    // Anew behind every change: that makes another scene.
    const auto sight = [&] {
        return Sight{.session = session,
                     .scene = session.scene(),
                     .solve = session.facts()->solve,
                     .picture = *session.picture(),
                     .canvas = canvas,
                     .area = area,
                     .scale = scale,
                     .pointer_px = {io.MousePos.x, io.MousePos.y},
                     .on_picture = canvas.hovered().has_value()};
    };
    const Vector2d pointer_px(io.MousePos.x, io.MousePos.y);
    const bool down = canvas.hand_is_free();
    // While it plays nothing is told of what lies under the pointer.
    if (down || (canvas.hovered() && !session.playing())) targets_.set_time(session.picture()->time_s);
    const bool goes_down = down && !down_, moved = pointer_px != last_px_;
    down_ = down;
    last_px_ = pointer_px;
    if (!down) {
        held_.reset();
        focuses_ = false;
    }
    if (goes_down) focuses_ = io.KeyShift;
    if (focuses_ && (goes_down || moved)) {
        focus(sight(), session);
    } else if (goes_down) {
        grab(sight(), session);
    } else if (moved && held_) {
        drag_on(sight(), session);
    }
    const Sight now = sight();
    const Under found = now.on_picture && !down && !session.playing() ? under(now) : Under{};
    draw(now, found);
    says_ = told(now, found);
}

void Hand::drop(const std::filesystem::path& file, const Vector2d& window_px, const Region& area, const Canvas& canvas,
                Session& session) const {
    Vector3d place_m(0, 0, 0);
    if (session.facts() != nullptr && session.picture() && session.picture()->camera_from_world) {
        const ShotPicture& picture = *session.picture();
        const auto ray = ray_of_pixel(picture.camera, *picture.camera_from_world, canvas.pixel_at(window_px, area));
        const auto met = ray ? meet(*ray, level_plane(session.scene().surface.z_m)) : std::nullopt;
        if (met) place_m = to_tenths_of_a_millimetre(*met);
    }
    session.take_file(file, place_m);
}

}  // namespace matchlight
