// Counts warnings by their text.
#include "core/warnings.h"

#include <algorithm>
#include <cstdio>

#include "core/error.h"

namespace matchlight {

void Warnings::add(const std::string& text) {
    const std::string line = printable(text);
    const std::lock_guard lock(mutex_);
    const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.text == line; });
    if (known != entries_.end()) {
        ++known->count;
        return;
    }
    entries_.push_back({line, 1});
    if (!quiet_) std::fprintf(stderr, "warning: %s\n", line.c_str());
}

std::vector<Warnings::Entry> Warnings::entries() const {
    const std::lock_guard lock(mutex_);
    return entries_;
}

std::int64_t Warnings::total() const {
    const std::lock_guard lock(mutex_);
    std::int64_t sum = 0;
    for (const Entry& entry : entries_) sum += entry.count;
    return sum;
}

}  // namespace matchlight
