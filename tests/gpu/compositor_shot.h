// A chrome ball on a table, composited with everything drawn and with what can be left out left out.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "compositor/compositor.h"
#include "gl_fixture.h"
#include "grey_plate.h"

namespace matchlight::test {

struct Shot {
    Scene scene;
    Solve solve;
};

/// A chrome ball on the sample's table.
inline Shot make_shot() {
    Shot shot;
    Warnings warnings;
    warnings.set_quiet(true);
    const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
    shot.scene = load_scene(folder / "table.toml", warnings);
    shot.scene.quality = QualityLevel::draft;
    shot.solve.camera = camera_for_size(load_camera(folder / "camera.yaml"), 320, 180, folder / "camera.yaml");
    SolvedFrame frame;
    frame.camera_from_world = camera_before_the_table();
    frame.exposure_ev = -1;
    shot.solve.frames.push_back(frame);
    ObjectSettings ball;
    ball.shape = "sphere";
    ball.name = "ball";
    ball.scale.setConstant(0.05);
    ball.translate_m.z() = 0.03;
    ball.material.metallic = 1;
    ball.material.roughness = 0;
    shot.scene.objects = {ball};
    return shot;
}

class CompositorTest : public GlTest {
protected:
    CompositedFrame composite(const Shot& shot, bool leave_out) {
        Warnings warnings;
        warnings.set_quiet(true);
        Compositor compositor(context(), shot.scene, shot.solve,
                              {.quality = shot.scene.quality, .leave_out = leave_out}, warnings);
        CompositedFrame frame = compositor.composite(grey_plate(320, 180, plate_luma_));
        reports_ = compositor.reports();
        return frame;
    }
    bool was_drawn(const std::string& pass) const {
        return std::any_of(reports_.begin(), reports_.end(),
                           [&](const PassReport& report) { return report.name == pass && report.drawn; });
    }
    /// The frame with everything drawn is the frame with passes left out, and `pass` is among those.
    void expect_same_without(const Shot& shot, const std::string& pass) {
        const CompositedFrame lean = composite(shot, true);
        EXPECT_FALSE(was_drawn(pass)) << pass;
        const CompositedFrame whole = composite(shot, false);
        EXPECT_TRUE(std::ranges::equal(lean.rgb16().samples(), whole.rgb16().samples())) << pass;
        EXPECT_EQ(whole.reach, (Region{0, 0, 320, 180})) << "everything was drawn";
    }

    std::vector<PassReport> reports_;
    std::uint8_t plate_luma_ = 120;
};

}  // namespace matchlight::test
