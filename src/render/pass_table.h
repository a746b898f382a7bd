// What became of a frame's passes, as a table for people.
#pragma once

#include <span>
#include <string>

#include "render/graph.h"

namespace matchlight {

/// A heading and one line a pass, without a newline at the end.
std::string pass_table(std::span<const PassReport> reports);

}  // namespace matchlight
