// Colours: green a solved pose, amber one bridged, red none; yellow exposure, blue the focus distance; white keys.
#include "preview/timeline.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui.h>

namespace matchlight {

namespace {

constexpr ImU32 solved_color = IM_COL32(74, 148, 92, 255), bridged_color = IM_COL32(206, 150, 50, 255),
                gap_color = IM_COL32(176, 60, 52, 255), exposure_color = IM_COL32(238, 206, 96, 255),
                focus_color = IM_COL32(104, 176, 240, 255), back_color = IM_COL32(22, 23, 25, 255),
                here_color = IM_COL32(255, 255, 255, 230), key_color = IM_COL32(255, 255, 255, 200);

/// Where frames lie on the strip.
struct Strip {
    ImVec2 from, to;
    std::int64_t count = 1;

    float x(double frame) const {
        return from.x + (to.x - from.x) * static_cast<float>((frame + 0.5) / static_cast<double>(count));
    }
    std::int64_t frame(float at) const {
        const double share = (at - from.x) / std::max(1.0f, to.x - from.x);
        return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(share * static_cast<double>(count))), 0,
                                        count - 1);
    }
};

void draw_poses(const Solve& solve, const Strip& strip, float top) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled({strip.from.x, top}, strip.to, gap_color);
    for (const SolvedFrame& frame : solve.frames) {
        if (!frame.camera_from_world) continue;
        const double index = static_cast<double>(frame.frame);
        list.AddRectFilled({strip.x(index - 0.5), top}, {strip.x(index + 0.5), strip.to.y},
                           frame.bridged ? bridged_color : solved_color);
    }
}

void draw_curve(const Solve& solve, const Strip& strip, float bottom, std::optional<double> SolvedFrame::*curve,
                ImU32 color) {
    const std::optional<CurveRange> range = range_of(solve, curve);
    if (!range) return;
    const double span = range->highest - range->lowest;
    std::optional<ImVec2> before;
    std::int64_t frame_before = 0;
    for (const SolvedFrame& frame : solve.frames) {
        const std::optional<double>& value = frame.*curve;
        if (!value) continue;
        // What does not change is drawn in the middle.
        const double height = span > 0 ? (*value - range->lowest) / span : 0.5;
        const float margin = 3;
        const float y = bottom - margin - static_cast<float>(height) * (bottom - strip.from.y - 2 * margin);
        const ImVec2 at(strip.x(static_cast<double>(frame.frame)), y);
        if (before && frame.frame == frame_before + 1) ImGui::GetWindowDrawList()->AddLine(*before, at, color, 1.5f);
        ImGui::GetWindowDrawList()->AddCircleFilled(at, 1.5f, color, 6);
        before = at;
        frame_before = frame.frame;
    }
}

/// A diamond for each key that the object moves by.
void draw_keys(const ObjectSettings& object, const Strip& strip, float scale) {
    const float half = 5 * scale, middle = strip.from.y + half + scale;
    for (const ObjectKey& key : object.keys) {
        const float x = strip.x(static_cast<double>(key.frame));
        ImGui::GetWindowDrawList()->AddQuadFilled({x, middle - half}, {x + half, middle}, {x, middle + half},
                                                  {x - half, middle}, key_color);
    }
}

void legend(const Solve& solve, const char* name, const char* unit, std::optional<double> SolvedFrame::*curve,
            ImU32 color) {
    const std::optional<CurveRange> range = range_of(solve, curve);
    if (!range) return;
    ImGui::SameLine();
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextUnformatted(fmt::format("{} {:.3g} to {:.3g} {}", name, range->lowest, range->highest, unit).c_str());
    ImGui::PopStyleColor();
}

void lay_out_buttons(Session& session, Controls& controls) {
    const std::int64_t last = session.frame_count() - 1;
    if (controls.button("first", "|<", "the first frame (home)")) session.go_to(0);
    ImGui::SameLine();
    if (controls.button("back", "<", "a frame back (left; ten: page up)")) session.step(-1);
    ImGui::SameLine();
    if (controls.button("play", session.playing() ? "Pause" : "Play", "by the footage's time stamps (space)")) {
        session.play(!session.playing());
    }
    ImGui::SameLine();
    if (controls.button("on", ">", "a frame on (right; ten: page down)")) session.step(1);
    ImGui::SameLine();
    if (controls.button("last", ">|", "the last frame (end)")) session.go_to(last);
    ImGui::SameLine();
    ImGui::TextUnformatted(fmt::format("frame {} of {}  {:.3f} s ", session.frame(), session.frame_count(),
                                       session.picture() ? session.picture()->time_s : 0.0)
                               .c_str());
}

}  // namespace

std::optional<CurveRange> range_of(const Solve& solve, std::optional<double> SolvedFrame::*curve) {
    std::optional<CurveRange> range;
    for (const SolvedFrame& frame : solve.frames) {
        const std::optional<double>& value = frame.*curve;
        if (!value) continue;
        if (!range) range = CurveRange{*value, *value};
        range->lowest = std::min(range->lowest, *value);
        range->highest = std::max(range->highest, *value);
    }
    return range;
}

void lay_out_timeline(Session& session, Controls& controls, const Region& area, float scale) {
    ImGui::SetNextWindowPos({static_cast<float>(area.x), static_cast<float>(area.y)});
    ImGui::SetNextWindowSize({static_cast<float>(area.width), static_cast<float>(area.height)});
    ImGui::Begin("##timeline", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
    const ShotFacts* facts = session.facts();
    if (facts != nullptr && area.height > 0) {
        lay_out_buttons(session, controls);
        legend(facts->solve, "exposure", "EV", &SolvedFrame::exposure_ev, exposure_color);
        legend(facts->solve, "focus", "m", &SolvedFrame::focus_distance_m, focus_color);
        const ImVec2 room = ImGui::GetContentRegionAvail();
        if (room.x > 1 && room.y > 1) {
            const ImVec2 from = ImGui::GetCursorScreenPos();
            const Strip strip{
                from, {from.x + room.x, from.y + room.y}, std::max<std::int64_t>(1, session.frame_count())};
            ImGui::InvisibleButton("strip", room);
            if (ImGui::IsItemActive()) {
                const std::int64_t frame = strip.frame(ImGui::GetIO().MousePos.x);
                if (frame != session.frame() || session.playing()) {
                    session.play(false);
                    session.go_to(frame);
                }
            }
            ImGui::GetWindowDrawList()->AddRectFilled(strip.from, strip.to, back_color);
            const float poses_top = strip.to.y - 7 * scale;
            draw_poses(facts->solve, strip, poses_top);
            draw_curve(facts->solve, strip, poses_top, &SolvedFrame::exposure_ev, exposure_color);
            draw_curve(facts->solve, strip, poses_top, &SolvedFrame::focus_distance_m, focus_color);
            if (session.chosen()) draw_keys(session.scene().objects[*session.chosen()], strip, scale);
            const float here = strip.x(static_cast<double>(session.frame()));
            ImGui::GetWindowDrawList()->AddLine({here, strip.from.y}, {here, strip.to.y}, here_color, 2 * scale);
        }
    }
    ImGui::End();
}

}  // namespace matchlight
