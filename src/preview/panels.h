// The panels beside the picture, one function each: what they change, they change through the session.
#pragma once

#include <string_view>

#include "preview/controls.h"
#include "preview/session.h"

namespace matchlight {

struct Panel {
    std::string_view name;  // of its tab, and for scripts
    void (*lay_out)(Session& session, Controls& controls);
};

void lay_out_objects_panel(Session& session, Controls& controls);
void lay_out_light_panel(Session& session, Controls& controls);
void lay_out_lens_panel(Session& session, Controls& controls);
void lay_out_effects_panel(Session& session, Controls& controls);
void lay_out_passes_panel(Session& session, Controls& controls);

}  // namespace matchlight
