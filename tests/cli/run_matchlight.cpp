// Starts the executable with fork and exec, and reads both its outputs while it runs.
#include "run_matchlight.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace matchlight::test {

namespace fs = std::filesystem;
using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

[[noreturn]] void throw_system(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

struct Pipe {
    int read_end = -1;
    int write_end = -1;
};

Pipe make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_system("pipe");
    return {ends[0], ends[1]};
}

std::vector<std::string> environment_with(const std::map<std::string, std::string>& changes) {
    std::vector<std::string> entries;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        if (!changes.contains(text.substr(0, text.find('=')))) entries.push_back(text);
    }
    for (const auto& [name, value] : changes) entries.push_back(name + "=" + value);
    return entries;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    pointers.reserve(texts.size() + 1);
    for (std::string& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

void replace_descriptor(int source, int target) {
    if (source < 0 || dup2(source, target) < 0) _exit(126);
}

/// Runs in the child between fork and exec, so it may call async-signal-safe functions only.
struct ChildSetup {
    const RunOptions& options;
    int output_end;
    int error_end;

    void apply() const {
        if (!options.working_directory.empty() && chdir(options.working_directory.c_str()) != 0) _exit(126);
        if (options.close_stdin) {
            close(STDIN_FILENO);
        } else {
            replace_descriptor(open("/dev/null", O_RDONLY | O_CLOEXEC), STDIN_FILENO);
        }
        if (options.stdout_path) {
            replace_descriptor(open(options.stdout_path->c_str(), O_WRONLY | O_CLOEXEC), STDOUT_FILENO);
        } else {
            replace_descriptor(output_end, STDOUT_FILENO);
        }
        replace_descriptor(error_end, STDERR_FILENO);
        if (options.file_size_limit_bytes) {
            // With the signal ignored (exec keeps that), write() past the limit fails with EFBIG: to a program that
            // looks at its return values, the same as ENOSPC of a full disk.
            std::signal(SIGXFSZ, SIG_IGN);
            const rlimit limit{*options.file_size_limit_bytes, *options.file_size_limit_bytes};
            if (setrlimit(RLIMIT_FSIZE, &limit) != 0) _exit(126);
        }
    }
};

/// Appends what the pipe holds; false at its end.
bool read_some(int descriptor, std::string& text) {
    std::array<char, 65536> buffer;
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) return true;
    if (count <= 0) return false;
    text.append(buffer.data(), static_cast<std::size_t>(count));
    return true;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

bool contains_all(const std::string& line, const std::vector<std::string>& words) {
    return std::all_of(words.begin(), words.end(),
                       [&](const std::string& word) { return line.find(word) != std::string::npos; });
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "\"" : ", \"") + word + "\"";
    return text;
}

testing::AssertionResult failure_with(const RunResult& result) {
    std::ostringstream text;
    PrintTo(result, &text);
    return testing::AssertionFailure() << text.str() << "\n";
}

}  // namespace

void PrintTo(const RunResult& result, std::ostream* stream) {
    *stream << "exit status " << result.status;
    if (result.signal != 0) *stream << ", ended by signal " << result.signal;
    if (result.timed_out) *stream << ", killed after " << result.seconds << " s";
    *stream << "\nstandard output:\n" << result.standard_output << "\nstandard error:\n" << result.standard_error;
}

RunningMatchlight::RunningMatchlight(const std::vector<std::string>& arguments, RunOptions options)
    : options_(std::move(options)), start_(steady_clock::now()) {
    const Pipe output = make_pipe();
    const Pipe error = make_pipe();
    output_pipe_ = output.read_end;
    error_pipe_ = error.read_end;

    // Everything that allocates is made before the fork.
    std::vector<std::string> words{MATCHLIGHT_EXECUTABLE};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<std::string> variables = environment_with(options_.environment);
    const std::vector<char*> word_pointers = pointers_to(words);
    const std::vector<char*> variable_pointers = pointers_to(variables);

    const ChildSetup setup{options_, output.write_end, error.write_end};
    process_ = fork();
    if (process_ < 0) throw_system("fork");
    if (process_ == 0) {
        setup.apply();
        execve(MATCHLIGHT_EXECUTABLE, word_pointers.data(), variable_pointers.data());
        _exit(127);
    }
    close(output.write_end);
    close(error.write_end);
}

RunningMatchlight::~RunningMatchlight() {
    if (process_ > 0) {
        kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    close(output_pipe_);
    close(error_pipe_);
}

void RunningMatchlight::send(int signal_number) {
    if (kill(process_, signal_number) != 0) throw_system("kill");
}

bool RunningMatchlight::wait_for_file(const fs::path& path) {
    const auto deadline = steady_clock::now() + std::chrono::seconds(60);
    while (steady_clock::now() < deadline) {
        if (fs::exists(path)) return true;
        siginfo_t ended{};
        waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT);
        if (ended.si_pid != 0) return fs::exists(path);
        std::this_thread::sleep_for(milliseconds(5));
    }
    return false;
}

RunResult RunningMatchlight::wait() {
    RunResult result;
    std::array<pollfd, 2> pipes{pollfd{output_pipe_, POLLIN, 0}, pollfd{error_pipe_, POLLIN, 0}};
    const auto deadline = start_ + options_.timeout;
    while (pipes[0].fd >= 0 || pipes[1].fd >= 0) {
        const auto left = duration_cast<milliseconds>(deadline - steady_clock::now()).count();
        if (left <= 0) {
            kill(process_, SIGKILL);
            result.timed_out = true;
            break;
        }
        if (poll(pipes.data(), pipes.size(), static_cast<int>(left)) < 0 && errno != EINTR) throw_system("poll");
        // A negative descriptor is one that poll passes over.
        if (pipes[0].revents != 0 && !read_some(output_pipe_, result.standard_output)) pipes[0].fd = -1;
        if (pipes[1].revents != 0 && !read_some(error_pipe_, result.standard_error)) pipes[1].fd = -1;
    }
    int state = 0;
    rusage usage{};
    while (wait4(process_, &state, 0, &usage) < 0) {
        if (errno != EINTR) throw_system("wait4");
    }
    process_ = -1;
    result.seconds = duration<double>(steady_clock::now() - start_).count();
    result.peak_memory_bytes = static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
    if (WIFEXITED(state)) result.status = WEXITSTATUS(state);
    if (WIFSIGNALED(state)) result.signal = WTERMSIG(state);
    return result;
}

RunResult run_matchlight(const std::vector<std::string>& arguments, const RunOptions& options) {
    return RunningMatchlight(arguments, options).wait();
}

testing::AssertionResult succeeded(const RunResult& result) {
    const std::vector<std::string> lines = lines_of(result.standard_error);
    const bool complained =
        std::any_of(lines.begin(), lines.end(), [](const std::string& line) { return line.starts_with("error:"); });
    if (result.status == 0 && !complained) return testing::AssertionSuccess();
    return failure_with(result) << "expected exit status 0 and no error";
}

testing::AssertionResult failed_naming(const RunResult& result, const std::vector<std::string>& words) {
    if (result.status != 1) return failure_with(result) << "expected exit status 1";
    if (!result.standard_output.empty()) return failure_with(result) << "expected nothing on standard output";
    std::vector<std::string> errors;
    for (const std::string& line : lines_of(result.standard_error)) {
        if (line.starts_with("error:")) errors.push_back(line);
    }
    if (errors.size() != 1) return failure_with(result) << "expected exactly one line \"error: …\"";
    if (!contains_all(errors.front(), words))
        return failure_with(result) << "expected the error line to name " << joined(words);
    return testing::AssertionSuccess();
}

testing::AssertionResult refused_call(const RunResult& result) {
    if (result.status == 2 && !result.standard_error.empty()) return testing::AssertionSuccess();
    return failure_with(result) << "expected exit status 2 and a message on standard error";
}

testing::AssertionResult warned_of(const RunResult& result, const std::vector<std::string>& words) {
    bool in_summary = false;
    for (const std::string& line : lines_of(result.standard_error)) {
        if (line.ends_with(" warning:") || line.ends_with(" warnings:")) in_summary = true;
        if ((in_summary || line.starts_with("warning:")) && contains_all(line, words))
            return testing::AssertionSuccess();
    }
    return failure_with(result) << "expected a warning that names " << joined(words);
}

testing::AssertionResult nothing_left_of(const fs::path& output) {
    // "out_%04d.png" stands for any number; the stem may carry ".part" while it is being written.
    const std::string stem = output.stem().string();
    const std::string quoted = std::regex_replace(stem, std::regex(R"([.^$|()\[\]{}*+?\\])"), R"(\$&)");
    const std::string numbered = std::regex_replace(quoted, std::regex("%[0-9]*d"), "-?[0-9]+");
    const std::regex form(numbered + R"((\.part)?)");
    const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
    if (!fs::is_directory(folder)) return testing::AssertionSuccess();
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == output.extension() && std::regex_match(entry.path().stem().string(), form))
            return testing::AssertionFailure() << entry.path() << " was left behind";
    }
    return testing::AssertionSuccess();
}

ScratchFolder::ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "matchlight-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw_system("mkdtemp");
    path_ = name;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

fs::path ScratchFolder::write(const fs::path& name, const std::string& bytes) const {
    const fs::path path = path_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream stream(path, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw std::runtime_error("cannot write " + path.string());
    return path;
}

fs::path ScratchFolder::copy_sample(const std::string& shot) const {
    fs::copy(fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / shot, path_ / shot, fs::copy_options::recursive);
    return path_ / shot;
}

std::string bytes_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw std::runtime_error("cannot read " + path.string());
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void SharedDataTest::SetUp() {
    const char* folder = std::getenv("MATCHLIGHT_DATA");
    if (folder == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA does not name the folder of shared test data";
    data_ = folder;
    ASSERT_TRUE(fs::is_directory(data_)) << data_ << " is no folder";
}

}  // namespace matchlight::test
