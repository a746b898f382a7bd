// AprilTags on pages: which ids at what size, how many fit, and their places as a scene file has them.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/board_sheet.h"
#include "calibration/ink_shape.h"
#include "calibration/paper_sizes.h"
#include "calibration/sheet_frame.h"
#include "calibration/tag_family.h"
#include "core/error.h"

namespace matchlight {

const char* const tag_sheet_form =
    "\"tags FAMILY IDS SIZE\" (ids such as 0-5 or 0,3,7-9; side of the black border in metres)";

namespace {

using Eigen::Vector2d;

constexpr double label_mm = 3.5;  // the line of text under a tag

[[noreturn]] void fail_sheet(const std::string& text, const std::string& cause) {
    throw InputError({}, "the sheet \"" + printable(text) + "\": " + cause, std::string("say ") + tag_sheet_form);
}

int whole_number(const std::string& word, const std::string& text) {
    int value = 0;
    const auto parsed = std::from_chars(word.data(), word.data() + word.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != word.data() + word.size() || value < 0) {
        fail_sheet(text, "\"" + printable(word) + "\" is no id");
    }
    return value;
}

std::vector<int> ids_of(const std::string& word, const TagFamily& family, const std::string& text) {
    std::vector<int> ids;
    std::istringstream parts(word);
    for (std::string part; std::getline(parts, part, ',');) {
        const std::size_t dash = part.find('-');
        const int first = whole_number(part.substr(0, dash), text);
        const int last = dash == std::string::npos ? first : whole_number(part.substr(dash + 1), text);
        for (const int id : {first, last}) {
            if (id < family.id_count()) continue;
            fail_sheet(text, fmt::format("{} has ids 0 to {}, not {}", family.name(), family.id_count() - 1, id));
        }
        if (last < first) fail_sheet(text, "the ids " + printable(part) + " run backwards");
        for (int id = first; id <= last; ++id) {
            if (std::ranges::find(ids, id) != ids.end()) fail_sheet(text, fmt::format("the id {} is named twice", id));
            ids.push_back(id);
        }
    }
    if (ids.empty()) fail_sheet(text, "names no id");
    return ids;
}

/// The cells that hold ink, which for some families reach beyond the detection corners.
struct InkCells {
    int begin = 0, end = 0;  // along a side of the pattern
    double cell_mm = 0;
    double side_mm() const { return (end - begin) * cell_mm; }
};

InkCells ink_cells_of(const TagPattern& pattern, double size_m) {
    const double cell_mm = 1000 * size_m / (pattern.border_end - pattern.border_begin);
    // Around the border lies a ring of white; where there are cells beyond it, they are part of the code.
    const bool beyond = pattern.border_begin > 1;
    if (beyond) return {0, pattern.cells, cell_mm};
    return {static_cast<int>(pattern.border_begin), static_cast<int>(pattern.border_end), cell_mm};
}

/// Where tags lie on a page.
struct TagGrid {
    int columns = 0, rows = 0;
    double left = 0, top = 0;  // of the first tag's ink
    double step_x = 0, step_y = 0;

    int count() const { return columns * rows; }
};

std::optional<TagGrid> grid_on(const Paper& paper, const InkCells& cells, int wanted) {
    // AprilTag asks for a cell of white around a tag; small print keeps off it.
    const double side = cells.side_mm(), white = std::max(cells.cell_mm, white_mm);
    const double edge = std::max(white, sheet_margin_mm);
    TagGrid grid;
    grid.step_x = side + 2 * white;
    grid.step_y = side + 2 * white + label_mm + top_mark_mm;
    const double above = std::max(edge, sheet_margin_mm + top_mark_mm + white);
    const double below = std::max(edge, sheet_margin_mm + footer_mm + label_mm + white);
    const double room_x = paper.width_mm - 2 * edge - side, room_y = paper.height_mm - above - below - side;
    if (room_x < 0 || room_y < 0) return std::nullopt;
    grid.columns = std::min(wanted, 1 + static_cast<int>(std::floor(room_x / grid.step_x)));
    grid.rows =
        std::min((wanted + grid.columns - 1) / grid.columns, 1 + static_cast<int>(std::floor(room_y / grid.step_y)));
    grid.left = edge + (room_x - (grid.columns - 1) * grid.step_x) / 2;
    grid.top = above + (room_y - (grid.rows - 1) * grid.step_y) / 2;
    return grid;
}

void add_tag(SheetPage& page, const TagFamily& family, int id, double size_m, const Vector2d& at) {
    const TagPattern pattern = family.pattern(id);
    const InkCells cells = ink_cells_of(pattern, size_m);
    const auto place = [&](double column, double row) {
        return Vector2d(at + cells.cell_mm * Vector2d(column - cells.begin, row - cells.begin));
    };
    std::vector<InkRectangle> black;
    for (int y = cells.begin; y < cells.end; ++y) {
        for (int x = cells.begin; x < cells.end; ++x) {
            if (pattern.at(x, y) != TagPattern::black) continue;
            const Vector2d low = place(x, y), high = place(x + 1, y + 1);
            black.push_back({low.x(), low.y(), high.x(), high.y()});
        }
    }
    page.ink.push_back(united(black));
    const double begin = pattern.border_begin, end = pattern.border_end;
    for (const Vector2d& corner : {place(begin, end), place(end, end), place(end, begin), place(begin, begin)}) {
        page.corners_mm.push_back(corner);
    }
    const double middle = (begin + end) / 2, side = cells.side_mm(), white = std::max(cells.cell_mm, white_mm);
    page.tags.push_back({id, place(middle, middle)});
    add_top_mark(page, at + Vector2d(side / 2, -white));
    page.texts.push_back({fmt::format("{} id {}, {:.4g} mm", family.name(), id, 1000 * size_m),
                          at + Vector2d(side / 2, side + white + 2.5), 2.5, side, true});
}

}  // namespace

bool names_tags(const std::string& text) {
    std::istringstream words(text);
    std::string first;
    words >> first;
    return first == "tags" || first == "tag";
}

TagSheetSpec read_tag_sheet(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    if (words.size() != 4) fail_sheet(text, fmt::format("has {} words, not 4", words.size()));
    TagSheetSpec spec;
    spec.family = words[1];
    if (std::ranges::find(TagFamily::names(), spec.family) == TagFamily::names().end()) {
        throw InputError({}, "the tag family \"" + printable(spec.family) + "\" is not known",
                         fmt::format("say one of {}", fmt::join(TagFamily::names(), ", ")));
    }
    spec.ids = ids_of(words[2], TagFamily(spec.family), text);
    const std::string& size = words[3];
    const auto parsed = std::from_chars(size.data(), size.data() + size.size(), spec.size_m);
    constexpr double smallest_m = 1e-3, largest_m = 20;  // a millimetre; the width of roll paper
    if (parsed.ec != std::errc() || parsed.ptr != size.data() + size.size() ||
        !(spec.size_m >= smallest_m && spec.size_m <= largest_m)) {
        fail_sheet(text,
                   fmt::format("\"{}\" is no size of a tag from {} to {} m", printable(size), smallest_m, largest_m));
    }
    return spec;
}

BoardSheet tag_sheet(const TagSheetSpec& spec, const Paper& paper, int most_per_page) {
    const TagFamily family(spec.family);
    const InkCells cells = ink_cells_of(family.pattern(spec.ids.front()), spec.size_m);
    const int total = static_cast<int>(spec.ids.size());
    const int wanted = most_per_page > 0 ? std::min(most_per_page, total) : total;
    std::optional<TagGrid> grid;
    BoardSheet sheet{paper, {}, {}};
    for (const Paper& way : ways_to_lay(paper)) {
        const std::optional<TagGrid> here = grid_on(way, cells, wanted);
        if (!here || (grid && here->count() <= grid->count())) continue;
        grid = here;
        sheet.paper = way;
    }
    if (!grid) {
        refuse_paper(fmt::format("a tag of {} with {:.4g} mm of ink", spec.family, cells.side_mm()), paper,
                     [&](const Paper& other) { return grid_on(other, cells, 1).has_value(); });
    }
    const int per_page = std::min(wanted, grid->count()), pages = (total + per_page - 1) / per_page;
    sheet.title = fmt::format("{} tags of {}, {:.4g} mm", total, spec.family, 1000 * spec.size_m);
    for (int first = 0; first < total; first += per_page) {
        SheetPage page;
        for (int i = first; i < std::min(first + per_page, total); ++i) {
            const int column = (i - first) % grid->columns, row = (i - first) / grid->columns;
            add_tag(page, family, spec.ids[static_cast<std::size_t>(i)], spec.size_m,
                    {grid->left + column * grid->step_x, grid->top + row * grid->step_y});
        }
        const std::string number =
            pages > 1 ? fmt::format(", page {} of {}", sheet.pages.size() + 1, pages) : std::string();
        add_footer(page, sheet.paper, fmt::format("{}, {:.4g} mm{}", spec.family, 1000 * spec.size_m, number));
        sheet.pages.push_back(std::move(page));
    }
    return sheet;
}

std::string rig_text(const TagSheetSpec& spec, const BoardSheet& sheet) {
    std::string text = fmt::format("[tags]\nfamily = \"{}\"\n", spec.family);
    if (sheet.pages.size() > 1) {
        text += "# The places are those on the first page; pages may lie anywhere, and `track` finds where.\n";
    }
    text += "rig = [\n";
    for (std::size_t i = 0; i < sheet.pages.size(); ++i) {
        const std::vector<PrintedTag>& tags = sheet.pages[i].tags;
        const PrintedTag& origin = *std::ranges::min_element(tags, {}, &PrintedTag::id);
        for (const PrintedTag& tag : tags) {
            const Vector2d at = tag.middle_mm - origin.middle_mm;
            // Adding zero turns a zero's minus sign, where y is mirrored, into a plus.
            const std::string place =
                i > 0 ? "" : fmt::format(", x = {:.6g}, y = {:.6g}", at.x() / 1000, 0 - at.y() / 1000);
            text += fmt::format("    {{id = {}, size = {:.6g}{}}},\n", tag.id, spec.size_m, place);
        }
    }
    return text + "]\n";
}

}  // namespace matchlight
