// Files are whole or absent; one output belongs to one run.
#include "core/atomic_file.h"

#include <fstream>

#include <gtest/gtest.h>
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
