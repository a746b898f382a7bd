// The keys of the preview: one table for the window, for --keys and for the help.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace matchlight {

enum class PreviewAction {
    play,
    step_back,
    step_on,
    ten_back,
    ten_on,
    first,
    last,
    bloom,
    glare,
    dazzle,
    exposure,
    shadow,
    plate,
    level,
    explain,
    reload,
    help,
    quit,
};

struct PreviewKey {
    std::string name;  // of one character: the key that types it, wherever the keyboard has it
    int glfw_key = 0;  // of others
    PreviewAction action = PreviewAction::quit;
    std::string what;
    bool repeats = false;  // while it is held down
};

std::span<const PreviewKey> preview_keys();

/// "b,right,right". Throws std::invalid_argument naming a key that there is not.
std::vector<PreviewAction> actions_of_keys(const std::string& keys);

/// One line a key.
std::string preview_keys_text();

}  // namespace matchlight
