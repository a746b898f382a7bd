// Where the parts of a TOML text are, byte by byte: for edits that leave all else as it is.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

namespace matchlight {

struct ByteRange {
    std::size_t begin = 0, end = 0;
};

/// How a table is written.
enum class TableForm {
    root,
    header,   // [a.b], or an element of [[a.b]]
    implied,  // the a of [a.b], where it has no header of its own
    dotted,   // the a of a.b = 1
    braces    // {…}
};

class TomlPlaces {
public:
    /// `text` must outlive this. Throws toml::parse_error.
    explicit TomlPlaces(std::string_view text);

    const toml::table& root() const { return root_; }

    TableForm form(const toml::table& table) const;
    /// Whether its elements have headers of their own.
    static bool is_of_headers(const toml::node& node);

    /// Of a value as it is written; of a table with a header, of the header alone.
    ByteRange range(const toml::node& node) const;
    std::size_t begin(const toml::key& key) const { return offset(key.source().begin); }
    std::size_t end(const toml::key& key) const { return offset(key.source().end); }

    /// What is written under a table's own header, in its braces, or by its dotted keys, in the order of the text.
    std::vector<ByteRange> own_values(const toml::table& table) const;
    /// Where what was written of it, and of what is within, last ends.
    std::size_t end_of_all(const toml::node& node) const;

    std::size_t line_begin(std::size_t at) const;
    /// Behind its line end, where it has one.
    std::size_t line_end(std::size_t at) const;
    bool is_blank(std::size_t line) const;
    /// Where the comments begin that stand right above a line.
    std::size_t comments_above(std::size_t line) const;
    /// Behind the comments right below that a blank line, or the text's end, parts from what follows.
    std::size_t comments_below(std::size_t line) const;
    std::string_view newline() const { return newline_; }

private:
    std::size_t offset(const toml::source_position& position) const;
    bool is_comment(std::size_t line) const;
    void add_own_values(const toml::table& table, std::vector<ByteRange>& values) const;

    std::string_view text_;
    toml::table root_;
    std::vector<std::size_t> lines_;  // where each begins
    std::string_view newline_ = "\n";
};

}  // namespace matchlight
