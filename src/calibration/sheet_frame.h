// What stands on every printed sheet beside the board: margins, a mark at the top, a ruler and a line of text.
#pragma once

#include <string>

#include "calibration/board_sheet.h"

namespace matchlight {

/// Most printers leave the outermost 4 to 6 mm of the paper white.
inline constexpr double sheet_margin_mm = 6.5;
/// Paper between ink that is measured and small print.
inline constexpr double white_mm = 3;
inline constexpr double top_mark_mm = 3.5, footer_mm = 6.5;

/// A small triangle and the word "top" whose lower end is at `foot_mm`.
void add_top_mark(SheetPage& page, const Eigen::Vector2d& foot_mm);
/// At the lower edge: the text, and a ruler of 100 mm, or of as many tens as the paper has room for.
void add_footer(SheetPage& page, const Paper& paper, const std::string& text);

}  // namespace matchlight
