// What stands around the picture looks as it did: panels, their words, the bars and the timeline.
//
// The goldens (tests/data/window) are windows at a quarter of their size, the picture and what tells times left black;
// they are written anew where MATCHLIGHT_WRITE_GOLDENS is set.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "media/image_io.h"
#include "preview_window.h"

namespace matchlight::test {
namespace {

constexpr int block_px = 4;
/// Of means over a block, in codes. Edges that another driver smooths otherwise change a block by some 10; a letter
/// that is there or is not, by 40 and more.
constexpr int tolerance = 24;

void blacken(Image8& picture, const Region& part) {
    for (int y = part.y; y < part.y + part.height; ++y) {
        std::fill_n(picture.pixel(part.x, y), std::size_t{3} * part.width, std::uint8_t{0});
    }
}

Image8 reduced(const Image8& window) {
    Image8 small(window.width() / block_px, window.height() / block_px, 3);
    for (int y = 0; y < small.height(); ++y) {
        for (int x = 0; x < small.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                int sum = 0;
                for (int i = 0; i < block_px * block_px; ++i) {
                    sum += window.at(x * block_px + i % block_px, y * block_px + i / block_px, c);
                }
                small.at(x, y, c) = static_cast<std::uint8_t>(std::lround(sum / double(block_px * block_px)));
            }
        }
    }
    return small;
}

/// Blocks that differ by more than the tolerance.
int different_blocks(const Image8& a, const Image8& b) {
    int count = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            int most = 0;
            for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(int{a.at(x, y, c)} - int{b.at(x, y, c)}));
            count += most > tolerance ? 1 : 0;
        }
    }
    return count;
}

struct WindowSize {
    const char* words;
    Region picture, status;
};

class PreviewGoldenTest : public PreviewTest {
protected:
    void SetUp() override {
        if (!fs::exists("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"))
            GTEST_SKIP() << "needs Debian's fonts-dejavu-core: letters of other fonts look otherwise";
        PreviewTest::SetUp();
    }

    fs::path shot(const std::string& name) const { return scratch_ / (name + ".png"); }

    void expect_golden(const std::string& name, const WindowSize& size) {
        Image8 window = read_rgb8(shot(name));
        blacken(window, size.picture);
        blacken(window, size.status);
        const Image8 small = reduced(window);
        const fs::path golden = fs::path(MATCHLIGHT_SOURCE_DIR) / "tests/data/window" / (name + ".png");
        if (std::getenv("MATCHLIGHT_WRITE_GOLDENS") != nullptr) write_png8(golden, small);
        ASSERT_TRUE(fs::exists(golden)) << golden;
        EXPECT_EQ(different_blocks(small, read_rgb8(golden)), 0) << name;
    }
};

TEST_F(PreviewGoldenTest, PanelsAndBarsLookAsTheyDid) {
    for (const WindowSize& size : {WindowSize{"1280x720", {0, 40, 900, 530}, {0, 694, 900, 26}},
                                   WindowSize{"1920x1080", {0, 40, 1540, 890}, {0, 1054, 1540, 26}}}) {
        const std::string end = std::string("_") + size.words;
        const auto take = [&](const std::string& name) {
            return "move 450 300\nwait_idle\nscreenshot " + shot(name + end).string() + "\n";
        };
        played("wait_idle\nshow objects\nclick object[0]\n" + take("objects") + "show light\n" + take("light") +
                   "show lens\nset effects.depth_of_field \"by hand\"\n" + take("lens") +
                   "show effects\nset effects.bloom \"by hand\"\n" + take("effects"),
               {"--size", size.words});
        for (const char* name : {"objects", "light", "lens", "effects"}) expect_golden(name + end, size);
    }
}

TEST_F(PreviewGoldenTest, FindsWhatIsMissing) {
    const WindowSize size{"1280x720", {0, 40, 900, 530}, {0, 694, 900, 26}};
    played("wait_idle\nshow light\nmove 450 300\nwait_idle\nscreenshot " + shot("light").string(),
           {"--size", size.words});
    const Image8 window = read_rgb8(shot("light"));
    // A word's last letters, in the bar above and in the panel, are painted over with what is beside them.
    for (const Region& letters : {Region{645, 8, 16, 20}, Region{1176, 176, 26, 14}}) {
        Image8 cut = window;
        for (int y = letters.y; y < letters.y + letters.height; ++y) {
            for (int x = letters.x; x < letters.x + letters.width; ++x) {
                std::copy_n(window.pixel(letters.x, letters.y), 3, cut.pixel(x, y));
            }
        }
        EXPECT_GT(different_blocks(reduced(cut), reduced(window)), 0) << letters.x;
    }
}

}  // namespace
}  // namespace matchlight::test
