// Draws progress on standard error, so that standard output stays free for results.
#include "core/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "core/work.h"

namespace matchlight {

using std::chrono::duration;
using std::chrono::steady_clock;

Progress::Progress(std::string label, std::int64_t total, bool quiet)
    : label_(std::move(label)),
      total_(total),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) != 0),
      start_(steady_clock::now()),
      last_print_(start_) {}

Progress::~Progress() {
    if (!quiet_ && done_ > 0) print(true);
}

void Progress::advance() {
    ++done_;
    tell_work(label_, done_, total_);
    if (quiet_) return;
    // A terminal bears ten redraws a second; a log file wants a line every few seconds.
    const duration<double> pause(terminal_ ? 0.1 : 5.0);
    if (steady_clock::now() - last_print_ < pause) return;
    print(false);
}

void Progress::print(bool last) {
    last_print_ = steady_clock::now();
    const double seconds = std::max(1e-9, duration<double>(last_print_ - start_).count());
    const double rate = static_cast<double>(done_) / seconds;
    std::string line =
        total_ > 0 ? fmt::format("{} {}/{}", label_, done_, total_) : fmt::format("{} {}", label_, done_);
    if (terminal_ && total_ > 0) {
        constexpr int bar_width = 30;
        const int filled = static_cast<int>(std::min<std::int64_t>(bar_width, done_ * bar_width / total_));
        line += fmt::format(" [{}{}]", std::string(filled, '#'), std::string(bar_width - filled, ' '));
    }
    line += fmt::format("  {:.2f} frames/s", rate);
    if (last) {
        line += fmt::format("  {:.1f} s", seconds);
    } else if (total_ > done_) {
        line += fmt::format("  {:.0f} s left", std::ceil(static_cast<double>(total_ - done_) / rate));
    }
    if (terminal_) {
        std::fprintf(stderr, "\r\033[K%s%s", line.c_str(), last ? "\n" : "");
    } else {
        std::fprintf(stderr, "%s\n", line.c_str());
    }
    std::fflush(stderr);
}

}  // namespace matchlight
