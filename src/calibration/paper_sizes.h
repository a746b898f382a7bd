// Which way a sheet of paper lies, and what to say when it is too small.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calibration/board_sheet.h"

namespace matchlight {

/// As it is, and turned where it may be.
std::vector<Paper> ways_to_lay(const Paper& paper);

/// Throws InputError: `what` does not fit; names the smallest paper that does.
[[noreturn]] void refuse_paper(const std::string& what, const Paper& paper,
                               const std::function<bool(const Paper&)>& fits);

}  // namespace matchlight
