// A kind of setting, a kind of control.
#include "preview/setting_controls.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <imgui.h>

#include "preview/aperture_sketch.h"

namespace matchlight {

namespace {

using enum SettingKind;

/// "focus distance m (m)" is said once: "focus distance (m)".
std::string label_of(const Setting& setting) {
    std::string label(setting.key);
    for (const std::string_view unit : {"_deg", "_px_m", "_px", "_mm", "_um", "_ev", "_ms", "_m", "_s"}) {
        if (!setting.unit.empty() && label.ends_with(unit)) {
            label.resize(label.size() - unit.size());
            break;
        }
    }
    std::ranges::replace(label, '_', ' ');
    // Long units stand in the tooltip.
    constexpr std::size_t longest_unit = 5;
    if (!setting.unit.empty() && setting.unit.size() <= longest_unit) label += fmt::format(" ({})", setting.unit);
    return label;
}

std::string tooltip_of(const Setting& setting) {
    std::string text(setting.help);
    text += fmt::format("\n{}", describe(setting.domain));
    if (!setting.unit.empty()) text += fmt::format(", {}", setting.unit);
    return text;
}

NumberControl control_of(const SettingDomain& domain) {
    constexpr double widest_slider = 100, half_turn = 180, many_turns = 36000;
    NumberControl control{.lowest = domain.lowest, .highest = domain.highest, .whole = domain.kind == integer};
    control.slides = control.highest - control.lowest <= widest_slider;
    if (control.highest == many_turns) control = {.lowest = -half_turn, .highest = half_turn};
    return control;
}

/// A value to begin with where nothing is given: 0, or as near to it as the domain allows.
double first_value(const SettingDomain& domain) {
    const double nearest = std::clamp(0.0, domain.lowest, domain.highest);
    return domain.above_lowest && nearest == domain.lowest ? std::min(domain.highest, domain.lowest + 1) : nearest;
}

SceneValue first_scene_value(const SettingDomain& domain) {
    switch (domain.kind) {
        case boolean:
            return true;
        case integer:
            return static_cast<std::int64_t>(first_value(domain));
        case choice:
            return std::string(domain.choices.front());
        case color:
        case vector:
        case rotation:
        case scale:
            return std::vector<double>(3, domain.kind == color ? 0.5 : first_value(domain));
        case number:
        case measure:
            break;
        default:
            return std::string();
    }
    return first_value(domain);
}

/// Of a setting that need not be given; whether it is.
bool lay_out_given(Session& session, Controls& controls, const Setting& setting, const std::string& key) {
    if (!setting.fallback.empty()) return true;
    bool given = session.values().is_written(key);
    if (controls.checkbox(key + "?", "", given, "ticked: by hand; otherwise as the solve or the file says")) {
        if (given) {
            session.set(key, first_scene_value(setting.domain));
        } else {
            session.remove(key);
        }
    }
    ImGui::SameLine();
    if (!given) ImGui::TextDisabled("%s", label_of(setting).c_str());
    return given && session.values().is_written(key);
}

void lay_out_three(Session& session, Controls& controls, const Setting& setting, const std::string& key) {
    const std::vector<double> values = session.values().numbers(key);
    const std::string label = label_of(setting), tooltip = tooltip_of(setting);
    const bool alone = values.size() == 1;  // a scale is for all axes; a rotation is about z
    const double none = first_value(setting.domain);
    if (setting.domain.kind == color) {
        float rgb[3] = {};
        for (std::size_t i = 0; i < 3; ++i) rgb[i] = static_cast<float>(values.size() == 3 ? values[i] : none);
        if (controls.color(key, label.c_str(), rgb, tooltip.c_str())) {
            session.set(key, std::vector<double>{rgb[0], rgb[1], rgb[2]}, key);
        }
        return;
    }
    double xyz[3] = {none, none, none};
    if (values.size() == 3) std::ranges::copy(values, xyz);
    if (alone && setting.domain.kind == rotation) xyz[2] = values[0];
    const bool uniform = setting.domain.kind == scale && (alone || (xyz[0] == xyz[1] && xyz[1] == xyz[2]));
    if (uniform) {
        double one = alone ? values[0] : xyz[0];
        if (controls.number(key, label.c_str(), one, control_of(setting.domain), tooltip.c_str())) {
            session.set(key, one, key);
        }
    } else if (controls.vector(key, label.c_str(), xyz, control_of(setting.domain), tooltip.c_str())) {
        session.set(key, std::vector<double>(xyz, xyz + 3), key);
    }
}

void lay_out_number(Session& session, Controls& controls, const Setting& setting, const std::string& key) {
    double value = session.values().number(key).value_or(first_value(setting.domain));
    if (!controls.number(key, label_of(setting).c_str(), value, control_of(setting.domain),
                         tooltip_of(setting).c_str())) {
        return;
    }
    if (setting.domain.kind == integer) {
        session.set(key, static_cast<std::int64_t>(std::llround(value)), key);
    } else {
        session.set(key, value, key);
    }
}

void lay_out_words(Session& session, Controls& controls, const Setting& setting, const std::string& key) {
    const std::string word = session.values().word(key).value_or("");
    const std::string label = label_of(setting), tooltip = tooltip_of(setting);
    if (setting.domain.kind != choice) {
        std::string text = word;
        if (controls.text(key, label.c_str(), text, tooltip.c_str())) session.set(key, text);
        return;
    }
    const auto found = std::ranges::find(setting.domain.choices, std::string_view(word));
    auto index = static_cast<std::size_t>(found - setting.domain.choices.begin());
    if (controls.choice(key, label.c_str(), index, setting.domain.choices, tooltip.c_str())) {
        session.set(key, std::string(setting.domain.choices[index]));
    }
}

/// Settings of a section that few scenes give: under a name of their own, closed until one of them is given.
struct SettingGroup {
    std::string_view name;
    std::vector<std::string_view> keys;

    bool has(const Setting& setting) const { return std::ranges::find(keys, setting.key) != keys.end(); }
};

std::span<const SettingGroup> groups_of(std::string_view section_name) {
    static const std::vector<SettingGroup> of_material{
        {"shading",
         {"shading", "shininess", "tones", "warm", "cool", "warm_share", "cool_share", "outline", "outline_color"}},
        {"relief", {"normal_map", "height_map", "height", "relief", "relief_steps"}},
        {"sampling", {"uv_scale", "texture_filter", "texture_wrap", "anisotropy"}}};
    static const std::vector<SettingGroup> of_object{
        {"animation", {"animation", "animation_speed", "animation_start", "animation_loop"}}};
    if (section_name == "object.material") return of_material;
    if (section_name == "object") return of_object;
    return {};
}

void lay_out_group(Session& session, Controls& controls, const SettingGroup& group, std::string_view section_name,
                   const std::string& section_key) {
    const bool is_given = std::ranges::any_of(group.keys, [&](std::string_view key) {
        return session.values().is_written(fmt::format("{}.{}", section_key, key));
    });
    if (!ImGui::TreeNodeEx(fmt::format("{}##{}", group.name, section_key).c_str(),
                           is_given ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None)) {
        return;
    }
    for (const Setting& setting : scene_settings()) {
        if (setting.section == section_name && group.has(setting))
            lay_out_setting(session, controls, setting, section_key);
    }
    ImGui::TreePop();
}

}  // namespace

void lay_out_setting(Session& session, Controls& controls, const Setting& setting, const std::string& section_key) {
    const std::string key = fmt::format("{}.{}", section_key, setting.key);
    const SettingKind kind = setting.domain.kind;
    if (kind == section) {
        const std::string name = fmt::format("{}.{}", setting.section, setting.key);
        // A table within a table is closed until the scene has it.
        const bool is_open = setting.section.find('.') == std::string_view::npos || session.values().is_table(key);
        if (ImGui::TreeNodeEx(fmt::format("{}##{}", label_of(setting), key).c_str(),
                              is_open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None)) {
            if (name.ends_with("glare.aperture")) lay_out_aperture_sketch(session, controls, key);
            lay_out_section(session, controls, name, key);
            ImGui::TreePop();
        }
        return;
    }
    if (kind == sections || kind == effect || kind == left_out || kind == not_built || kind == interval) return;
    if (!lay_out_given(session, controls, setting, key)) return;
    switch (kind) {
        case boolean: {
            bool on = session.values().flag(key).value_or(false);
            if (controls.checkbox(key, label_of(setting).c_str(), on, tooltip_of(setting).c_str())) {
                session.set(key, on);
            }
            return;
        }
        case integer:
        case number:
        case measure:
            return lay_out_number(session, controls, setting, key);
        case color:
        case vector:
        case rotation:
        case scale:
            return lay_out_three(session, controls, setting, key);
        default:
            return lay_out_words(session, controls, setting, key);
    }
}

void lay_out_section(Session& session, Controls& controls, std::string_view section_name,
                     const std::string& section_key, std::span<const std::string_view> left_out_keys) {
    const std::span<const SettingGroup> groups = groups_of(section_name);
    for (const Setting& setting : scene_settings()) {
        const bool is_grouped =
            std::ranges::any_of(groups, [&](const SettingGroup& group) { return group.has(setting); });
        if (setting.section != section_name || is_grouped) continue;
        if (std::ranges::find(left_out_keys, setting.key) != left_out_keys.end()) continue;
        lay_out_setting(session, controls, setting, section_key);
    }
    for (const SettingGroup& group : groups) lay_out_group(session, controls, group, section_name, section_key);
}

void lay_out_effect(Session& session, Controls& controls, const Setting& setting) {
    const std::string key = fmt::format("{}.{}", setting.section, setting.key);
    static constexpr std::array<std::string_view, 3> ways{"off", "auto", "by hand"};
    const bool off = session.values().word(key) == "off", by_hand = session.values().is_table(key);
    std::size_t way = off ? 0 : by_hand ? 2 : 1;
    if (controls.choice(key, label_of(setting).c_str(), way, ways, tooltip_of(setting).c_str())) {
        if (way == 2) {
            session.set(key, TomlText("{}"));
        } else {
            session.set(key, std::string(ways[way]));
        }
    }
    if (!session.values().is_table(key)) return;
    ImGui::Indent();
    lay_out_section(session, controls, key, key);
    ImGui::Unindent();
}

}  // namespace matchlight
