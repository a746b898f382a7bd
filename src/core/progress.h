// A progress bar with rate and time left on a terminal; a plain line every few seconds elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace matchlight {

class Progress {
public:
    /// `total` may be 0 where it is not known. Prints nothing when `quiet`.
    Progress(std::string label, std::int64_t total, bool quiet);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// One more item is done.
    void advance();

private:
    void print(bool last);

    std::string label_;
    std::int64_t total_;
    std::int64_t done_ = 0;
    bool quiet_;
    bool terminal_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point last_print_;
};

}  // namespace matchlight
