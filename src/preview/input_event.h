// What a hand does to the window: GLFW's callbacks and scripts say it in the same words.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

struct InputEvent {
    enum class Kind { pointer, button, scroll, key, text, drop, close };
    Kind kind = Kind::pointer;
    Eigen::Vector2d value = Eigen::Vector2d::Zero();  // of a pointer: its place, pixels; of scrolling: steps
    int code = 0;                                     // of a button (0 left, 1 right, 2 middle) or key (GLFW's)
    bool down = false;                                // of a button or key
    bool repeated = false;                            // of a key that is held down
    bool control = false, shift = false, alt = false;
    std::string text = {};  // UTF-8: what a key types without modifiers, what is typed, or a file that was dropped
};

}  // namespace matchlight
