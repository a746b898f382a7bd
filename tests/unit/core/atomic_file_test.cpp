// Files are whole or absent; one output belongs to one run.
#include "core/atomic_file.h"

#include <atomic>
#include <fstream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("matchlight_atomic_" + std::to_string(getpid()));
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

TEST_F(AtomicFile, AppearsOnlyWhenCommitted) {
    const fs::path path = folder_ / "a b.json";
    {
        PendingFile file(path);
        std::ofstream(file.path()) << "half";
        EXPECT_EQ(file.path().extension(), ".json");
        EXPECT_FALSE(fs::exists(path));
    }
    EXPECT_TRUE(fs::is_empty(folder_));  // not committed: nothing is left
    write_text_file(path, "whole");
    EXPECT_EQ(read_text_file(path), "whole");
}

TEST_F(AtomicFile, ASecondRunOnOneOutputIsRefused) {
    const fs::path path = folder_ / "out.mp4";
    {
        const OutputLock first(path);
        EXPECT_THROW(OutputLock second(path), InputError);
    }
    const OutputLock third(path);  // released with the first
}

TEST_F(AtomicFile, NeverTwoRunsHoldOneOutputWhileLocksComeAndGo) {
    const fs::path path = folder_ / "out.mp4";
    std::atomic<int> holders = 0;
    std::atomic<int> most_holders = 0;
    std::atomic<int> times_held = 0;
    const auto run = [&] {
        for (int attempt = 0; attempt < 3000; ++attempt) {
            try {
                const OutputLock lock(path);
                const int now = ++holders;
                for (int most = most_holders; now > most && !most_holders.compare_exchange_weak(most, now);) continue;
                std::this_thread::yield();
                ++times_held;
                --holders;
            } catch (const InputError&) {
                std::this_thread::yield();
            }
        }
    };
    std::vector<std::thread> runs;
    for (int i = 0; i < 4; ++i) runs.emplace_back(run);
    for (std::thread& one : runs) one.join();
    EXPECT_EQ(most_holders, 1);
    EXPECT_GT(times_held, 100);  // the threads did take turns
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(AtomicFile, APipeIsNeverReplaced) {
    const fs::path path = folder_ / "pipe.mp4";
    ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    EXPECT_THROW(check_output(path, false), InputError);
    EXPECT_THROW(check_output(path, true), InputError);
}

TEST_F(AtomicFile, OutputsAreCheckedBeforeWork) {
    const fs::path path = folder_ / "out.mp4";
    EXPECT_NO_THROW(check_output(path, false));
    write_text_file(path, "x");
    EXPECT_THROW(check_output(path, false), InputError);
    EXPECT_NO_THROW(check_output(path, true));
    EXPECT_THROW(check_output(folder_ / "missing" / "out.mp4", false), InputError);
}

}  // namespace
}  // namespace matchlight
