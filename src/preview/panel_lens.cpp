// Focus, the opening and the angle of view.
#include <array>
#include <string_view>

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
    static constexpr std::array<std::string_view, 5> left_out{"keys", "width", "height", "frames", "fps"};
    lay_out_section(session, controls, "camera", "camera", left_out);
}

}  // namespace matchlight
