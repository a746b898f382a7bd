// The tables as JSON, CSV, text and HTML.
#include "report/sphere_study.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/html_text.h"
#include "report/csv_text.h"

namespace matchlight {
namespace {

using nlohmann::ordered_json;

ordered_json row_json(const SphereStudyRow& row) {
    ordered_json json{{"set", row.set},
                      {"spheres", row.spheres},
                      {"orbit", row.orbit},
                      {"part", row.part},
                      {"way", row.way},
                      {"frames", row.frames},
                      {"ms_median", row.time.median_ms},
                      {"ms_min", row.time.min_ms},
                      {"ms_max", row.time.max_ms},
                      {"speedup", row.speedup ? ordered_json(*row.speedup) : ordered_json(nullptr)}};
    json["beside"] = ordered_json::object();
    for (const Knob& knob : row.beside) json["beside"][knob.name] = knob.value;
    return json;
}

ordered_json check_json(const SphereCheckRow& row) {
    return {{"set", row.set},
            {"orbit", row.orbit},
            {"frames", row.frames},
            {"pixels", row.pixels},
            {"edge_pixels", row.edge_pixels},
            {"largest_codes", row.largest_codes},
            {"over_one_code", row.over_one_code},
            {"largest_coverage", row.largest_coverage},
            {"mean_coverage", row.mean_coverage},
            {"over_a_sixteenth", row.over_a_sixteenth}};
}

std::string speedup_text(const SphereStudyRow& row) {
    return row.speedup ? fmt::format("{:.2f}", *row.speedup) : "–";
}

std::string orbits_html(const SphereStudy& study) {
    std::string html =
        "<table><tr><th class=\"word\">set</th><th>spheres</th><th class=\"word\">orbit</th><th "
        "class=\"word\">part</th>"
        "<th class=\"word\">way</th><th>frames</th><th>ms median</th><th>min</th><th>max</th><th>× the first way</th>"
        "<th class=\"word\">beside</th></tr>";
    for (const SphereStudyRow& row : study.rows) {
        html += fmt::format(
            "<tr><td class=\"word\">{}</td><td>{}</td><td class=\"word\">{}</td><td class=\"word\">{}</td>"
            "<td class=\"word\">{}</td><td>{}</td><td>{:.4g}</td><td>{:.4g}</td><td>{:.4g}</td><td>{}</td>"
            "<td class=\"word knobs\">{}</td></tr>",
            html_text(row.set), row.spheres, html_text(row.orbit), html_text(row.part), html_text(row.way), row.frames,
            row.time.median_ms, row.time.min_ms, row.time.max_ms, speedup_text(row), html_text(knobs_text(row.beside)));
    }
    return html + "</table>";
}

std::string checks_html(const SphereStudy& study) {
    if (study.checks.empty()) return {};
    std::string html =
        "<p>Opaque pictures against the double-precision ray caster. Edges are silhouettes and the seams where spheres "
        "meet: there the covered share of the pixel, drawn by 8×8 places at edges, is compared, elsewhere the "
        "picture's codes of 255.</p>"
        "<table><tr><th class=\"word\">set</th><th class=\"word\">orbit</th><th>frames</th><th>pixels</th><th>at "
        "edges</th><th>largest difference, codes</th><th>pixels over 1</th><th>largest difference of coverage</th>"
        "<th>mean</th><th>pixels over 1/16</th></tr>";
    for (const SphereCheckRow& row : study.checks) {
        html += fmt::format(
            "<tr><td class=\"word\">{}</td><td class=\"word\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3g}</td>"
            "<td>{}</td><td>{:.3g}</td><td>{:.3g}</td><td>{}</td></tr>",
            html_text(row.set), html_text(row.orbit), row.frames, row.pixels, row.edge_pixels, row.largest_codes,
            row.over_one_code, row.largest_coverage, row.mean_coverage, row.over_a_sixteenth);
    }
    return html + "</table>";
}

}  // namespace

ordered_json sphere_study_json(const SphereStudy& study) {
    ordered_json json{{"ways", ordered_json::array()}, {"checks", ordered_json::array()}};
    for (const SphereStudyRow& row : study.rows) json["ways"].push_back(row_json(row));
    for (const SphereCheckRow& row : study.checks) json["checks"].push_back(check_json(row));
    return json;
}

std::string sphere_study_csv(const SphereStudy& study) {
    std::string csv = "set,spheres,orbit,part,way,frames,ms_median,ms_min,ms_max,speedup,beside\n";
    for (const SphereStudyRow& row : study.rows) {
        csv +=
            fmt::format("{},{},{},{},{},{},{:.9g},{:.9g},{:.9g},{},{}\n", csv_text(row.set), row.spheres, row.orbit,
                        row.part, csv_text(row.way), row.frames, row.time.median_ms, row.time.min_ms, row.time.max_ms,
                        row.speedup ? fmt::format("{:.6g}", *row.speedup) : "", csv_text(knobs_text(row.beside)));
    }
    return csv;
}

std::string sphere_study_lines(const SphereStudy& study) {
    std::string text = "sphere sets, ms a frame\n";
    for (const SphereStudyRow& row : study.rows) {
        text += fmt::format("  {:<12}{:<7}{:<12}{:<22}{:>10.4g} ms  × {:<6}{}\n", row.set, row.orbit, row.part, row.way,
                            row.time.median_ms, speedup_text(row), knobs_text(row.beside));
    }
    for (const SphereCheckRow& row : study.checks) {
        text += fmt::format(
            "  {:<12}{:<7}against rays: {:.3g} codes at most off edges ({} of {} pixels over 1); coverage {:.3g} at "
            "most at edges ({} of {} over 1/16)\n",
            row.set, row.orbit, row.largest_codes, row.over_one_code, row.pixels - row.edge_pixels,
            row.largest_coverage, row.over_a_sixteenth, row.edge_pixels);
    }
    return text;
}

std::string sphere_study_html(const SphereStudy& study) {
    return "<h2 id=\"sphere_study\">Sphere sets, by way of drawing</h2><p>Milliseconds a frame, from the first call to "
           "the end of glFinish, over the frames of an orbit around each set: <em>whole</em> sees all of it, "
           "<em>near</em> stands at its border. The ways of a part are drawn in turn at every frame; how many times as "
           "fast one is as the first of them is the median of the frames' ratios.</p>" +
           orbits_html(study) + checks_html(study);
}

}  // namespace matchlight
