// What built probes say of their pixels is read back, resampled with them and summed up over the sphere.
#include "lighting/probe_record.h"

#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "lighting/resample.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class ProbeRecordTest : public testing::Test {
protected:
    ProbeRecordTest() : path_(fs::temp_directory_path() / ("probe_record_" + std::to_string(getpid()) + ".exr")) {}
    ~ProbeRecordTest() override { fs::remove(path_); }

    /// A furnace whose lower half was not seen, whose upper quarter's columns left of the middle are clipped.
    ImageF built_probe() const {
        ImageF image(64, 32, 6, 1.0f);
        for (int y = 0; y < 32; ++y) {
            for (int x = 0; x < 64; ++x) {
                image.at(x, y, 3) = 0.02f;
                image.at(x, y, 4) = y < 16 ? 1.0f : 0.0f;
                image.at(x, y, 5) = y < 16 && x < 32 ? 1.0f : 0.0f;
            }
        }
        return image;
    }
    void write(const ImageF& image) const {
        write_exr(path_, image.width(), image.height(),
                  {{.name = "",
                    .channels = {"R", "G", "B", "sigma", "seen", "clipped"},
                    .image = &image,
                    .half = false,
                    .data_window = {}}},
                  {{"mapping", "latlong"}, {"place_m", "0 0.02 0.04"}});
    }
    ProbeCoverage coverage() {
        const ProbeImage file = read_probe_image(path_, std::nullopt, warnings_);
        record_ = read_probe_record(path_, file);
        return coverage_of(record_, unwrapped(file).latlong);
    }

    fs::path path_;
    Warnings warnings_;
    ProbeRecord record_;
};

TEST_F(ProbeRecordTest, ChannelsAndMetadataComeBack) {
    write(built_probe());
    const ProbeCoverage found = coverage();
    EXPECT_NEAR(found.clipped, 0.25, 1e-6);
    ASSERT_TRUE(found.unseen);
    EXPECT_NEAR(*found.unseen, 0.5, 1e-6);
    ASSERT_TRUE(found.median_sigma);
    EXPECT_NEAR(*found.median_sigma, 0.02, 1e-6);
    EXPECT_EQ(record_.metadata["place_m"], "0 0.02 0.04");
}

TEST_F(ProbeRecordTest, WhatIsNoNumberIsNotTrusted) {
    ImageF image = built_probe();
    for (int x = 0; x < 64; ++x) {
        image.at(x, 15, 4) = std::numeric_limits<float>::quiet_NaN();
        image.at(x, 15, 5) = std::numeric_limits<float>::quiet_NaN();
    }
    write(image);
    const ProbeCoverage found = coverage();
    EXPECT_GT(*found.unseen, 0.5);
    EXPECT_GT(found.clipped, 0.25);
    EXPECT_LE(*found.unseen, 0.6);
}

TEST_F(ProbeRecordTest, APlainProbeSaysNothing) {
    const ImageF image(64, 32, 3, 1.0f);
    write_exr(path_, 64, 32,
              {{.name = "", .channels = {"R", "G", "B"}, .image = &image, .half = true, .data_window = {}}}, {});
    const ProbeCoverage found = coverage();
    EXPECT_FALSE(found.unseen);
    EXPECT_FALSE(found.median_sigma);
    EXPECT_EQ(found.clipped, 0);
}

}  // namespace
}  // namespace matchlight
