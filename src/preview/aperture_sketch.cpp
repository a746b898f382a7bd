// A click adds a corner, a click of the right button takes the last away.
#include "preview/aperture_sketch.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

#include "core/content_hash.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

constexpr std::size_t least_corners = 3;

/// By the even-odd rule.
bool is_inside(std::span<const Eigen::Vector2d> corners, const Eigen::Vector2d& point) {
    bool inside = false;
    for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
        const Eigen::Vector2d &a = corners[i], &b = corners[before];
        if ((a.y() > point.y()) == (b.y() > point.y())) continue;
        const double crossing = a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
        if (point.x() < crossing) inside = !inside;
    }
    return inside;
}

void draw_sketch(std::span<const Eigen::Vector2d> corners, const ImVec2& from, float side) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(from, {from.x + side, from.y + side}, IM_COL32(10, 10, 10, 255));
    std::vector<ImVec2> places;
    for (const Eigen::Vector2d& corner : corners) {
        places.push_back(
            {from.x + side * static_cast<float>(corner.x()), from.y + side * static_cast<float>(corner.y())});
    }
    list.AddPolyline(places.data(), static_cast<int>(places.size()), IM_COL32(255, 255, 255, 230), ImDrawFlags_Closed,
                     2);
    for (const ImVec2& place : places) list.AddCircleFilled(place, 3, IM_COL32(255, 200, 60, 255), 8);
}

}  // namespace

Image8 picture_of_polygon(std::span<const Eigen::Vector2d> corners, int side) {
    constexpr int samples = 4;  // along a pixel's side
    Image8 picture(side, side, 3);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            int inside = 0;
            for (int row = 0; row < samples; ++row) {
                for (int column = 0; column < samples; ++column) {
                    const Eigen::Vector2d at(x + (column + 0.5) / samples, y + (row + 0.5) / samples);
                    inside += is_inside(corners, at / side) ? 1 : 0;
                }
            }
            const auto code = static_cast<std::uint8_t>(std::lround(255.0 * inside / (samples * samples)));
            std::fill_n(picture.pixel(x, y), 3, code);
        }
    }
    return picture;
}

std::filesystem::path write_aperture(const std::filesystem::path& scene, std::span<const Eigen::Vector2d> corners) {
    ContentHash hash;
    for (const Eigen::Vector2d& corner : corners) hash.add(fmt::format("{:.4f} {:.4f};", corner.x(), corner.y()));
    constexpr std::size_t digits = 8;
    constexpr int side = 256;
    std::filesystem::path path = scene;
    path.replace_extension(fmt::format("aperture-{}.png", hash.hex().substr(0, digits)));
    write_png8(path, picture_of_polygon(corners, side));
    return path;
}

void lay_out_aperture_sketch(Session& session, Controls& controls, const std::string& key) {
    std::vector<Eigen::Vector2d>& corners = session.aperture_corners();
    ImGui::TextWrapped("Draw the opening: a click adds a corner, the right button takes the last away.");
    const float side = std::min(ImGui::GetContentRegionAvail().x, 12 * ImGui::GetTextLineHeight());
    const ImVec2 from = ImGui::GetCursorScreenPos();
    const auto place_of = [&](const ImVec2& at) {
        return Eigen::Vector2d(std::clamp((at.x - from.x) / side, 0.0f, 1.0f),
                               std::clamp((at.y - from.y) / side, 0.0f, 1.0f));
    };
    if (controls.area(key + ".draw", side)) corners.push_back(place_of(ImGui::GetIO().MousePos));
    if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Right) && !corners.empty()) corners.pop_back();
    draw_sketch(corners, from, side);
    if (corners.size() >= least_corners &&
        controls.button(key + ".take", "Take", "write it as a picture beside the scene: the aperture's image")) {
        session.attempt([&] {
            const std::filesystem::path path = write_aperture(session.scene().path, corners);
            session.set(key + ".image", path.filename().string());
        });
    }
    if (corners.empty()) return;
    if (corners.size() >= least_corners) ImGui::SameLine();
    if (controls.button(key + ".clear", "Clear", "all corners")) corners.clear();
}

}  // namespace matchlight
