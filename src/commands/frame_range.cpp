// Reads frame ranges strictly: digits and one dash.
#include "commands/frame_range.h"

#include <charconv>
#include <string_view>

namespace matchlight {

namespace {

std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
    return value;
}

}  // namespace

std::optional<FrameRange> parse_frame_range(const std::string& text) {
    const std::string_view all = text;
    const std::size_t dash = all.find('-');
    const std::optional<std::int64_t> first = whole_number(all.substr(0, dash));
    if (!first) return std::nullopt;
    if (dash == std::string_view::npos) return FrameRange{*first, *first};
    if (dash + 1 == all.size()) return FrameRange{*first, std::nullopt};
    const std::optional<std::int64_t> last = whole_number(all.substr(dash + 1));
    if (!last || *last < *first) return std::nullopt;
    return FrameRange{*first, last};
}

void add_frames_option(CLI::App& command, FrameRange& range) {
    command
        .add_option_function<std::string>(
            "--frames",
            [&range](const std::string& text) {
                const std::optional<FrameRange> parsed = parse_frame_range(text);
                if (!parsed)
                    throw CLI::ValidationError("--frames", "'" + text + "' is not a range such as 10-20, 10- or 7");
                range = *parsed;
            },
            "Only frames A to B, both included, counted from 0 (A-B, A- or A)")
        ->type_name("A-B");
}

}  // namespace matchlight
