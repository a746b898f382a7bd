// Footage of ten bits with HDR curves and wide primaries: light inside is Rec.709's, codes are the footage's.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "calibration/response.h"
#include "compositor/compositor.h"
#include "core/primaries.h"
#include "gl_fixture.h"
#include "grey_plate.h"

namespace matchlight {
namespace {

struct WideFootage {
    AVColorTransferCharacteristic transfer;
    AVColorPrimaries primaries;
    Primaries expected;
    Response response;
};

/// A ten-bit R'G'B' plate of one saturated colour.
PlateFrame wide_plate(const WideFootage& footage, int width, int height, const Eigen::Vector3i& code) {
    AVFrame* raw = av_frame_alloc();
    raw->width = width;
    raw->height = height;
    raw->format = AV_PIX_FMT_GBRP10;
    raw->color_trc = footage.transfer;
    raw->color_primaries = footage.primaries;
    av_frame_get_buffer(raw, 0);
    const int planes[] = {code.y(), code.z(), code.x()};  // G, B, R
    for (int plane = 0; plane < 3; ++plane) {
        for (int y = 0; y < height; ++y) {
            auto* row = reinterpret_cast<std::uint16_t*>(raw->data[plane] +
                                                         static_cast<std::ptrdiff_t>(y) * raw->linesize[plane]);
            std::fill_n(row, width, static_cast<std::uint16_t>(planes[plane]));
        }
    }
    const std::shared_ptr<AVFrame> samples(raw, [](AVFrame* frame) { av_frame_free(&frame); });
    return {samples, plate_format_of(*samples, 0, {}, "wide plate"), 0, 0.0};
}

class WideFootageTest : public GlTest, public testing::WithParamInterface<int> {
protected:
    static WideFootage footage() {
        switch (GetParam()) {
            case 0:
                return {AVCOL_TRC_SMPTE2084, AVCOL_PRI_BT2020, Primaries::rec2020, Response::pq()};
            case 1:
                return {AVCOL_TRC_ARIB_STD_B67, AVCOL_PRI_BT2020, Primaries::rec2020, Response::hlg()};
            default:
                return {AVCOL_TRC_BT709, AVCOL_PRI_SMPTE432, Primaries::p3, Response::srgb()};
        }
    }
};

TEST_P(WideFootageTest, IsCompositedInRec709AndGoesBackAsItCame) {
    const WideFootage wide = footage();
    Warnings warnings;
    warnings.set_quiet(true);
    const std::filesystem::path folder = std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "samples/table";
    Scene scene = load_scene(folder / "table.toml", warnings);
    Solve solve;
    solve.camera = camera_for_size(load_camera(folder / "camera.yaml"), 160, 90, folder / "camera.yaml");
    SolvedFrame frame;
    frame.camera_from_world = test::camera_before_the_table();
    frame.exposure_ev = 0;
    solve.frames = {frame};
    // A lamp that sends a colour of Rec.709 and reflects nothing.
    const Eigen::Vector3d lamp(0.02, 0.3, 0.1);
    ObjectSettings box;
    box.shape = "box";
    box.name = "box";
    box.scale.setConstant(0.08);
    box.translate_m.z() = 0.04;
    box.casts_shadow = false;
    box.material.diffuse = {0, 0, 0};
    box.material.specular = {0, 0, 0};
    box.material.emissive = {lamp.x(), lamp.y(), lamp.z()};
    scene.objects = {box};
    const Eigen::Vector3i code(640, 300, 120);
    const PlateFrame plate = wide_plate(wide, 160, 90, code);
    EXPECT_EQ(plate.format().primaries, wide.expected);

    Compositor compositor(context(), scene, solve, {.quality = QualityLevel::draft, .layers = true}, warnings);
    Eigen::Vector3d linear;
    for (int c = 0; c < 3; ++c) linear[c] = wide.response.linear_from_code(code[c] / 1023.0, c);
    const Eigen::Vector3d light = rec709_from(wide.expected) * linear;
    const Eigen::Vector3d sent = from_rec709(wide.expected) * lamp;
    const ImageF plate_linear = compositor.plate_linear(plate);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(plate_linear.at(3, 3, c), light[c], 1e-5);

    const CompositedFrame made = compositor.composite(plate);
    const FrameLayers& layers = *made.layers;
    const Image16 shown = made.rgb16(), before = plate.rgb16({0, 0, 160, 90});
    int solid = 0, untouched = 0, edges = 0;
    for (int y = 0; y < made.reach.height; ++y) {
        for (int x = 0; x < made.reach.width; ++x) {
            const float alpha = layers.alpha.at(x, y);
            solid += alpha > 0.999F ? 1 : 0;
            untouched += alpha == 0 ? 1 : 0;
            edges += alpha > 0 && alpha < 1 ? 1 : 0;
            for (int c = 0; c < 3; ++c) {
                if (alpha == 0) {
                    ASSERT_EQ(made.touched.at(x, y), 0);
                    ASSERT_EQ(shown.at(made.reach.x + x, made.reach.y + y, c), before.at(0, 0, c)) << "bit for bit";
                } else {
                    const double mixed = (1 - alpha) * linear[c] + alpha * sent[c];
                    const double expected = std::clamp(wide.response.code_from_linear(mixed, c), 0.0, 1.0);
                    // The layer is of half floats: 2^-11 of its light, in a curve that is steep in the dark.
                    EXPECT_NEAR(made.code.at(x, y, c), expected, 0.5 / 1023) << alpha;
                }
            }
        }
    }
    EXPECT_GT(solid, 100);
    EXPECT_GT(edges, 10);
    EXPECT_GT(untouched, 10);
}

INSTANTIATE_TEST_SUITE_P(Kinds, WideFootageTest, testing::Values(0, 1, 2));

}  // namespace
}  // namespace matchlight
