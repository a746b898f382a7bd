// What the camera does to the light of what is virtual.
#include <imgui.h>

#include "preview/panels.h"
#include "preview/setting_controls.h"

namespace matchlight {

void lay_out_effects_panel(Session& session, Controls& controls) {
    for (const Setting& setting : scene_settings()) {
        // The lens has a panel of its own.
        if (setting.section != "effects" || setting.key == "depth_of_field") continue;
        lay_out_effect(session, controls, setting);
    }
}

}  // namespace matchlight
