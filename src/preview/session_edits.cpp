// What a session changes of its scene: always the text, from which the scene is read again.
#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "core/error.h"
#include "core/lowercase.h"
#include "preview/session.h"

namespace matchlight {

void Session::take_text(const SceneText& text) {
    // What is to be said of the scene was said when its file was read.
    Warnings known;
    known.set_quiet(true);
    auto scene = std::make_shared<const Scene>(load_scene(text, known));
    values_ = SceneValues(text, *scene);
    scene_ = std::move(scene);
    trouble_.clear();
    touch();
}

void Session::change(const std::function<void(SceneText&)>& edit, const std::string& what, const std::string& drag) {
    if (!history_) return;
    attempt([&] {
        SceneText text = history_->text();
        edit(text);
        if (text.text() == history_->text().text()) return;
        dragging_ = !drag.empty();
        take_text(text);
        history_->record(std::move(text), what, drag);
    });
}

void Session::set(const std::string& key, const SceneValue& value, const std::string& drag) {
    change([&](SceneText& text) { text.set(key, value); }, "set " + key, drag);
}

void Session::remove(const std::string& key) {
    change([&](SceneText& text) { text.remove(key); }, "remove " + key);
}

void Session::end_drag() {
    if (!history_) return;
    history_->end_drag();
    if (!dragging_) return;
    dragging_ = false;
    touch();
}

void Session::undo() {
    if (!history_ || !history_->can_undo()) return;
    history_->undo();
    attempt([&] { take_text(history_->text()); });
}

void Session::redo() {
    if (!history_ || !history_->can_redo()) return;
    history_->redo();
    attempt([&] { take_text(history_->text()); });
}

void Session::save() {
    if (!history_) return;
    attempt([&] {
        history_->save();
        options_.print(fmt::format("saved: {}", options_.scene.string()));
    });
    changed_ = true;
}

std::optional<std::size_t> Session::chosen() const {
    const bool there = chosen_ && scene_ && *chosen_ < scene_->objects.size();
    return there ? chosen_ : std::nullopt;
}

void Session::add_object(const SceneEntries& entries) {
    if (!scene_) return;
    const std::size_t before = scene_->objects.size();
    change([&](SceneText& text) { text.append("object", entries); }, "add an object");
    if (scene_->objects.size() > before) chosen_ = before;
}

std::string Session::written(const std::filesystem::path& file) const {
    const std::filesystem::path folder = std::filesystem::absolute(options_.scene).parent_path();
    const std::filesystem::path nearby = std::filesystem::absolute(file).lexically_relative(folder);
    const bool is_below = !nearby.empty() && *nearby.begin() != "..";
    return (is_below ? nearby : std::filesystem::absolute(file)).string();
}

void Session::take_file(const std::filesystem::path& file, const Eigen::Vector3d& translate_m) {
    const std::string kind = lowercase_extension(file);
    if (kind == ".exr" || kind == ".hdr") return set("light.probe", written(file));
    static constexpr std::array<std::string_view, 5> models{".gltf", ".glb", ".obj", ".ply", ".stl"};
    const bool is_model = std::ranges::find(models, kind) != models.end();
    add_object({{is_model ? "model" : "spheres", written(file)},
                {"translate", std::vector<double>(translate_m.begin(), translate_m.end())}});
}

void Session::remove_chosen() {
    const std::optional<std::size_t> object = chosen();
    if (!object) return;
    chosen_.reset();
    remove(fmt::format("object[{}]", *object));
}

void Session::toggle(const std::string& key, const SceneValue& off, const SceneValue& on) {
    if (!history_) return;
    const auto before = switched_off_.find(key);
    if (values_.word(key) != "off" && values_.number(key) != 0.0) {
        switched_off_[key] = values_.written(key);
        set(key, off);
    } else if (before == switched_off_.end()) {
        set(key, on);
    } else if (before->second.empty()) {
        remove(key);
    } else {
        set(key, TomlText(before->second));
    }
}

}  // namespace matchlight
