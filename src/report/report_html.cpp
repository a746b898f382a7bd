// The report as one page that needs nothing else: plots as SVG, pictures inside it.
#include <algorithm>

#include <fmt/format.h>

#include "core/html_text.h"
#include "core/page_style.h"
#include "core/version.h"
#include "report/embedded_png.h"
#include "report/pareto_plot.h"
#include "report/report.h"
#include "report/track_text.h"

namespace matchlight {
namespace {

/// Wide enough to judge by eye, small enough for a page of dozens.
constexpr int picture_width_px = 480;

std::string cell(const std::optional<double>& value, const char* format = "{:.4g}") {
    return value ? fmt::format("<td>{}</td>", fmt::format(fmt::runtime(format), *value)) : "<td>–</td>";
}

std::string word(const std::string& text) {
    return fmt::format("<td class=\"word\">{}</td>", html_text(text));
}

std::string long_words(const std::string& text) {
    return fmt::format("<td class=\"word long\">{}</td>", html_text(text));
}

std::string figure(const Image8& picture, const std::string& caption) {
    if (picture.empty()) return {};
    return fmt::format("<figure><img alt=\"{0}\" src=\"{1}\"><figcaption>{0}</figcaption></figure>", html_text(caption),
                       embedded_png(picture, picture_width_px));
}

std::string points_table(const EffectReport& effect) {
    const std::vector<bool> front = pareto_front(effect.points);
    std::string html =
        "<table><tr><th class=\"word\">level</th><th class=\"word\">knobs</th><th>kept in</th><th>ms median</th>"
        "<th>min</th><th>max</th><th>MB moved</th><th>× bandwidth bound</th><th>FLIP</th><th>HDR-FLIP</th>"
        "<th>PSNR dB</th><th>relative RMS</th><th>mean light − 1</th></tr>";
    for (std::size_t i = 0; i < effect.points.size(); ++i) {
        const EffectPoint& point = effect.points[i];
        html += fmt::format("<tr{}>", front[i] ? " class=\"front\"" : "") + word(point.level) +
                fmt::format("<td class=\"word knobs\">{}</td>", html_text(knobs_text(point.knobs))) +
                fmt::format("<td>{}</td>", point.precision) + cell(point.time.median_ms, "{:.3g}") +
                cell(point.time.min_ms, "{:.3g}") + cell(point.time.max_ms, "{:.3g}") +
                cell(point.bytes > 0 ? std::optional(point.bytes * 1e-6) : std::nullopt, "{:.3g}") +
                cell(point.bandwidth_bounds, "{:.3g}") + cell(point.errors.flip) + cell(point.errors.hdr_flip) +
                cell(point.errors.psnr_db) + cell(point.errors.relative_rms) + cell(point.errors.mean_light, "{:.2g}") +
                "</tr>";
    }
    if (const auto& left_out = effect.left_out) {
        html += fmt::format(
            "<tr class=\"skipped\"><td class=\"word\">left out</td><td class=\"word long\" colspan=\"12\">{}: saves "
            "{:.3g} ms a "
            "{}; largest difference of the picture {} of 255{}</td></tr>",
            html_text(left_out->condition), left_out->ms_saved, effect.unit == WorkUnit::frame ? "frame" : "clip",
            left_out->max_code_difference,
            left_out->cost.empty() ? "" : html_text("; what it costs: " + knobs_text(left_out->cost)));
    }
    return html + "</table>";
}

std::string effect_section(const EffectReport& effect) {
    std::string html = fmt::format("<h2 id=\"{0}\">{0}</h2><p>{1}</p>", html_text(effect.name), html_text(effect.what));
    if (!effect.left_out_of_frame.empty()) {
        html +=
            fmt::format("<p><strong>This frame leaves it out:</strong> {}.</p>", html_text(effect.left_out_of_frame));
    }
    if (!effect.reference.empty()) {
        html += fmt::format("<p class=\"note\">Reference: {}.", html_text(effect.reference));
        if (effect.reference_self_error_flip) {
            html += fmt::format(" Half its effort differs from it by FLIP {:.2g}.", *effect.reference_self_error_flip);
        }
        html += fmt::format(" Errors are means over {}×{} pixels.</p>", effect.region.width, effect.region.height);
    }
    html += pareto_plot_svg(effect) + points_table(effect) + "<div class=\"pictures\">" +
            figure(effect.reference_picture, "reference");
    for (const EffectPoint& point : effect.points) {
        html += figure(point.picture, point.level) + figure(point.flip_map, point.level + ": FLIP");
    }
    return html + "</div>";
}

std::string stability_section(const std::vector<StabilityRow>& rows) {
    if (rows.empty()) return {};
    const auto passed = std::ranges::count_if(rows, [](const StabilityRow& row) { return row.pass; });
    std::string html = fmt::format(
        "<h2 id=\"stability\">Stability</h2><p>{} of {} stiff and extreme cases stay within their "
        "bounds.</p><table><tr>"
        "<th class=\"word\">part</th><th class=\"word\">case</th><th class=\"word\">bound</th><th>value</th>"
        "<th>energy kept</th><th></th><th class=\"word\">beside</th></tr>",
        passed, rows.size());
    for (const StabilityRow& row : rows) {
        html += "<tr>" + word(row.effect) + long_words(row.name) + long_words(row.bound) + cell(row.value) +
                cell(row.energy_kept, "{:.6g}") +
                fmt::format("<td class=\"{0}\">{0}</td>", row.pass ? "pass" : "fail") +
                fmt::format("<td class=\"word knobs\">{}</td></tr>", html_text(knobs_text(row.beside)));
    }
    return html + "</table>";
}

std::string truth_plot(const std::vector<TruthRow>& rows) {
    EffectReport ladder;
    ladder.name = "whole frame";
    for (const TruthRow& row : rows) {
        EffectPoint& point = ladder.points.emplace_back();
        point.level = row.level;
        point.time = row.time;
        point.errors.flip = row.flip_in;
    }
    return pareto_plot_svg(ladder, {.time = "ms a frame", .error = "FLIP", .against = "FLIP against the truth"});
}

std::string truth_section(const std::vector<TruthRow>& rows) {
    if (rows.empty()) return {};
    std::string html =
        "<h2 id=\"truth\">Whole frame against the truth</h2><p>FLIP inside the region that the objects change.</p>" +
        truth_plot(rows) +
        "<table><tr><th class=\"word\">level</th><th>ms median</th><th>min</th><th>max</th><th>FLIP</th></tr>";
    for (const TruthRow& row : rows) {
        html += "<tr>" + word(row.level) + cell(row.time.median_ms, "{:.3g}") + cell(row.time.min_ms, "{:.3g}") +
                cell(row.time.max_ms, "{:.3g}") + cell(row.flip_in) + "</tr>";
    }
    return html + "</table>";
}

std::string budget_section(const std::vector<BudgetRow>& rows) {
    if (rows.empty()) return {};
    std::string html =
        "<h2 id=\"budget\">Budgets</h2><p>What this machine's table chooses for this frame, predicted and measured.</p>"
        "<table><tr><th>budget ms</th><th>predicted ms</th><th>measured ms</th><th class=\"word\">choice</th></tr>";
    for (const BudgetRow& row : rows) {
        html += "<tr>" + cell(row.budget_ms, "{:.3g}") + cell(row.predicted_ms, "{:.3g}") +
                cell(row.measured_ms, "{:.3g}") + long_words(row.choice) + "</tr>";
    }
    return html + "</table>";
}

}  // namespace

std::string report_html(const Report& report) {
    const Machine& machine = report.machine;
    const bool is_study = !report.depth_of_field_study.empty();
    const bool is_spheres = !report.sphere_study.empty();
    const std::string title = report.scene.empty() ? "Stability"
                              : report.track       ? fmt::format("Tracking, error against run time: {}", report.scene)
                              : is_spheres         ? fmt::format("Sphere sets: {}", report.scene)
                              : is_study           ? fmt::format("Depth of field: {}", report.scene)
                                                   : fmt::format("Error against run time: {}", report.scene);
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Matchlight: {0}</title>"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{1}</style></head><body>"
        "<h1>{0}</h1>",
        html_text(title), page_style);
    const bool shows_frame = !report.scene.empty() && !report.track && !is_study && !is_spheres;
    if (shows_frame) html += fmt::format("<p>Frame {}, {}×{}. ", report.frame, report.width, report.height);
    html += fmt::format(
        "{}Matchlight {} on {} (OpenGL {}), {} cores; times by {}; a copy moves {:.1f} GB/s, the bound that no pass "
        "can beat.</p>",
        shows_frame ? "" : "<p>", version, html_text(machine.renderer), html_text(machine.gl_version), machine.cores,
        machine.timer_queries ? "timer queries" : "the wall clock between two glFinish",
        machine.copy_bytes_per_second * 1e-9);
    if (!report.effects.empty()) {
        html +=
            "<p class=\"note\">Each level and knob is held against a converged reference of its effect: the lower left "
            "is "
            "where to be. Filled points are the ones that no other beats in both. Runs are interleaved, so that what "
            "else "
            "the machine does hits all alike.</p>";
    }
    if (is_spheres) html += sphere_study_html(report.sphere_study);
    for (const EffectReport& effect : report.effects) html += effect_section(effect);
    if (report.track) html += track_html(*report.track);
    if (is_study) html += depth_of_field_study_html(report.depth_of_field_study);
    html += truth_section(report.truth) + budget_section(report.budget) + stability_section(report.stability);
    if (!report.provenance.empty()) {
        html += fmt::format("<h2>Settings</h2><pre>{}</pre>", html_text(report.provenance));
    }
    return html + "</body></html>\n";
}

}  // namespace matchlight
