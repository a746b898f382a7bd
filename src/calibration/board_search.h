// Looks for a board in photographs or in the frames of a video.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/lens_fit.h"
#include "core/warnings.h"

namespace matchlight {

struct BoardSearchOptions {
    /// Photographs; or one folder of them, one pattern such as "photos/*.jpg" or "photo_%04d.png"; or one video.
    std::vector<std::filesystem::path> inputs;
    std::optional<std::size_t> most_views;  // of a video 40 unless given, of photographs all
    bool strict = false;                    // a damaged video is an error
    bool quiet = false;                     // no progress
    bool as_opencv = false;                 // measure the corners also as OpenCV does, to compare
};

struct BoardSearch {
    LensData data;
    bool is_video = false;
    std::int64_t looked_at = 0;              // photographs or frames
    std::int64_t with_board = 0;             // of them
    std::vector<std::string> without_board;  // photographs only
};

/// Finds the board. Throws InputError where no picture shows it (saying what was looked for and what was seen), where
/// photographs differ in size, or where an input cannot be read. Photographs without the board are warned of.
BoardSearch find_boards(const BoardSpec& board, const BoardSearchOptions& options, Warnings& warnings);

}  // namespace matchlight
