// Plots of the response and tables around them.
#include "calibration/response_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/html_text.h"
#include "core/page_style.h"
#include "core/version.h"

namespace matchlight {
namespace {

constexpr const char* own_style = R"(
tr.chosen td { font-weight: 700; }
.red { stroke: #c0392b; } .green { stroke: #1b7f4b; } .blue { stroke: #2a62b8; }
polyline { fill: none; stroke-width: 1.8; } polyline.srgb { stroke: #566274; stroke-dasharray: 5 4; stroke-width: 1.2; }
.untold { fill: #f0f2f5; } .scatter { stroke-opacity: .35; stroke-width: 1.2; } circle { fill: #fff; stroke-width: 1.6; }
)";

constexpr std::array<const char*, 3> channel_names = {"red", "green", "blue"};

/// Codes from left to right, EV upwards.
struct CodePlot {
    double low_ev, high_ev, height = 320;
    static constexpr double width = 720, left = 56, right = 10, top = 10, bottom = 40;

    double x(double code) const { return left + (width - left - right) * code; }
    double y(double ev) const {
        return top + (height - top - bottom) * (high_ev - std::clamp(ev, low_ev, high_ev)) / (high_ev - low_ev);
    }
    std::string open(const char* what, double tick_ev) const {
        std::string svg = fmt::format(
            "<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">", width, height, what);
        const auto line = [&svg](double x1, double y1, double x2, double y2) {
            svg += fmt::format("<line class=\"grid\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>", x1, y1,
                               x2, y2);
        };
        for (int i = 0; low_ev + i * tick_ev <= high_ev + 1e-9; ++i) {
            const double ev = low_ev + i * tick_ev;
            line(left, y(ev), width - right, y(ev));
            svg += fmt::format("<text class=\"tick\" text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{:.3g}</text>",
                               left - 6, y(ev) + 4, std::abs(ev) < 1e-9 ? 0 : ev);
        }
        for (const int code : {0, 64, 128, 192, 255}) {
            line(x(code / 255.0), top, x(code / 255.0), height - bottom);
            svg += fmt::format("<text class=\"tick\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
                               x(code / 255.0), height - bottom + 16, code);
        }
        return svg + fmt::format(
                         "<text class=\"axis\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">code of 255</text>"
                         "<text class=\"axis\" text-anchor=\"middle\" transform=\"rotate(-90)\" x=\"{:.1f}\" "
                         "y=\"14\">{}</text>",
                         width / 2, height - 6, -height / 2, what);
    }
};

/// Ten stops below full are what eight bits hold of any curve in use.
constexpr double lowest_ev = -10;

std::string curve_points(const CodePlot& plot, const Response& response, int channel) {
    std::string points;
    for (int code = 1; code <= 255; ++code) {
        const double light = response.linear_from_code(code / 255.0, channel);
        if (light > 0) points += fmt::format("{:.1f},{:.1f} ", plot.x(code / 255.0), plot.y(std::log2(light)));
    }
    return points;
}

std::string curve_plot(const ResponseFit& fit) {
    double highest = 0;
    for (int c = 0; c < 3; ++c)
        highest = std::max(highest, std::ceil(std::log2(fit.response.linear_from_code(1, c)) - 1e-9));
    const CodePlot plot{lowest_ev, highest};
    std::string svg = plot.open("light, EV below full", 2);
    float least = 1, greatest = 0;
    for (const ResponseSamples::Span& span : fit.spans) {
        least = std::min(least, span.least);
        greatest = std::max(greatest, span.greatest);
    }
    for (const auto& [from, to] : {std::pair<double, double>(0, least), std::pair<double, double>(greatest, 1)}) {
        if (to <= from) continue;
        svg += fmt::format("<rect class=\"untold\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                           plot.x(from), CodePlot::top, plot.x(to) - plot.x(from),
                           plot.height - CodePlot::top - CodePlot::bottom);
    }
    svg += fmt::format("<polyline class=\"srgb\" points=\"{}\"><title>sRGB</title></polyline>",
                       curve_points(plot, Response::srgb(), 0));
    for (int c = 0; c < 3; ++c) {
        svg += fmt::format("<polyline class=\"{0}\" points=\"{1}\"><title>{0}</title></polyline>",
                           channel_names[static_cast<std::size_t>(c)], curve_points(plot, fit.response, c));
    }
    return svg + "</svg>";
}

std::string residual_plot(const ResponseFit& fit) {
    double largest = 0.05;
    for (const ResidualBin& bin : fit.residuals) {
        for (const double mean : bin.mean_ev) largest = std::isnan(mean) ? largest : std::max(largest, std::abs(mean));
    }
    const double reach = std::ceil(largest * 1.5 * 20) / 20;
    const CodePlot plot{-reach, reach, 260};
    std::string svg = plot.open("shorter exposure over longer, EV", reach / 2);
    for (const ResidualBin& bin : fit.residuals) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = bin.mean_ev[c], sigma = bin.sigma_ev[c];
            if (std::isnan(mean)) continue;
            const double x = plot.x(bin.code) + 3 * (static_cast<double>(c) - 1);  // side by side
            svg += fmt::format(
                "<line class=\"{0} scatter\" x1=\"{1:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{3:.1f}\"/>"
                "<circle class=\"{0}\" cx=\"{1:.1f}\" cy=\"{4:.1f}\" r=\"2.6\"><title>{0}: {5:+.3f} ± {6:.3f} "
                "EV</title></circle>",
                channel_names[c], x, plot.y(mean + sigma), plot.y(mean - sigma), plot.y(mean), mean, sigma);
        }
    }
    return svg + "</svg>";
}

std::string score_table(const ResponseFit& fit) {
    std::string html =
        "<table><tr><th class=\"word\">family</th><th>rms of pixels left out, codes of 255</th>"
        "<th>mean square above the best</th><th>± one standard error</th><th class=\"word\"></th></tr>";
    for (const ResponseScore& score : fit.scores) {
        html += fmt::format(
            "<tr{}><td class=\"word\">{}</td><td>{:.3f}</td><td>{:.3f}</td><td>{:.3f}</td><td class=\"word\">{}</td>"
            "</tr>",
            score.chosen ? " class=\"chosen\"" : "", name_of(score.method), 255 * score.held_out_codes,
            255 * 255 * score.excess, 255 * 255 * score.excess_error, score.chosen ? "chosen" : "");
    }
    return html + "</table>";
}

std::string photograph_table(const ExposureSeries& series) {
    std::string html =
        "<table><tr><th class=\"word\">photograph</th><th>seconds</th><th>f-number</th><th>ISO</th>"
        "<th>EV below the longest</th></tr>";
    for (const Photograph& shot : series.shots) {
        const auto known = [](double value) { return value > 0 ? fmt::format("{:.4g}", value) : std::string(); };
        html +=
            fmt::format("<tr><td class=\"word\">{}</td><td>{:.5g}</td><td>{}</td><td>{}</td><td>{:.2f}</td></tr>",
                        html_text(shot.path.filename().string()), shot.record.exposure_s, known(shot.record.f_number),
                        known(shot.record.iso), std::log2(series.shots.front().exposure / shot.exposure));
    }
    return html + "</table>";
}

}  // namespace

std::string response_page(const ResponseFit& fit, const ExposureSeries& series) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Matchlight: response</title>"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{}{}</style></head><body>"
        "<h1>Response of a camera</h1><p>From {} photographs of {}×{} pixels, {} places. Matchlight {}.</p>"
        "<p><strong>{}</strong>: two exposures of one light differ by {:.3f} EV (root mean square over the codes) more "
        "than their exposures say.</p>"
        "<h2>Curve</h2><p class=\"note\">Light that gives each code, by channel; dashed: sRGB. On grey, no pixel told "
        "it and the curve is carried on.</p>{}"
        "<h2>What is left over</h2><p class=\"note\">Light by the shorter of two exposures over that by the longer, "
        "against the code of the longer: median and scatter. A right curve leaves the medians at 0; all of them off "
        "to one side means exposure times that are not true.</p>{}"
        "<h2>Families</h2><p class=\"note\">Fitted to one half of the picture, in a checkerboard, judged by the other. "
        "The first is chosen that is no worse than the best by more than a standard error, or by a quarter of a "
        "code.</p>{}<h2>Photographs</h2>{}</body></html>\n",
        page_style, own_style, series.shots.size(), series.width(), series.height(), fit.places, version,
        name_of(fit.method), fit.residual_ev, curve_plot(fit), residual_plot(fit), score_table(fit),
        photograph_table(series));
}

}  // namespace matchlight
