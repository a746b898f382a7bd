// What FFmpeg's libraries would print: kept off the terminal, and kept for the messages of errors.
#pragma once

#include <mutex>
#include <string>

namespace matchlight {

/// Collects the errors that are logged by contexts whose `opaque` points to it.
class AvLog {
public:
    /// Routes the libraries' log here for the whole process; the first call counts.
    static void install();

    void add(const std::string& message);
    bool has_errors();
    /// The first error since the last call, as " (text)"; empty where there was none.
    std::string take_cause();

private:
    std::mutex mutex_;
    std::string first_error_;
};

/// "Invalid data found when processing input" for an FFmpeg error code.
std::string av_error_text(int code);

}  // namespace matchlight
