// The study's table as JSON, CSV, text and HTML.
#include "report/depth_of_field_study.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/html_text.h"

namespace matchlight {
namespace {

using nlohmann::ordered_json;

ordered_json time_json(const RunTime& time) {
    return {{"ms_median", time.median_ms}, {"ms_min", time.min_ms}, {"ms_max", time.max_ms}};
}

double cost_percent(const DepthOfFieldStudyRow& row) {
    return row.without.median_ms > 0 ? 100 * row.cost_ms / row.without.median_ms : 0;
}

}  // namespace

ordered_json depth_of_field_study_json(const DepthOfFieldStudy& study) {
    ordered_json rows = ordered_json::array();
    for (const DepthOfFieldStudyRow& row : study) {
        rows.push_back({{"width", row.width},
                        {"height", row.height},
                        {"level", row.level},
                        {"widest_coc_px", row.widest_coc_px},
                        {"without", time_json(row.without)},
                        {"with", time_json(row.with)},
                        {"cost_ms", row.cost_ms}});
    }
    return rows;
}

std::string depth_of_field_study_csv(const DepthOfFieldStudy& study) {
    std::string csv =
        "width,height,level,widest_coc_px,without_ms_median,without_ms_min,without_ms_max,with_ms_median,with_ms_min,"
        "with_ms_max,cost_ms\n";
    for (const DepthOfFieldStudyRow& row : study) {
        csv += fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", row.width, row.height,
                           row.level, row.widest_coc_px, row.without.median_ms, row.without.min_ms, row.without.max_ms,
                           row.with.median_ms, row.with.min_ms, row.with.max_ms, row.cost_ms);
    }
    return csv;
}

std::string depth_of_field_study_lines(const DepthOfFieldStudy& study) {
    std::string text = "depth of field, ms a frame\n";
    for (const DepthOfFieldStudyRow& row : study) {
        text += fmt::format("  {:>4}×{:<5}{:<14}{:>9.4g} without{:>10.4g} with{:>10.4g} more ({:.0f} %)\n", row.width,
                            row.height, row.level, row.without.median_ms, row.with.median_ms, row.cost_ms,
                            cost_percent(row));
    }
    return text;
}

std::string depth_of_field_study_html(const DepthOfFieldStudy& study) {
    std::string html =
        "<h2 id=\"depth_of_field_study\">Depth of field, by size and method</h2><p>Milliseconds a frame, drawn, "
        "composited and read back: medians. Frames with and without take turns; the cost is the median of the "
        "differences within each pair. The vertical angle of view stays the same.</p>"
        "<table><tr><th>size</th><th class=\"word\">level</th><th>widest circle px</th><th>without</th><th>with</th>"
        "<th>cost</th><th>cost %</th></tr>";
    for (const DepthOfFieldStudyRow& row : study) {
        html += fmt::format(
            "<tr><td>{}×{}</td><td class=\"word\">{}</td><td>{:.1f}</td><td>{:.4g}</td><td>{:.4g}</td>"
            "<td>{:.4g}</td><td>{:.0f}</td></tr>",
            row.width, row.height, html_text(row.level), row.widest_coc_px, row.without.median_ms, row.with.median_ms,
            row.cost_ms, cost_percent(row));
    }
    return html + "</table>";
}

}  // namespace matchlight
