// Pictures of how it really was, found by their numbers.
#include "preview/truth_picture.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class TruthPicturesTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, std::uint8_t code) const {
        Image8 picture(2, 1, 3);
        for (std::uint8_t& sample : picture.samples()) sample = code;
        write_png8(folder_ / name, picture);
        return folder_ / name;
    }

    const fs::path folder_ = fs::temp_directory_path() / ("matchlight_truth_" + std::to_string(getpid()));
};

TEST_F(TruthPicturesTest, OfAFolderAreThoseThatEndInTheNumber) {
    write("b_0003.png", 30);
    write("a3.png", 31);
    write("7.png", 70);
    write("no_number.png", 1);
    const TruthPictures truth(folder_);
    EXPECT_EQ(truth.of_frame(3)->at(0, 0, 0), 31) << "the first name in order";
    EXPECT_EQ(truth.of_frame(7)->at(1, 0, 2), 70);
    EXPECT_FALSE(truth.of_frame(0));
}

TEST_F(TruthPicturesTest, OfAPatternOrAPicture) {
    const fs::path alone = write("t_002.png", 20);
    EXPECT_EQ(TruthPictures(folder_ / "t_%03d.png").of_frame(2)->at(0, 0, 0), 20);
    EXPECT_FALSE(TruthPictures(folder_ / "t_%03d.png").of_frame(1));
    EXPECT_EQ(TruthPictures(alone).of_frame(11)->at(0, 0, 0), 20);
    EXPECT_THROW(TruthPictures(folder_ / "none.png").of_frame(0), InputError);
}

}  // namespace
}  // namespace matchlight
