// A ball and a box on the sample's table, seen by a camera that stands still: for tests of what changes over them.
#pragma once

#include <cstdint>
#include <filesystem>

#include "compositor/compositor.h"
#include "gl_fixture.h"
#include "grey_plate.h"

namespace matchlight::test {

class BallAndBox : public GlTest {
protected:
    /// Frames of so many pixels.
    void set_up(int width, int height) {
        warnings_.set_quiet(true);
        const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
        scene_ = load_scene(folder / "table.toml", warnings_);
        solve_.camera = camera_for_size(load_camera(folder / "camera.yaml"), width, height, folder / "camera.yaml");
        for (std::int64_t i = 0; i < 4; ++i) {
            SolvedFrame frame;
            frame.frame = i;
            frame.time_s = static_cast<double>(i) / 25;
            frame.camera_from_world = camera_before_the_table();
            frame.exposure_ev = -1;
            solve_.frames.push_back(frame);
        }
        ObjectSettings ball, box;
        ball.shape = "sphere";
        ball.name = "ball";
        ball.scale.setConstant(0.05);
        ball.translate_m = {-0.06, 0, 0.03};
        box.shape = "box";
        box.name = "box";
        box.scale.setConstant(0.06);
        box.translate_m = {0.05, 0, 0.03};
        scene_.objects = {ball, box};
    }
    PlateFrame plate(std::int64_t frame) const {
        return grey_plate(solve_.camera.width, solve_.camera.height, 120, frame);
    }
    /// Coarse, so that maps are made quickly.
    static Quality coarse_quality() {
        return {.supersampling = 1,
                .mirror_face_px = 32,
                .shadow = {.directions = 8, .resolution = 64},
                .object_shadow = {.directions = 4, .resolution = 32},
                .reflection = {.lobe_rays = 1, .bounces = 1},
                .bounce = {.rays = 4, .surface_rays = 4, .bounces = 1, .surface_points = 8}};
    }

    Warnings warnings_;
    Scene scene_;
    Solve solve_;
};

}  // namespace matchlight::test
