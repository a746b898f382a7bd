// Effects, on or off.
#include <imgui.h>

#include "preview/panels.h"

namespace matchlight {

void lay_out_effects_panel(Session& session, Controls& controls) {
    ShotSwitches switches = session.switches();
    bool changed = controls.checkbox("bloom", "Bloom", switches.bloom, "bright light spills around itself (b)");
    changed |= controls.checkbox("glare", "Glare", switches.glare, "bright light is drawn out into streaks (g)");
    changed |=
        controls.checkbox("dazzle", "Dazzling reflection", switches.dazzle, "what objects send to bloom and glare (d)");
    changed |= controls.checkbox("exposure", "Simulated exposure control", switches.exposure,
                                 "the whole picture exposed anew, as metered (x)");
    changed |= controls.checkbox("shadow", "Shadow on the surface", switches.shadow, "of what is virtual (s)");
    if (changed) session.set_switches(switches);
}

}  // namespace matchlight
