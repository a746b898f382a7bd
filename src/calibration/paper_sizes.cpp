// Sizes of paper.
#include "calibration/paper_sizes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/lowercase.h"

namespace matchlight {

const char* const paper_forms = "a0 to a6, letter, legal, tabloid, or WIDTHxHEIGHTmm such as 300x400mm";

namespace {

struct NamedPaper {
    const char* name;
    double width_mm, height_mm;
};
/// ISO 216, and ANSI's sizes in inches; by area.
constexpr std::array<NamedPaper, 10> named_papers = {{{"a6", 105, 148},
                                                      {"a5", 148, 210},
                                                      {"letter", 215.9, 279.4},
                                                      {"a4", 210, 297},
                                                      {"legal", 215.9, 355.6},
                                                      {"tabloid", 279.4, 431.8},
                                                      {"a3", 297, 420},
                                                      {"a2", 420, 594},
                                                      {"a1", 594, 841},
                                                      {"a0", 841, 1189}}};

/// What roll printers take, and what holds a ruler's line of text.
constexpr double largest_mm = 20000, smallest_mm = 40;

[[noreturn]] void fail(const std::string& text, const std::string& cause) {
    throw InputError({}, "the paper \"" + printable(text) + "\" " + cause, std::string("say ") + paper_forms);
}

}  // namespace

Paper read_paper(const std::string& text) {
    const std::string name = lowercase(text);
    for (const NamedPaper& paper : named_papers) {
        if (name == paper.name) return {name, paper.width_mm, paper.height_mm, true};
    }
    Paper paper{name, 0, 0, false};
    const char* const end = name.data() + name.size();
    const auto width = std::from_chars(name.data(), end, paper.width_mm);
    if (width.ec != std::errc() || width.ptr == end || *width.ptr != 'x') fail(text, "is not known");
    const auto height = std::from_chars(width.ptr + 1, end, paper.height_mm);
    const std::string unit(height.ptr, end);
    if (height.ec != std::errc() || (!unit.empty() && unit != "mm")) fail(text, "is not known");
    for (const double side : {paper.width_mm, paper.height_mm}) {
        if (!(side >= smallest_mm && side <= largest_mm)) {
            fail(text, fmt::format("has a side of {} mm, not of {} to {}", side, smallest_mm, largest_mm));
        }
    }
    return paper;
}

std::vector<Paper> ways_to_lay(const Paper& paper) {
    std::vector<Paper> ways = {paper};
    if (paper.may_turn && paper.width_mm != paper.height_mm) {
        ways.push_back({paper.name, paper.height_mm, paper.width_mm, true});
    }
    return ways;
}

void refuse_paper(const std::string& what, const Paper& paper, const std::function<bool(const Paper&)>& fits) {
    std::vector<const char*> larger;
    for (const NamedPaper& other : named_papers) {
        const std::vector<Paper> ways = ways_to_lay({other.name, other.width_mm, other.height_mm, true});
        if (std::ranges::any_of(ways, fits)) larger.push_back(other.name);
    }
    const std::string cure = larger.empty() ? "make it smaller, or name a plotter's paper, such as --paper 1200x1600mm"
                                            : fmt::format("it fits on {}", fmt::join(larger, ", "));
    throw InputError({},
                     fmt::format("{} with margins does not fit on {} ({:.4g} × {:.4g} mm)", what, paper.name,
                                 paper.width_mm, paper.height_mm),
                     cure);
}

}  // namespace matchlight
