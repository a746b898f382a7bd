// Whole texts are kept: a scene file is small, and no step can be taken back wrongly.
#include "preview/scene_history.h"

#include <filesystem>
#include <numeric>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_steps = 500;
constexpr std::size_t most_bytes = 64u << 20;

}  // namespace

SceneHistory::SceneHistory(SceneText text) : known_(text.text()) {
    steps_.push_back({std::move(text), ""});
}

void SceneHistory::record(SceneText text, std::string what, std::string_view drag) {
    if (text.text() == this->text().text()) return;
    const bool goes_on = !drag.empty() && drag == drag_ && at_ > 0;
    steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(at_) + 1, steps_.end());
    if (goes_on) steps_.pop_back();
    steps_.push_back({std::move(text), std::move(what)});
    drag_ = drag;
    std::size_t bytes =
        std::accumulate(steps_.begin(), steps_.end(), std::size_t{0},
                        [](std::size_t sum, const Step& step) { return sum + step.text.text().size(); });
    std::size_t oldest = 0;
    while (steps_.size() - oldest > 2 && (steps_.size() - oldest > most_steps || bytes > most_bytes)) {
        bytes -= steps_[oldest].text.text().size();
        ++oldest;
    }
    steps_.erase(steps_.begin(), steps_.begin() + static_cast<std::ptrdiff_t>(oldest));
    at_ = steps_.size() - 1;
}

void SceneHistory::undo() {
    if (can_undo()) --at_;
    end_drag();
}

void SceneHistory::redo() {
    if (can_redo()) ++at_;
    end_drag();
}

SceneOnDisk SceneHistory::on_disk() const {
    std::error_code error;
    const fs::path& path = text().path();
    if (!fs::exists(path, error)) return SceneOnDisk::gone;
    try {
        return read_text_file(path, scene_limit_bytes) == known_ ? SceneOnDisk::as_known : SceneOnDisk::changed;
    } catch (const InputError&) {
        return SceneOnDisk::changed;  // into something that is no scene any more
    }
}

void SceneHistory::save() {
    if (on_disk() == SceneOnDisk::changed) {
        throw InputError(text().path(), "another program has changed it since it was read",
                         "read it again, or save over it");
    }
    save_over();
}

void SceneHistory::save_over() {
    std::error_code error;
    // What a link leads to is written, not put in the link's place; and who may read it stays.
    fs::path file = fs::canonical(text().path(), error);
    if (error) file = text().path();
    const fs::perms permissions = fs::status(file, error).permissions();
    write_text_file(file, text().text());
    if (permissions != fs::perms::unknown && permissions != fs::perms::none) fs::permissions(file, permissions, error);
    known_ = text().text();
    end_drag();
}

void SceneHistory::read_again() {
    SceneText read = SceneText::load(text().path());
    known_ = read.text();
    record(std::move(read), "read again");
}

}  // namespace matchlight
