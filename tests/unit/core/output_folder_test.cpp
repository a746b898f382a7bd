// A folder's files appear together, and nothing of another's is replaced unasked.
#include "core/output_folder.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class OutputFolderTest : public testing::Test {
protected:
    OutputFolderTest() : scratch_(fs::temp_directory_path() / ("output_folder_test." + std::to_string(getpid()))) {
        fs::create_directory(scratch_);
    }
    ~OutputFolderTest() override { fs::remove_all(scratch_); }

    const std::vector<std::string> names_{"a.txt", "b.txt"};
    fs::path scratch_;
};

TEST_F(OutputFolderTest, WritesAllFilesAndNothingElse) {
    {
        const OutputFolder folder(scratch_ / "out", names_, false);
        folder.write({"one", "two"});
    }
    EXPECT_EQ(read_text_file(scratch_ / "out" / "a.txt"), "one");
    EXPECT_EQ(read_text_file(scratch_ / "out" / "b.txt"), "two");
    EXPECT_EQ(std::distance(fs::directory_iterator(scratch_ / "out"), fs::directory_iterator()), 2);
}

TEST_F(OutputFolderTest, AFolderThatWasMadeForNothingGoesAgain) {
    { const OutputFolder folder(scratch_ / "out", names_, false); }
    EXPECT_FALSE(fs::exists(scratch_ / "out"));
    fs::create_directory(scratch_ / "mine");
    { const OutputFolder folder(scratch_ / "mine", names_, false); }
    EXPECT_TRUE(fs::exists(scratch_ / "mine"));
}

TEST_F(OutputFolderTest, RefusesWhatIsThere) {
    fs::create_directory(scratch_ / "out");
    std::ofstream(scratch_ / "out" / "b.txt") << "mine";
    EXPECT_THROW(OutputFolder(scratch_ / "out", names_, false), InputError);
    EXPECT_NO_THROW(OutputFolder(scratch_ / "out", names_, true));
    EXPECT_THROW(OutputFolder(scratch_ / "out" / "b.txt", names_, true), InputError);  // a file
    EXPECT_THROW(OutputFolder(scratch_ / "no" / "such", names_, true), InputError);
    EXPECT_EQ(read_text_file(scratch_ / "out" / "b.txt"), "mine");
}

TEST_F(OutputFolderTest, TwoRunsCannotHoldOne) {
    const OutputFolder first(scratch_ / "out", names_, true);
    EXPECT_THROW(OutputFolder(scratch_ / "out", names_, true), InputError);
}

}  // namespace
}  // namespace matchlight
