// The study's tables of sphere sets: what a frame costs over an orbit by each way of drawing, and what its picture is
// off by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/knob.h"
#include "report/measured_time.h"

namespace matchlight {

/// One way to draw a set over the frames of an orbit. Ways of one part are drawn in turn at every frame.
struct SphereStudyRow {
    std::string set;
    std::uint64_t spheres = 0;
    std::string orbit;
    std::string part;  // "visibility", "layers", "light", "maps"
    std::string way;
    std::size_t frames = 0;
    RunTime time;                   // of a frame, over the orbit
    std::optional<double> speedup;  // over the part's first way: the median of the frames' ratios
    std::vector<Knob> beside;       // what else the last frame tells: cells drawn, layers
};

/// An opaque picture against the double-precision ray caster's.
struct SphereCheckRow {
    std::string set;
    std::string orbit;
    std::size_t frames = 0;
    std::uint64_t pixels = 0, edge_pixels = 0;       // of all frames; edges: silhouettes and seams
    double largest_codes = 0;                        // off the edges
    std::uint64_t over_one_code = 0;                 // pixels off the edges
    double largest_coverage = 0, mean_coverage = 0;  // difference, at the edges
    std::uint64_t over_a_sixteenth = 0;              // pixels at the edges
};

struct SphereStudy {
    std::vector<SphereStudyRow> rows;
    std::vector<SphereCheckRow> checks;

    bool empty() const { return rows.empty() && checks.empty(); }
};

nlohmann::ordered_json sphere_study_json(const SphereStudy& study);
/// One line a way, with a header.
std::string sphere_study_csv(const SphereStudy& study);
/// For a terminal.
std::string sphere_study_lines(const SphereStudy& study);
/// A section of the page.
std::string sphere_study_html(const SphereStudy& study);

}  // namespace matchlight
