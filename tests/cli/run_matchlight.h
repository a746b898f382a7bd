// Runs the real executable as a user would, and says what came of it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/types.h>

namespace matchlight::test {

/// What the program is started with. The defaults are those of a plain call from a script.
struct RunOptions {
    std::map<std::string, std::string> environment;      // added to this process' own, replacing entries of that name
    std::filesystem::path working_directory;             // this process' own unless given
    bool close_stdin = false;                            // descriptor 0 is closed; otherwise it reads /dev/null
    std::optional<std::string> stdout_path;              // standard output goes to this file instead of being captured
    std::optional<std::uint64_t> file_size_limit_bytes;  // a disk that fills up: writing past it fails with an error
    std::chrono::seconds timeout{120};                   // then the process is killed and `timed_out` is set
};

struct RunResult {
    int status = -1;  // exit status; -1 when a signal ended the process
    int signal = 0;   // the signal that ended it, or 0
    bool timed_out = false;
    std::string standard_output;
    std::string standard_error;
    std::int64_t peak_memory_bytes = 0;  // resident
    double seconds = 0;                  // wall clock
};

/// Shown by GoogleTest when an assertion about a result fails.
void PrintTo(const RunResult& result, std::ostream* stream);

/// A run that has been started and not yet waited for: for tests that send signals or start two at once.
class RunningMatchlight {
public:
    explicit RunningMatchlight(const std::vector<std::string>& arguments, RunOptions options = {});
    /// Kills the process if nobody waited for it.
    ~RunningMatchlight();
    RunningMatchlight(const RunningMatchlight&) = delete;
    RunningMatchlight& operator=(const RunningMatchlight&) = delete;

    void send(int signal_number);
    /// Waits until `path` exists, for at most ten seconds or until the process ends.
    bool wait_for_file(const std::filesystem::path& path);
    /// Reads the output until the process ends or its time is up.
    RunResult wait();

private:
    RunOptions options_;
    std::chrono::steady_clock::time_point start_;
    pid_t process_ = -1;
    int output_pipe_ = -1;
    int error_pipe_ = -1;
};

/// Runs `matchlight arguments…` to its end.
RunResult run_matchlight(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// Exit status 0, and no line on standard error that starts with "error:".
testing::AssertionResult succeeded(const RunResult& result);
/// The contract for bad input: exit status 1, nothing on standard output, exactly one line "error: …" on standard
/// error, and that line contains each of `words` (the file, the frame, the cause).
testing::AssertionResult failed_naming(const RunResult& result, const std::vector<std::string>& words);
/// A wrong call: exit status 2 and something said about it on standard error.
testing::AssertionResult refused_call(const RunResult& result);
/// The warning was given while it happened or at the end: a line of standard error contains "warning" and each word,
/// or stands below "N warnings:" at the end and contains each word.
testing::AssertionResult warned_of(const RunResult& result, const std::vector<std::string>& words);
/// Neither `output` nor a temporary of it ("name.part.ext") exists; for a pattern such as out_%04d.png: no file of
/// that form at all.
testing::AssertionResult nothing_left_of(const std::filesystem::path& output);

/// A folder of its own for each test, gone afterwards.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }
    /// Writes a file of these bytes and returns its path.
    std::filesystem::path write(const std::filesystem::path& name, const std::string& bytes) const;
    /// Copies samples/`shot` here and returns the copy's folder.
    std::filesystem::path copy_sample(const std::string& shot) const;

private:
    std::filesystem::path path_;
};

/// The bytes of a file.
std::string bytes_of(const std::filesystem::path& path);

/// The fixture of most tests here.
class CommandTest : public testing::Test {
protected:
    ScratchFolder scratch_;
};

/// For tests on data too large or not free enough for the repository: skips when MATCHLIGHT_DATA does not name it.
class SharedDataTest : public CommandTest {
protected:
    void SetUp() override;
    std::filesystem::path data_;
};

}  // namespace matchlight::test
