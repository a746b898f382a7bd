// The interactive window: a scene's frames, played and stepped through, and what is drawn of them, by hand or script.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/warnings.h"
#include "preview/keys.h"
#include "scene/scene_file.h"

namespace matchlight {

struct PreviewOptions {
    std::filesystem::path scene;
    std::int64_t frame = 0;               // shown first
    std::optional<QualityLevel> level;    // instead of the scene's
    std::optional<Eigen::Vector2i> size;  // of the window; the footage's, fitted to the screen, unless given
    std::vector<PreviewAction> keys;      // pressed at the start
    bool quiet = false;                   // no progress of what takes long
    std::filesystem::path truth;          // how the scene really looked: see truth_picture.h; empty: not known
    std::filesystem::path script;         // a scripted hand, played first; empty: none
    bool overwrite = false;               // what a script's screenshots are called
    std::filesystem::path snapshot;       // where given: what the window shows after them is saved, and that is all
    std::function<void(const std::string&)> print;  // of text for the terminal, line by line
};

/// What was shown last.
struct PreviewResult {
    std::int64_t frame = 0;
    double time_s = 0;
    Eigen::Vector2i window_px = Eigen::Vector2i::Zero();
};

/// Returns when the user quits. Throws InputError: no display, nothing to show.
PreviewResult run_preview(const PreviewOptions& options, Warnings& warnings);

}  // namespace matchlight
