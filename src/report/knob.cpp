// Named numbers in words.
#include "report/knob.h"

#include <fmt/format.h>

namespace matchlight {

std::string knobs_text(const std::vector<Knob>& knobs) {
    std::string text;
    for (const Knob& knob : knobs) {
        text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", knob.name, knob.value);
    }
    return text;
}

}  // namespace matchlight
