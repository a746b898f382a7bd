// Steps from table to table.
#include "scene/scene_key.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <memory>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace {

/// What a step leads to, and the list it is an element of.
struct Found {
    const toml::node* node = nullptr;
    const toml::array* list = nullptr;
    std::size_t index = 0;
};

Found follow(const toml::table& table, const SceneKeyStep& step, bool is_last) {
    const toml::node* node = table.get(step.name);
    const toml::array* list = node != nullptr ? node->as_array() : nullptr;
    if (list == nullptr) return {.node = step.index ? nullptr : node};
    const auto with_probe = [&]() -> std::optional<std::size_t> {
        for (std::size_t i = 0; i < list->size(); ++i) {
            const toml::table* entry = (*list)[i].as_table();
            if (entry != nullptr && entry->contains("probe")) return i;
        }
        return std::nullopt;
    };
    std::optional<std::size_t> stands_for_table;
    if (!step.index && !is_last && list->size() == 1) stands_for_table = 0;
    if (!step.index && !is_last && step.name == "light" && list->size() > 1) stands_for_table = with_probe();
    if (!step.index && !stands_for_table) return {.node = node};
    const std::size_t index = step.index ? *step.index : *stands_for_table;
    if (index >= list->size()) return {};
    return {.node = &(*list)[index], .list = list, .index = index};
}

toml::node& mutable_child(toml::table& table, const SceneKeyStep& step) {
    const Found found = follow(table, step, false);
    return const_cast<toml::node&>(
        *found.node);  // NOLINT(cppcoreguidelines-pro-type-const-cast): the table is not const
}

toml::table& table_for(toml::table& root, std::span<const SceneKeyStep> steps) {
    toml::table* table = &root;
    for (const SceneKeyStep& step : steps) {
        const Found found = follow(*table, step, false);
        if (found.node == nullptr || !found.node->is_table()) table->insert_or_assign(step.name, toml::table{});
        table = mutable_child(*table, step).as_table();
    }
    return *table;
}

toml::table read_value(const std::string& value, const std::filesystem::path& path) {
    try {
        toml::table read = toml::parse("value = " + value);
        if (read.size() == 1 && read.contains("value")) return read;
    } catch (const toml::parse_error&) {
        // Said below.
    }
    throw InputError(path, fmt::format("'{}' is not a value", printable(value)));
}

}  // namespace

std::vector<SceneKeyStep> scene_key_steps(std::string_view key) {
    std::vector<SceneKeyStep> steps;
    while (!key.empty()) {
        const std::string_view word = key.substr(0, key.find('.'));
        key.remove_prefix(std::min(key.size(), word.size() + 1));
        const std::size_t bracket = word.find('[');
        SceneKeyStep step{.name = std::string(word.substr(0, bracket))};
        if (bracket != std::string_view::npos) {
            std::size_t index = 0;
            std::from_chars(word.data() + bracket + 1, word.data() + word.size(), index);
            step.index = index;
        }
        assert(!step.name.empty());
        steps.push_back(std::move(step));
    }
    assert(!steps.empty());
    return steps;
}

PlaceOfKey place_of_key(const TomlPlaces& places, std::span<const SceneKeyStep> steps,
                        const std::filesystem::path& path) {
    PlaceOfKey place;
    place.parent = place.container = &places.root();
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool is_last = i + 1 == steps.size();
        const Found found = follow(*place.parent, steps[i], is_last);
        const toml::table* table = found.node != nullptr ? found.node->as_table() : nullptr;
        if (found.node == nullptr || (!is_last && table == nullptr)) {
            const std::size_t first_missing = found.node == nullptr ? i : i + 1;
            for (std::size_t j = first_missing; j < steps.size(); ++j) {
                if (steps[j].index) {
                    throw InputError(path, fmt::format("the scene has no {}[{}]", steps[j].name, *steps[j].index));
                }
                place.missing.push_back(steps[j].name);
            }
            place.node = found.node;
            return place;
        }
        if (is_last) {
            const auto entry = place.parent->find(steps[i].name);
            place.key = &entry->first;
            place.node = found.node;
            place.list = found.list;
            place.index = found.index;
            return place;
        }
        place.parent = table;
        if (places.form(*table) == TableForm::dotted) {
            place.prefix.push_back(steps[i].name);
            continue;
        }
        place.container = table;
        place.names.insert(place.names.end(), place.prefix.begin(), place.prefix.end());
        place.names.push_back(steps[i].name);
        place.prefix.clear();
    }
    return place;
}

const toml::node* node_of_key(const toml::table& root, std::span<const SceneKeyStep> steps) {
    const toml::table* table = &root;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool is_last = i + 1 == steps.size();
        const Found found = follow(*table, steps[i], is_last);
        if (found.node == nullptr || is_last) return found.node;
        table = found.node->as_table();
        if (table == nullptr) return nullptr;
    }
    return nullptr;
}

void set_in_tree(toml::table& root, std::span<const SceneKeyStep> steps, const std::string& value,
                 const std::filesystem::path& path) {
    const toml::table read = read_value(value, path);
    if (steps.back().index) {
        throw InputError(path, fmt::format("{}[{}] is set key by key", steps.back().name, *steps.back().index));
    }
    table_for(root, steps.first(steps.size() - 1)).insert_or_assign(steps.back().name, *read.get("value"));
}

void remove_from_tree(toml::table& root, std::span<const SceneKeyStep> steps) {
    toml::table& table = table_for(root, steps.first(steps.size() - 1));
    const SceneKeyStep& last = steps.back();
    if (!last.index) {
        table.erase(last.name);
        return;
    }
    toml::array& list = *table.get(last.name)->as_array();
    const bool is_of_headers = TomlPlaces::is_of_headers(list);
    list.erase(list.cbegin() + static_cast<std::ptrdiff_t>(*last.index));
    if (list.empty() && is_of_headers) table.erase(last.name);  // no header, no list
}

void append_in_tree(toml::table& root, std::span<const SceneKeyStep> steps, const std::string& value,
                    const std::filesystem::path& path) {
    const toml::table read = read_value(value, path);
    toml::table& table = table_for(root, steps.first(steps.size() - 1));
    const std::string& name = steps.back().name;
    if (!table.contains(name)) table.insert(name, toml::array{});
    toml::array* list = table.get(name)->as_array();
    if (list != nullptr) list->push_back(*read.get("value"));
}

}  // namespace matchlight
