// AprilTag's family tables turned into cells.
#include "calibration/tag_family.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>

namespace matchlight {

namespace {

struct FamilyEntry {
    const char* name;
    apriltag_family_t* (*create)();
    void (*destroy)(apriltag_family_t*);
};

constexpr std::array<FamilyEntry, 5> families{{
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
}};

const FamilyEntry& entry_of(const std::string& name) {
    const auto found = std::ranges::find_if(families, [&](const FamilyEntry& entry) { return name == entry.name; });
    assert(found != families.end());
    return *found;
}

/// Draws the square ring whose outer side is `width` cells, centred in the pattern.
void draw_ring(TagPattern& pattern, int width, TagPattern::Ink ink) {
    const int first = (pattern.cells - width) / 2;
    const int last = first + width - 1;
    for (int i = first; i <= last; ++i) {
        for (const auto& [x, y] : {std::pair{i, first}, {i, last}, {first, i}, {last, i}}) {
            pattern.ink[static_cast<std::size_t>(y) * pattern.cells + x] = ink;
        }
    }
}

}  // namespace

const std::vector<std::string>& TagFamily::names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> list;
        for (const FamilyEntry& entry : families) list.emplace_back(entry.name);
        return list;
    }();
    return all;
}

TagFamily::TagFamily(const std::string& name) : name_(name), family_(entry_of(name).create(), entry_of(name).destroy) {}

int TagFamily::id_count() const {
    return static_cast<int>(family_->ncodes);
}

int TagFamily::allowed_hamming() const {
    if (family_->nbits < 20) return 0;
    return family_->nbits < 30 ? 1 : 2;
}

TagPattern TagFamily::pattern(int id) const {
    assert(id >= 0 && id < id_count());
    TagPattern pattern;
    pattern.cells = family_->total_width;
    const int border = family_->width_at_border;
    const int begin = (pattern.cells - border) / 2;
    pattern.border_begin = begin;
    pattern.border_end = begin + border;
    // Cells that carry neither a border nor a bit (the corners of round tags) may hold anything.
    pattern.ink.assign(static_cast<std::size_t>(pattern.cells) * pattern.cells, TagPattern::unknown);
    // The detection square lies where white meets black; a reversed border has its white inside.
    draw_ring(pattern, family_->reversed_border ? border + 2 : border, TagPattern::black);
    draw_ring(pattern, family_->reversed_border ? border : border + 2, TagPattern::white);
    for (std::uint32_t bit = 0; bit < family_->nbits; ++bit) {
        const int x = static_cast<int>(family_->bit_x[bit]) + begin;
        const int y = static_cast<int>(family_->bit_y[bit]) + begin;
        const bool set = (family_->codes[id] >> (family_->nbits - 1 - bit)) & 1;
        pattern.ink[static_cast<std::size_t>(y) * pattern.cells + x] = set ? TagPattern::white : TagPattern::black;
    }
    return pattern;
}

}  // namespace matchlight
