// What was changed of a scene file, to be undone, redone and saved.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene_edit.h"

namespace matchlight {

enum class SceneOnDisk {
    as_known,  // as it was read or saved last
    changed,   // by another program
    gone
};

class SceneHistory {
public:
    /// `text` is as its file has it.
    explicit SceneHistory(SceneText text);

    const SceneText& text() const { return steps_[at_].text; }

    /// A change, with what is said of it ("move ball"). Those of one `drag`, one after the other until end_drag(), are
    /// one step. A text that is the same is none.
    void record(SceneText text, std::string what, std::string_view drag = {});
    void end_drag() { drag_.clear(); }

    bool can_undo() const { return at_ > 0; }
    bool can_redo() const { return at_ + 1 < steps_.size(); }
    /// What undo() and redo() would take back and do again; empty where there is nothing.
    std::string undone_next() const { return can_undo() ? steps_[at_].what : ""; }
    std::string redone_next() const { return can_redo() ? steps_[at_ + 1].what : ""; }
    void undo();
    void redo();

    /// Otherwise than the file, as it was read or saved last.
    bool is_modified() const { return text().text() != known_; }
    SceneOnDisk on_disk() const;
    /// Writes the text over its file, whole or not at all. Throws InputError where another program changed that
    /// meanwhile.
    void save();
    /// The same, whatever is there.
    void save_over();
    /// What the file has now, as a step that can be undone. Throws InputError.
    void read_again();

private:
    struct Step {
        SceneText text;
        std::string what;  // that led to it
    };

    std::vector<Step> steps_;
    std::size_t at_ = 0;
    std::string drag_;   // that the last step is of
    std::string known_;  // what the file has
};

}  // namespace matchlight
