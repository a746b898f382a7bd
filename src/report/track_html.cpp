// Tracking on the report's page.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/html_text.h"
#include "report/pareto_plot.h"
#include "report/track_text.h"

namespace matchlight {
namespace {

constexpr double width_px = 720, height_px = 260;
constexpr double left_px = 76, right_px = 150, top_px = 14, bottom_px = 40;

std::string cell(const std::optional<double>& value, double scale = 1, const char* format = "{:.3g}") {
    if (!value || !std::isfinite(*value)) return "<td>–</td>";
    return fmt::format("<td>{}</td>", fmt::format(fmt::runtime(format), scale * *value));
}

/// Error of every frame, logarithmic, one line a way; a gap where a frame has no pose.
std::string error_curves_svg(const TrackReport& track) {
    static constexpr const char* colours[] = {"#2a62b8", "#1b7f4b", "#d98200", "#7b3fa0",
                                              "#b3261e", "#e08fb0", "#6b7785", "#a8b2bd"};
    double low = 1e9, high = 0;
    std::size_t frames = 0;
    for (const TrackPoint& point : track.points) {
        frames = std::max(frames, point.error_px.size());
        for (const auto& error : point.error_px) {
            if (error && *error > 0) low = std::min(low, *error), high = std::max(high, *error);
        }
    }
    if (frames < 2 || !(high > 0)) return {};
    low = std::pow(10, std::floor(std::log10(low))), high = std::pow(10, std::ceil(std::log10(high)));
    if (high <= low) high = 10 * low;
    const auto x = [&](std::size_t frame) {
        return left_px + (width_px - left_px - right_px) * static_cast<double>(frame) / static_cast<double>(frames - 1);
    };
    const auto y = [&](double error) {
        const double share = std::log(std::max(error, low) / low) / std::log(high / low);
        return height_px - bottom_px - share * (height_px - bottom_px - top_px);
    };
    std::string svg = fmt::format(
        "<svg class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"Error over the clip\">", width_px,
        height_px);
    for (double tick = low; tick <= high * 1.001; tick *= 10) {
        svg += fmt::format(
            "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\"/>"
            "<text class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:g}</text>",
            left_px, y(tick), width_px - right_px, left_px - 6, y(tick) + 4, tick);
    }
    svg += fmt::format("<text class=\"axis\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">frame</text>",
                       (left_px + width_px - right_px) / 2, height_px - 8);
    svg += fmt::format(
        "<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(18 {:.1f}) rotate(-90)\">px</text>",
        (top_px + height_px - bottom_px) / 2);
    for (const std::size_t frame : {std::size_t{0}, frames - 1}) {
        svg += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x(frame),
                           height_px - bottom_px + 14, frame);
    }
    for (std::size_t p = track.points.size(); p-- > 0;) {  // the first on top
        const TrackPoint& point = track.points[p];
        const char* colour = colours[p % std::size(colours)];
        std::string path;
        bool drawing = false;
        for (std::size_t f = 0; f < point.error_px.size(); ++f) {
            const auto& error = point.error_px[f];
            if (error) path += fmt::format("{}{:.1f} {:.1f}", drawing ? "L" : "M", x(f), y(*error));
            drawing = error.has_value();
        }
        svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.3\"/>", path, colour);
        svg += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" style=\"fill:{}\">{}</text>",
                           width_px - right_px + 8, top_px + 10 + 15 * static_cast<double>(p), colour,
                           html_text(point.name));
    }
    return svg + "</svg>";
}

std::string first_cell(const TrackPoint& point) {
    return fmt::format("<tr><td class=\"word\" title=\"{}\">{}</td>", html_text(point.what), html_text(point.name));
}

std::string poses_table(const TrackReport& track) {
    std::string html = "<table><tr><th class=\"word\">way</th><th>ms a frame</th><th>frames/s</th><th>posed</th>";
    if (track.against_truth) {
        html +=
            "<th>mean px</th><th>median</th><th>95 %</th><th>max</th><th>slow</th><th>fast</th><th>jitter</th>"
            "<th>NEES/6</th>";
    }
    html += "<th>reprojection px</th><th>one left out px</th><th>its median</th><th>its jitter</th></tr>";
    const double frames = static_cast<double>(std::max<std::int64_t>(track.frames, 1));
    for (const TrackPoint& point : track.points) {
        html += first_cell(point) + cell(point.time.median_ms / frames) + cell(1e3 * frames / point.time.median_ms) +
                fmt::format("<td>{}</td>", point.posed);
        if (track.against_truth) {
            const TrackErrors errors = point.errors.value_or(TrackErrors{});
            html += cell(errors.mean_px) + cell(errors.median_px) + cell(errors.p95_px) + cell(errors.max_px) +
                    cell(errors.slow_mean_px) + cell(errors.fast_mean_px) + cell(errors.jitter_px) +
                    cell(errors.nees_median);
        }
        html += cell(point.agreement.reprojection_px) + cell(point.agreement.leave_one_out_px) +
                cell(point.agreement.leave_one_out_median_px) + cell(point.agreement.leave_one_out_jitter_px) + "</tr>";
    }
    return html + "</table>";
}

/// What was found of the camera beside its poses, against the truth.
std::string camera_table(const TrackReport& track) {
    std::string rows;
    for (const TrackPoint& point : track.points) {
        if (!point.errors) continue;
        const TrackErrors& errors = *point.errors;
        const std::string cells = cell(errors.ev_mean) + cell(errors.ev_spread) + cell(errors.white_balance, 100) +
                                  cell(errors.focus, 100) + cell(errors.coc_scale, 100) + cell(errors.shutter);
        const bool known = errors.ev_mean || errors.white_balance || errors.focus || errors.coc_scale || errors.shutter;
        if (known) rows += first_cell(point) + cells + "</tr>";
    }
    if (rows.empty()) return {};
    return "<table><tr><th class=\"word\">way</th><th>EV, mean</th><th>EV, spread</th><th>white balance %</th>"
           "<th>focus distance %</th><th>coc_scale %</th><th>shutter</th></tr>" +
           rows + "</table>";
}

}  // namespace

std::string track_html(const TrackReport& track) {
    EffectReport plot;
    plot.name = "tracking";
    for (const TrackPoint& point : track.points) {
        EffectPoint& drawn = plot.points.emplace_back();
        drawn.level = point.name;
        const double frames = static_cast<double>(std::max<std::int64_t>(track.frames, 1));
        drawn.time = {point.time.median_ms / frames, point.time.min_ms / frames, point.time.max_ms / frames};
        drawn.errors.flip = track.error_of(point);
        if (drawn.errors.flip && !std::isfinite(*drawn.errors.flip)) drawn.errors.flip.reset();
    }
    const std::string error =
        track.against_truth ? "registration error, mean px" : "a tag under the pose of the others, RMS px";
    std::string html = fmt::format(
        "<h2 id=\"tracking\">Tracking</h2><p>{} frames; run times are of the whole clip, decoding included. Other "
        "libraries are given the places of the tags.{}</p>",
        track.frames,
        track.against_truth ? " Registration errors are means over a box around the world's origin, as wide to every "
                              "side and as high as the largest tag, against the exact pose."
                            : "");
    html += pareto_plot_svg(plot, {"ms a frame", "px", error}) + error_curves_svg(track);
    html += poses_table(track) + camera_table(track);
    return html;
}

}  // namespace matchlight
