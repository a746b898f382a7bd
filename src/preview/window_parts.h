// What stands around the picture: the bar above it, the line below, the panels, the help.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "preview/canvas.h"
#include "preview/keys.h"
#include "preview/layout.h"
#include "preview/panels.h"

namespace matchlight {

struct WindowState {
    LayoutSettings layout;
    std::size_t panel = 0;   // which is open
    bool open_panel = true;  // bring it to the front with the next frame
    bool help = false;
    bool has_truth = false;
};

std::span<const Panel> window_panels();
/// Its index; capitals do not matter. Throws std::invalid_argument naming those that there are.
std::size_t panel_named(const std::string& name);

/// What the parts show and change.
struct WindowParts {
    WindowState& state;
    Session& session;
    Canvas& canvas;
    Controls& controls;
    const std::string& hand_says;              // in the line below
    std::function<void(PreviewAction)> press;  // what a key does
};

/// Lays out all but the picture.
void lay_out_window(const Layout& layout, WindowParts& parts);

}  // namespace matchlight
