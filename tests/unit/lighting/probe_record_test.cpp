// What built probes say of their pixels is read back, resampled with them and summed up over the sphere.
#include "lighting/probe_record.h"

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

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
    EXPECT_FALSE(distances_of(record_));
}

TEST_F(ProbeRecordTest, DistancesComeBackAsNearnessAndWhatIsNoneIsFar) {
    // Left half: 2 m; right half: 1 m above the horizon, and below it what says nothing.
    const ImageF light(64, 32, 3, 1.0f);
    RecordedChannels beside{{}, ImageF(64, 32, 1)};
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) beside.image.at(x, y) = x < 32 ? 0.5f : y < 16 ? 1.0f : 0.0f;
    }
    store_distances(beside, 0);
    EXPECT_EQ(beside.names, std::vector<std::string>{"distance_m"});
    EXPECT_EQ(beside.image.at(0, 0), 2);
    EXPECT_EQ(beside.image.at(40, 30), 0);
    beside.image.at(40, 20) = std::numeric_limits<float>::infinity();
    beside.image.at(41, 20) = std::numeric_limits<float>::quiet_NaN();
    beside.image.at(42, 20) = -3;
    write_probe_image(path_, light, layout_of_size(ProbeMapping::latlong, 32), {}, beside);
    coverage();
    ASSERT_TRUE(record_.nearness);
    EXPECT_EQ(record_.nearness->at(3, 3), 0.5f);
    EXPECT_EQ(record_.nearness->at(50, 3), 1);
    for (const int x : {40, 41, 42, 50}) EXPECT_EQ(record_.nearness->at(x, 20), 0) << x;
    const auto found = distances_of(record_);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->known_share, 0.75, 1e-6);
    EXPECT_EQ(found->least_m, 1);
    EXPECT_EQ(found->median_m, 2);
}

TEST_F(ProbeRecordTest, DistancesKeepThroughMappings) {
    RecordedChannels beside{{}, ImageF(64, 32, 1)};
    for (int y = 16; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) beside.image.at(x, y) = 2;  // below the horizon half a metre
    }
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, 32);
    const ProbeLayout cube = layout_of_size(ProbeMapping::cube, 16);
    beside.image = resample(beside.image, latlong, cube);
    store_distances(beside, 0);
    write_probe_image(path_, ImageF(cube.width, cube.height, 3, 1.0f), cube, {}, beside);
    coverage();
    ASSERT_TRUE(record_.nearness);
    const int rows = record_.nearness->height();
    for (int x = 0; x < record_.nearness->width(); ++x) {
        // A pixel of either image beside the horizon holds some of both sides.
        EXPECT_EQ(record_.nearness->at(x, rows / 2 - 4), 0) << x;
        EXPECT_NEAR(record_.nearness->at(x, rows / 2 + 3), 2, 1e-3) << x;
    }
    // Mixed pixels lie farther, never nearer: means are of nearness.
    const auto found = distances_of(record_);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->least_m, 0.5, 1e-3);
    EXPECT_NEAR(found->median_m, 0.5, 1e-3);
}

}  // namespace
}  // namespace matchlight
