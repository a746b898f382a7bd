// Two tables: the file's, and the effective scene that the loader makes of it.
#include "preview/scene_values.h"

#include <cstdint>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace matchlight {

struct SceneValues::Tables {
    toml::table written, effective;
};

namespace {

/// On one line. (toml++ would write 0.6 with seventeen digits.)
std::string text_of(const toml::node& node) {
    std::vector<std::string> parts;
    if (const toml::table* table = node.as_table()) {
        for (const auto& [key, value] : *table) parts.push_back(fmt::format("{} = {}", key.str(), text_of(value)));
        return fmt::format("{{{}}}", fmt::join(parts, ", "));
    }
    if (const toml::array* array = node.as_array()) {
        for (const toml::node& element : *array) parts.push_back(text_of(element));
        return fmt::format("[{}]", fmt::join(parts, ", "));
    }
    if (const auto flag = node.value_exact<bool>()) return scene_value_text(*flag);
    if (const auto whole = node.value_exact<std::int64_t>()) return scene_value_text(*whole);
    if (const auto number = node.value_exact<double>()) return scene_value_text(*number);
    return scene_value_text(node.value_or(std::string()));
}

}  // namespace

SceneValues::SceneValues() : tables_(std::make_unique<Tables>()) {}

SceneValues::SceneValues(const SceneText& text, const Scene& scene)
    : tables_(std::make_unique<Tables>(Tables{toml::parse(text.text()), toml::parse(scene.effective_toml)})) {}

SceneValues::~SceneValues() = default;
SceneValues::SceneValues(SceneValues&& other) noexcept = default;
SceneValues& SceneValues::operator=(SceneValues&& other) noexcept = default;

std::optional<bool> SceneValues::flag(const std::string& key) const {
    return toml::at_path(tables_->effective, key).value<bool>();
}

std::optional<double> SceneValues::number(const std::string& key) const {
    return toml::at_path(tables_->effective, key).value<double>();
}

std::optional<std::string> SceneValues::word(const std::string& key) const {
    return toml::at_path(tables_->effective, key).value<std::string>();
}

std::vector<double> SceneValues::numbers(const std::string& key) const {
    const auto node = toml::at_path(tables_->effective, key);
    if (const std::optional<double> alone = node.value<double>()) return {*alone};
    std::vector<double> values;
    if (const toml::array* array = node.as_array()) {
        for (const toml::node& element : *array) values.push_back(element.value<double>().value_or(0));
    }
    return values;
}

std::string SceneValues::written(const std::string& key) const {
    const auto node = toml::at_path(tables_->written, key);
    return node ? text_of(*node.node()) : "";
}

bool SceneValues::is_table(const std::string& key) const {
    return toml::at_path(tables_->written, key).is_table();
}

}  // namespace matchlight
