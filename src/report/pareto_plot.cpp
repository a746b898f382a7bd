// Places axes, points and labels by hand: a plot needs no library.
#include "report/pareto_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "core/html_text.h"

namespace matchlight {
namespace {

constexpr double width_px = 720, height_px = 420;
constexpr double left_px = 76, right_px = 24, top_px = 20, bottom_px = 56;
/// Errors below it are drawn on the axis: no display shows them, and 0 has no logarithm.
constexpr double least_error = 1e-6;

/// A logarithmic axis from whole steps of 1, 2 or 5 times a power of ten.
struct LogAxis {
    double low = 1, high = 10;  // values
    double from_px = 0, to_px = 1;

    double px(double value) const {
        const double share = std::log(std::max(value, 1e-300) / low) / std::log(high / low);
        return from_px + std::clamp(share, 0.0, 1.0) * (to_px - from_px);
    }
};

double step_at_or_below(double value) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    const double digits = value / power * (1 + 1e-9);
    return power * (digits >= 5 ? 5 : digits >= 2 ? 2 : 1);
}

double next_step(double step) {
    const double power = std::pow(10, std::floor(std::log10(step * (1 + 1e-9))));
    const double digits = std::round(step / power);
    return power * (digits >= 5 ? 10 : digits >= 2 ? 5 : 2);
}

LogAxis axis_over(const std::vector<double>& values, double from_px, double to_px) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    LogAxis axis{step_at_or_below(*low / 1.15), *high * 1.15, from_px, to_px};
    double top = axis.low;
    while (top < axis.high || top < axis.low * 2) top = next_step(top);
    axis.high = top;
    return axis;
}

std::vector<double> ticks_of(const LogAxis& axis) {
    const bool whole_powers = axis.high / axis.low > 500;
    std::vector<double> ticks;
    for (double tick = axis.low; tick <= axis.high * (1 + 1e-9); tick = next_step(tick)) {
        const double power = std::pow(10, std::round(std::log10(tick)));
        if (!whole_powers || std::abs(tick / power - 1) < 1e-6) ticks.push_back(tick);
    }
    return ticks;
}

struct Box {
    double left, top, right, bottom;
    bool meets(const Box& other) const {
        return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
    }
};

struct Label {
    double x, y;
    const char* anchor;
};

/// A label as far away as this has a line to its point.
constexpr double far_px = 30;

/// Beside a point where it covers the fewest of what is there already, far above it if need be.
Label place_label(double x, double y, double text_width, const std::vector<Box>& taken, Box& box) {
    struct Candidate {
        double dx, dy;
        const char* anchor;
    };
    static constexpr std::array<Candidate, 18> candidates{{{8, -6, "start"},
                                                           {8, 14, "start"},
                                                           {-8, -6, "end"},
                                                           {-8, 14, "end"},
                                                           {0, -11, "middle"},
                                                           {0, 20, "middle"},
                                                           {10, -20, "start"},
                                                           {10, 28, "start"},
                                                           {-10, -20, "end"},
                                                           {-10, 28, "end"},
                                                           {8, -34, "start"},
                                                           {-8, -34, "end"},
                                                           {8, -48, "start"},
                                                           {-8, -48, "end"},
                                                           {8, -62, "start"},
                                                           {-8, -62, "end"},
                                                           {8, -76, "start"},
                                                           {-8, -76, "end"}}};
    Label best{};
    double least = 1e9;
    for (const Candidate& candidate : candidates) {
        const double at = x + candidate.dx;
        const double shift = candidate.anchor[0] == 's' ? 0 : candidate.anchor[0] == 'e' ? -1 : -0.5;
        const Box here{at + shift * text_width, y + candidate.dy - 10, at + (shift + 1) * text_width,
                       y + candidate.dy + 3};
        double cost = static_cast<double>(std::ranges::count_if(taken, [&](const Box& b) { return b.meets(here); }));
        if (here.left < left_px || here.right > width_px || here.top < 2 || here.bottom > height_px - bottom_px) {
            cost += 2;
        }
        if (cost < least) {
            least = cost;
            best = {at, y + candidate.dy, candidate.anchor};
            box = here;
        }
    }
    return best;
}

}  // namespace

std::string pareto_plot_svg(const EffectReport& effect, const PlotWords& words) {
    std::vector<const EffectPoint*> points;
    std::vector<double> times, errors;
    for (const EffectPoint& point : effect.points) {
        if (!point.errors.flip || !(point.time.median_ms > 0)) continue;
        points.push_back(&point);
        times.insert(times.end(), {point.time.median_ms, std::max(point.time.min_ms, 1e-6), point.time.max_ms});
        errors.push_back(std::max(*point.errors.flip, least_error));
    }
    if (points.empty()) return {};
    const bool has_self_error = effect.reference_self_error_flip && *effect.reference_self_error_flip > least_error;
    if (has_self_error) errors.push_back(*effect.reference_self_error_flip);
    const LogAxis x = axis_over(times, left_px, width_px - right_px);
    const LogAxis y = axis_over(errors, height_px - bottom_px, top_px);

    std::string svg = fmt::format(
        "<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{} against milliseconds, {}\">",
        width_px, height_px, html_text(words.error), html_text(effect.name));
    for (const double tick : ticks_of(x)) {
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\"/>"
            "<text class=\"tick\" x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:g}</text>",
            x.px(tick), top_px, height_px - bottom_px, height_px - bottom_px + 16, tick);
    }
    for (const double tick : ticks_of(y)) {
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\"/>"
            "<text class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>",
            left_px, y.px(tick), width_px - right_px, left_px - 6, y.px(tick) + 4, tick);
    }
    svg += fmt::format("<text class=\"axis\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                       (left_px + width_px - right_px) / 2, height_px - 14, html_text(words.time));
    svg += fmt::format(
        "<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(18 {:.1f}) rotate(-90)\">{}</text>",
        (top_px + height_px - bottom_px) / 2, html_text(words.against));

    std::vector<Box> taken;
    if (has_self_error) {
        const double at = y.px(*effect.reference_self_error_flip);
        svg += fmt::format("<line class=\"self\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", left_px,
                           at, width_px - right_px, at);
        svg +=
            fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">the reference's own</text>",
                        width_px - right_px - 4, at - 4);
        taken.push_back({width_px - right_px - 120, at - 16, width_px - right_px, at + 2});
    }

    const std::vector<bool> on_front = pareto_front(effect.points);
    std::vector<const EffectPoint*> front;
    for (std::size_t i = 0; i < effect.points.size(); ++i) {
        if (on_front[i] && effect.points[i].time.median_ms > 0) front.push_back(&effect.points[i]);
    }
    std::ranges::sort(front, {}, [](const EffectPoint* point) { return point->time.median_ms; });
    std::string line;
    for (const EffectPoint* point : front) {
        line += fmt::format("{:.1f},{:.1f} ", x.px(point->time.median_ms),
                            y.px(std::max(*point->errors.flip, least_error)));
    }
    svg += fmt::format("<polyline class=\"front\" points=\"{}\"/>", line);

    for (const EffectPoint* point : points) {
        const double px = x.px(point->time.median_ms), py = y.px(std::max(*point->errors.flip, least_error));
        taken.push_back({px - 5, py - 5, px + 5, py + 5});
    }
    for (const EffectPoint* point : points) {
        const double px = x.px(point->time.median_ms), py = y.px(std::max(*point->errors.flip, least_error));
        const bool is_front = std::ranges::find(front, point) != front.end();
        svg += fmt::format("<line class=\"range\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
                           x.px(std::max(point->time.min_ms, 1e-6)), py, x.px(point->time.max_ms), py);
        svg += fmt::format(
            "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\"><title>{} ({}): {:.3g} ms, {} "
            "{:.3g}</title></circle>",
            is_front ? "best" : "other", px, py, html_text(point->level), html_text(knobs_text(point->knobs)),
            point->time.median_ms, html_text(words.error), *point->errors.flip);
        Box box{};
        constexpr double letter_px = 6.2;  // of the 11 px face, on the whole
        const Label label = place_label(px, py, letter_px * static_cast<double>(point->level.size()), taken, box);
        taken.push_back(box);
        if (std::abs(label.y - py) > far_px) {
            svg += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", px,
                               py - 5, label.x, label.y + 3);
        }
        svg += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>", label.x,
                           label.y, label.anchor, html_text(point->level));
    }
    return svg + "</svg>";
}

std::string pareto_plot_svg(const EffectReport& effect) {
    PlotWords words;
    if (effect.unit == WorkUnit::clip) words.time = "ms, once a clip";
    return pareto_plot_svg(effect, words);
}

}  // namespace matchlight
