// The aperture's image: areas that are known, repeatable dirt, pictures from files.
#include "render/effects/aperture.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using std::numbers::pi;

double sum_of(const Image<double>& image) {
    double sum = 0;
    for (const double sample : image.samples()) sum += sample;
    return sum;
}

class ScratchPicture {
public:
    explicit ScratchPicture(const std::string& name)
        : path_(fs::temp_directory_path() / (std::to_string(::getpid()) + name)) {}
    ~ScratchPicture() { fs::remove(path_); }
    ScratchPicture(const ScratchPicture&) = delete;
    ScratchPicture& operator=(const ScratchPicture&) = delete;
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

TEST(Aperture, PolygonsAndCirclesHaveTheirAreas) {
    constexpr int side = 256;
    const double radius = side / (2.0 * aperture_field);
    for (const int blades : {0, 3, 4, 5, 6, 7, 9, 32}) {
        const ApertureSettings settings{.blades = blades, .rotation_deg = 11.3};
        const double area =
            blades == 0 ? pi * radius * radius : blades / 2.0 * radius * radius * std::sin(2 * pi / blades);
        // 256 points of each texel at the rim: the rim's 200 texels err by less than a point's share of 1/16 each.
        EXPECT_NEAR(sum_of(make_aperture_image(settings, side)), area, 1.0) << blades;
    }
    const ApertureSettings round{.blades = 5, .roundness = 1};
    EXPECT_NEAR(sum_of(make_aperture_image(round, side)), pi * radius * radius, 1.0);
}

TEST(Aperture, BladesFaceTheirRotationCounterClockwise) {
    const ApertureSettings settings{.blades = 3, .rotation_deg = 90};
    // A triangle whose one edge faces up: the middle of an edge is half as far away as a corner.
    EXPECT_NEAR(aperture_edge(settings, pi / 2), 0.5, 1e-12);
    EXPECT_NEAR(aperture_edge(settings, pi / 2 + pi / 3), 1, 1e-12);
    EXPECT_NEAR(aperture_edge(settings, -pi / 2), 1, 1e-12);
    const Image<double> image = make_aperture_image(settings, 64);
    // Rows count downwards: up at 0.75 of the radius (8 texels) is dark, down is open.
    EXPECT_EQ(image.at(32, 32 - 6), 0);
    EXPECT_EQ(image.at(32, 32 + 5), 1);
}

TEST(Aperture, LashesAndDustTakeLightAwayAndAreTheSameEveryTime) {
    const ApertureSettings clean{.blades = 8};
    ApertureSettings dirty = clean;
    dirty.eyelashes = 20;
    dirty.dust = 50;
    const Image<double> first = make_aperture_image(dirty, 512);
    const Image<double> again = make_aperture_image(dirty, 512);
    const Image<double> open = make_aperture_image(clean, 512);
    EXPECT_TRUE(std::equal(first.samples().begin(), first.samples().end(), again.samples().begin()));
    EXPECT_LT(sum_of(first), 0.97 * sum_of(open));
    EXPECT_GT(sum_of(first), 0.3 * sum_of(open));
    for (std::size_t i = 0; i < first.samples().size(); ++i) {
        ASSERT_GE(first.samples()[i], 0);
        ASSERT_LE(first.samples()[i], open.samples()[i]);
    }
    dirty.seed = 2;
    const Image<double> other = make_aperture_image(dirty, 512);
    EXPECT_FALSE(std::equal(first.samples().begin(), first.samples().end(), other.samples().begin()));
    // Lashes hang from above.
    dirty.dust = 0;
    const Image<double> lashes = make_aperture_image(dirty, 512);
    double above = 0, below = 0;
    for (int y = 0; y < 512; ++y) {
        for (int x = 0; x < 512; ++x) (y < 256 ? above : below) += open.at(x, y) - lashes.at(x, y);
    }
    EXPECT_GT(above, 2 * below);
}

TEST(Aperture, PicturesAreFittedToTheOpening) {
    const ScratchPicture file("aperture.png");
    // White on the left half, grey on the right: 40 × 20.
    Image8 picture(40, 20, 3, 255);
    for (int y = 0; y < 20; ++y) {
        for (int x = 20; x < 40; ++x) std::fill_n(picture.pixel(x, y), 3, std::uint8_t{51});
    }
    write_png8(file.path(), picture);
    ApertureSettings settings;
    settings.image = file.path();
    const Image<double> image = make_aperture_image(settings, 256);
    // The longer side spans 64 texels, the shorter 32.
    EXPECT_NEAR(sum_of(image), 32 * 32 * (1 + 0.2), 1e-6);
    EXPECT_NEAR(image.at(128 - 16, 128), 1, 1e-9);
    EXPECT_NEAR(image.at(128 + 16, 128), 0.2, 1e-9);
    EXPECT_EQ(image.at(128, 128 - 17), 0);
    EXPECT_EQ(image.at(128 - 33, 128), 0);
}

TEST(Aperture, RefusesPicturesThatLetNoLightThrough) {
    const ScratchPicture black("black.png");
    write_png8(black.path(), Image8(8, 8, 3, 0));
    ApertureSettings settings;
    settings.image = black.path();
    EXPECT_THROW(make_aperture_image(settings, 64), InputError);
    settings.image = black.path().string() + "missing";
    EXPECT_THROW(make_aperture_image(settings, 64), InputError);
    const ScratchPicture damaged("damaged.png");
    std::ofstream(damaged.path()) << "no picture";
    settings.image = damaged.path();
    EXPECT_THROW(make_aperture_image(settings, 64), InputError);
}

TEST(Aperture, RefusesSettingsOutOfRange) {
    EXPECT_NO_THROW((ApertureSettings{.blades = 0}.check()));
    for (const int blades : {-1, 1, 2, 33})
        EXPECT_THROW((ApertureSettings{.blades = blades}.check()), std::invalid_argument);
    EXPECT_THROW((ApertureSettings{.roundness = 1.1}.check()), std::invalid_argument);
    EXPECT_THROW((ApertureSettings{.f_number = 0.0}.check()), std::invalid_argument);
    EXPECT_THROW((ApertureSettings{.pixel_pitch_um = -1.0}.check()), std::invalid_argument);
}

}  // namespace
}  // namespace matchlight
