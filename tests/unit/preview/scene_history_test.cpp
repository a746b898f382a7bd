// Undo, redo and saving of a scene's text.
#include "preview/scene_history.h"

#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

SceneText with_z(const SceneHistory& history, double z) {
    SceneText text = history.text();
    text.set("surface.z", z);
    return text;
}

TEST(SceneHistory, UndoesAndRedoesStepByStep) {
    SceneHistory history(SceneText("scene.toml", "[surface]\nz = 0\n"));
    EXPECT_FALSE(history.can_undo());
    history.record(with_z(history, 1), "raise");
    history.record(with_z(history, 2), "raise more");
    history.record(with_z(history, 2), "nothing");
    EXPECT_EQ(history.undone_next(), "raise more");
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 1\n");
    EXPECT_EQ(history.redone_next(), "raise more");
    history.undo();
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 0\n");
    EXPECT_FALSE(history.is_modified());
    history.redo();
    EXPECT_TRUE(history.is_modified());
    history.record(with_z(history, 5), "another way");
    EXPECT_FALSE(history.can_redo());
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 1\n");
}

TEST(SceneHistory, ADragIsOneStep) {
    SceneHistory history(SceneText("scene.toml", "[surface]\nz = 0\n"));
    for (const double z : {1, 2, 3}) history.record(with_z(history, z), "raise", "surface.z");
    history.end_drag();
    for (const double z : {4, 5}) history.record(with_z(history, z), "raise", "surface.z");
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 3\n");
    // What follows an undo is a drag of its own.
    history.record(with_z(history, 7), "raise", "surface.z");
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 3\n");
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 0\n");
    EXPECT_FALSE(history.can_undo());
}

TEST(SceneHistory, KeepsTheLatestOfManySteps) {
    SceneHistory history(SceneText("scene.toml", "[surface]\nz = 0\n"));
    for (int z = 1; z <= 600; ++z) history.record(with_z(history, z), "raise");
    int undone = 0;
    for (; history.can_undo(); ++undone) history.undo();
    EXPECT_EQ(undone, 499);
    EXPECT_EQ(history.text().text(), "[surface]\nz = 101\n");
    EXPECT_TRUE(history.is_modified());
}

class SavedScene : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("matchlight_history_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        path_ = folder_ / "scene.toml";
        write_text_file(path_, "[surface]\nz = 0\n");
    }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path folder_, path_;
};

TEST_F(SavedScene, IsModifiedUntilItIsSaved) {
    SceneHistory history(SceneText::load(path_));
    history.record(with_z(history, 1), "raise");
    EXPECT_TRUE(history.is_modified());
    history.save();
    EXPECT_FALSE(history.is_modified());
    EXPECT_EQ(read_text_file(path_), "[surface]\nz = 1\n");
    history.undo();
    EXPECT_TRUE(history.is_modified());
}

TEST_F(SavedScene, IsNotWrittenOverAnothersChange) {
    SceneHistory history(SceneText::load(path_));
    history.record(with_z(history, 1), "raise");
    EXPECT_EQ(history.on_disk(), SceneOnDisk::as_known);
    write_text_file(path_, "[surface]\nz = 9\n");
    EXPECT_EQ(history.on_disk(), SceneOnDisk::changed);
    EXPECT_THROW(history.save(), InputError);
    EXPECT_EQ(read_text_file(path_), "[surface]\nz = 9\n");
    history.read_again();
    EXPECT_FALSE(history.is_modified());
    history.undo();
    EXPECT_EQ(history.text().text(), "[surface]\nz = 1\n");
    history.save();
    EXPECT_EQ(read_text_file(path_), "[surface]\nz = 1\n");
    fs::remove(path_);
    EXPECT_EQ(history.on_disk(), SceneOnDisk::gone);
    history.save();
    EXPECT_EQ(history.on_disk(), SceneOnDisk::as_known);
}

TEST_F(SavedScene, StaysBehindItsLinkAndAsReadableAsItWas) {
    const fs::path link = folder_ / "link.toml";
    fs::create_symlink("scene.toml", link);
    fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_write);
    SceneHistory history(SceneText::load(link));
    history.record(with_z(history, 1), "raise");
    history.save();
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(read_text_file(path_), "[surface]\nz = 1\n");
    EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

}  // namespace
}  // namespace matchlight
