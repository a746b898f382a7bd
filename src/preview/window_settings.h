// What the window remembers from one run to the next, in the user's folder of settings.
#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Core>

namespace matchlight {

struct WindowSettings {
    std::optional<Eigen::Vector2i> size_px;
    float panel_width = 380;  // as LayoutSettings has it
};

/// $XDG_CONFIG_HOME/matchlight/window.json, or that of ~/.config; empty where neither is known.
std::filesystem::path window_settings_file();

/// What is not there, or makes no sense, is as it is at first.
WindowSettings load_window_settings();
/// Where it cannot be written, nothing is remembered.
void save_window_settings(const WindowSettings& settings);

}  // namespace matchlight
