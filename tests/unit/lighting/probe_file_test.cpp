// Probe files: what they are recognised as, what is repaired, and what is refused.
#include "lighting/probe_file.h"

#include <filesystem>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "lighting/resample.h"
#include "synthetic_probes.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using test::probe_of;

class ProbeFile : public testing::Test {
protected:
    ProbeFile() {
        fs::create_directories(folder_);
        warnings_.set_quiet(true);
    }
    ~ProbeFile() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const ImageF& image) const {
        const fs::path path = folder_ / name;
        write_exr(path, image.width(), image.height(), {{"rgb", {"R", "G", "B"}, &image, false, {}}}, {});
        return path;
    }
    ImageF marked_image(ProbeMapping mapping, int size, CubeLayout cube = CubeLayout::vertical_cross) const {
        return image_from_probe(probe_of(64, test::smooth_sky), layout_of_size(mapping, size, cube));
    }
    std::string refusal(const fs::path& path, std::optional<ProbeMapping> mapping = {}) {
        try {
            load_probe(path, mapping, warnings_);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    }

    fs::path folder_ = fs::temp_directory_path() / ("matchlight_probe_file_" + std::to_string(getpid()));
    Warnings warnings_;
};

TEST_F(ProbeFile, IsRecognisedByItsShape) {
    const auto mapping_of = [&](const fs::path& path) { return read_probe_image(path, {}, warnings_).layout.mapping; };
    EXPECT_EQ(mapping_of(write("a.exr", marked_image(ProbeMapping::latlong, 32))), ProbeMapping::latlong);
    EXPECT_EQ(mapping_of(write("b.exr", marked_image(ProbeMapping::angular, 64))), ProbeMapping::angular);
    EXPECT_EQ(mapping_of(write("My Mirror-Ball 3.exr", marked_image(ProbeMapping::mirrorball, 64))),
              ProbeMapping::mirrorball);
    for (const auto cube :
         {CubeLayout::vertical_cross, CubeLayout::horizontal_cross, CubeLayout::strip, CubeLayout::column}) {
        const auto probe = read_probe_image(write("c.exr", marked_image(ProbeMapping::cube, 16, cube)), {}, warnings_);
        EXPECT_EQ(probe.layout.mapping, ProbeMapping::cube);
        EXPECT_EQ(probe.layout.cube, cube);
    }
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ProbeFile, RecordsItsMapping) {
    for (const char* name : {"ball.exr", "ball.hdr"}) {
        const ImageF image = marked_image(ProbeMapping::mirrorball, 64);
        write_probe_image(folder_ / name, image, layout_of_size(ProbeMapping::mirrorball, 64), {});
        const bool exr = std::string(name).ends_with("exr");
        const ProbeImage probe = read_probe_image(folder_ / name, {}, warnings_);
        EXPECT_EQ(probe.layout.mapping, exr ? ProbeMapping::mirrorball : ProbeMapping::angular);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 64; ++x) {
                // Half floats keep 11 bits; RGBE keeps 8 of the largest channel.
                const float largest = std::max({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
                EXPECT_NEAR(probe.image.at(x, y, 1), image.at(x, y, 1), largest / (exr ? 2048 : 128));
            }
        }
    }
}

TEST_F(ProbeFile, KeepsASunBeyondHalfRange) {
    ImageF image(8, 4, 3, 1.0f);
    image.at(3, 1, 0) = 1e6f;
    write_probe_image(folder_ / "sun.exr", image, layout_of_size(ProbeMapping::latlong, 4), {});
    EXPECT_EQ(load_probe(folder_ / "sun.exr", {}, warnings_).latlong.at(3, 1, 0), 1e6f);
}

TEST_F(ProbeFile, RepairsWhatCannotBeLight) {
    ImageF image(8, 4, 3, 1.0f);
    image.at(0, 0, 0) = std::numeric_limits<float>::quiet_NaN();
    image.at(1, 0, 0) = -std::numeric_limits<float>::infinity();
    image.at(2, 0, 1) = std::numeric_limits<float>::infinity();
    image.at(3, 0, 2) = -2;
    const ProbeImage probe = read_probe_image(write("bad.exr", image), {}, warnings_);
    EXPECT_EQ(probe.image.at(0, 0, 0), 0);
    EXPECT_EQ(probe.image.at(1, 0, 0), 0);
    EXPECT_EQ(probe.image.at(2, 0, 1), 65504);
    EXPECT_EQ(probe.image.at(3, 0, 2), 0);
    EXPECT_EQ(probe.negative_samples, 2);
    EXPECT_EQ(warnings_.total(), 3);  // NaN, infinite, negative
}

TEST_F(ProbeFile, AllBlackIsAccepted) {
    EXPECT_EQ(load_probe(write("black.exr", ImageF(16, 8, 3)), {}, warnings_).latlong.height(), 8);
    EXPECT_EQ(load_probe(write("disc.exr", ImageF(16, 16, 3)), {}, warnings_).latlong.height(), 8);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ProbeFile, AWrongAspectIsRefused) {
    const auto wide = write("wide.exr", ImageF(50, 20, 3, 1.0f));
    EXPECT_NE(refusal(wide).find("wide.exr"), std::string::npos);
    EXPECT_NE(refusal(wide).find("50 × 20"), std::string::npos);
    const auto latlong = write("ll.exr", ImageF(40, 20, 3, 1.0f));
    EXPECT_NE(refusal(latlong, ProbeMapping::cube).find("mapping cube"), std::string::npos);
    EXPECT_NE(refusal(latlong, ProbeMapping::angular).find("mapping angular"), std::string::npos);
    EXPECT_NE(refusal(write("tiny.exr", ImageF(2, 2, 3)), ProbeMapping::mirrorball).find("4 × 4"), std::string::npos);
}

TEST_F(ProbeFile, ASquareWithoutADiscIsRefusedUnlessSaid) {
    // A picture up to its corners: a cropped ball, or none at all.
    ImageF image(64, 64, 3);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) image.at(x, y, 1) = 1 + 0.5f * static_cast<float>((x * 7 + y * 13) % 29);
    }
    const auto path = write("picture.exr", image);
    EXPECT_NE(refusal(path).find("looked for a disc"), std::string::npos);
    EXPECT_EQ(refusal(path, ProbeMapping::mirrorball), "accepted");
    // A ball that fills only half of the frame.
    const ImageF ball = marked_image(ProbeMapping::angular, 32);
    ImageF loose(64, 64, 3);
    for (int y = 0; y < 32; ++y) std::copy_n(ball.pixel(0, y), 96, loose.pixel(16, 16 + y));
    EXPECT_NE(refusal(write("loose.exr", loose)).find("looked for a disc"), std::string::npos);
}

TEST_F(ProbeFile, ALatlongMapComesAsItIs) {
    const ImageF image = marked_image(ProbeMapping::latlong, 20);
    const Probe probe = load_probe(write("exact.exr", image), {}, warnings_);
    ASSERT_EQ(probe.latlong.bounds(), image.bounds());
    EXPECT_TRUE(std::equal(image.samples().begin(), image.samples().end(), probe.latlong.samples().begin()));
}

}  // namespace
}  // namespace matchlight
