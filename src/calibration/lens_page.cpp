// Tables and text around the plots.
#include "calibration/lens_page.h"

#include <cmath>

#include <fmt/format.h>

#include "calibration/lens_plots.h"
#include "core/html_text.h"
#include "core/page_style.h"
#include "core/version.h"

namespace matchlight {
namespace {

constexpr const char* own_style = R"(
tr.chosen td { font-weight: 700; }
.frame { fill: #fafbfd; stroke: #9fb2cc; }
.arrows path { stroke: #b3261e; stroke-width: .8; fill: none; } .arrows circle { fill: #2a62b8; }
.centre { stroke: #1b7f4b; stroke-width: 1.6; fill: none; }
.heat { fill: #2a62b8; stroke: #fff; stroke-width: .5; }
.on-dark, .on-light { font-size: 11px; text-anchor: middle; } .on-dark { fill: #fff; } .on-light { fill: #1c2430; }
.bar { fill: #2a62b8; } .dot { fill: #2a62b8; fill-opacity: .35; }
.mean { stroke: #b3261e; stroke-width: 1.6; fill: none; }
)";

std::string section(const char* title, const std::string& text) {
    return fmt::format("<h2>{}</h2>{}", title, text);
}

std::string parameter_table(const LensCalibration& calibration) {
    std::string html =
        "<table><tr><th class=\"word\">parameter</th><th>value</th><th>sigma</th><th>by the corners' scatter</th>"
        "<th>by leaving views out</th></tr>";
    for (const ParameterEstimate& p : calibration.parameters) {
        html += p.sigma > 0 ? fmt::format(
                                  "<tr><td class=\"word\">{}</td><td>{:.8g}</td><td>{:.2g}</td><td>{:.2g}</td>"
                                  "<td>{:.2g}</td></tr>",
                                  p.name, p.value, p.sigma, p.sigma_of_noise, p.sigma_of_views)
                            : fmt::format(
                                  "<tr><td class=\"word\">{}</td><td>{:.8g}</td><td class=\"word\" "
                                  "colspan=\"3\">not estimated</td></tr>",
                                  p.name, p.value);
    }
    html += "</table>";
    if (!calibration.bend_sigma_m.empty()) {
        html += "<p>The board is not flat:";
        const char* names[] = {"along its rows its middle stands out by", "along its columns by",
                               "its corners twist by"};
        for (std::size_t i = 0; i < 3; ++i) {
            html += fmt::format("{} {} {:.3g} ± {:.1g} mm", i > 0 ? "," : "", names[i],
                                1000 * calibration.fit.bend_m[i], 1000 * calibration.bend_sigma_m[i]);
        }
        html += ".</p>";
    }
    return html;
}

std::string candidate_table(const LensCalibration& calibration) {
    std::string html =
        "<table><tr><th class=\"word\">model</th><th>parameters</th><th>rms px</th><th>held out px</th>"
        "<th>worse than the best by px²</th><th>± one standard error</th><th class=\"word\"></th></tr>";
    for (const CandidateScore& score : calibration.candidates) {
        html += fmt::format(
            "<tr{}><td class=\"word\">{}</td><td>{}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.2g}</td><td>{:.2g}</td>"
            "<td class=\"word\">{}</td></tr>",
            score.chosen ? " class=\"chosen\"" : "", score.candidate.name(), score.candidate.parameter_count(),
            score.fit.rms_px, score.held_out_px, score.excess_px2, score.excess_error_px2,
            score.chosen            ? "chosen"
            : score.reaches_corners ? ""
                                    : "folds back inside the picture");
    }
    return html + "</table>";
}

std::string view_table(const LensCalibration& calibration) {
    std::string html =
        "<table><tr><th class=\"word\">view</th><th>corners</th><th>rms px</th><th>board tilted by</th></tr>";
    for (std::size_t v = 0; v < calibration.data.views.size(); ++v) {
        html += fmt::format("<tr><td class=\"word\">{}</td><td>{}</td><td>{:.3f}</td><td>{:.0f}°</td></tr>",
                            html_text(calibration.data.views[v].name), calibration.data.views[v].corners.size(),
                            calibration.view_rms_px[v], calibration.view_tilt_deg[v]);
    }
    return html + "</table>";
}

std::string compared_table(const LensCalibration& calibration, const std::vector<ComparedCalibration>& compared) {
    if (compared.empty()) return {};
    std::string html =
        "<table><tr><th class=\"word\">calibration</th><th>rms px</th><th>held out px</th><th>fx</th><th>fy</th>"
        "<th>cx</th><th>cy</th></tr>";
    const auto row = [&](const std::string& name, double rms, double held_out, const Camera& camera) {
        html += fmt::format(
            "<tr><td class=\"word\">{}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>"
            "<td>{:.2f}</td></tr>",
            html_text(name), rms, held_out, camera.fx, camera.fy, camera.cx, camera.cy);
    };
    for (const ComparedCalibration& other : compared) row(other.name, other.rms_px, other.held_out_px, other.camera);
    row("Matchlight, " + calibration.fit.candidate.name(), calibration.fit.rms_px, calibration.held_out_px,
        calibration.camera);
    return section("Against OpenCV",
                   "<p>cv::calibrateCamera with five coefficients, the same views and folds.</p>" + html + "</table>");
}

}  // namespace

std::string lens_page(const LensCalibration& calibration, const LensPageContext& context) {
    const LensData& data = calibration.data;
    std::size_t corners = 0;
    for (const LensView& view : data.views) corners += view.corners.size();
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Matchlight: calibration</title>"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{}{}</style></head><body>"
        "<h1>Calibration of a lens</h1><p>{}×{} pixels, from {}; {}. Matchlight {}.</p>",
        page_style, own_style, data.width, data.height, html_text(context.source), html_text(board_text(data.board)),
        version);
    html += fmt::format(
        "<p><strong>{}</strong>: {} corners in {} views lie {:.3f} px (root mean square) from where the lens has them, "
        "{:.3f} px in views that were left out when it was made. What is not known of the parameters moves a pixel by "
        "{:.2g} px on average over the picture, {:.2g} px at worst. {} corners and {} views were left out as "
        "outliers.</p>",
        html_text(calibration.fit.candidate.name()), corners, data.views.size(), calibration.fit.rms_px,
        calibration.held_out_px, calibration.pixels.rms_px, calibration.pixels.worst_px, calibration.dropped_corners,
        calibration.dropped_views.size());
    html += section("Parameters",
                    "<p class=\"note\">The sigma is the larger of two: what the corners' scatter says if all errors "
                    "are independent, and what changes when views are left out.</p>" +
                        parameter_table(calibration));
    const ArrowPlot arrows = residual_arrows_svg(calibration);
    html += section("What the lens leaves over",
                    fmt::format("<p>From each corner (blue) its residual, {:.4g} times its length. Arrows that point "
                                "the same way in a part of the picture would be something the model cannot follow. "
                                "Green: the principal point.</p>{}",
                                arrows.magnification, arrows.svg) +
                        "<p>Residuals along the radius; the red line is their mean, near 0 where the model fits.</p>" +
                        radial_residuals_svg(calibration));
    html += section("Where the corners lay",
                    fmt::format("<p>Corners in each part of the picture; they cover {:.0f} % of it. The lens is "
                                "extrapolated where there are none.</p>{}",
                                100 * calibration.coverage, coverage_svg(calibration)));
    html += section("How sure a pixel is",
                    "<p>One sigma of a pixel's place by the parameters' uncertainty, in pixels; a turn of the whole "
                    "camera does no harm and is taken out.</p>" +
                        uncertainty_svg(calibration));
    html += section("Models",
                    "<p>Each model is made again without a part of the views and judged on those. The simplest is "
                    "chosen that is worse than the best by no more than one standard error, or a hundredth of the "
                    "error.</p>" +
                        candidate_table(calibration));
    html += compared_table(calibration, context.compared);
    html += section("Views", view_bars_svg(calibration) + view_table(calibration));
    return html + "</body></html>\n";
}

}  // namespace matchlight
