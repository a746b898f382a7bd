// Where the window's parts lie: the picture, the panel beside it, the bar above and the timeline below.
#pragma once

#include <Eigen/Core>

#include "core/image.h"

namespace matchlight {

/// How far the panel's border can be dragged, in an ordinary screen's pixels.
inline constexpr float narrowest_panel = 300, widest_panel = 900;

struct LayoutSettings {
    float scale = 1;          // of the screen
    float panel_width = 380;  // in an ordinary screen's pixels: as wide as the user made it
    bool panels = true;       // or the picture alone
};

/// In pixels of the window; the parts cover it and do not overlap.
struct Layout {
    Region bar, picture, panel, timeline, status;
};

/// Where the window is too small for all of them, the picture keeps a third of it.
Layout lay_out(const Eigen::Vector2i& window_px, const LayoutSettings& settings);

/// The window that gives the picture this much room.
Eigen::Vector2i window_around(const Eigen::Vector2i& picture_px, const LayoutSettings& settings);

}  // namespace matchlight
