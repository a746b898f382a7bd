// Windows of ImGui's without frames, each where the layout has it.
#include "preview/window_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <imgui.h>

#include "compositor/quality.h"
#include "core/lowercase.h"
#include "preview/flight.h"
#include "preview/timeline.h"

namespace matchlight {

namespace {

constexpr ImGuiWindowFlags fixed_part = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;
const ImVec4 trouble_color{1.0f, 0.45f, 0.38f, 1};

void begin_part(const char* name, const Region& area, ImGuiWindowFlags flags = fixed_part) {
    ImGui::SetNextWindowPos({static_cast<float>(area.x), static_cast<float>(area.y)});
    ImGui::SetNextWindowSize({static_cast<float>(area.width), static_cast<float>(area.height)});
    ImGui::Begin(name, nullptr, flags);
}

void lay_out_shown(WindowParts& parts) {
    Canvas& canvas = parts.canvas;
    Controls& controls = parts.controls;
    const auto choose = [&](ShownKind kind, const char* name, const char* text, const char* tooltip) {
        bool on = canvas.shown == kind && parts.session.watched_pass().empty() && !parts.session.shown_probe();
        if (controls.toggle(name, text, on, tooltip)) {
            canvas.shown = on ? kind : ShownKind::composite;
            parts.session.watch("");
            parts.session.show_probe({});
        }
        ImGui::SameLine();
    };
    choose(ShownKind::composite, "view.composite", "Composite", "what render writes");
    choose(ShownKind::plate, "view.plate", "Plate", "the footage alone (p)");
    if (parts.state.has_truth) choose(ShownKind::truth, "view.truth", "Truth", "what --truth gave (t)");
    choose(ShownKind::difference, "view.flip", "FLIP",
           "where the composite differs from the truth, or without one from the plate (f)");
    controls.toggle("view.wipe", "Wipe", canvas.wipe,
                    "the composite on the left of a line that can be dragged, what is chosen on its right (w)");
    ImGui::SameLine();
    bool flies = parts.session.free_view().has_value();
    if (controls.toggle("view.free", "Fly", flies,
                        "leave the footage and fly around the scene, or come back (v): left button turns, right one "
                        "shifts, the wheel goes nearer")) {
        toggle_flight(parts.session);
    }
    ImGui::SameLine(0, 18 * parts.state.layout.scale);
    if (controls.button("view.fit", "Fit", "the whole picture (0); the wheel zooms, the right button drags"))
        canvas.fit();
    ImGui::SameLine();
    if (controls.button("view.pixels", "1:1", "a pixel of the picture is one of the screen (1)")) canvas.set_zoom(1);
}

void lay_out_level(Session& session, Controls& controls, float scale) {
    std::array<std::string_view, quality_levels.size() + 1> words;
    for (std::size_t i = 0; i < quality_levels.size(); ++i) words[i] = quality_levels[i].first;
    words.back() = "budget";
    const bool has_budget = session.facts() != nullptr && session.facts()->scene.budget_ms;
    ShotLevel level = session.level();
    std::size_t index = level.budget ? quality_levels.size() : static_cast<std::size_t>(level.level);
    ImGui::SetNextItemWidth(110 * scale);
    const std::span<const std::string_view> choices(words.data(), words.size() - (has_budget ? 0 : 1));
    if (controls.choice("level", "", index, choices, "how exactly it is drawn when nothing moves (l)")) {
        level.budget = index == quality_levels.size();
        if (!level.budget) level.level = static_cast<QualityLevel>(index);
        session.set_level(level);
    }
}

void lay_out_history(Session& session, Controls& controls) {
    if (session.facts() == nullptr) return;
    const SceneHistory& history = session.history();
    const std::string undone = history.undone_next() + " (ctrl+z)", redone = history.redone_next() + " (ctrl+shift+z)";
    if (controls.button("undo", "Undo", undone.c_str())) session.undo();
    ImGui::SameLine();
    if (controls.button("redo", "Redo", redone.c_str())) session.redo();
    ImGui::SameLine();
    bool modified = history.is_modified();
    if (controls.toggle("save", "Save", modified,
                        "the scene file, its remarks kept (ctrl+s); lit: there are changes")) {
        session.save();
    }
}

void lay_out_bar(const Layout& layout, WindowParts& parts) {
    begin_part("##bar", layout.bar);
    lay_out_shown(parts);
    ImGui::SameLine(0, 18 * parts.state.layout.scale);
    lay_out_level(parts.session, parts.controls, parts.state.layout.scale);
    ImGui::SameLine(0, 18 * parts.state.layout.scale);
    lay_out_history(parts.session, parts.controls);
    ImGui::SameLine();
    if (parts.controls.button("help", "Help", "all keys (f1)")) parts.state.help = !parts.state.help;
    ImGui::End();
}

std::string values_under_pointer(const WindowParts& parts) {
    const std::optional<Eigen::Vector2i>& at = parts.canvas.hovered();
    if (!at || !parts.session.picture()) return "";
    const ShotPicture& shown = *parts.session.picture();
    const bool plate = parts.canvas.shown == ShownKind::plate;
    const Image8& picture = plate                                    ? shown.plate
                            : parts.canvas.shown == ShownKind::truth ? shown.truth
                                                                     : shown.composite;
    if (!picture.bounds().contains(at->x(), at->y())) return "";
    const std::uint8_t* code = picture.pixel(at->x(), at->y());
    std::string text = fmt::format("{}, {}: code {} {} {}", at->x(), at->y(), code[0], code[1], code[2]);
    if (const ShotFacts* facts = parts.session.facts()) {
        std::array<double, 3> light{};
        for (int c = 0; c < 3; ++c)
            light[static_cast<std::size_t>(c)] = facts->solve.response.linear_from_code(code[c] / 255.0, c);
        text += fmt::format("  linear {:.4f} {:.4f} {:.4f}", light[0], light[1], light[2]);
    }
    return text;
}

/// What is done of work as a part of the line; where its end is not known, a part runs along it, once in two seconds.
void draw_progress(const Region& line, const WorkStage& stage, double busy_s, float scale) {
    constexpr double round_s = 2;
    const auto whole = static_cast<float>(line.width);
    float left = 0, part = 0.2f * whole;
    if (stage.all > 0) {
        part = whole * std::min(1.0f, static_cast<float>(stage.done) / static_cast<float>(stage.all));
    } else {
        left = (whole - part) * static_cast<float>(std::fmod(busy_s, round_s) / round_s);
    }
    const float x = static_cast<float>(line.x) + left, top = static_cast<float>(line.y);
    ImGui::GetWindowDrawList()->AddRectFilled({x, top}, {x + part, top + 2 * scale},
                                              ImGui::GetColorU32(ImGuiCol_PlotHistogram));
}

/// What takes long, how far it is, and a way out.
void lay_out_work(const Layout& layout, const WindowParts& parts) {
    const Session& session = parts.session;
    const WorkStage stage = session.stage();
    draw_progress(layout.status, stage, session.busy_s(), parts.state.layout.scale);
    std::string text = session.facts() == nullptr ? "loading" : "drawing";
    if (!stage.name.empty()) text += ": " + stage.name;
    if (stage.all > 0) text += fmt::format(" {} of {}", stage.done, stage.all);
    text += fmt::format(", {:.1f} s", session.busy_s());
    constexpr const char* way_out = "Give up";
    const ImGuiStyle& style = ImGui::GetStyle();
    const float button = ImGui::CalcTextSize(way_out).x + 2 * style.FramePadding.x;
    const float width = ImGui::CalcTextSize(text.c_str()).x + style.ItemSpacing.x + button;
    ImGui::SameLine(std::max(0.0f, ImGui::GetWindowContentRegionMax().x - width));
    ImGui::TextUnformatted(text.c_str());
    if (session.facts() == nullptr) return;  // there is nothing yet that could stay
    ImGui::SameLine();
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {style.FramePadding.x, 0});
    if (parts.controls.button("give_up", way_out, "the picture stays as it is until something is changed (escape)"))
        parts.press(PreviewAction::give_up);
    ImGui::PopStyleVar();
}

void lay_out_status(const Layout& layout, const WindowParts& parts) {
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {8 * parts.state.layout.scale, 3 * parts.state.layout.scale});
    begin_part("##status", layout.status);
    ImGui::PopStyleVar();
    const Session& session = parts.session;
    std::string right = session.picture() ? fmt::format("{:.0f} ms", session.picture()->ms) : "";
    if (parts.canvas.shown == ShownKind::difference && session.picture()) {
        right = fmt::format("mean FLIP against the {}: {:.4f}", session.picture()->flip_of_plate ? "plate" : "truth",
                            session.picture()->mean_flip);
    }
    const std::string sphere_mode = session.sphere_mode();
    if (!sphere_mode.empty()) right = sphere_mode + (right.empty() ? "" : ", ") + right;
    if (!session.trouble().empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, trouble_color);
        ImGui::TextUnformatted(session.trouble().c_str());
        ImGui::PopStyleColor();
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", session.trouble().c_str());
    } else {
        const bool shows_texture = session.picture() && !session.picture()->watched_words.empty();
        std::string left = shows_texture ? session.picture()->watched_words : values_under_pointer(parts);
        if (!parts.hand_says.empty()) left += (left.empty() ? "" : "   ") + parts.hand_says;
        ImGui::TextUnformatted(left.c_str());
        if (session.is_told()) {
            lay_out_work(layout, parts);
            ImGui::End();
            return;
        }
        ImGui::SameLine(std::max(0.0f, ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(right.c_str()).x));
        ImGui::TextUnformatted(right.c_str());
    }
    ImGui::End();
}

void lay_out_panel(const Layout& layout, WindowParts& parts) {
    begin_part("##panel", layout.panel);
    WindowState& state = parts.state;
    if (ImGui::BeginTabBar("panels", ImGuiTabBarFlags_FittingPolicyResizeDown)) {
        const std::span<const Panel> panels = window_panels();
        for (std::size_t i = 0; i < panels.size(); ++i) {
            const bool bring = state.open_panel && state.panel == i;
            if (!ImGui::BeginTabItem(std::string(panels[i].name).c_str(), nullptr,
                                     bring ? ImGuiTabItemFlags_SetSelected : 0)) {
                continue;
            }
            if (!state.open_panel) state.panel = i;
            ImGui::BeginChild("controls");
            ImGui::PushItemWidth(-0.42f * static_cast<float>(layout.panel.width));
            if (parts.session.facts() != nullptr) panels[i].lay_out(parts.session, parts.controls);
            ImGui::PopItemWidth();
            ImGui::EndChild();
            ImGui::EndTabItem();
        }
        ImGui::EndTabBar();
    }
    state.open_panel = false;
    ImGui::End();
}

/// Drags the border between picture and panel.
void lay_out_splitter(const Layout& layout, WindowState& state) {
    const float reach = 4 * state.layout.scale;
    const Region grip{layout.panel.x - static_cast<int>(reach), layout.panel.y, static_cast<int>(2 * reach),
                      layout.panel.height};
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
    begin_part("##splitter", grip,
               (fixed_part & ~ImGuiWindowFlags_NoBringToFrontOnFocus) | ImGuiWindowFlags_NoBackground);
    ImGui::PopStyleVar(2);
    ImGui::InvisibleButton("grip", {static_cast<float>(grip.width), static_cast<float>(grip.height)});
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive()) {
        const float dragged = state.layout.panel_width - ImGui::GetIO().MouseDelta.x / state.layout.scale;
        state.layout.panel_width = std::clamp(dragged, narrowest_panel, widest_panel);
    }
    ImGui::End();
}

void lay_out_help(const Layout& layout, WindowState& state) {
    const float scale = state.layout.scale;
    const auto width = static_cast<float>(layout.picture.width);
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({width / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSizeConstraints({320 * scale, 100 * scale}, {620 * scale, window.y - 20 * scale});
    ImGui::Begin("Keys and pointer", &state.help,
                 ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::PushTextWrapPos(580 * scale);
    ImGui::TextUnformatted(
        "Wheel: zoom about the pointer. Right or middle button: drag the picture. Timeline: drag to scrub. "
        "Left button: choose an object and drag it over what it stands on; its ring turns it, the square scales it, "
        "the "
        "knob above lifts it. With shift: focus there. Drop a model or a set of spheres to add it, a picture of light "
        "(.exr, .hdr) to light the scene by it.");
    ImGui::PopTextWrapPos();
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) {
        for (const PreviewKey& key : preview_keys()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key.name.c_str());
            ImGui::TableNextColumn();
            ImGui::PushTextWrapPos(580 * scale);
            ImGui::TextUnformatted(key.what.c_str());
            ImGui::PopTextWrapPos();
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

}  // namespace

std::span<const Panel> window_panels() {
    static constexpr std::array<Panel, 5> panels{{{"Objects", lay_out_objects_panel},
                                                  {"Light", lay_out_light_panel},
                                                  {"Lens", lay_out_lens_panel},
                                                  {"Effects", lay_out_effects_panel},
                                                  {"Passes", lay_out_passes_panel}}};
    return panels;
}

std::size_t panel_named(const std::string& name) {
    std::string known;
    const std::span<const Panel> panels = window_panels();
    for (std::size_t i = 0; i < panels.size(); ++i) {
        if (lowercase(panels[i].name) == lowercase(name)) return i;
        known += (i == 0 ? "" : ", ") + std::string(panels[i].name);
    }
    throw std::invalid_argument(fmt::format("there is no panel '{}'; there are {}", name, known));
}

void lay_out_window(const Layout& layout, WindowParts& parts) {
    if (parts.state.layout.panels) {
        lay_out_bar(layout, parts);
        lay_out_panel(layout, parts);
        lay_out_timeline(parts.session, parts.controls, layout.timeline, parts.state.layout.scale);
        lay_out_status(layout, parts);
        lay_out_splitter(layout, parts.state);
    }
    if (parts.state.help) lay_out_help(layout, parts.state);
}

}  // namespace matchlight
