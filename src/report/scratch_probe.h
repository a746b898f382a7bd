// A light probe's file for a scene made up in memory.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

#include "core/image.h"
#include "media/image_io.h"

namespace matchlight {

/// A probe's file that is gone again with its folder.
class ScratchProbe {
public:
    explicit ScratchProbe(const ImageF& light) {
        std::string name = (std::filesystem::temp_directory_path() / "matchlight_stability_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for temporary files");
        folder_ = name;
        write_exr(path(), light.width(), light.height(),
                  {{.name = "", .channels = {"R", "G", "B"}, .image = &light, .half = false, .data_window = {}}}, {});
    }
    ~ScratchProbe() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    ScratchProbe(const ScratchProbe&) = delete;
    ScratchProbe& operator=(const ScratchProbe&) = delete;

    std::filesystem::path path() const { return folder_ / "probe.exr"; }

private:
    std::filesystem::path folder_;
};

}  // namespace matchlight
