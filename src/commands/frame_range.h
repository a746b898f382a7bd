// "--frames 10-20": the part of a clip that a command works on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <CLI/App.hpp>

namespace matchlight {

/// Frames `first` to `last`, both included, counted from 0; without `last` up to the clip's end.
struct FrameRange {
    std::int64_t first = 0;
    std::optional<std::int64_t> last;

    bool contains(std::int64_t frame) const { return frame >= first && (!last || frame <= *last); }
    bool is_past(std::int64_t frame) const { return last && frame > *last; }
};

/// "7", "3-9" or "3-"; nullopt for anything else, and where the last lies before the first.
std::optional<FrameRange> parse_frame_range(const std::string& text);

/// Adds --frames to a command; a malformed range is a wrong call.
void add_frames_option(CLI::App& command, FrameRange& range);

}  // namespace matchlight
