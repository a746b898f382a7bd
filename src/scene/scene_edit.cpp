// Finds the bytes of a key, changes them, and holds the result against what the parser reads of it.
#include "scene/scene_edit.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "scene/scene_key.h"
#include "scene/scene_schema.h"
#include "scene/setting_reader.h"
#include "scene/toml_places.h"

namespace matchlight {

namespace {

toml::table parsed(std::string_view text) {
    return toml::parse(text);
}

std::string entry_text(const std::string& key, const SceneValue& value) {
    return fmt::format("{} = {}", key, scene_value_text(value));
}

/// {bloom = {strength = 1}} of the names and the value's text.
std::string nested(std::span<const std::string> names, const std::string& value) {
    std::string text = value;
    for (std::size_t i = names.size(); i-- > 0;) text = fmt::format("{{{} = {}}}", names[i], text);
    return text;
}

/// One change of the text, in whichever of several ways holds.
class Change {
public:
    Change(const std::filesystem::path& path, std::string_view key, std::string_view text)
        : path_(path), key_(key), text_(text), places_(text), steps_(scene_key_steps(key)) {
        place_ = place_of_key(places_, steps_, path);
    }

    const TomlPlaces& places() const { return places_; }
    const PlaceOfKey& place() const { return place_; }
    const std::vector<SceneKeyStep>& steps() const { return steps_; }

    /// Puts `by` in the place of some bytes; true where the parser then reads what it should.
    bool replace(const ByteRange& bytes, std::string_view by) {
        std::string text(text_.substr(0, bytes.begin));
        text += by;
        text += text_.substr(bytes.end);
        return take(std::move(text));
    }
    /// A block of lines, set off by blank ones.
    bool insert_block(std::size_t at, const std::string& block) {
        const std::string_view newline = places_.newline();
        std::string text;
        if (at > 0 && text_[at - 1] != '\n') text += newline;
        const bool first = at == places_.line_begin(0);
        if (!first && !places_.is_blank(places_.line_begin(at - 1))) text += newline;
        text += block;
        if (at < text_.size() && !places_.is_blank(at)) text += newline;
        return replace({at, at}, text);
    }
    bool insert_line(std::size_t at, const std::string& line) {
        const std::string_view newline = places_.newline();
        const bool behind_last = at > 0 && text_[at - 1] != '\n';
        return replace({at, at}, fmt::format("{}{}{}", behind_last ? newline : "", line, newline));
    }
    /// A section of its own, behind those that the schema names before it.
    bool insert_section(const std::string& section, const std::string& block);

    void expect(toml::table tree) { expected_ = std::move(tree); }
    toml::table& expected() { return expected_; }

    std::string_view text() const { return text_; }
    /// Throws InputError unless a way held.
    std::string result() const {
        if (result_) return *result_;
        const toml::node* near = place_.node != nullptr ? place_.node : place_.container;
        throw InputError(InputErrorParts{
            path_, std::nullopt, fmt::format("'{}' is written in a way that cannot be changed here", key_),
            "change it in a text editor", static_cast<std::int64_t>(near->source().begin.line)});
    }

private:
    bool take(std::string text) {
        try {
            if (parsed(text) != expected_) return false;
        } catch (const toml::parse_error&) {
            return false;
        }
        result_ = std::move(text);
        return true;
    }

    const std::filesystem::path& path_;
    std::string_view key_;
    std::string_view text_;
    TomlPlaces places_;
    std::vector<SceneKeyStep> steps_;
    PlaceOfKey place_;
    toml::table expected_ = places_.root();
    std::optional<std::string> result_;
};

bool Change::insert_section(const std::string& section, const std::string& block) {
    const auto order_of = [](std::string_view name) {
        const std::span<const SceneSection> sections = scene_sections();
        return std::ranges::find(sections, name, &SceneSection::name) - sections.begin();
    };
    const toml::node* before = nullptr;
    std::ptrdiff_t order_before = -1;
    for (const auto& [key, node] : places_.root()) {
        const std::ptrdiff_t order = order_of(key.str());
        if (order >= order_of(section) || order <= order_before) continue;
        order_before = order;
        before = &node;
    }
    if (before != nullptr) {
        const std::size_t below = places_.line_end(places_.end_of_all(*before));
        if (insert_block(places_.comments_below(below), block)) return true;
    }
    return insert_block(text_.size(), block);
}

/// Where a table's next line goes, and how it is indented.
struct NextLine {
    std::size_t at = 0;
    std::string_view indent;
};

NextLine next_line(const Change& change) {
    const PlaceOfKey& place = change.place();
    const TomlPlaces& places = change.places();
    const std::vector<ByteRange> values = places.own_values(*place.parent);
    const std::size_t header = places.range(*place.container).begin;
    const std::size_t like = places.line_begin(values.empty() ? header : values.front().begin);
    const std::size_t text_begin = change.text().find_first_not_of(" \t", like);
    return {places.line_end(values.empty() ? places.range(*place.container).end : values.back().end),
            change.text().substr(like, text_begin - like)};
}

/// The key is not there: it is added to the table that would hold it.
void add_key(Change& change, const std::string& value) {
    const PlaceOfKey& place = change.place();
    const TomlPlaces& places = change.places();
    const std::span<const std::string> missing(place.missing);
    const std::string rest = nested(missing.subspan(1), value);
    const std::string dotted = place.prefix.empty() ? "" : fmt::format("{}.", fmt::join(place.prefix, "."));
    const std::string entry = fmt::format("{}{} = {}", dotted, missing.front(), rest);
    const std::string_view newline = places.newline();
    switch (places.form(*place.container)) {
        case TableForm::braces: {
            const std::vector<ByteRange> values = places.own_values(*place.container);
            if (values.empty()) {
                change.replace(places.range(*place.container), fmt::format("{{{}}}", entry));
            } else {
                change.replace({values.back().end, values.back().end}, ", " + entry);
            }
            return;
        }
        case TableForm::implied: {
            const std::size_t line = places.line_begin(places.range(*place.container).begin);
            change.insert_block(places.comments_above(line),
                                fmt::format("[{}]{}{}{}", fmt::join(place.names, "."), newline, entry, newline));
            return;
        }
        case TableForm::root:
            if (place.prefix.empty()) {
                if (missing.size() < 2) return;  // a section is no single value
                const std::string line = fmt::format("{} = {}", missing[1], nested(missing.subspan(2), value));
                change.insert_section(missing.front(),
                                      fmt::format("[{}]{}{}{}", missing.front(), newline, line, newline));
                return;
            }
            [[fallthrough]];
        default: {
            const NextLine next = next_line(change);
            change.insert_line(next.at, fmt::format("{}{}", next.indent, entry));
        }
    }
}

/// A table with a header of its own, and what is within: whole lines, one of the blank lines around them too.
void remove_block(Change& change) {
    const TomlPlaces& places = change.places();
    ByteRange bytes{places.comments_above(places.line_begin(places.range(*change.place().node).begin)),
                    places.line_end(places.end_of_all(*change.place().node))};
    const std::size_t size = change.text().size();
    while (bytes.end < size && places.is_blank(bytes.end)) bytes.end = places.line_end(bytes.end);
    const auto blank_before = [&] {
        return bytes.begin > places.line_begin(0) && places.is_blank(places.line_begin(bytes.begin - 1));
    };
    while (bytes.end == size && blank_before()) bytes.begin = places.line_begin(bytes.begin - 1);
    change.replace(bytes, "");
}

/// One of several in braces or brackets, with the comma that parted it from the others. `inside` begins behind the
/// opening one.
void remove_item(Change& change, std::span<const ByteRange> items, std::size_t item, std::size_t inside) {
    const auto begin_of = [&](std::size_t i) {
        const std::size_t behind = i == 0 ? inside : items[i - 1].end;
        return change.text().find_first_not_of(i == 0 ? " \t\r\n" : " \t\r\n,", behind);
    };
    if (item + 1 < items.size()) {
        change.replace({begin_of(item), begin_of(item + 1)}, "");
    } else {
        change.replace({item == 0 ? begin_of(0) : items[item - 1].end, items[item].end}, "");
    }
}

void remove_value(Change& change) {
    const PlaceOfKey& place = change.place();
    const TomlPlaces& places = change.places();
    const ByteRange value = places.range(*place.node);
    if (place.list != nullptr) {
        std::vector<ByteRange> items;
        for (const toml::node& node : *place.list) items.push_back(places.range(node));
        return remove_item(change, items, place.index, places.range(*place.list).begin + 1);
    }
    const bool in_braces = places.form(*place.container) == TableForm::braces;
    const std::size_t line = places.line_begin(places.begin(*place.key));
    if (!place.prefix.empty() && place.parent->size() == 1) {
        // The table goes on, empty: it may mean that something is on.
        const std::size_t parent_begin = places.range(*place.parent).begin;
        const std::size_t begin = in_braces ? parent_begin : change.text().find_first_not_of(" \t", line);
        change.replace({begin, value.end}, fmt::format("{} = {{}}", fmt::join(place.prefix, ".")));
        return;
    }
    if (!in_braces) {
        change.replace({line, places.line_end(value.end)}, "");
        return;
    }
    const std::vector<ByteRange> items = places.own_values(*place.container);
    const auto found = std::ranges::find(items, value.begin, &ByteRange::begin);
    remove_item(change, items, static_cast<std::size_t>(found - items.begin()),
                places.range(*place.container).begin + 1);
}

}  // namespace

std::string scene_value_text(const SceneValue& value) {
    const auto number = [](double x) {
        if (!std::isfinite(x)) throw InputError({}, "a scene's numbers are finite");
        return fmt::format("{}", x);
    };
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* whole = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *whole);
    if (const auto* real = std::get_if<double>(&value)) return number(*real);
    if (const auto* word = std::get_if<std::string>(&value)) return toml_text(toml::value<std::string>(*word));
    if (const auto* toml = std::get_if<TomlText>(&value)) return toml->text;
    std::vector<std::string> items;
    for (const double x : std::get<std::vector<double>>(value)) items.push_back(number(x));
    return fmt::format("[{}]", fmt::join(items, ", "));
}

SceneText::SceneText(std::filesystem::path path, std::string text) : path_(std::move(path)), text_(std::move(text)) {
    try {
        static_cast<void>(parsed(text_));
    } catch (const toml::parse_error& error) {
        throw InputError(InputErrorParts{path_, std::nullopt, std::string(error.description()), "",
                                         static_cast<std::int64_t>(error.source().begin.line)});
    }
}

SceneText SceneText::load(const std::filesystem::path& path) {
    return {path, read_text_file(path, scene_limit_bytes)};
}

bool SceneText::has(std::string_view key) const {
    const toml::table root = parsed(text_);
    return node_of_key(root, scene_key_steps(key)) != nullptr;
}

std::size_t SceneText::count(std::string_view key) const {
    const toml::table root = parsed(text_);
    const toml::node* node = node_of_key(root, scene_key_steps(key));
    return node != nullptr && node->is_array() ? node->as_array()->size() : 0;
}

void SceneText::set(std::string_view key, const SceneValue& value) {
    const std::string written = scene_value_text(value);
    Change change(path_, key, text_);
    const PlaceOfKey& place = change.place();
    const bool has_lines =
        place.node != nullptr && place.missing.empty() &&
        ((place.node->is_table() && !place.node->as_table()->is_inline()) || TomlPlaces::is_of_headers(*place.node));
    if (has_lines) {
        SceneText without = *this;
        without.remove(key);
        without.set(key, value);
        text_ = std::move(without.text_);
        return;
    }
    set_in_tree(change.expected(), change.steps(), written, path_);
    if (place.node != nullptr) {
        change.replace(change.places().range(*place.node), nested(place.missing, written));
    } else {
        add_key(change, written);
    }
    text_ = change.result();
}

void SceneText::remove(std::string_view key) {
    if (!has(key)) return;
    Change change(path_, key, text_);
    const PlaceOfKey& place = change.place();
    if (TomlPlaces::is_of_headers(*place.node)) {
        SceneText without = *this;
        for (std::size_t i = place.node->as_array()->size(); i-- > 0;) without.remove(fmt::format("{}[{}]", key, i));
        text_ = std::move(without.text_);
        return;
    }
    remove_from_tree(change.expected(), change.steps());
    const toml::table* table = place.node->as_table();
    if (table == nullptr || table->is_inline()) {
        remove_value(change);
    } else if (change.places().form(*table) != TableForm::dotted) {
        remove_block(change);
    } else {
        const TomlPlaces& places = change.places();
        const std::vector<ByteRange> values = places.own_values(*table);
        change.replace({places.line_begin(values.front().begin), places.line_end(values.back().end)}, "");
    }
    text_ = change.result();
}

void SceneText::append(std::string_view list, const SceneEntries& entries) {
    Change change(path_, list, text_);
    const PlaceOfKey& place = change.place();
    const TomlPlaces& places = change.places();
    const std::string_view newline = places.newline();
    std::vector<std::string> lines;
    for (const auto& [key, value] : entries) lines.push_back(entry_text(key, value));
    const std::string braces = fmt::format("{{{}}}", fmt::join(lines, ", "));
    const std::string block = fmt::format("[[{}]]{}{}{}", list, newline, fmt::join(lines, newline), newline);
    const bool is_section = change.steps().size() == 1;
    if (place.node == nullptr && !is_section) return set(list, TomlText(fmt::format("[{}]", braces)));
    append_in_tree(change.expected(), change.steps(), braces, path_);
    if (place.node == nullptr) {
        change.insert_section(std::string(list), block);
    } else if (TomlPlaces::is_of_headers(*place.node)) {
        const std::size_t below = places.line_end(places.end_of_all(*place.node));
        if (!change.insert_block(places.comments_below(below), block)) change.insert_block(text_.size(), block);
    } else if (const toml::array* array = place.node->as_array(); array != nullptr && !array->empty()) {
        const ByteRange last = places.range(array->back());
        const std::size_t line = places.line_begin(last.begin);
        const bool has_own_line = text_.find_first_not_of(" \t", line) == last.begin;
        const std::string gap =
            has_own_line ? fmt::format(",{}{}", newline, text_.substr(line, last.begin - line)) : ", ";
        change.replace({last.end, last.end}, gap + braces);
    } else if (array != nullptr) {
        change.replace(places.range(*array), fmt::format("[{}]", braces));
    }
    text_ = change.result();
}

}  // namespace matchlight
