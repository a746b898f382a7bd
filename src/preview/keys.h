// The keys of the preview: one table for the window, for --keys and for the help.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "preview/input_event.h"

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
    truth,
    difference,
    wipe,
    whole_pixels,
    fit,
    free_view,
    level,
    explain,
    undo,
    redo,
    save,
    reload,
    panels,
    help,
    give_up,
    quit,
};

struct PreviewKey {
    std::string name;  // of one character: the key that types it, wherever the keyboard has it; "ctrl+" may precede it
    int glfw_key = 0;  // of others
    PreviewAction action = PreviewAction::quit;
    std::string what;
    bool repeats = false;  // while it is held down
};

std::span<const PreviewKey> preview_keys();

/// What a key that went down asks for.
std::optional<PreviewAction> action_of(const InputEvent& event);

/// The key as a hand presses it: what GLFW and the keyboard would say. Throws as actions_of_keys does.
InputEvent event_of_key(const std::string& name);

/// "b" of PreviewAction::bloom: for tooltips.
std::string key_of(PreviewAction action);

/// "b,right,right". Throws std::invalid_argument naming a key that there is not.
std::vector<PreviewAction> actions_of_keys(const std::string& keys);

/// One line a key.
std::string preview_keys_text();

}  // namespace matchlight
