// Axes, lines, bands and bars, placed by hand.
#include "report/curve_plot.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/html_text.h"

namespace matchlight {
namespace {

constexpr double width_px = 720, height_px = 210;
constexpr double left_px = 64, right_px = 12, top_px = 26, bottom_px = 26;

struct FrameAxis {
    double first = 0, last = 1;

    explicit FrameAxis(const std::vector<std::int64_t>& frames) {
        first = static_cast<double>(frames.front()) - 0.5;
        last = static_cast<double>(frames.back()) + 0.5;
    }
    double px(double frame) const {
        return left_px + (frame - first) / (last - first) * (width_px - right_px - left_px);
    }
};

bool says_something(const Curve& curve) {
    return std::ranges::any_of(curve.values, [](const auto& value) { return value.has_value(); });
}

std::string frame_ticks(const FrameAxis& axis, double bottom) {
    std::string svg;
    for (const double tick : axis_ticks(axis.first, axis.last)) {
        if (tick < axis.first || tick > axis.last || tick != std::round(tick)) continue;
        svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:g}</text>",
                           axis.px(tick), bottom + 15, tick);
    }
    return svg;
}

/// From values to heights in the plot.
class ValueAxis {
public:
    explicit ValueAxis(const CurvePlot& plot) : logarithmic_(plot.axis == CurvePlot::Axis::logarithmic) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const Curve& curve : plot.curves) {
            for (const auto& value : curve.values) {
                if (!value) continue;
                low = std::min(low, position(*value));
                high = std::max(high, position(*value));
            }
        }
        if (logarithmic_) {
            low = std::floor(low);
            for (double tick = low; tick == low || tick < high; ++tick) ticks_.push_back(tick);
            ticks_.push_back(ticks_.back() + 1);
            return;
        }
        const bool from_zero = plot.axis == CurvePlot::Axis::from_zero;
        if (from_zero) low = std::min(low, 0.0);
        // A curve that does not move is a line in the middle, not noise across the plot.
        const double least = std::max(1e-6, 1e-3 * std::max(std::abs(low), std::abs(high)));
        if (high - low < least) {
            high += least / 2;
            if (!from_zero) low -= least / 2;
        }
        ticks_ = axis_ticks(low, high);
    }

    double px(double value) const {
        const double share = (position(value) - ticks_.front()) / (ticks_.back() - ticks_.front());
        return height_px - bottom_px - share * (height_px - bottom_px - top_px);
    }
    std::string grid() const {
        std::string svg;
        for (const double tick : ticks_) {
            const double value = logarithmic_ ? std::pow(10, tick) : std::abs(tick) < 1e-12 ? 0 : tick;
            svg += fmt::format(
                "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\"/><text "
                "class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.6g}</text>",
                left_px, px(value), width_px - right_px, left_px - 6, px(value) + 4, value);
        }
        return svg;
    }

private:
    double position(double value) const {
        return logarithmic_ ? std::log10(std::max(value, least_drawn_error)) : value;
    }

    bool logarithmic_;
    std::vector<double> ticks_;
};

/// Polylines between the gaps of a curve.
std::string lines_of(const CurvePlot& plot, const Curve& curve, const FrameAxis& x, const ValueAxis& y,
                     std::size_t color) {
    assert(curve.values.size() == plot.frames.size());
    std::string svg, points;
    int count = 0;
    double last_x = 0, last_y = 0;
    const auto flush = [&] {
        if (count == 1)
            svg += fmt::format("<circle class=\"c{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/>", color, last_x, last_y);
        if (count > 1) svg += fmt::format("<polyline class=\"c{}\" points=\"{}\"/>", color, points);
        points.clear();
        count = 0;
    };
    for (std::size_t i = 0; i < plot.frames.size(); ++i) {
        const bool skips = i > 0 && plot.frames[i] != plot.frames[i - 1] + 1;
        if (skips || !curve.values[i]) flush();
        if (!curve.values[i]) continue;
        last_x = x.px(static_cast<double>(plot.frames[i]));
        last_y = y.px(*curve.values[i]);
        points += fmt::format("{:.1f},{:.1f} ", last_x, last_y);
        ++count;
    }
    flush();
    return svg;
}

}  // namespace

std::vector<double> axis_ticks(double low, double high) {
    constexpr double wanted = 6;
    const double rough = std::max((high - low) / wanted, std::numeric_limits<double>::min());
    const double power = std::pow(10, std::floor(std::log10(rough)));
    const double digits = rough / power;
    const double step = power * (digits > 5 ? 10 : digits > 2 ? 5 : digits > 1 ? 2 : 1);
    std::vector<double> ticks;
    const double first = std::floor(low / step);
    for (double i = first; (i - 1) * step < high && i < first + 20; ++i) ticks.push_back(i * step);
    return ticks;
}

bool CurvePlot::says_something() const {
    return std::ranges::any_of(curves, [](const Curve& curve) { return matchlight::says_something(curve); });
}

std::string curve_plot_svg(const CurvePlot& plot) {
    if (plot.frames.empty() || !plot.says_something()) return {};
    const FrameAxis x(plot.frames);
    const ValueAxis y(plot);
    std::string svg = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">",
                                  width_px, height_px, html_text(plot.what));
    for (const Band& band : plot.bands) {
        const double from = x.px(static_cast<double>(band.first) - 0.5),
                     to = x.px(static_cast<double>(band.last) + 0.5);
        svg += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                           band.style, from, top_px, std::max(1.0, to - from), height_px - bottom_px - top_px);
    }
    svg += y.grid();
    svg += frame_ticks(x, height_px - bottom_px);
    svg += fmt::format("<text class=\"axis\" x=\"{:.1f}\" y=\"15\">{}</text>", left_px, html_text(plot.what));
    double legend_px = width_px - right_px;
    for (std::size_t i = plot.curves.size(); i-- > 0;) {
        svg += lines_of(plot, plot.curves[i], x, y, i);
        if (plot.curves.size() == 1 || !says_something(plot.curves[i])) continue;
        constexpr double letter_px = 6.6;
        svg += fmt::format("<text class=\"legend t{}\" x=\"{:.1f}\" y=\"15\" text-anchor=\"end\">{}</text>", i,
                           legend_px, html_text(plot.curves[i].name));
        legend_px -= letter_px * static_cast<double>(plot.curves[i].name.size()) + 14;
    }
    return svg + "</svg>";
}

std::string timeline_svg(const std::vector<std::int64_t>& frames, const std::vector<TimelineRow>& rows) {
    if (frames.empty() || rows.empty()) return {};
    constexpr double row_px = 16;
    const double bottom = 4 + row_px * static_cast<double>(rows.size());
    const FrameAxis x(frames);
    std::string svg = fmt::format(
        "<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"tags over the frames\">", width_px,
        bottom + 22);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        const double y = 4 + row_px * static_cast<double>(r);
        svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left_px - 6,
                           y + 11, html_text(rows[r].name));
        for (std::size_t from = 0; from < frames.size();) {
            std::size_t to = from + 1;
            while (to < frames.size() && rows[r].level[to] == rows[r].level[from] && frames[to] == frames[to - 1] + 1)
                ++to;
            if (rows[r].level[from] > 0) {
                const double start = x.px(static_cast<double>(frames[from]) - 0.5);
                svg += fmt::format("<rect class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                                   rows[r].level[from] == 2 ? "used" : "seen", start, y,
                                   x.px(static_cast<double>(frames[to - 1]) + 0.5) - start, row_px - 4);
            }
            from = to;
        }
    }
    return svg + frame_ticks(x, bottom) + "</svg>";
}

}  // namespace matchlight
