// Text as it stands inside an HTML page.
#pragma once

#include <string>

namespace matchlight {

/// With &, <, > and quotes written as entities.
std::string html_text(const std::string& text);

}  // namespace matchlight
