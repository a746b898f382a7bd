// Text as a field of a CSV file.
#pragma once

#include <string>

namespace matchlight {

/// In quotes, those within it doubled.
inline std::string csv_text(const std::string& text) {
    std::string field = "\"";
    for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
    return field + "\"";
}

}  // namespace matchlight
