// FLIP against its authors' tool, against an independent implementation, and by its own definition.
#include "report/flip.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "report/change_region.h"
#include "report/flip_colors.h"
#include "report/image_error.h"

namespace matchlight {
namespace {

using nlohmann::json;
using test::cropped;
using test::flat_picture;
using test::noise_picture;
using test::read_picture;

json read_json(const std::filesystem::path& path) {
    std::ifstream stream(path);
    return json::parse(stream);
}

class FlipPair : public testing::Test {
protected:
    const std::filesystem::path folder_ = std::filesystem::path(MATCHLIGHT_TEST_DATA) / "compare";
    const Image8 truth_ = read_picture(folder_ / "truth.png");
    const Image8 plate_ = read_picture(folder_ / "plate.png");
    const json expected_ = read_json(folder_ / "expected.json");
};

TEST_F(FlipPair, AgreesWithAnIndependentImplementation) {
    ASSERT_EQ(expected_["flip"].size(), 3u);
    for (const json& expected : expected_["flip"]) {
        const ImageF map = flip_error_map(truth_, plate_, {expected["pixels_per_degree"].get<double>()});
        // Float against double: hues near grey lose about 1e-5.
        EXPECT_NEAR(masked_mean(map).value(), expected["mean"].get<double>(), 1e-5);
        for (const json& pixel : expected["pixels"]) {
            EXPECT_NEAR(map.at(pixel["x"], pixel["y"]), pixel["error"].get<double>(), 1e-4);
        }
    }
}

TEST_F(FlipPair, RegionIsThatOfTheRuler) {
    const Image8 region = change_region(plate_, truth_);
    const json& expected = expected_["region"];
    EXPECT_DOUBLE_EQ(mask_share(region), expected["share"].get<double>());
    EXPECT_NEAR(masked_mean(flip_error_map(truth_, plate_), &region).value(), expected["flip"].get<double>(), 1e-5);
    EXPECT_NEAR(psnr_db(truth_, plate_, &region).value(), expected["psnr_db"].get<double>(), 1e-9);
}

TEST_F(FlipPair, IsSymmetric) {
    const ImageF forth = flip_error_map(truth_, plate_), back = flip_error_map(plate_, truth_);
    for (std::size_t i = 0; i < forth.samples().size(); ++i) EXPECT_EQ(forth.samples()[i], back.samples()[i]);
}

TEST_F(FlipPair, OfAPictureWithItselfIsNothing) {
    const ImageF map = flip_error_map(truth_, truth_);
    for (const float error : map.samples()) EXPECT_EQ(error, 0);
}

TEST(Flip, OfFlatColoursIsTheirDistance) {
    const auto flip_of = [](const Image8& a, const Image8& b) { return masked_mean(flip_error_map(a, b)).value(); };
    const Image8 black = flat_picture(40, 40, 0, 0, 0), white = flat_picture(40, 40, 255, 255, 255);
    const Image8 green = flat_picture(40, 40, 0, 255, 0), blue = flat_picture(40, 40, 0, 0, 255);
    // Green against blue is the largest distance there is, by definition.
    EXPECT_NEAR(flip_of(green, blue), 1, 1e-6);
    // Black against white, from the paper's formulae: HyAB = 100. The CIELAB values of green (87.7362,
    // −86.1788, 83.1828) and blue (32.2982, 79.1935, −107.8593), chroma times L/100, lie 203.3017 apart.
    const double largest = std::pow(203.3017, 0.7), knee = 0.4 * largest;
    EXPECT_NEAR(flip_of(black, white), 0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (largest - knee), 1e-5);
}

TEST(Flip, StaysWithinItsRangeOnNoise) {
    const ImageF map = flip_error_map(noise_picture(97, 61, 1), noise_picture(97, 61, 2));
    for (const float error : map.samples()) {
        EXPECT_GE(error, 0);
        EXPECT_LE(error, 1);
    }
    EXPECT_GT(masked_mean(map).value(), 0.3);
}

TEST(Flip, DoesNotDependOnWhereABandStarts) {
    // The rows are cut into bands for the threads; taking away the top 37 rows moves every cut. Away from the border
    // (filter radius 10) the bits must stay.
    const Image8 a = noise_picture(60, 200, 3), b = noise_picture(60, 200, 4);
    const ImageF whole = flip_error_map(a, b), part = flip_error_map(cropped(a, 0, 37), cropped(b, 0, 37));
    for (int y = 10; y < part.height(); ++y) {
        for (int x = 0; x < part.width(); ++x) ASSERT_EQ(part.at(x, y), whole.at(x, y + 37)) << x << ", " << y;
    }
}

TEST(Flip, TakesPicturesSmallerThanItsFilters) {
    EXPECT_NEAR(masked_mean(flip_error_map(flat_picture(1, 1, 0, 255, 0), flat_picture(1, 1, 0, 0, 255))).value(), 1,
                1e-6);
    EXPECT_EQ(flip_error_map(flat_picture(3, 2, 9, 9, 9), flat_picture(3, 2, 9, 9, 9)).samples().size(), 6u);
}

TEST(FlipColors, RunFromBlackToPaleYellow) {
    ImageF map(2, 1, 1);
    map.at(0, 0) = 0;
    map.at(1, 0) = 1;
    const Image8 colors = flip_colors(map);
    // The ends of magma: (0.001, 0.000, 0.014) and (0.987, 0.991, 0.750).
    EXPECT_NEAR(colors.at(0, 0, 0), 0, 1);
    EXPECT_NEAR(colors.at(0, 0, 2), 4, 1);
    EXPECT_NEAR(colors.at(1, 0, 0), 252, 1);
    EXPECT_NEAR(colors.at(1, 0, 1), 253, 1);
    EXPECT_NEAR(colors.at(1, 0, 2), 191, 1);
}

/// Whole frames that the metric authors' own tool has measured; they are too large for the repository.
class FlipReference : public testing::Test {
protected:
    void SetUp() override {
        const char* data = std::getenv("MATCHLIGHT_DATA");
        if (data == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA does not name the test data";
        folder_ = std::filesystem::path(data) / "table";
    }
    static std::string numbered(const char* stem, int frame) {
        std::string digits = std::to_string(frame);
        return stem + std::string(3 - digits.size(), '0') + digits + ".png";
    }
    std::filesystem::path folder_;
};

TEST_F(FlipReference, AgreesWithTheAuthorsTool) {
    const json expected = read_json(folder_ / "flip_reference.json")["mean_flip"];
    double inside_sum = 0;
    for (std::size_t frame = 0; frame < expected.size(); ++frame) {
        const Image8 truth = read_picture(folder_ / numbered("truth_", static_cast<int>(frame)));
        const Image8 plate = read_picture(folder_ / numbered("plate_", static_cast<int>(frame)));
        const ImageF map = flip_error_map(truth, plate);
        // The tool's own output is printed to six digits and works in floats.
        EXPECT_NEAR(masked_mean(map).value(), expected[frame].get<double>(), 1e-5) << frame;
        const Image8 region = change_region(plate, truth);
        inside_sum += masked_mean(map, &region).value();
    }
    EXPECT_NEAR(inside_sum / static_cast<double>(expected.size()), 0.4957, 1e-4);
}

}  // namespace
}  // namespace matchlight
