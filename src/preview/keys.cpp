// The table of keys, and reading key names.
#include "preview/keys.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string_view>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace matchlight {

std::span<const PreviewKey> preview_keys() {
    using enum PreviewAction;
    static const std::vector<PreviewKey> keys{
        {"space", GLFW_KEY_SPACE, play, "play by the footage's time stamps, or pause"},
        {"left", GLFW_KEY_LEFT, step_back, "a frame back", true},
        {"right", GLFW_KEY_RIGHT, step_on, "a frame on", true},
        {"pageup", GLFW_KEY_PAGE_UP, ten_back, "ten frames back", true},
        {"pagedown", GLFW_KEY_PAGE_DOWN, ten_on, "ten frames on", true},
        {"home", GLFW_KEY_HOME, first, "the first frame"},
        {"end", GLFW_KEY_END, last, "the last frame"},
        {"b", 0, bloom, "bloom on or off"},
        {"g", 0, glare, "glare on or off"},
        {"d", 0, dazzle, "dazzling reflection on or off: what objects send to bloom and glare"},
        {"x", 0, exposure, "exposure control on or off"},
        {"s", 0, shadow, "shadow on the surface on or off"},
        {"p", 0, plate, "the plate alone, or the composite"},
        {"t", 0, truth, "what --truth gave, or the composite"},
        {"f", 0, difference, "FLIP: where the composite differs from the truth, or from the plate"},
        {"w", 0, wipe, "wipe between the composite and the plate (or what is shown instead), or not"},
        {"1", 0, whole_pixels, "a pixel of the picture is one of the screen"},
        {"0", 0, fit, "the whole picture"},
        {"v", 0, free_view, "leave the footage and fly around the scene, or come back"},
        {"l", 0, level, "the next quality level"},
        {"e", 0, explain, "print each pass of the frame: drawn or left out and why, and its cost"},
        {"ctrl+z", 0, undo, "undo the last change of the scene", true},
        {"ctrl+shift+z", 0, redo, "do it again", true},
        {"ctrl+s", 0, save, "save the scene file; remarks and order stay"},
        {"r", 0, reload, "read the scene file again"},
        {"tab", GLFW_KEY_TAB, panels, "the panels, or the picture alone"},
        {"h", 0, help, "print these keys, and show them or hide them"},
        {"f1", GLFW_KEY_F1, help, "the same"},
        {"q", 0, quit, "quit"},
        {"escape", GLFW_KEY_ESCAPE, give_up, "give up what is being drawn; where nothing is, quit"},
    };
    return keys;
}

namespace {

struct KeyParts {
    bool control = false, shift = false;
    std::string_view base;
};

KeyParts parts_of(std::string_view name) {
    KeyParts parts;
    const auto cut = [&](std::string_view prefix) {
        if (!name.starts_with(prefix)) return false;
        name.remove_prefix(prefix.size());
        return true;
    };
    parts.control = cut("ctrl+");
    parts.shift = cut("shift+");
    parts.base = name;
    return parts;
}

const PreviewKey& key_named(const std::string& name) {
    const auto key = std::ranges::find(preview_keys(), name, &PreviewKey::name);
    if (key == preview_keys().end()) {
        std::string known;
        for (const PreviewKey& one : preview_keys()) known += (known.empty() ? "" : ", ") + one.name;
        throw std::invalid_argument(fmt::format("there is no key '{}'; there are {}", name, known));
    }
    return *key;
}

}  // namespace

std::optional<PreviewAction> action_of(const InputEvent& event) {
    if (event.kind == InputEvent::Kind::close) return PreviewAction::quit;
    if (event.kind != InputEvent::Kind::key || !event.down || event.alt) return std::nullopt;
    for (const PreviewKey& key : preview_keys()) {
        const KeyParts parts = parts_of(key.name);
        const bool pressed = key.glfw_key != 0 ? key.glfw_key == event.code : parts.base == event.text;
        if (!pressed || parts.control != event.control || (parts.control && parts.shift != event.shift)) continue;
        if (event.repeated && !key.repeats) continue;
        return key.action;
    }
    return std::nullopt;
}

InputEvent event_of_key(const std::string& name) {
    const PreviewKey& key = key_named(name);
    const KeyParts parts = parts_of(key.name);
    return {.kind = InputEvent::Kind::key,
            .code = key.glfw_key,
            .down = true,
            .control = parts.control,
            .shift = parts.shift,
            .text = std::string(parts.base)};
}

std::string key_of(PreviewAction action) {
    return std::ranges::find(preview_keys(), action, &PreviewKey::action)->name;
}

std::vector<PreviewAction> actions_of_keys(const std::string& keys) {
    std::vector<PreviewAction> actions;
    std::istringstream names(keys);
    for (std::string name; std::getline(names, name, ',');) {
        name.erase(0, name.find_first_not_of(' '));
        name.erase(name.find_last_not_of(' ') + 1);
        actions.push_back(key_named(name).action);
    }
    return actions;
}

std::string preview_keys_text() {
    std::string text;
    for (const PreviewKey& key : preview_keys()) text += fmt::format("{:<12} {}\n", key.name, key.what);
    return text;
}

}  // namespace matchlight
