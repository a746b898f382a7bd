// The probe and the surface it falls on.
#include <array>
#include <string>

#include <fmt/format.h>
#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"
#include "scene/lamp_schema.h"

namespace matchlight {

namespace {

/// The entries of [[light]]: at most one of them is the probe.
void lay_out_lights(Session& session, Controls& controls) {
    for (std::size_t i = 0;; ++i) {
        const std::string key = fmt::format("light[{}]", i);
        if (!session.values().is_table(key)) return;
        if (session.values().is_written(key + ".probe")) {
            lay_out_section(session, controls, "light", key);
            continue;
        }
        const std::string type = session.values().word(key + ".type").value_or("");
        // More of them would not fit.
        constexpr std::size_t most_open = 2;
        const bool is_open = session.scene().lamps.size() <= most_open;
        if (ImGui::TreeNodeEx(fmt::format("lamp {}: {}##{}", i, type, key).c_str(),
                              is_open ? ImGuiTreeNodeFlags_DefaultOpen : ImGuiTreeNodeFlags_None)) {
            lay_out_section(session, controls, lamp_section, key);
            ImGui::TreePop();
        }
    }
}

}  // namespace

void lay_out_light_panel(Session& session, Controls& controls) {
    if (session.scene().probe) {
        ImGui::TextUnformatted("Probe");
        static constexpr std::array<std::string_view, 3> forms{"picture", "lat-long", "three balls"};
        std::size_t form = session.shown_probe() ? 1 + static_cast<std::size_t>(*session.shown_probe()) : 0;
        if (controls.choice("probe.view", "show", form, forms, "instead of the picture: what lights the scene")) {
            session.show_probe(form == 0 ? std::nullopt : std::optional(static_cast<ProbeForm>(form - 1)));
        }
        if (session.values().is_table("light")) lay_out_section(session, controls, "light", "light");
    }
    lay_out_lights(session, controls);
    ImGui::Spacing();
    ImGui::TextUnformatted("Surface");
    lay_out_section(session, controls, "surface", "surface");
}

}  // namespace matchlight
