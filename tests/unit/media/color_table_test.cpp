// Look-up tables from files.
#include "media/color_table.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class ColorTableTest : public testing::Test {
protected:
    ColorTableTest() : folder_(fs::temp_directory_path() / ("matchlight_tables_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
    }
    ~ColorTableTest() override { fs::remove_all(folder_); }
    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }
    std::string refusal(const fs::path& path) const {
        try {
            read_color_table(path);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

    fs::path folder_;
};

TEST_F(ColorTableTest, ReadsCubes) {
    const ColorTable inverting = read_color_table(
        write("inverse.cube", "LUT_3D_SIZE 2\n1 1 1\n0 1 1\n1 0 1\n0 0 1\n1 1 0\n0 1 0\n1 0 0\n0 0 0\n"));
    for (const std::array<double, 3>& code :
         {std::array<double, 3>{0, 0, 0}, {0.25, 0.5, 0.8}, {0.9, 0.1, 0.45}, {1, 1, 1}, {-0.5, 0.3, 1.5}}) {
        const std::array<double, 3> made = inverting(code);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(made[c], 1 - std::clamp(code[c], 0.0, 1.0), 1e-6) << code[c];
    }
    const ColorTable curve = read_color_table(write("curve.cube", "LUT_1D_SIZE 3\n0 0 0\n0.3 0.5 0.6\n1 1 1\n"));
    const std::array<double, 3> middle = curve({0.5, 0.5, 0.25});
    EXPECT_NEAR(middle[0], 0.3, 1e-6);
    EXPECT_NEAR(middle[1], 0.5, 1e-6);
    EXPECT_NEAR(middle[2], 0.3, 1e-6);
}

TEST_F(ColorTableTest, NodesOfCommonCubesAreKept) {
    // A cube whose one odd node must come through unharmed; each time the file is another one of the same name.
    for (const int size : {3, 5, 9, 17, 33, 65}) {
        std::string text = "LUT_3D_SIZE " + std::to_string(size) + "\n";
        for (int i = 0; i < size * size * size; ++i) text += i == size + 1 ? "0.9 0.8 0.7\n" : "0.1 0.1 0.1\n";
        const ColorTable table = read_color_table(write("odd.cube", text));
        const double step = 1.0 / (size - 1);
        EXPECT_NEAR(table({step, step, 0})[0], 0.9, 1e-5) << size;
        EXPECT_NEAR(table({step, step, 0})[2], 0.7, 1e-5) << size;
        EXPECT_NEAR(table({0, 0, 0})[0], 0.1, 1e-5) << size;
    }
}

TEST_F(ColorTableTest, WhatIsNoTableIsRefused) {
    EXPECT_THAT(refusal(write("words.cube", "hello\n")), testing::HasSubstr("words.cube"));
    EXPECT_THAT(refusal(write("short.cube", "LUT_3D_SIZE 2\n1 1 1\n0 1 1\n")), testing::HasSubstr("no look-up table"));
    EXPECT_THAT(refusal(write("empty.cube", "")), testing::HasSubstr("empty.cube"));
    EXPECT_THAT(refusal(write("huge.cube", "LUT_3D_SIZE 100000\n0 0 0\n")), testing::HasSubstr("huge.cube"));
    EXPECT_THAT(refusal(write("picture.png", "\x89PNG")), testing::HasSubstr("picture.png"));
    EXPECT_THAT(refusal(folder_ / "none.cube"), testing::HasSubstr("none.cube"));
    EXPECT_EQ(refusal(folder_ / "none.cube").find('\n'), std::string::npos);
}

}  // namespace
}  // namespace matchlight
