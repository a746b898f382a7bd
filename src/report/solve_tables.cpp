// Rows of HTML; a figure that is not known has no row.
#include "report/solve_tables.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/html_text.h"

namespace matchlight {
namespace {

std::string row(const std::string& name, const std::string& value) {
    return fmt::format("<tr><td class=\"word\">{}</td><td class=\"word long\">{}</td></tr>", html_text(name),
                       html_text(value));
}

/// "1574.40 ± 0.31 (refined)".
std::string with_sigma(const Solve& solve, const std::string& name, double value) {
    std::string text = fmt::format("{:.6g}", value);
    const auto known = std::ranges::find(solve.lens_parameters, name, &LensParameter::name);
    if (known != solve.lens_parameters.end()) {
        text += fmt::format(" ± {:.2g}{}", known->sigma, known->refined ? " (refined by the clip)" : "");
    }
    return text;
}

std::string lens_rows(const Solve& solve) {
    const Camera& camera = solve.camera;
    std::string html =
        row("fx, px", with_sigma(solve, "fx", camera.fx)) + row("fy, px", with_sigma(solve, "fy", camera.fy)) +
        row("cx, px", with_sigma(solve, "cx", camera.cx)) + row("cy, px", with_sigma(solve, "cy", camera.cy));
    static constexpr const char* radtan[] = {"k1", "k2", "p1", "p2", "k3", "k4", "k5",
                                             "k6", "s1", "s2", "s3", "s4", "tx", "ty"};
    static constexpr const char* fisheye[] = {"k1", "k2", "k3", "k4"};
    std::string coefficients;
    for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
        const char* name = camera.lens == LensModel::fisheye ? fisheye[i] : radtan[i];
        coefficients += fmt::format("{}{} {}", i > 0 ? ", " : "", name, with_sigma(solve, name, camera.distortion[i]));
    }
    const char* model = camera.lens == LensModel::fisheye ? "fisheye" : "radial and tangential";
    return html + row("distortion", camera.has_distortion() ? fmt::format("{}: {}", model, coefficients) : "none");
}

}  // namespace

std::string summary_table(const Solve& solve, const SolveFindings& found) {
    std::int64_t posed = 0, bridged = 0;
    double worst = 0;
    std::vector<double> predicted;
    for (std::size_t i = 0; i < solve.frames.size(); ++i) {
        const SolvedFrame& frame = solve.frames[i];
        posed += frame.camera_from_world.has_value();
        bridged += frame.bridged;
        worst = std::max(worst, frame.reprojection_px.value_or(0));
        if (found.frames[i].predicted_px) predicted.push_back(*found.frames[i].predicted_px);
    }
    const auto frames = static_cast<std::int64_t>(solve.frames.size());
    std::string html =
        "<table>" + row("frames", fmt::format("{}", frames)) +
        row("with a pose", fmt::format("{}, of these {} bridged; {} without", posed, bridged, frames - posed));
    if (found.median_reprojection_px) {
        html += row("residuals of a frame, RMS",
                    fmt::format("{:.3f} px median, {:.3f} px worst", *found.median_reprojection_px, worst));
    }
    if (!predicted.empty()) {
        std::ranges::sort(predicted);
        html += row("predicted error at the tags", fmt::format("{:.3f} px median, {:.3f} px worst",
                                                               predicted[predicted.size() / 2], predicted.back()));
    }
    std::int64_t flagged = 0;
    for (const SolvedFrame& frame : solve.frames) {
        flagged += std::ranges::any_of(
            found.flagged, [&](const FlaggedRun& run) { return frame.frame >= run.first && frame.frame <= run.last; });
    }
    return html + row("flagged frames", fmt::format("{}", flagged)) + "</table>";
}

std::string tag_table(const std::vector<TagFindings>& tags) {
    std::string html =
        "<table><tr><th>tag</th><th>frames</th><th>RMS px</th><th>mean right px</th><th>mean down px</th><th>worst "
        "frame's "
        "RMS px</th><th>worst frame</th></tr>";
    for (const TagFindings& tag : tags) {
        if (tag.frames == 0) {
            html +=
                fmt::format("<tr><td>{}</td><td>0</td><td>–</td><td>–</td><td>–</td><td>–</td><td>–</td></tr>", tag.id);
            continue;
        }
        html += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.3f}</td><td>{:+.3f}</td><td>{:+.3f}</td><td>{:.3f}</td><td>{}</td></tr>",
            tag.id, tag.frames, tag.rms_px, tag.mean_px.x(), tag.mean_px.y(), tag.worst_px, tag.worst_frame);
    }
    return html +
           "</table><p class=\"note\">Over the frames whose pose rests on the tag. A mean that is not near zero says "
           "that "
           "the tag's place or size, or the lens, is off.</p>";
}

std::string clip_table(const Solve& solve) {
    std::string html = "<table>" + lens_rows(solve);
    if (solve.readout_s)
        html += row("rolling shutter", fmt::format("{:.2f} ms from the first row to the last", *solve.readout_s * 1e3));
    html += row("response", solve.response.to_json().dump());
    if (solve.vignette) {
        const auto [v1, v2] = *solve.vignette;
        html += row("vignette", fmt::format("1 {:+.4f} r² {:+.4f} r⁴: {:.1f} % of the light in the corners", v1, v2,
                                            100 * (1 + v1 + v2)));
    }
    if (solve.noise) {
        html += row("noise", fmt::format("read {:.5f}, shot {:.6f} (plate-linear; {:.2f} % of white)",
                                         (*solve.noise)[0], (*solve.noise)[1],
                                         100 * std::sqrt((*solve.noise)[0] * (*solve.noise)[0] + (*solve.noise)[1])));
    }
    if (solve.softness_px) html += row("softness of the coding", fmt::format("{:.3f} px", *solve.softness_px));
    if (solve.light_gradient_ev_per_m) {
        const Eigen::Vector3d& gradient = *solve.light_gradient_ev_per_m;
        html += row("light over the world", fmt::format("{:+.2f}, {:+.2f}, {:+.2f} EV a metre along x, y, z",
                                                        gradient.x(), gradient.y(), gradient.z()));
    }
    return html + "</table>";
}

}  // namespace matchlight
