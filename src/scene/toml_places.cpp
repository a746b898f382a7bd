// From the parser's lines and code points to bytes.
#include "scene/toml_places.h"

#include <algorithm>
#include <iterator>

namespace matchlight {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool continues_code_point(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u;
}

}  // namespace

TomlPlaces::TomlPlaces(std::string_view text) : text_(text), root_(toml::parse(text)) {
    lines_.push_back(text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '\n') lines_.push_back(i + 1);
    }
    const std::size_t first = text.find('\n');
    if (first != std::string_view::npos && first > 0 && text[first - 1] == '\r') newline_ = "\r\n";
}

std::size_t TomlPlaces::offset(const toml::source_position& position) const {
    const std::size_t line = std::min<std::size_t>(position.line, lines_.size());
    std::size_t at = lines_[line - 1];
    for (toml::source_index column = 1; column < position.column && at < text_.size(); ++column) {
        ++at;
        while (at < text_.size() && continues_code_point(text_[at])) ++at;
    }
    return at;
}

ByteRange TomlPlaces::range(const toml::node& node) const {
    return {offset(node.source().begin), offset(node.source().end)};
}

bool TomlPlaces::is_of_headers(const toml::node& node) {
    const toml::array* array = node.as_array();
    return array != nullptr && !array->empty() && array->front().is_table() && !array->front().as_table()->is_inline();
}

TableForm TomlPlaces::form(const toml::table& table) const {
    if (&table == &root_) return TableForm::root;
    if (table.is_inline()) return TableForm::braces;
    const std::size_t begin = range(table).begin;
    if (begin >= text_.size() || text_[begin] != '[') return TableForm::dotted;
    // The parser gives a table that has no header the place of the first one further in.
    const bool is_implied = std::any_of(table.cbegin(), table.cend(), [&](const auto& entry) {
        const toml::node& child = entry.second;
        const bool may_have_header = child.is_table() ? !child.as_table()->is_inline() : is_of_headers(child);
        return may_have_header && range(child).begin == begin;
    });
    return is_implied ? TableForm::implied : TableForm::header;
}

void TomlPlaces::add_own_values(const toml::table& table, std::vector<ByteRange>& values) const {
    for (const auto& [key, node] : table) {
        if (is_of_headers(node)) continue;
        const toml::table* inner = node.as_table();
        if (inner == nullptr || inner->is_inline()) {
            values.push_back(range(node));
        } else if (form(*inner) == TableForm::dotted) {
            add_own_values(*inner, values);
        }
    }
}

std::vector<ByteRange> TomlPlaces::own_values(const toml::table& table) const {
    std::vector<ByteRange> values;
    add_own_values(table, values);
    std::ranges::sort(values, {}, &ByteRange::begin);
    return values;
}

std::size_t TomlPlaces::end_of_all(const toml::node& node) const {
    std::size_t end = range(node).end;
    if (const toml::table* table = node.as_table()) {
        for (const auto& [key, inner] : *table) end = std::max(end, end_of_all(inner));
    } else if (const toml::array* array = node.as_array()) {
        for (const toml::node& inner : *array) end = std::max(end, end_of_all(inner));
    }
    return end;
}

std::size_t TomlPlaces::line_begin(std::size_t at) const {
    return *std::prev(std::ranges::upper_bound(lines_, std::max(at, lines_.front())));
}

std::size_t TomlPlaces::line_end(std::size_t at) const {
    const std::size_t found = text_.find('\n', at);
    return found == std::string_view::npos ? text_.size() : found + 1;
}

bool TomlPlaces::is_blank(std::size_t line) const {
    return text_.substr(line, line_end(line) - line).find_first_not_of(" \t\r\n") == std::string_view::npos;
}

bool TomlPlaces::is_comment(std::size_t line) const {
    const std::size_t first = text_.find_first_not_of(" \t", line);
    return first != std::string_view::npos && text_[first] == '#';
}

std::size_t TomlPlaces::comments_above(std::size_t line) const {
    while (line > lines_.front() && is_comment(line_begin(line - 1))) line = line_begin(line - 1);
    return line;
}

std::size_t TomlPlaces::comments_below(std::size_t line) const {
    std::size_t end = line;
    while (end < text_.size() && is_comment(end)) end = line_end(end);
    return end == text_.size() || is_blank(end) ? end : line;
}

}  // namespace matchlight
