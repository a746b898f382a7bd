// Xvfb says its display's number on a pipe, and keeps its screen in a file of the form of xwd.
#include "virtual_display.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace matchlight::test {

VirtualDisplay::VirtualDisplay(const std::filesystem::path& folder) : screen_file_(folder / "Xvfb_screen0") {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
    const std::string number_to = std::to_string(ends[1]);
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    const std::string screen_folder = folder.string();
    process_ = fork();
    if (process_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        close(ends[0]);
        const int nowhere = open("/dev/null", O_RDWR);
        dup2(nowhere, STDOUT_FILENO);
        dup2(nowhere, STDERR_FILENO);
        execlp("Xvfb", "Xvfb", "-displayfd", number_to.c_str(), "-screen", "0", screen.c_str(), "-nolisten", "tcp",
               "-fbdir", screen_folder.c_str(), nullptr);
        _exit(127);
    }
    close(ends[1]);
    std::string number;
    for (char digit = 0; read(ends[0], &digit, 1) == 1 && digit != '\n';) number += digit;
    close(ends[0]);
    if (number.empty()) throw std::runtime_error("Xvfb does not run: is Debian's package xvfb installed?");
    name_ = ":" + number;
}

VirtualDisplay::~VirtualDisplay() {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
}

Image8 VirtualDisplay::corner(int corner_width, int corner_height) const {
    std::ifstream stream(screen_file_, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    // XWDFile.h: 25 numbers of 32 bits, the most significant byte first; then the colour map; then rows.
    const auto number = [&](std::size_t index) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes.at(4 * index + i));
        return value;
    };
    constexpr std::size_t header_size = 0, bits_a_pixel = 11, bytes_a_row = 12, colors = 19;
    constexpr std::size_t bytes_a_color = 12;
    if (number(bits_a_pixel) != 32) throw std::runtime_error("the screen's pixels are not of 32 bits");
    const std::size_t first = number(header_size) + number(colors) * bytes_a_color;
    Image8 image(corner_width, corner_height, 3);
    for (int y = 0; y < corner_height; ++y) {
        for (int x = 0; x < corner_width; ++x) {
            // Blue, green, red, nothing.
            const std::size_t at = first + static_cast<std::size_t>(y) * number(bytes_a_row) + 4u * x;
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<std::uint8_t>(bytes.at(at + 2 - c));
        }
    }
    return image;
}

bool VirtualDisplay::comes_to_show(const Image8& picture) const {
    using std::chrono::steady_clock;
    const auto deadline = steady_clock::now() + std::chrono::minutes(1);
    while (steady_clock::now() < deadline) {
        const Image8 shown = corner(picture.width(), picture.height());
        if (std::ranges::equal(shown.samples(), picture.samples())) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
}

}  // namespace matchlight::test
