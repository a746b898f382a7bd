// The start of the process and what it has taken are Linux' own account of it.
#include "preview/script_clock.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

namespace matchlight {

namespace {

using Clock = ScriptClock::Clock;

double ms_between(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

/// When this process was started (proc(5): the 22nd field of stat, in ticks since the machine was); now, where that is
/// not told.
Clock::time_point process_start() {
    const Clock::time_point now = Clock::now();
    std::ifstream file("/proc/self/stat");
    std::string text;
    std::getline(file, text);
    // The second field is a name in brackets, which may hold spaces.
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) return now;
    std::istringstream fields(text.substr(name_end + 1));
    std::string field;
    for (int i = 3; i <= 22; ++i) fields >> field;
    timespec since_boot{};
    if (!fields || clock_gettime(CLOCK_BOOTTIME, &since_boot) != 0) return now;
    const double booted_s = static_cast<double>(since_boot.tv_sec) + static_cast<double>(since_boot.tv_nsec) * 1e-9;
    const double age_s = booted_s - std::stod(field) / static_cast<double>(sysconf(_SC_CLK_TCK));
    return now - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::max(0.0, age_s)));
}

/// Resident, in MB (proc(5): statm's second field, in pages); 0 where it is not told.
double resident_mb() {
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

/// Allocated and not freed, in MB. Unlike what is resident it does not depend on what the allocator keeps for later,
/// nor on how threads happened to share its arenas. 0 where a sanitizer allocates.
double allocated_mb() {
    const struct mallinfo2 info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd) * 1e-6;
}

/// Of all threads.
double processor_s() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace

ScriptClock::ScriptClock() : began_(process_start()), moved_(began_), settled_(began_) {}

void ScriptClock::begin(std::int64_t pictures) {
    began_ = moved_ = settled_ = Clock::now();
    pictures_.clear();
    counted_ = pictures;
    processor_before_s_ = processor_s();
}

void ScriptClock::count(std::int64_t pictures) {
    for (; counted_ < pictures; ++counted_) pictures_.push_back(Clock::now());
}

std::string ScriptClock::told() const {
    std::string text = fmt::format("settled after {:.0f} ms", ms_between(began_, settled_));
    text += fmt::format(", {} pictures", pictures_.size());
    if (!pictures_.empty()) text += fmt::format(", the first after {:.0f} ms", ms_between(began_, pictures_.front()));
    const auto within = std::ranges::upper_bound(pictures_, moved_) - pictures_.begin();
    const double moved_ms = ms_between(began_, moved_);
    if (within > 1 && moved_ms > 0) {
        text += fmt::format(", {:.1f} a second while the hand moved", static_cast<double>(within) * 1000 / moved_ms);
    }
    return text + fmt::format("; {:.2f} s of processor time, {:.0f} MB, {:.2f} MB of it allocated",
                              processor_s() - processor_before_s_, resident_mb(), allocated_mb());
}

}  // namespace matchlight
