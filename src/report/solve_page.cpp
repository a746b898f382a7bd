// Sections in the order in which a doubtful solve is judged.
#include "report/solve_page.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "core/html_text.h"
#include "core/page_style.h"
#include "core/version.h"
#include "report/curve_plot.h"
#include "report/path_plot.h"
#include "report/solve_overlay.h"
#include "report/solve_tables.h"
#include "scene/footage_options.h"

namespace matchlight {
namespace {

constexpr std::size_t most_pictures = 12;
/// Where nothing is flagged, these many are shown all the same: first, middle, last.
constexpr std::size_t least_pictures = 3;

constexpr const char* own_style = R"(
.plan { width: 100%; max-width: 470px; height: auto; } .plans { display: flex; flex-wrap: wrap; gap: 1rem; }
polyline { fill: none; stroke-width: 1.5; stroke-linejoin: round; } .legend { font-size: 12px; }
polyline.c0 { stroke: #2a62b8; } polyline.c1 { stroke: #c2571a; } polyline.c2 { stroke: #1b7f4b; }
circle.c0, .t0 { fill: #2a62b8; } circle.c1, .t1 { fill: #c2571a; } circle.c2, .t2 { fill: #1b7f4b; }
.gap { fill: #f3c6c2; } .bridged { fill: #fbe3bd; } .bridged-mark { fill: #e08a00; }
.used { fill: #2a62b8; } .seen { fill: #e0a458; } .tag { fill: #eef1f5; stroke: #8894a5; }
.look { stroke: #9fb2cc; stroke-width: 1.2; } .start { fill: #1b7f4b; } .end { fill: #b3261e; }
.frames figure img { max-width: 100%; width: 540px; } .frames figcaption { max-width: 540px; font-size: 13px; }
)";

std::string frames_text(const FlaggedRun& run) {
    return run.first == run.last ? fmt::format("{}", run.first) : fmt::format("{}–{}", run.first, run.last);
}

struct ShownFrame {
    std::int64_t number = 0;
    std::string why;
};

/// The frames whose pictures are shown: the worst of each run, one run of each reason before the second of any, the
/// worst reasons first; then plain ones.
std::vector<ShownFrame> shown_frames(const Solve& solve, const SolveFindings& found) {
    std::map<std::string, std::size_t> rank;
    std::vector<std::pair<std::size_t, const FlaggedRun*>> ranked;
    for (const FlaggedRun& run : found.flagged) ranked.emplace_back(rank[run.reason]++, &run);
    std::ranges::stable_sort(ranked, {}, [](const auto& entry) { return entry.first; });
    std::vector<ShownFrame> shown;
    for (const auto& [turn, run] : ranked) {
        std::string why = run->reason;
        if (!run->worst_value.empty()) why += ": " + run->worst_value;
        const auto known = std::ranges::find(shown, run->worst, &ShownFrame::number);
        if (known != shown.end()) {
            known->why += "; " + why;
        } else if (shown.size() < most_pictures) {
            shown.push_back({run->worst, why});
        }
    }
    const std::size_t count = solve.frames.size();
    for (const std::size_t i : {std::size_t{0}, count / 2, count - 1}) {
        const std::int64_t number = solve.frames[i].frame;
        const bool known = std::ranges::find(shown, number, &ShownFrame::number) != shown.end();
        if (!known && shown.size() < least_pictures) shown.push_back({number, "not flagged"});
    }
    return shown;
}

std::string figure(const SolvePageInput& input, const SolveFindings& found, const ShownFrame& shown) {
    const SolvedFrame* frame = input.solve.find(shown.number);
    const auto at = static_cast<std::size_t>(frame - input.solve.frames.data());
    const std::optional<Image8> picture = input.picture(shown.number);
    if (!picture) return {};
    return fmt::format(
        "<figure><img alt=\"frame {0}\" src=\"{1}\"><figcaption><strong>Frame {0}</strong>, {2:.3f} s: "
        "{3}</figcaption></figure>",
        shown.number, solve_overlay_url(*picture, input.solve, *frame, found.frames[at]), frame->time_s,
        html_text(shown.why));
}

std::string flagged_section(const SolvePageInput& input, const SolveFindings& found) {
    std::string html = "<h2 id=\"flagged\">Flagged frames</h2>";
    if (found.flagged.empty()) {
        html += "<p>No frame is doubtful.</p>";
    } else {
        html += "<table><tr><th class=\"word\">reason</th><th>frames</th><th>worst</th><th class=\"word\"></th></tr>";
        for (const FlaggedRun& run : found.flagged) {
            html +=
                fmt::format("<tr><td class=\"word long\">{}</td><td>{}</td><td>{}</td><td class=\"word\">{}</td></tr>",
                            html_text(run.reason), frames_text(run), run.worst, html_text(run.worst_value));
        }
        html += "</table>";
    }
    html += fmt::format(
        "<p class=\"note\">Yellow: the tags where pose and lens put them. Cyan: the corners found in this frame; red: "
        "their residuals, {:g} times as long. The axes are the world's: x red, y green, z blue.</p>"
        "<div class=\"pictures frames\">",
        overlay_magnification);
    const std::vector<ShownFrame> shown = shown_frames(input.solve, found);
    // Decoded in the clip's order, shown in that of what is wrong with them.
    std::map<std::int64_t, std::string> figures;
    for (const ShownFrame& frame : shown) figures[frame.number];
    for (auto& [number, text] : figures) {
        text = figure(input, found, *std::ranges::find(shown, number, &ShownFrame::number));
    }
    for (const ShownFrame& frame : shown) html += figures[frame.number];
    return html + "</div>";
}

/// Where the plots are shaded.
std::vector<Band> bands_of(const Solve& solve) {
    std::vector<Band> bands;
    for (const SolvedFrame& frame : solve.frames) {
        const char* style = !frame.camera_from_world ? "gap" : frame.bridged ? "bridged" : nullptr;
        if (style == nullptr) continue;
        if (!bands.empty() && bands.back().last == frame.frame - 1 && bands.back().style == style) {
            bands.back().last = frame.frame;
        } else {
            bands.push_back({frame.frame, frame.frame, style});
        }
    }
    return bands;
}

class Plots {
public:
    explicit Plots(const Solve& solve) : solve_(solve), bands_(bands_of(solve)) {
        for (const SolvedFrame& frame : solve.frames) frames_.push_back(frame.frame);
    }

    using Value = std::function<std::optional<double>(const SolvedFrame&, std::size_t)>;
    Curve curve(const std::string& name, const Value& value) const {
        Curve made{name, {}};
        for (std::size_t i = 0; i < solve_.frames.size(); ++i) made.values.push_back(value(solve_.frames[i], i));
        return made;
    }
    std::string svg(const std::string& what, std::vector<Curve> curves,
                    CurvePlot::Axis axis = CurvePlot::Axis::fitted) const {
        return curve_plot_svg({what, frames_, std::move(curves), bands_, axis});
    }
    const std::vector<std::int64_t>& frames() const { return frames_; }

private:
    const Solve& solve_;
    std::vector<Band> bands_;
    std::vector<std::int64_t> frames_;
};

/// Heading (from world +x, counter-clockwise), elevation and roll of the view, degrees; the heading runs on.
struct ViewAngles {
    std::vector<std::optional<double>> heading, elevation, roll;

    explicit ViewAngles(const Solve& solve) {
        constexpr double deg = 180 / std::numbers::pi;
        double before = 0, roll_before = 0;
        for (const SolvedFrame& frame : solve.frames) {
            heading.emplace_back();
            elevation.emplace_back();
            roll.emplace_back();
            if (!frame.camera_from_world) continue;
            const Eigen::Matrix3d r = frame.camera_from_world->rotation();  // rows: the camera's axes in the world
            const double angle = std::atan2(r(2, 1), r(2, 0)) * deg;
            before = angle + 360 * std::round((before - angle) / 360);
            heading.back() = before;
            elevation.back() = std::asin(std::clamp(r(2, 2), -1.0, 1.0)) * deg;
            // Positive: the picture's right side is down.
            const double tilt = std::atan2(-r(0, 2), -r(1, 2)) * deg;
            roll_before = tilt + 360 * std::round((roll_before - tilt) / 360);
            roll.back() = roll_before;
        }
    }
};

std::string path_section(const Solve& solve, const Plots& plots) {
    std::string html = "<h2 id=\"path\">Path</h2>";
    if (std::ranges::none_of(solve.frames, [](const SolvedFrame& f) { return f.camera_from_world.has_value(); })) {
        return html + "<p>No frame has a pose.</p>";
    }
    html +=
        "<p class=\"note\">Green: the first frame with a pose, red: the last; grey ticks: where the camera looks. "
        "Shaded "
        "in the curves: frames without a pose (red) and bridged ones (orange).</p><div class=\"plans\">" +
        path_plot_svg(solve, true) + path_plot_svg(solve, false) + "</div>";
    std::vector<Curve> places;
    for (int axis = 0; axis < 3; ++axis) {
        places.push_back(plots.curve(std::string(1, "xyz"[axis]),
                                     [axis](const SolvedFrame& f, std::size_t) -> std::optional<double> {
                                         if (!f.camera_from_world) return std::nullopt;
                                         return f.camera_from_world->inverse().translation()[axis];
                                     }));
    }
    const ViewAngles angles(solve);
    return html + plots.svg("position, m", std::move(places)) +
           plots.svg("view, degrees",
                     {{"heading", angles.heading}, {"elevation", angles.elevation}, {"roll", angles.roll}});
}

std::string residual_section(const Solve& solve, const SolveFindings& found, const Plots& plots) {
    std::string html = "<h2 id=\"residuals\">Residuals</h2>";
    html +=
        plots.svg("residuals and predicted error, px",
                  {plots.curve("residuals, RMS", [](const SolvedFrame& f, std::size_t) { return f.reprojection_px; }),
                   plots.curve("predicted by the covariance, at the tags",
                               [&](const SolvedFrame&, std::size_t i) { return found.frames[i].predicted_px; })},
                  CurvePlot::Axis::logarithmic);
    html += plots.svg("confidence",
                      {plots.curve("pose", [](const SolvedFrame& f, std::size_t) { return f.pose_confidence; }),
                       plots.curve("exposure", [](const SolvedFrame& f, std::size_t) { return f.exposure_confidence; }),
                       plots.curve("focus", [](const SolvedFrame& f, std::size_t) { return f.focus_confidence; })},
                      CurvePlot::Axis::from_zero);
    std::vector<TimelineRow> rows;
    for (const SolvedTag& tag : solve.rig) {
        TimelineRow& row = rows.emplace_back();
        row.name = fmt::format("tag {}", tag.id);
        for (const FrameResiduals& frame : found.frames) {
            int level = 0;
            for (const TagResidual& seen : frame.tags) {
                if (seen.id == tag.id) level = std::max(level, seen.used ? 2 : 1);
            }
            row.level.push_back(level);
        }
    }
    html += "<p class=\"note\">Which tags are seen when; orange: seen, but the pose does not rest on it.</p>" +
            timeline_svg(plots.frames(), rows);
    return html + tag_table(found.tags);
}

std::string camera_section(const Solve& solve, const Plots& plots) {
    const auto member = [&](const std::string& name, std::optional<double> SolvedFrame::*value) {
        return plots.curve(name, [value](const SolvedFrame& f, std::size_t) { return f.*value; });
    };
    const auto gain = [&](const std::string& name, std::size_t channel) {
        return plots.curve(name, [channel](const SolvedFrame& f, std::size_t) -> std::optional<double> {
            if (!f.white_balance) return std::nullopt;
            return (*f.white_balance)[channel];
        });
    };
    std::string html = "<h2 id=\"camera\">What the camera did</h2>";
    const std::vector<std::pair<std::string, std::string>> plotted{
        {"exposure", plots.svg("exposure, EV", {member("EV", &SolvedFrame::exposure_ev)})},
        {"white balance", plots.svg("white balance over green", {gain("blue", 2), gain("red", 0)})},
        {"focus", plots.svg("focus distance, m", {member("focus", &SolvedFrame::focus_distance_m)})},
        {"aperture", plots.svg("circle of confusion, px m", {member("scale", &SolvedFrame::coc_scale_px_m)})},
        {"shutter", plots.svg("shutter, part of a frame", {member("shutter", &SolvedFrame::shutter_fraction)},
                              CurvePlot::Axis::from_zero)}};
    std::string unknown;
    for (const auto& [name, svg] : plotted) {
        html += svg;
        if (svg.empty()) unknown += (unknown.empty() ? "" : ", ") + name;
    }
    if (!unknown.empty()) html += fmt::format("<p>The footage does not say: {}.</p>", unknown);
    return html + clip_table(solve);
}

std::string warnings_section(const std::vector<Warnings::Entry>& warnings) {
    if (warnings.empty()) return {};
    std::string html = "<h2 id=\"warnings\">Warnings</h2><ul>";
    for (const Warnings::Entry& entry : warnings) html += fmt::format("<li>{}</li>", html_text(entry.text));
    return html + "</ul>";
}

}  // namespace

std::string solve_page_html(const SolvePageInput& input) {
    const Solve& solve = input.solve;
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Matchlight: solve of {0}</title>"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{1}{2}</style></head><body>"
        "<h1>Solve of {0}</h1>",
        html_text(input.title), page_style, own_style);
    html += fmt::format("<p>{}, {}×{}, frames {} to {}. Matchlight {}.</p>", html_text(solve.footage_file),
                        solve.camera.width, solve.camera.height, solve.frames.front().frame, solve.frames.back().frame,
                        version);
    const SolveFindings found = find_weak_points(solve, input.details);
    const Plots plots(solve);
    html += summary_table(solve, found) + flagged_section(input, found) + warnings_section(input.warnings) +
            path_section(solve, plots) + residual_section(solve, found, plots) + camera_section(solve, plots);
    if (!solve.provenance.empty()) {
        html += fmt::format("<h2>Settings</h2><pre>{}</pre>", html_text(solve.provenance));
    }
    return html + "</body></html>\n";
}

std::string solve_page_html(const Scene& scene, const Solve& solve, const TrackDetails& details, Warnings& warnings) {
    const std::vector<Warnings::Entry> of_track = warnings.entries();
    // What is wrong with the footage was said when it was tracked.
    Warnings again;
    again.set_quiet(true);
    const std::unique_ptr<FrameSource> source =
        FrameSource::open(scene.footage.video, footage_options(scene.footage, false), again);
    const auto picture = [&](std::int64_t number) -> std::optional<Image8> {
        source->seek(number);
        const std::optional<PlateFrame> frame = source->next();
        if (!frame || frame->index() != number) return std::nullopt;
        return frame->rgb8({0, 0, frame->format().width, frame->format().height});
    };
    return solve_page_html({solve, details, of_track, scene.path.filename().string(), picture});
}

}  // namespace matchlight
