// What a report writes: its JSON, its CSV, its page and its plot.
#include <algorithm>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/embedded_png.h"
#include "report/pareto_plot.h"
#include "report/report.h"

namespace matchlight {
namespace {

EffectPoint point(const std::string& level, double ms, double flip) {
    EffectPoint made{.level = level, .knobs = {{"taps", 4}, {"size", 256}}, .precision = "16F"};
    made.time = {ms, ms * 0.9, ms * 1.2};
    made.errors = {flip, 2 * flip, 40.0, 0.01, 5e-4};
    made.picture = Image8(20, 10, 3, 128);
    made.flip_map = Image8(20, 10, 3, 5);
    return made;
}

Report small_report() {
    Report report;
    report.scene = "a \"b\" <c>.toml";
    report.width = 20;
    report.height = 10;
    EffectReport effect;
    effect.name = "bloom";
    effect.reference = "a sum";
    effect.reference_self_error_flip = 0.0005;
    effect.region = {1, 2, 20, 10};
    effect.points = {point("slow", 20, 0.001), point("quick", 2, 0.01), point("worse", 10, 0.02)};
    effect.left_out = LeftOutRow{"no light above the threshold", 2.0, 0, {{"share moved", 0.1}}};
    effect.reference_picture = Image8(20, 10, 3, 130);
    report.effects.push_back(effect);
    report.stability = {{"flip", "black", "0", 0, std::nullopt, true},
                        {"flip", "NaN, \"quoted\"", "finite", std::numeric_limits<double>::quiet_NaN(), 1.0, false}};
    report.truth = {{"final", {3, 2, 4}, 0.2}};
    return report;
}

/// Fields of a CSV line: quoted ones may hold commas and doubled quotes (RFC 4180).
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"') {
            if (quoted && i + 1 < line.size() && line[i + 1] == '"') {
                fields.back() += line[++i];
            } else {
                quoted = !quoted;
            }
        } else if (line[i] == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += line[i];
        }
    }
    EXPECT_FALSE(quoted) << line;
    return fields;
}

TEST(ReportFiles, JsonHoldsEveryKeyOfTheSchema) {
    const nlohmann::json json = nlohmann::json::parse(report_json(small_report()));
    EXPECT_EQ(json["matchlight_report"], 1);
    EXPECT_TRUE(json["machine"].is_object());
    EXPECT_EQ(json["scene"], "a \"b\" <c>.toml");
    EXPECT_EQ(json["frame"], 0);
    const nlohmann::json& effect = json["effects"]["bloom"];
    EXPECT_EQ(effect["reference_self_error_flip"], 0.0005);
    ASSERT_EQ(effect["points"].size(), 3u);
    const nlohmann::json& first = effect["points"][0];
    EXPECT_EQ(first["level"], "slow");
    EXPECT_EQ(first["knobs"]["taps"], 4);
    EXPECT_EQ(first["precision"], "16F");
    EXPECT_EQ(first["ms_median"], 20);
    EXPECT_EQ(first["ms_min"], 18);
    EXPECT_EQ(first["ms_max"], 24);
    EXPECT_EQ(first["flip"], 0.001);
    EXPECT_EQ(first["hdr_flip"], 0.002);
    EXPECT_EQ(first["psnr_db"], 40);
    EXPECT_EQ(first["relative_rms"], 0.01);
    EXPECT_EQ(first["mean_light"], 5e-4);
    EXPECT_TRUE(first.contains("bandwidth_bounds"));
    EXPECT_EQ(effect["left_out"]["ms_saved"], 2);
    EXPECT_EQ(effect["left_out"]["max_code_difference"], 0);
    EXPECT_EQ(effect["left_out"]["cost"]["share moved"], 0.1);
    EXPECT_EQ(json["stability"][0]["case"], "black");
    EXPECT_EQ(json["stability"][0]["pass"], true);
    EXPECT_TRUE(json["stability"][1]["value"].is_null());  // JSON has no NaN
    EXPECT_EQ(json["frame_error_against_truth"][0]["level"], "final");
    EXPECT_EQ(json["frame_error_against_truth"][0]["flip_in"], 0.2);
}

TEST(ReportFiles, CsvHasOneWidth) {
    std::istringstream csv(report_csv(small_report()));
    std::string line;
    ASSERT_TRUE(std::getline(csv, line));
    const std::vector<std::string> header = fields_of(line);
    std::size_t rows = 0;
    for (; std::getline(csv, line); ++rows) EXPECT_EQ(fields_of(line).size(), header.size()) << line;
    EXPECT_EQ(rows, 4u);  // three points and the row "left out"
}

TEST(ReportFiles, PageNeedsNothingElse) {
    const std::string page = report_html(small_report());
    for (const char* reference : {"src=\"http", "href=\"http", "url(", "<script", "<link", "@import", "src=\"/"}) {
        EXPECT_EQ(page.find(reference), std::string::npos) << reference;
    }
    EXPECT_NE(page.find("src=\"data:image/png;base64,iVBORw0KGgo"), std::string::npos);
    // Names are text, not markup.
    EXPECT_EQ(page.find("<c>"), std::string::npos);
    EXPECT_NE(page.find("a &quot;b&quot; &lt;c&gt;.toml"), std::string::npos);
    for (const char* tag : {"table", "svg", "div", "figure", "p", "h2", "tr"}) {
        std::size_t opened = 0, closed = 0;
        const std::string open = "<" + std::string(tag), close = "</" + std::string(tag) + ">";
        for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at + 1)) {
            const char next = page[at + open.size()];
            opened += next == '>' || next == ' ' ? 1 : 0;
        }
        for (std::size_t at = page.find(close); at != std::string::npos; at = page.find(close, at + 1)) ++closed;
        EXPECT_EQ(opened, closed) << tag;
    }
}

TEST(ReportFiles, PicturesAreScaledToFit) {
    const Image8 wide(64, 16, 1, 200);
    const std::string small = embedded_png(wide, 16), whole = embedded_png(wide, 64);
    EXPECT_TRUE(small.starts_with("data:image/png;base64,"));
    EXPECT_NE(small, whole);
}

TEST(ParetoFront, KeepsWhatNoOtherBeats) {
    const std::vector<EffectPoint> points{point("slow", 20, 0.001), point("quick", 2, 0.01), point("worse", 10, 0.02),
                                          point("same", 2, 0.01)};
    EXPECT_EQ(pareto_front(points), (std::vector<bool>{true, true, false, true}));
}

TEST(ParetoFront, LeavesOutPointsWithoutAnError) {
    EffectPoint unknown = point("unknown", 1, 0);
    unknown.errors.flip.reset();
    EXPECT_EQ(pareto_front({unknown, point("known", 2, 0.1)}), (std::vector<bool>{false, true}));
}

TEST(ParetoPlot, TakesErrorsAndTimesOfNothing) {
    EffectReport effect = small_report().effects[0];
    effect.points.push_back(point("exact", 30, 0));
    effect.points.push_back(point("free", 0, 0.5));
    const std::string svg = pareto_plot_svg(effect);
    EXPECT_NE(svg.find("exact"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    effect.points.clear();
    EXPECT_TRUE(pareto_plot_svg(effect).empty());
}

}  // namespace
}  // namespace matchlight
