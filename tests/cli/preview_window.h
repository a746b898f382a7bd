// The preview of the table sample on a display of its own, played by script and compared with what render writes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/image.h"
#include "media/image_io.h"
#include "run_matchlight.h"
#include "virtual_display.h"

namespace matchlight::test {

namespace fs = std::filesystem;

inline bool same(const Image8& a, const Image8& b) {
    return a.width() == b.width() && a.height() == b.height() && std::ranges::equal(a.samples(), b.samples());
}

class PreviewTest : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        ASSERT_TRUE(succeeded(run_matchlight({"track", scene_})));
        options_.environment["DISPLAY"] = display_.name();
    }

    static std::vector<std::string> call_of(const fs::path& scene, const std::vector<std::string>& more) {
        std::vector<std::string> call{"preview", scene, "--level", "draft"};
        call.insert(call.end(), more.begin(), more.end());
        return call;
    }

    Image8 snapshot(const std::vector<std::string>& more) {
        const fs::path output = scratch_ / ("snapshot" + std::to_string(++snapshots_) + ".png");
        std::vector<std::string> call = call_of(scene_, more);
        call.insert(call.end(), {"--snapshot", output});
        result_ = run_matchlight(call, options_);
        EXPECT_TRUE(succeeded(result_));
        return read_rgb8(output);
    }

    Image8 rendered(int frame) const {
        const fs::path output = scratch_ / "out_%03d.png";
        EXPECT_TRUE(succeeded(run_matchlight({"render", scene_, "-o", output, "--level", "draft", "--frames",
                                              std::to_string(frame) + "-" + std::to_string(frame), "--overwrite"},
                                             options_)));
        return read_rgb8(numbered(output, frame));
    }

    /// What a script printed.
    std::string played(const std::string& script, const std::vector<std::string>& more = {}) {
        const fs::path file = scratch_.write("hand.txt", script + "\nquit\n");
        std::vector<std::string> call = call_of(scene_, more);
        call.insert(call.end(), {"--script", file, "--overwrite"});
        result_ = run_matchlight(call, options_);
        EXPECT_TRUE(succeeded(result_));
        return result_.standard_output;
    }

    /// The part of a screenshot that starts at this corner.
    static Image8 part_of(const Image8& picture, const Region& part) {
        Image8 cut(part.width, part.height, 3);
        for (int y = 0; y < part.height; ++y) {
            const std::uint8_t* from = picture.pixel(part.x, part.y + y);
            std::copy(from, from + std::size_t{3} * part.width, cut.pixel(0, y));
        }
        return cut;
    }

    void append_to_scene(const std::string& text) const { std::ofstream(scene_, std::ios::app) << text; }

    VirtualDisplay display_{scratch_.path()};
    RunOptions options_;
    RunResult result_;
    fs::path shot_;
    fs::path scene_;
    int snapshots_ = 0;
};

// The picture at one pixel of the screen each, in the middle of its place: 900×530 from (0, 40) in this window.
inline constexpr Region whole_pixels_at{130, 125, 640, 360};

}  // namespace matchlight::test
