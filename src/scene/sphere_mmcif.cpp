// mmCIF: the loop of _atom_site, a row an atom, in ångström (Hall, Allen & Brown 1991, "The Crystallographic
// Information File"). gemmi would hold the whole file as words.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "scene/element_table.h"
#include "scene/sphere_readers.h"
#include "scene/text_fields.h"

namespace matchlight {
namespace {

struct SiteItem {
    int axis = -1;  // 0 to 2: of the place
    bool is_element = false;
    bool is_model = false;
    SphereValues wanted;
};

/// Words, quoted words, and text between lines that begin with a semicolon.
class CifWords {
public:
    explicit CifWords(ChunkedFile& file) : file_(file) {}

    /// The next word; nullopt at the end of the file. It is valid until the next call.
    std::optional<std::string_view> next() {
        while (true) {
            while (!line_.empty() && is_blank(line_.front())) line_.remove_prefix(1);
            if (!line_.empty() && line_.front() != '#') break;
            const auto line = file_.line();
            if (!line) return std::nullopt;
            line_ = *line;
            if (line_.starts_with(';')) return text_field();
        }
        is_quoted_ = line_.front() == '\'' || line_.front() == '"';
        return is_quoted_ ? quoted_word(line_.front()) : next_word(line_);
    }
    /// Whether the last word stood in quotes, and so is no keyword.
    bool is_quoted() const { return is_quoted_; }

private:
    std::string_view text_field() {
        is_quoted_ = true;
        while (!file_.needed_line("the end of a text").starts_with(';')) {
        }
        line_ = {};
        return "text";
    }
    /// A quote ends a word only where a blank follows.
    std::string_view quoted_word(char quote) {
        for (std::size_t i = 1; i < line_.size(); ++i) {
            if (line_[i] != quote || (i + 1 < line_.size() && !is_blank(line_[i + 1]))) continue;
            const std::string_view word = line_.substr(1, i - 1);
            line_.remove_prefix(i + 1);
            return word;
        }
        file_.fail("a quoted word has no end");
    }

    ChunkedFile& file_;
    std::string_view line_;  // what is left of it
    bool is_quoted_ = false;
};

bool begins_something_else(std::string_view word) {
    return word.starts_with('_') || word.starts_with("loop_") || word.starts_with("data_") || word.starts_with("save_");
}

std::vector<SiteItem> claimed_items(const ChunkedFile& file, const std::vector<std::string>& names,
                                    SphereBuilder& builder) {
    std::vector<SiteItem> items;
    int axes = 0;
    builder.have_elements(1);
    for (const std::string& name : names) {
        SiteItem item;
        for (int axis = 0; axis < 3; ++axis) {
            if (name == fmt::format("Cartn_{}", "xyz"[axis])) item.axis = axis;
        }
        if (item.axis >= 0) axes |= 1 << item.axis;
        item.is_element = name == "type_symbol";
        item.is_model = name == "pdbx_PDB_model_num";
        item.wanted = builder.claim(name);
        items.push_back(item);
    }
    if (axes != 7) file.fail("its _atom_site has no Cartn_x, Cartn_y and Cartn_z");
    return items;
}

void read_sites(ChunkedFile& file, CifWords& words, std::string first, const std::vector<SiteItem>& items,
                std::int64_t frame, SphereBuilder& builder) {
    std::string model;
    std::int64_t models = 0;
    std::optional<std::string_view> word = first;
    while (word && (words.is_quoted() || !begins_something_else(*word))) {
        SphereRecord record;
        record.line = file.line_number();
        for (std::size_t i = 0; i < items.size(); ++i) {
            if (!word) file.fail(fmt::format("it ends inside an atom, after {} of {} items", i, items.size()));
            const SiteItem& item = items[i];
            if (item.is_element) record.element = atomic_number(*word);
            if (item.is_model && (models == 0 || *word != model)) {
                model = *word;
                ++models;
            }
            if (item.axis >= 0 || item.wanted.any()) {
                const bool is_unknown = *word == "." || *word == "?";
                const auto number = is_unknown ? std::numeric_limits<double>::quiet_NaN() : number_in(*word);
                if (!number) file.fail(fmt::format("'{}' is no number", word->substr(0, 40)));
                if (item.axis >= 0) record.centre[static_cast<std::size_t>(item.axis)] = *number;
                record.put(item.wanted, *number);
            }
            word = words.next();
        }
        if (models > frame + 1) break;
        if (models == frame + 1 || (models == 0 && frame == 0)) builder.add(record);
    }
    if (frame > 0 && models <= frame) file.fail(fmt::format("it has {} models and no frame {}", models, frame));
}

}  // namespace

void read_mmcif_spheres(ChunkedFile& file, std::int64_t frame, SphereBuilder& builder) {
    constexpr std::string_view category = "_atom_site.";
    CifWords words(file);
    std::vector<std::string> names;
    while (const auto word = words.next()) {
        const bool is_site = !words.is_quoted() && word->starts_with(category);
        if (is_site) {
            names.emplace_back(word->substr(category.size()));
        } else if (!names.empty()) {
            const std::string first(*word);
            const std::vector<SiteItem> items = claimed_items(file, names, builder);
            builder.begin(std::nullopt);
            return read_sites(file, words, first, items, frame, builder);
        }
    }
    file.fail("it has no _atom_site loop", "give an mmCIF file with coordinates");
}

}  // namespace matchlight
