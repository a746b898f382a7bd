// Footage whose colour space an OpenColorIO config names, tracked and rendered on the sample shot.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "media/image_io.h"
#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;

class OcioFootage : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
        plain_ = bytes_of(scene_);
        std::ofstream(shot_ / "config.ocio") << R"(ocio_profile_version: 2
roles:
  default: lin_rec709
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  none:
    - !<View> {name: raw, colorspace: lin_rec709}
colorspaces:
  - !<ColorSpace>
    name: lin_rec709
    isdata: false
  - !<ColorSpace>
    name: the camera's
    isdata: false
    to_scene_reference: !<ExponentWithLinearTransform> {gamma: [2.4, 2.4, 2.4, 1], offset: [0.055, 0.055, 0.055, 0]}
)";
    }
    void say_of_footage(const std::string& lines) const {
        std::string text = plain_;
        text.replace(text.find("[footage]\n"), 10, "[footage]\n" + lines);
        std::ofstream(scene_, std::ios::binary | std::ios::trunc) << text;
    }
    Image8 rendered(const std::string& name) const {
        EXPECT_TRUE(succeeded(run_matchlight({"track", scene_})));
        EXPECT_TRUE(succeeded(run_matchlight(
            {"render", scene_, "-o", scratch_ / (name + "_%03d.png"), "--frames", "5-5", "--level", "draft"})));
        return read_rgb8(numbered(scratch_ / (name + "_%03d.png"), 5));
    }

    fs::path shot_, scene_;
    std::string plain_;
};

TEST_F(OcioFootage, InTheSpaceOfSrgbItLooksAsWithoutOne) {
    const Image8 without = rendered("plain");
    say_of_footage("ocio_config = \"config.ocio\"\nocio_space = \"the camera's\"\n");
    // Another curve and primaries: the solve is of another scene.
    EXPECT_TRUE(failed_naming(run_matchlight({"render", scene_, "-o", scratch_ / "no_%03d.png", "--frames", "5-5"}),
                              {"table.solve.json", "other settings of [footage]"}));
    const Image8 with = rendered("ocio");
    int worst = 0;
    for (std::size_t i = 0; i < with.samples().size(); ++i) {
        worst = std::max(worst, std::abs(int{with.samples()[i]} - int{without.samples()[i]}));
    }
    // A table of 1,025 codes, and transforms in single precision, in place of the formula.
    EXPECT_LE(worst, 1);
}

TEST_F(OcioFootage, WhatContradictsItselfIsRefused) {
    const auto refused = [&](const std::string& lines, const std::vector<std::string>& words) {
        say_of_footage(lines);
        EXPECT_TRUE(failed_naming(run_matchlight({"track", scene_}), words)) << lines;
        EXPECT_TRUE(nothing_left_of(shot_ / "table.solve.json"));
    };
    refused("ocio_config = \"config.ocio\"\n", {"table.toml", "ocio_space"});
    refused("ocio_config = \"config.ocio\"\nocio_space = \"LogC3\"\n", {"config.ocio", "no colour space 'LogC3'"});
    refused("ocio_config = \"missing.ocio\"\nocio_space = \"LogC3\"\n", {"missing.ocio"});
    refused("response = \"solve\"\nocio_config = \"config.ocio\"\nocio_space = \"the camera's\"\n",
            {"table.toml", "'response'", "leave one of them out"});
}

}  // namespace
}  // namespace matchlight::test
