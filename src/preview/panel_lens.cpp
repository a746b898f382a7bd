// Focus, the opening and the angle of view.
#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

void lay_out_lens_panel(Session& session, Controls& controls) {
    lay_out_effect(session, controls, *find_setting("effects", "depth_of_field"));
    ImGui::TextWrapped("Click in the picture with shift held down to focus there.");
    if (!session.scene().camera) return;
    ImGui::Spacing();
    ImGui::TextUnformatted("Camera");
    lay_out_section(session, controls, "camera", "camera", {"keys", "width", "height", "frames", "fps"});
}

}  // namespace matchlight
