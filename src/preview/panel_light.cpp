// The probe and the surface it falls on.
#include <array>

#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

void lay_out_light_panel(Session& session, Controls& controls) {
    if (session.scene().probe) {
        ImGui::TextUnformatted("Probe");
        static constexpr std::array<std::string_view, 3> forms{"picture", "lat-long", "three balls"};
        std::size_t form = session.shown_probe() ? 1 + static_cast<std::size_t>(*session.shown_probe()) : 0;
        if (controls.choice("probe.view", "show", form, forms, "instead of the picture: what lights the scene")) {
            session.show_probe(form == 0 ? std::nullopt : std::optional(static_cast<ProbeForm>(form - 1)));
        }
        lay_out_section(session, controls, "light", "light");
    }
    ImGui::Spacing();
    ImGui::TextUnformatted("Surface");
    lay_out_section(session, controls, "surface", "surface");
}

}  // namespace matchlight
