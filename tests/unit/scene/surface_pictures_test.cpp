// What the scene lays on surfaces: settings arrive, pictures that are wrong are refused, maps are what they are said to
// be.
#include "scene/surface_pictures.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "media/image_io.h"
#include "scene/relief_map.h"
#include "temporary_folder.h"

namespace matchlight {
namespace {

using testing::HasSubstr;

class SurfacePicturesTest : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
        write_png8(folder_ / "grey.png", Image8(4, 4, 1, 128));
        write("broken.png", "\x89PNG and no more");
    }
    Scene load(const std::string& material) {
        return load_scene(write("scene.toml",
                                "[camera]\nwidth = 8\nheight = 8\norbit = {radius = 1}\n"
                                "[[object]]\nshape = \"plane\"\n[object.material]\n" +
                                    material),
                          warnings_);
    }
    template <class Call>
    std::string error_of(const Call& call) {
        try {
            call();
        } catch (const InputError& error) {
            std::string line = error.what();
            const std::string prefix = folder_.string() + "/";
            if (const std::size_t at = line.find(prefix); at != std::string::npos) line.erase(at, prefix.size());
            EXPECT_EQ(line.find('\n'), std::string::npos);
            return line;
        }
        return "no error";
    }
    std::string error_of_pictures(const std::string& material) {
        return error_of([&] {
            Model plane = make_shape("plane", "test");
            load_surface_pictures(plane, load(material).objects[0].material, warnings_);
        });
    }

    Warnings warnings_;
};

TEST_F(SurfacePicturesTest, SettingsArrive) {
    const Scene scene = load(
        "height_map = \"grey.png\"\nheight = 0.02\nrelief = \"cone_step\"\nrelief_steps = 12\nuv_scale = 3\n"
        "normal_map = \"grey.png\"\ntexture_filter = \"nearest\"\ntexture_wrap = \"mirror\"\nanisotropy = 8\n"
        "pattern = {kind = \"marble\", space = \"uv\", color = [1, 0.5, 0], middle_color = [0.1, 0.2, 0.3], "
        "frequency = 5, direction = [0, 1, 0], octaves = 2, turbulence = 0.5, filtered = false}\n"
        "layers = [{texture = \"grey.png\", alpha = 0.25}, {texture = \"grey.png\", uv_scale = 2}]\n");
    const SurfaceDetail& detail = scene.objects[0].material.detail;
    EXPECT_EQ(
        detail.relief,
        (ReliefSettings{
            .height_map = folder_ / "grey.png", .depth_m = 0.02, .method = ReliefMethod::cone_step, .steps = 12}));
    EXPECT_EQ(detail.normal_map, folder_ / "grey.png");
    EXPECT_EQ(detail.uv_scale, 3);
    EXPECT_EQ(detail.sampling.filter, PictureFilter::nearest);
    EXPECT_EQ(detail.sampling.wrap, PictureWrap::mirror);
    EXPECT_EQ(detail.sampling.anisotropy, 8);
    ASSERT_TRUE(detail.pattern);
    EXPECT_EQ(detail.pattern->kind, PatternKind::marble);
    EXPECT_EQ(detail.pattern->space, PatternSpace::uv);
    EXPECT_EQ(detail.pattern->middle_color, (std::array<double, 3>{0.1, 0.2, 0.3}));
    EXPECT_EQ(detail.pattern->direction, (std::array<double, 3>{0, 1, 0}));
    EXPECT_FALSE(detail.pattern->filtered);
    ASSERT_EQ(detail.layers.size(), 2U);
    EXPECT_EQ(detail.layers[0].alpha, 0.25);
    EXPECT_EQ(detail.layers[1].uv_scale, 2);
    EXPECT_EQ(load("roughness = 1\n").objects[0].material.detail, SurfaceDetail{});
}

TEST_F(SurfacePicturesTest, RefusesWhatMakesNoSense) {
    const auto error = [&](const std::string& material) { return error_of([&] { load(material); }); };
    EXPECT_THAT(error("height = 0.1\n"), HasSubstr("carves nothing without a height_map"));
    EXPECT_THAT(error("height_map = \"grey.png\"\n"), HasSubstr("needs to know how deep it is"));
    EXPECT_THAT(error("height_map = \"none.png\"\nheight = 1\n"), HasSubstr("none.png"));
    EXPECT_THAT(error("pattern = {kind = \"wood\", direction = [0, 0, 0]}\n"), HasSubstr("has no direction"));
    EXPECT_THAT(error("pattern = {kind = \"stripes\"}\n"), HasSubstr("square_wave"));
    EXPECT_THAT(error("pattern = {frequency = 4}\n"), HasSubstr("'kind' is missing"));
    EXPECT_THAT(error("layers = []\n"), HasSubstr("at least one entry"));
    EXPECT_THAT(error("layers = [{alpha = 1}]\n"), HasSubstr("'texture' is missing"));
    EXPECT_THAT(error("relief = \"sphere_trace\"\n"), HasSubstr("sphere_tracing"));
    EXPECT_THAT(error("heigth_map = \"grey.png\"\n"), HasSubstr("did you mean 'height_map'?"));
}

TEST_F(SurfacePicturesTest, RefusesPicturesThatCannotBeRead) {
    for (const char* material : {"height_map = \"broken.png\"\nheight = 1\n", "normal_map = \"broken.png\"\n",
                                 "layers = [{texture = \"broken.png\"}]\n",
                                 // Flat, it is read all the same.
                                 "height_map = \"broken.png\"\nheight = 0\n"}) {
        EXPECT_THAT(error_of_pictures(material), HasSubstr("broken.png")) << material;
    }
    write_png8(folder_ / "wide.png", Image8(16385, 1, 1, 128));
    for (const char* material : {"height_map = \"wide.png\"\nheight = 1\n", "normal_map = \"wide.png\"\n",
                                 "layers = [{texture = \"wide.png\"}]\n"}) {
        EXPECT_THAT(error_of_pictures(material), HasSubstr("16384")) << material;
    }
}

TEST_F(SurfacePicturesTest, LieAsTheSceneSays) {
    Model plane = make_shape("plane", "test");
    const float before = plane.meshes[0].vertices.back().uv[0];
    const SurfacePictures pictures =
        load_surface_pictures(plane,
                              load("height_map = \"grey.png\"\nheight = 0.1\nuv_scale = 4\nnormal_map = \"grey.png\"\n"
                                   "texture_filter = \"linear\"\nanisotropy = 4\n")
                                  .objects[0]
                                  .material,
                              warnings_);
    EXPECT_EQ(plane.meshes[0].vertices.back().uv[0], 4 * before);
    EXPECT_NEAR(pictures.u_extent, 0.25, 1e-6);
    EXPECT_NEAR(pictures.v_extent, 0.25, 1e-6);
    EXPECT_NEAR(pictures.heights.at(2, 2), 128 / 255.0, 1e-4);
    ASSERT_EQ(plane.textures.size(), 1U);
    EXPECT_EQ(plane.materials[0].texture(MaterialSlot::normal), 0);
    EXPECT_EQ(plane.textures[0].sampling.mipmaps, TextureMipmaps::none);
    EXPECT_EQ(plane.textures[0].sampling.anisotropy, 4);
    EXPECT_TRUE(
        load_surface_pictures(plane, load("height_map = \"grey.png\"\nheight = 0\n").objects[0].material, warnings_)
            .heights.empty());
}

TEST_F(SurfacePicturesTest, AreLeftOutWithoutCoordinates) {
    Model plane = make_shape("plane", "test");
    for (ModelVertex& vertex : plane.meshes[0].vertices) vertex.uv = {0, 0};
    const MaterialOverride material =
        load("height_map = \"grey.png\"\nheight = 0.1\nlayers = [{texture = \"grey.png\"}]\n").objects[0].material;
    Warnings warnings;
    warnings.set_quiet(true);
    const SurfacePictures pictures = load_surface_pictures(plane, material, warnings);
    EXPECT_TRUE(pictures.heights.empty() && pictures.layers.empty());
    EXPECT_EQ(warnings.total(), 1);
}

ImageF hills(int width, int height) {
    ImageF heights(width, height, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            heights.at(x, y) = static_cast<float>(0.5 + 0.25 * std::sin(0.4 * x) + 0.25 * std::cos(0.03 * y * x));
    }
    return heights;
}

TEST(ReliefMap, ConesMeetNothingHigher) {
    for (const PictureWrap wrap : {PictureWrap::repeat, PictureWrap::clamp}) {
        const ImageF heights = hills(21, 13);
        const ImageF cones = cones_of(heights, wrap);
        const int around = wrap == PictureWrap::repeat ? 1 : 0;
        for (int y = 0; y < 13; ++y) {
            for (int x = 0; x < 21; ++x) {
                double narrowest = 1;  // every other texel, one by one
                for (int j = -13 * around; j < 13 + 13 * around; ++j) {
                    for (int i = -21 * around; i < 21 + 21 * around; ++i) {
                        const double rise =
                            static_cast<double>(heights.at(wrapped(i, 21, wrap), wrapped(j, 13, wrap))) -
                            heights.at(x, y);
                        if (rise > 0)
                            narrowest = std::min(narrowest, std::hypot((i - x) / 21.0, (j - y) / 13.0) / rise);
                    }
                }
                ASSERT_NEAR(cones.at(x, y), narrowest, 1e-6) << x << ", " << y;
            }
        }
    }
}

TEST(ReliefMap, DistancesReachNoGround) {
    const ImageF heights = hills(32, 16);
    constexpr double u_extent = 3, v_extent = 2;
    const std::vector<ImageF> layers = distances_above(heights, PictureWrap::repeat, u_extent, v_extent);
    double longest = 0;
    for (std::size_t layer = 0; layer < layers.size(); layer += 5) {
        const double depth = static_cast<double>(layer) / static_cast<double>(layers.size() - 1);
        for (int y = 0; y < 16; y += 3) {
            for (int x = 0; x < 32; x += 3) {
                const double way = layers[layer].at(x, y);
                longest = std::max(longest, way);
                if (way == 0) continue;
                EXPECT_LT(depth, 1 - heights.at(x, y));
                for (int i = 0; i < 64; ++i) {
                    const double turn = 0.3 + i, down = std::sin(0.9 * i) * way,
                                 across = std::sqrt(way * way - down * down);
                    const double u = (x + 0.5) / 32 + std::cos(turn) * across / u_extent;
                    const double v = (y + 0.5) / 16 + std::sin(turn) * across / v_extent;
                    EXPECT_GE(1 - height_at(heights, PictureWrap::repeat, u, v), std::min(depth + down, 1.0) - 0.05);
                }
            }
        }
    }
    EXPECT_GT(longest, 0.2);
}

TEST(ReliefMap, SlopesAreThoseOfARamp) {
    ImageF ramp(16, 4, 1);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 16; ++x) ramp.at(x, y) = static_cast<float>(x) / 16;
    }
    const ImageF slopes = slopes_of(ramp, PictureWrap::clamp);
    EXPECT_FLOAT_EQ(slopes.at(7, 2, 0), 1);
    EXPECT_FLOAT_EQ(slopes.at(7, 2, 1), 0);
    EXPECT_FLOAT_EQ(slopes.at(0, 2, 0), 0.5F);  // half of its two sides is beyond the edge
    EXPECT_FLOAT_EQ(slopes_of(ramp, PictureWrap::mirror).at(15, 0, 0), 0.5F);
    EXPECT_FLOAT_EQ(slopes_of(ImageF(1, 1, 1, 0.3F), PictureWrap::repeat).at(0, 0, 0), 0);
    EXPECT_NEAR(height_at(ramp, PictureWrap::repeat, 0.5, 0.3), 7.5 / 16, 1e-6);
}

}  // namespace
}  // namespace matchlight
