// The table of keys, and reading key names.
#include "preview/keys.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>

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
        {"l", 0, level, "the next quality level"},
        {"e", 0, explain, "print each pass of the frame: drawn or left out and why, and its cost"},
        {"r", 0, reload, "read the scene file again"},
        {"h", 0, help, "print these keys"},
        {"q", 0, quit, "quit"},
        {"escape", GLFW_KEY_ESCAPE, quit, "quit"},
    };
    return keys;
}

std::vector<PreviewAction> actions_of_keys(const std::string& keys) {
    std::vector<PreviewAction> actions;
    std::istringstream names(keys);
    for (std::string name; std::getline(names, name, ',');) {
        name.erase(0, name.find_first_not_of(' '));
        name.erase(name.find_last_not_of(' ') + 1);
        const auto key = std::ranges::find(preview_keys(), name, &PreviewKey::name);
        if (key == preview_keys().end()) {
            std::string known;
            for (const PreviewKey& one : preview_keys()) known += (known.empty() ? "" : ", ") + one.name;
            throw std::invalid_argument(fmt::format("there is no key '{}'; there are {}", name, known));
        }
        actions.push_back(key->action);
    }
    return actions;
}

std::string preview_keys_text() {
    std::string text;
    for (const PreviewKey& key : preview_keys()) text += fmt::format("{:<9} {}\n", key.name, key.what);
    return text;
}

}  // namespace matchlight
