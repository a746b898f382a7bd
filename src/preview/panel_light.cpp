// The probe and the surface it falls on.
#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

void lay_out_light_panel(Session& session, Controls& controls) {
    if (session.scene().probe) {
        ImGui::TextUnformatted("Probe");
        lay_out_section(session, controls, "light", "light");
    }
    ImGui::Spacing();
    ImGui::TextUnformatted("Surface");
    lay_out_section(session, controls, "surface", "surface");
}

}  // namespace matchlight
