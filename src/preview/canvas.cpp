// Places are kept in displayed pixels, so that zooming is about what lies under the pointer.
#include "preview/canvas.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <imgui.h>

namespace matchlight {

namespace {

constexpr double least_zoom = 1.0 / 32, most_zoom = 64;
constexpr double wheel_factor = 1.25;  // a step
constexpr float wipe_reach_px = 6;     // of its handle, at scale 1

}  // namespace

void Canvas::set_picture(ShownKind kind, const Image8& image, double pixel_aspect) {
    if (!picture(kind).set(image, pixel_aspect) && has_[static_cast<std::size_t>(kind)]) return;
    has_[static_cast<std::size_t>(kind)] = true;
    ++pictures_set_;
    displayed_ = picture(kind).displayed();
    picture_px_ = {image.width(), image.height()};
}

void Canvas::remove_picture(ShownKind kind) {
    if (std::exchange(has_[static_cast<std::size_t>(kind)], false)) ++pictures_set_;
}

Eigen::Vector4f Canvas::place(const Region& area) const {
    Eigen::Vector4f place;
    if (zoom_) {
        const double left = area.x + area.width / 2.0 - middle_.x() * *zoom_;
        const double top = area.y + area.height / 2.0 - middle_.y() * *zoom_;
        place =
            Eigen::Vector4d(std::round(left), std::round(top), displayed_.width * *zoom_, displayed_.height * *zoom_)
                .cast<float>();
    } else {
        place = letterbox(displayed_, area.width, area.height);
        place[0] += static_cast<float>(area.x);
        place[1] += static_cast<float>(area.y);
    }
    return place;
}

Eigen::Vector2d Canvas::pixel_at(const Eigen::Vector2d& window_px, const Region& area) const {
    const Eigen::Vector4d at = place(area).cast<double>();
    return {(window_px.x() - at[0]) / at[2] * picture_px_.x() - 0.5,
            (window_px.y() - at[1]) / at[3] * picture_px_.y() - 0.5};
}

Eigen::Vector2d Canvas::window_at(const Eigen::Vector2d& pixel, const Region& area) const {
    const Eigen::Vector4d at = place(area).cast<double>();
    return {at[0] + (pixel.x() + 0.5) / picture_px_.x() * at[2], at[1] + (pixel.y() + 0.5) / picture_px_.y() * at[3]};
}

void Canvas::set_zoom(double zoom) {
    if (!zoom_) middle_ = {displayed_.width / 2, displayed_.height / 2};
    zoom_ = std::clamp(zoom, least_zoom, most_zoom);
}

void Canvas::zoom_about(const Eigen::Vector2d& window_px, double factor, const Region& area) {
    const Eigen::Vector4d at = place(area).cast<double>();
    const double before = at[3] / displayed_.height;
    const Eigen::Vector2d under((window_px.x() - at[0]) / before, (window_px.y() - at[1]) / before);
    const double after = std::clamp(before * factor, least_zoom, most_zoom);
    zoom_ = after;
    middle_ = under - (window_px - Eigen::Vector2d(area.x + area.width / 2.0, area.y + area.height / 2.0)) / after;
}

double Canvas::wipe_x(const Region& area) const {
    return std::round(area.x + wipe_share_ * area.width);
}

void Canvas::lay_out(const Region& area, float scale) {
    ImGui::SetNextWindowPos({static_cast<float>(area.x), static_cast<float>(area.y)});
    ImGui::SetNextWindowSize({static_cast<float>(area.width), static_cast<float>(area.height)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::Begin("##picture", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoScrollWithMouse | ImGuiWindowFlags_NoNav);
    ImGui::PopStyleVar();
    ImGui::InvisibleButton(
        "picture", {static_cast<float>(area.width), static_cast<float>(area.height)},
        ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const ImGuiIO& io = ImGui::GetIO();
    const Eigen::Vector2d pointer(io.MousePos.x, io.MousePos.y);
    motion_ = {};
    if (hovered && leads_camera) motion_.wheel = io.MouseWheel;
    if (hovered && !leads_camera && io.MouseWheel != 0) {
        zoom_about(pointer, std::pow(wheel_factor, io.MouseWheel), area);
    }
    const bool at_wipe = wipe && hovered && std::abs(pointer.x() - wipe_x(area)) <= wipe_reach_px * scale;
    if (at_wipe && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) moves_wipe_ = true;
    if (!ImGui::IsMouseDown(ImGuiMouseButton_Left)) moves_wipe_ = false;
    if (moves_wipe_) wipe_share_ = std::clamp((pointer.x() - area.x) / std::max(1, area.width), 0.0, 1.0);
    hand_is_free_ = active && !moves_wipe_ && ImGui::IsMouseDown(ImGuiMouseButton_Left);
    const bool pans = active && (ImGui::IsMouseDragging(ImGuiMouseButton_Middle, 0) ||
                                 ImGui::IsMouseDragging(ImGuiMouseButton_Right, 0));
    if (pans && leads_camera) motion_.drag_px = {io.MouseDelta.x, io.MouseDelta.y};
    if (pans && !leads_camera && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
        if (!zoom_) zoom_about(pointer, 1, area);
        middle_ -= Eigen::Vector2d(io.MouseDelta.x, io.MouseDelta.y) / *zoom_;
    }
    hovered_.reset();
    if (hovered) {
        const Eigen::Vector2d pixel = pixel_at(pointer, area);
        const Eigen::Vector2i whole(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
        if (Region{0, 0, picture_px_.x(), picture_px_.y()}.contains(whole.x(), whole.y())) hovered_ = whole;
    }
    if (wipe) {
        const auto x = static_cast<float>(wipe_x(area));
        ImGui::GetWindowDrawList()->AddLine(
            {x, static_cast<float>(area.y)}, {x, static_cast<float>(area.y + area.height)},
            at_wipe || moves_wipe_ ? IM_COL32(255, 200, 60, 255) : IM_COL32(255, 255, 255, 160), scale);
    }
    ImGui::End();
}

bool Canvas::take_change(const Region& area) {
    const Look look{.pictures = pictures_set_,
                    .shown = shown,
                    .wipe_x = wipe ? std::optional(wipe_x(area)) : std::nullopt,
                    .leads_camera = leads_camera,
                    .place = place(area)};
    return std::exchange(look_, look) != look;
}

void Canvas::draw(PictureView& view, const Region& area) {
    const auto has = [&](ShownKind kind) { return has_[static_cast<std::size_t>(kind)]; };
    const Eigen::Vector4f at = place(area);
    const ShownKind kind = has(ShownKind::texture) ? ShownKind::texture : has(shown) ? shown : ShownKind::composite;
    if (has(kind)) view.draw(picture(kind), at, area);
    if (!wipe || !has(ShownKind::composite) || leads_camera) return;
    // Of the composite with itself nothing could be seen: the plate is on the right.
    if (kind == ShownKind::composite && has(ShownKind::plate)) view.draw(picture(ShownKind::plate), at, area);
    Region left = area;
    left.width = static_cast<int>(std::lround(wipe_x(area))) - area.x;
    if (!left.empty()) view.draw(picture(ShownKind::composite), at, left);
}

}  // namespace matchlight
