// Plain SVG, styled by the page's classes.
#include "calibration/lens_plots.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/html_text.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;

constexpr double plot_width = 720;  // of the drawings, in their own units

/// 1, 2 or 5 times a power of ten, at most `value`.
double round_step(double value) {
    const double power = std::pow(10, std::floor(std::log10(std::max(value, 1e-12))));
    for (const double step : {5.0, 2.0}) {
        if (step * power <= value) return step * power;
    }
    return power;
}

/// A drawing of the picture's frame, its left and upper edge at 0.
struct PictureFrame {
    double scale = 1, height = 0;

    explicit PictureFrame(const LensCalibration& calibration)
        : scale(plot_width / calibration.data.width), height(calibration.data.height * scale) {}
    /// Pixel centres lie at whole numbers, the frame's edge at −0.5.
    Vector2d place(const Vector2d& px) const { return (px + Vector2d(0.5, 0.5)) * scale; }
    std::string open() const {
        return fmt::format(
            "<svg class=\"plot\" viewBox=\"-1 -1 {:.0f} {:.0f}\" role=\"img\"><rect class=\"frame\" x=\"0\" y=\"0\" "
            "width=\"{:.1f}\" height=\"{:.1f}\"/>",
            plot_width + 2, height + 2, plot_width, height);
    }
};

/// A cell of a map, darker where `share` (0 to 1) is larger, with its number.
std::string map_cell(const PictureFrame& frame, int column, int row, int columns, int rows, double share,
                     const std::string& number) {
    const double w = plot_width / columns, h = frame.height / rows;
    const double x = column * w, y = row * h;
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"heat\" fill-opacity=\"{:.3f}\"/>"
        "<text class=\"{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
        x, y, w, h, share, share > 0.6 ? "on-dark" : "on-light", x + w / 2, y + h / 2 + 4, number);
}

struct Axes {
    double left = 60, right = 10, top = 10, bottom = 40, height = 260;
    double x_end = 1, y_low = 0, y_high = 1;

    double x(double value) const { return left + (plot_width - left - right) * value / x_end; }
    double y(double value) const {
        return top + (height - top - bottom) * (1 - (value - y_low) / std::max(1e-300, y_high - y_low));
    }
    std::string open(const std::string& y_name) const {
        std::string svg =
            fmt::format("<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\">", plot_width, height);
        const double step = round_step((y_high - y_low) / 3);
        for (double value = std::ceil(y_low / step) * step; value <= y_high + 1e-9 * step; value += step) {
            const double shown = std::abs(value) < 1e-9 * step ? 0 : value;
            svg += fmt::format(
                "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
                "<text class=\"tick\" text-anchor=\"end\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5:.4g}</text>",
                left, plot_width - right, y(value), left - 6, y(value) + 4, shown);
        }
        svg += fmt::format(
            "<text class=\"axis\" text-anchor=\"middle\" transform=\"rotate(-90)\" x=\"{:.1f}\" y=\"14\">{}</text>",
            -(top + height - bottom) / 2, html_text(y_name));
        return svg;
    }
};

}  // namespace

ArrowPlot residual_arrows_svg(const LensCalibration& calibration) {
    const PictureFrame frame(calibration);
    ArrowPlot plot;
    // A middling arrow becomes a fiftieth of the picture's width.
    plot.magnification = round_step(0.02 * calibration.data.width / std::max(calibration.fit.rms_px, 1e-6));
    plot.svg = frame.open();
    for (std::size_t v = 0; v < calibration.data.views.size(); ++v) {
        const std::vector<Vector2d> residuals = residuals_of(calibration.data, calibration.fit, v);
        plot.svg += fmt::format("<g class=\"arrows\"><title>{}</title>", html_text(calibration.data.views[v].name));
        for (std::size_t i = 0; i < residuals.size(); ++i) {
            const Vector2d px = calibration.data.views[v].corners[i].px;
            const Vector2d from = frame.place(px), to = frame.place(px + plot.magnification * residuals[i]);
            plot.svg +=
                fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/><circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.3\"/>",
                            from.x(), from.y(), to.x(), to.y(), from.x(), from.y());
        }
        plot.svg += "</g>";
    }
    const Vector2d centre = frame.place({calibration.camera.cx, calibration.camera.cy});
    plot.svg += fmt::format(
        "<path class=\"centre\" d=\"M{0:.1f} {1:.1f}h16M{2:.1f} {3:.1f}v16\"><title>principal "
        "point</title></path></svg>",
        centre.x() - 8, centre.y(), centre.x(), centre.y() - 8);
    return plot;
}

std::string coverage_svg(const LensCalibration& calibration) {
    const PictureFrame frame(calibration);
    constexpr int columns = 16;
    const int rows = std::max(1, columns * calibration.data.height / calibration.data.width);
    const std::vector<int> counts = coverage_counts(calibration.data, columns, rows);
    const double most = std::max(1, *std::ranges::max_element(counts));
    std::string svg = frame.open();
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            const int count = counts[static_cast<std::size_t>(row * columns + column)];
            // By the root: a few corners are much more than none.
            svg += map_cell(frame, column, row, columns, rows, std::sqrt(count / most),
                            count > 0 ? fmt::format("{}", count) : std::string());
        }
    }
    return svg + "</svg>";
}

std::string uncertainty_svg(const LensCalibration& calibration) {
    const PictureFrame frame(calibration);
    const PixelUncertainty& pixels = calibration.pixels;
    std::string svg = frame.open();
    for (int row = 0; row < pixels.rows; ++row) {
        for (int column = 0; column < pixels.columns; ++column) {
            const double sigma = pixels.sigma_px[static_cast<std::size_t>(row * pixels.columns + column)];
            if (!std::isfinite(sigma)) continue;
            svg += map_cell(frame, column, row, pixels.columns, pixels.rows, sigma / std::max(pixels.worst_px, 1e-12),
                            fmt::format("{:.2g}", sigma));
        }
    }
    return svg + "</svg>";
}

std::string view_bars_svg(const LensCalibration& calibration) {
    const std::vector<double>& rms = calibration.view_rms_px;
    Axes axes;
    axes.x_end = static_cast<double>(rms.size());
    axes.y_high = 1.1 * std::max(1e-6, *std::ranges::max_element(rms));
    std::string svg = axes.open("rms, px");
    for (std::size_t v = 0; v < rms.size(); ++v) {
        const double x = axes.x(static_cast<double>(v) + 0.15), end = axes.x(static_cast<double>(v) + 0.85);
        svg += fmt::format(
            "<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"><title>{}: {:.3f} px"
            "</title></rect>",
            x, axes.y(rms[v]), end - x, axes.y(0) - axes.y(rms[v]), html_text(calibration.data.views[v].name), rms[v]);
    }
    const double all = axes.y(calibration.fit.rms_px);
    return svg +
           fmt::format(
               "<line class=\"mean\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
               "<text class=\"axis\" text-anchor=\"middle\" x=\"{3:.1f}\" y=\"{4:.1f}\">views, in order</text></svg>",
               axes.left, plot_width - axes.right, all, plot_width / 2, axes.height - 12);
}

std::string radial_residuals_svg(const LensCalibration& calibration) {
    const Vector2d centre(calibration.camera.cx, calibration.camera.cy);
    struct Point {
        double radius, along;
    };
    std::vector<Point> points;
    double largest = 1e-6, furthest = 1;
    for (std::size_t v = 0; v < calibration.data.views.size(); ++v) {
        const std::vector<Vector2d> residuals = residuals_of(calibration.data, calibration.fit, v);
        for (std::size_t i = 0; i < residuals.size(); ++i) {
            const Vector2d from_centre = calibration.data.views[v].corners[i].px - centre;
            const double radius = from_centre.norm();
            if (radius == 0) continue;
            points.push_back({radius, residuals[i].dot(from_centre) / radius});
            largest = std::max(largest, std::abs(points.back().along));
            furthest = std::max(furthest, radius);
        }
    }
    Axes axes;
    axes.x_end = furthest;
    axes.y_low = -largest;
    axes.y_high = largest;
    std::string svg = axes.open("residual outward, px");
    for (const Point& point : points) {
        svg += fmt::format("<circle class=\"dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.4\"/>", axes.x(point.radius),
                           axes.y(point.along));
    }
    constexpr int bins = 12;
    std::vector<double> sums(bins, 0), counts(bins, 0);
    for (const Point& point : points) {
        const auto bin = static_cast<std::size_t>(std::min(bins - 1.0, point.radius / furthest * bins));
        sums[bin] += point.along;
        counts[bin] += 1;
    }
    std::string line;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        if (counts[bin] < 3) continue;  // no mean to speak of
        line += fmt::format("{:.1f},{:.1f} ", axes.x((static_cast<double>(bin) + 0.5) / bins * furthest),
                            axes.y(sums[bin] / counts[bin]));
    }
    svg += fmt::format("<polyline class=\"mean\" points=\"{}\"/>", line);
    const double step = round_step(furthest / 4);
    for (double radius = 0; radius <= furthest; radius += step) {
        svg += fmt::format("<text class=\"tick\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{:.4g}</text>",
                           axes.x(radius), axes.height - axes.bottom + 16, radius);
    }
    return svg +
           fmt::format(
               "<text class=\"axis\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">distance from the principal "
               "point, px</text></svg>",
               plot_width / 2, axes.height - 8);
}

}  // namespace matchlight
