// Curves over the frames of a clip, and who is seen when, as SVG.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace matchlight {

struct Curve {
    std::string name;
    std::vector<std::optional<double>> values;  // parallel to CurvePlot::frames
};

/// Frames first to last, both included, with a class of the page's style: "gap", "bridged".
struct Band {
    std::int64_t first = 0, last = 0;
    const char* style = "";
};

struct CurvePlot {
    std::string what;  // with its unit: "position, m"
    std::vector<std::int64_t> frames;
    std::vector<Curve> curves;
    std::vector<Band> bands;
    /// The axis: as wide as the values; from 0; or of logarithms, for errors that differ by powers of ten.
    enum class Axis { fitted, from_zero, logarithmic };
    Axis axis = Axis::fitted;

    /// Whether any curve has a value.
    bool says_something() const;
};

/// Errors below it are drawn on the edge of a logarithmic axis.
inline constexpr double least_drawn_error = 1e-3;

/// Lines that break where nothing is known; a lone value is a point. Empty where no value is.
std::string curve_plot_svg(const CurvePlot& plot);

/// A row for each name, with bars over runs of frames; `level` 0: nothing, 1: class "seen", 2: class "used".
struct TimelineRow {
    std::string name;
    std::vector<int> level;  // parallel to the frames
};
std::string timeline_svg(const std::vector<std::int64_t>& frames, const std::vector<TimelineRow>& rows);

/// Whole steps of 1, 2 or 5 times a power of ten that cover [low, high] with some four to eight of them.
std::vector<double> axis_ticks(double low, double high);

}  // namespace matchlight
