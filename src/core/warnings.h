// Warnings are printed when they happen, counted, and repeated at the end of the command.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace matchlight {

/// Collects warnings; the same text said again only raises its count. Safe to call from several threads.
class Warnings {
public:
    struct Entry {
        std::string text;
        std::int64_t count = 0;
    };

    /// `text` reads like an error line: "table.mp4: 87 of 150 frames could be decoded".
    void add(const std::string& text);

    std::vector<Entry> entries() const;
    std::int64_t total() const;
    bool empty() const { return total() == 0; }

    /// Whether each new text is also printed on standard error at once (default: yes).
    void set_quiet(bool quiet) { quiet_ = quiet; }

private:
    mutable std::mutex mutex_;
    std::vector<Entry> entries_;
    bool quiet_ = false;
};

}  // namespace matchlight
