// Top mark, ruler and text of a sheet.
#include "calibration/sheet_frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/ink_shape.h"

namespace matchlight {

void add_top_mark(SheetPage& page, const Eigen::Vector2d& foot_mm) {
    constexpr double height = 2;  // of triangle and letters
    const Eigen::Vector2d left = foot_mm - Eigen::Vector2d(4, 0);
    page.ink.push_back({{left, left + Eigen::Vector2d(1, -height), left + Eigen::Vector2d(2, 0)}});
    page.texts.push_back({"top", left + Eigen::Vector2d(2.8, 0), height, 10, false});
}

void add_footer(SheetPage& page, const Paper& paper, const std::string& text) {
    const double room = paper.width_mm - 2 * sheet_margin_mm;
    const int tens = static_cast<int>(std::min(10.0, std::floor(room / 10)));
    constexpr double thickness = 0.2, end_tick = 3, tick = 1.5;
    const double base = paper.height_mm - sheet_margin_mm, left = sheet_margin_mm;
    std::vector<InkRectangle> ruler = {{left, base - thickness, left + 10 * tens, base}};
    for (int i = 0; i <= tens; ++i) {
        const double x = left + 10 * i, length = i == 0 || i == tens ? end_tick : tick;
        // Lengths are taken from one tick's middle to the other's.
        ruler.push_back({x - thickness / 2, base - length, x + thickness / 2, base});
    }
    page.ink.push_back(united(ruler));
    const std::string hint = fmt::format("print at 100 %, not fitted to the page: the ruler is {} mm long", 10 * tens);
    page.texts.push_back({text + "; " + hint, {left, base - end_tick - 1}, 2.5, room, false});
}

}  // namespace matchlight
