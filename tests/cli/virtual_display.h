// An X server without a screen, and what its screen would show.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <sys/types.h>

#include "core/image.h"

namespace matchlight::test {

/// Xvfb (Debian: xvfb), running as long as this lives.
class VirtualDisplay {
public:
    static constexpr int width = 1280, height = 1024;

    /// Keeps its screen in a file in `folder`. Throws std::runtime_error where there is no Xvfb.
    explicit VirtualDisplay(const std::filesystem::path& folder);
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    /// For the environment's DISPLAY.
    const std::string& name() const { return name_; }

    /// The screen's upper left corner, of this size, 3 channels: without a window manager, windows open there.
    Image8 corner(int corner_width, int corner_height) const;
    /// Waits until the corner shows the picture, for at most a minute; whether it did.
    bool comes_to_show(const Image8& picture) const;

private:
    std::filesystem::path screen_file_;
    pid_t process_ = -1;
    std::string name_;
};

}  // namespace matchlight::test
