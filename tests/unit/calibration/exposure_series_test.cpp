// Exposures from EXIF and from the user, and what a series refuses.
#include "calibration/exposure_series.h"

#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "../media/scratch_folder.h"
#include "core/error.h"
#include "synthetic_dng.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

struct Exif {
    double exposure_s = 0, f_number = 0;
    int iso = 0;
};

class ExposureSeriesTest : public ScratchFolder {
protected:
    fs::path write_photograph(const std::string& name, const Exif& exif, std::uint8_t code, int width = 8) const {
        const fs::path path = folder_ / name;
        OIIO::ImageSpec spec(width, 8, 3, OIIO::TypeDesc::UINT8);
        if (exif.exposure_s > 0) spec.attribute("ExposureTime", static_cast<float>(exif.exposure_s));
        if (exif.f_number > 0) spec.attribute("FNumber", static_cast<float>(exif.f_number));
        if (exif.iso > 0) spec.attribute("Exif:PhotographicSensitivity", exif.iso);
        const std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * 8 * 3, code);
        const auto output = OIIO::ImageOutput::create(path.string());
        EXPECT_TRUE(output->open(path.string(), spec) && output->write_image(OIIO::TypeDesc::UINT8, pixels.data()) &&
                    output->close());
        return path;
    }
    std::string error_of(const std::vector<fs::path>& photographs, const ExposureOptions& given = {}) {
        try {
            read_exposure_series(photographs, given, warnings_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }
};

TEST_F(ExposureSeriesTest, ReadsTimeFNumberAndIsoAndOrdersByThem) {
    const auto dark = write_photograph("a.jpg", {1.0 / 3840, 22.627417, 100}, 20);
    const auto bright = write_photograph("b.jpg", {2.0 / 15, 8, 100}, 200);
    const auto sensitive = write_photograph("c.jpg", {2.0 / 15, 8, 400}, 250);
    const ExposureSeries series = read_exposure_series({dark, bright, sensitive}, {}, warnings_);
    ASSERT_EQ(series.shots.size(), 3u);
    EXPECT_EQ(series.shots[0].path, sensitive);
    EXPECT_EQ(series.shots[2].path, dark);
    // The library that writes these files rounds times to some four digits.
    EXPECT_NEAR(series.shots[0].exposure, 4 * (2.0 / 15) / 64, 1e-5);
    EXPECT_NEAR(series.shots[1].exposure, (2.0 / 15) / 64, 1e-5);
    EXPECT_NEAR(series.shots[2].exposure / series.shots[1].exposure, 1.0 / 4096, 1e-6);
    EXPECT_NEAR(series.shots[1].code.at(4, 4, 1), 200.0 / 255, 2.0 / 255);
    EXPECT_FALSE(series.shots[1].linear);
    EXPECT_NEAR(series.shots[1].code_step, 1.0 / 255, 1e-12);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ExposureSeriesTest, WhatTheUserSaysReplacesExif) {
    const auto a = write_photograph("a.png", {}, 20), b = write_photograph("b.png", {}, 200);
    const ExposureSeries series = read_exposure_series({a, b}, {{1.0 / 30, 0.5}, {8}, {200}}, warnings_);
    EXPECT_EQ(series.shots[0].path, b);
    EXPECT_NEAR(series.shots[0].exposure, 0.5 * 2 / 64, 1e-12);
}

TEST_F(ExposureSeriesTest, WhatIsNotKnownOfSomeIsThatOfTheOthersWhereTheyAgree) {
    const auto a = write_photograph("a.jpg", {1.0 / 30, 8, 100}, 20),
               b = write_photograph("b.jpg", {1.0 / 60, 8, 0}, 9);
    const ExposureSeries series = read_exposure_series({a, b}, {}, warnings_);
    EXPECT_NEAR(series.shots[0].exposure / series.shots[1].exposure, 2, 1e-3);
    EXPECT_EQ(warned("does not say its ISO value"), 1);
    const auto c = write_photograph("c.jpg", {1.0 / 60, 8, 400}, 9);
    EXPECT_NE(error_of({a, b, c}).find("b.jpg: does not say its ISO value, which differs"), std::string::npos);
}

TEST_F(ExposureSeriesTest, RefusesWithACause) {
    const auto a = write_photograph("a.jpg", {1.0 / 30, 8, 100}, 20),
               b = write_photograph("b.jpg", {1.0 / 60, 8, 100}, 9);
    const auto same = write_photograph("same.jpg", {1.0 / 30, 8, 100}, 20);
    const auto none = write_photograph("none.png", {}, 20);
    const auto wide = write_photograph("wide.jpg", {1.0 / 90, 8, 100}, 20, 16);
    EXPECT_NE(error_of({}).find("no photographs"), std::string::npos);
    EXPECT_NE(error_of({a, a}).find("is given twice"), std::string::npos);
    EXPECT_NE(error_of({a, folder_ / "." / "a.jpg"}).find("is given twice"), std::string::npos);
    EXPECT_NE(error_of({a, same}).find("all 2 photographs have the same exposure"), std::string::npos);
    EXPECT_NE(error_of({a, none}).find("none.png: its EXIF data has no exposure time"), std::string::npos);
    EXPECT_NE(error_of({a, wide}).find("wide.jpg: 16 × 8 pixels, but a.jpg has 8 × 8"), std::string::npos);
    EXPECT_NE(error_of({a, b}, {{0.1}, {}, {}}).find("1 exposure times for 2 photographs"), std::string::npos);
    EXPECT_NE(error_of({a, b}, {{0.1, 0}, {}, {}}).find("b.jpg: its exposure time is 0"), std::string::npos);
    EXPECT_NE(error_of({a, b}, {{0.1, -1}, {}, {}}).find("its exposure time is -1"), std::string::npos);
    EXPECT_NE(error_of({a, b}, {{0.1, 0.2}, {0}, {}}).find("its f-number is 0"), std::string::npos);
    EXPECT_NE(error_of({a, folder_ / "missing.jpg"}).find("missing.jpg: no such file"), std::string::npos);
    EXPECT_EQ(error_of({a}), "accepted");
    EXPECT_EQ(warned("one photograph alone"), 1);
}

TEST_F(ExposureSeriesTest, RawFilesAreLinearAndNothingFollowsTheirContent) {
    if (!OIIO::ImageInput::create("raw")) GTEST_SKIP() << "OpenImageIO was built without LibRaw";
    const fs::path bright = write_bytes("bright.dng", SyntheticDng{.level = 8000, .time_divisor = 30}.bytes());
    const fs::path dark = write_bytes("dark.DNG", SyntheticDng{.level = 2000, .time_divisor = 120}.bytes());
    const ExposureSeries series = read_exposure_series({dark, bright}, {}, warnings_);
    ASSERT_EQ(series.shots[0].path, bright);
    EXPECT_NEAR(series.shots[0].exposure, 1.0 / 30 / 64, 1e-6);
    EXPECT_NEAR(series.shots[1].exposure, 1.0 / 120 / 64, 1e-6);
    for (const Photograph& shot : series.shots) {
        EXPECT_TRUE(shot.linear);
        const double expected = (shot.path == bright ? 8000.0 : 2000.0) / 16383;
        // The colour matrix, rounded to ten-thousandths, is not quite its own inverse.
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(shot.code.at(30, 20, c), expected, 3e-4 * expected + 1e-5);
    }
    const fs::path developed = write_photograph("developed.jpg", {1.0 / 60, 8, 100}, 9, 64);
    EXPECT_NE(error_of({bright, write_bytes("broken.dng", "no raw file")}).find("broken.dng: is no readable raw file"),
              std::string::npos);
    EXPECT_NE(error_of({bright, developed}), "accepted");
}

TEST(Seconds, FractionsAndNumbers) {
    EXPECT_DOUBLE_EQ(seconds_from_text("1/30"), 1.0 / 30);
    EXPECT_DOUBLE_EQ(seconds_from_text("2/15"), 2.0 / 15);
    EXPECT_DOUBLE_EQ(seconds_from_text("0.5"), 0.5);
    EXPECT_DOUBLE_EQ(seconds_from_text("32"), 32);
    for (const char* wrong : {"", "1/0", "0", "-1", "1/", "/2", "1s", "nan", "inf", "1/2/3"})
        EXPECT_THROW(seconds_from_text(wrong), InputError) << wrong;
}

}  // namespace
}  // namespace matchlight
