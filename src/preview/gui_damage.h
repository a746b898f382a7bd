// What of the window looks otherwise than in the frame before: where a processor draws, only that is drawn anew.
#pragma once

#include <vector>

#include <imgui.h>

#include "core/image.h"

namespace matchlight {

class GuiDamage {
public:
    /// Parts of a window that do not overlap, cut to it: where the controls differ from those of the call before.
    std::vector<Region> since_last(const ImDrawData& data, const Region& window);

private:
    /// An ImDrawList, which lives for one frame.
    struct Drawn {
        std::vector<ImDrawVert> corners;
        std::vector<ImDrawIdx> indices;
        std::vector<ImDrawCmd> parts;
    };
    static Drawn copy_of(const ImDrawList& list);
    /// From the corner `first` to `end`.
    static Region reached(const Drawn& drawn, std::size_t first, std::size_t end);
    static Region changed(const Drawn& before, const Drawn& now);

    std::vector<Drawn> before_;
};

/// Regions of which none overlaps another, over all that these cover; the fewest of them.
std::vector<Region> apart(std::vector<Region> regions);

}  // namespace matchlight
