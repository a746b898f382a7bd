// Black rectangles united into outlines.
#pragma once

#include <vector>

#include "calibration/board_sheet.h"

namespace matchlight {

/// Millimetres on the page.
struct InkRectangle {
    double left = 0, top = 0, right = 0, bottom = 0;
};

/// The outlines of what the rectangles cover together. Edges closer than a nanometre are one.
InkShape united(const std::vector<InkRectangle>& rectangles);

}  // namespace matchlight
