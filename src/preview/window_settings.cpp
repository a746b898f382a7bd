// A small JSON file; nobody is bothered where it cannot be read or written.
#include "preview/window_settings.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/user_folder.h"
#include "preview/layout.h"

namespace matchlight {

namespace {

constexpr int smallest_px = 320, largest_px = 16384;
constexpr std::size_t limit_bytes = 65536;  // of a file of three numbers

}  // namespace

std::filesystem::path window_settings_file() {
    const auto settings = user_folder("XDG_CONFIG_HOME", ".config");
    return settings ? *settings / "matchlight" / "window.json" : std::filesystem::path();
}

WindowSettings load_window_settings() {
    WindowSettings settings;
    const std::filesystem::path file = window_settings_file();
    std::error_code missing;
    if (file.empty() || !std::filesystem::is_regular_file(file, missing)) return settings;
    try {
        const nlohmann::json json = nlohmann::json::parse(read_text_file(file, limit_bytes));
        const Eigen::Vector2i size(json.at("width").get<int>(), json.at("height").get<int>());
        if (size.minCoeff() >= smallest_px && size.maxCoeff() <= largest_px) settings.size_px = size;
        settings.panel_width = std::clamp(json.at("panel_width").get<float>(), narrowest_panel, widest_panel);
    } catch (const nlohmann::json::exception&) {
        return {};
    } catch (const InputError&) {
        return {};
    }
    return settings;
}

void save_window_settings(const WindowSettings& settings) {
    const std::filesystem::path file = window_settings_file();
    if (file.empty() || !settings.size_px) return;
    std::error_code failed;
    std::filesystem::create_directories(file.parent_path(), failed);
    if (failed) return;
    const nlohmann::json json{
        {"width", settings.size_px->x()}, {"height", settings.size_px->y()}, {"panel_width", settings.panel_width}};
    try {
        write_text_file(file, json.dump(2) + "\n");
    } catch (const InputError&) {
        return;  // a settings folder that cannot be written is no reason to fail
    }
}

}  // namespace matchlight
