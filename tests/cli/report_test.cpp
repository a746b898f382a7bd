// `matchlight report` on the sample shot: its three files, and what it refuses.
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class ReportTest : public CommandTest {
protected:
    void SetUp() override {
        shot_ = scratch_.copy_sample("table");
        scene_ = shot_ / "table.toml";
    }
    void track() const { ASSERT_TRUE(succeeded(run_matchlight({"track", scene_}))); }

    RunResult report(const fs::path& folder, const std::vector<std::string>& more) const {
        std::vector<std::string> call{"report", scene_, "-o", folder};
        call.insert(call.end(), more.begin(), more.end());
        RunOptions options;
        options.timeout = std::chrono::seconds(280);
        return run_matchlight(call, options);
    }

    fs::path shot_, scene_;
};

void expect_number_or_null(const json& object, const char* key) {
    ASSERT_TRUE(object.contains(key)) << key;
    EXPECT_TRUE(object[key].is_number() || object[key].is_null()) << key;
}

void expect_schema(const json& effect) {
    expect_number_or_null(effect, "reference_self_error_flip");
    for (const json& point : effect["points"]) {
        EXPECT_TRUE(point["level"].is_string());
        EXPECT_TRUE(point["knobs"].is_object());
        EXPECT_TRUE(point["precision"] == "16F" || point["precision"] == "32F");
        EXPECT_LE(point["ms_min"], point["ms_median"]);
        EXPECT_LE(point["ms_median"], point["ms_max"]);
        for (const char* key : {"bandwidth_bounds", "flip", "hdr_flip", "psnr_db", "relative_rms"}) {
            expect_number_or_null(point, key);
        }
    }
    if (effect["left_out"].is_object()) {
        EXPECT_TRUE(effect["left_out"]["ms_saved"].is_number());
        EXPECT_EQ(effect["left_out"]["max_code_difference"], 0);
    }
}

/// FLIP by level.
std::map<std::string, double> errors_of(const json& effect) {
    std::map<std::string, double> errors;
    for (const json& point : effect["points"]) errors[point["level"]] = point["flip"];
    return errors;
}

TEST_F(ReportTest, WritesPageTableAndJson) {
    track();
    const fs::path folder = scratch_ / "report";
    const RunResult result =
        report(folder, {"--quick", "--repeats", "1", "--effects", "antialiasing,contact_shadow,object_shadow",
                        "--frame", "6", "--truth", shot_ / "truth_%03d.png", "--json"});
    ASSERT_TRUE(succeeded(result));
    const json written = json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(written, json::parse(result.standard_output));
    EXPECT_EQ(written["matchlight_report"], 1);
    EXPECT_EQ(written["scene"], "table.toml");
    EXPECT_EQ(written["frame"], 6);
    EXPECT_TRUE(written["machine"]["renderer"].is_string());
    ASSERT_EQ(written["effects"].size(), 3u);
    for (const json& effect : written["effects"]) expect_schema(effect);

    // Each ladder falls: more samples, more directions are nearer to the reference.
    const auto samples = errors_of(written["effects"]["antialiasing"]);
    EXPECT_GT(samples.at("draft, preview"), samples.at("final"));
    EXPECT_GT(samples.at("final"), samples.at("reference"));
    for (const char* shadow : {"contact_shadow", "object_shadow"}) {
        const auto errors = errors_of(written["effects"][shadow]);
        EXPECT_GT(errors.at("draft"), errors.at("preview")) << shadow;
        EXPECT_GT(errors.at("preview"), errors.at("final")) << shadow;
    }
    ASSERT_EQ(written["frame_error_against_truth"].size(), 3u);
    for (const json& row : written["frame_error_against_truth"]) {
        EXPECT_GT(row["ms_median"], 0);
        EXPECT_GT(row["flip_in"], 0);
        EXPECT_LT(row["flip_in"], 1);
    }

    const std::string page = bytes_of(folder / "report.html");
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_NE(page.find("FLIP against milliseconds, whole frame"), std::string::npos) << "the curve against the truth";
    for (const char* reference : {"src=\"http", "href=\"http", "url(", "<script", "<link", "@import"}) {
        EXPECT_EQ(page.find(reference), std::string::npos) << reference;
    }
    std::istringstream csv(bytes_of(folder / "report.csv"));
    std::string line;
    std::size_t rows = 0;
    while (std::getline(csv, line)) ++rows;
    std::size_t points = 0;
    for (const json& effect : written["effects"]) points += effect["points"].size() + effect["left_out"].is_object();
    EXPECT_EQ(rows, 1 + points);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 3);
}

TEST_F(ReportTest, DoesNotReplaceAReportUnasked) {
    track();
    const fs::path folder = scratch_ / "report";
    fs::create_directory(folder);
    const fs::path page = scratch_.write("report/report.html", "mine");
    EXPECT_TRUE(failed_naming(report(folder, {"--quick"}), {"report.html", "--overwrite"}));
    EXPECT_EQ(bytes_of(page), "mine");
    EXPECT_FALSE(fs::exists(folder / "report.json"));
}

TEST_F(ReportTest, LeavesNothingBehindWhenItFails) {
    const fs::path folder = scratch_ / "report";
    EXPECT_TRUE(failed_naming(report(folder, {"--quick"}), {"solve", "matchlight track"}));
    EXPECT_FALSE(fs::exists(folder));
    track();
    EXPECT_TRUE(failed_naming(report(folder, {"--frame", "5000"}), {"5000"}));
    EXPECT_FALSE(fs::exists(folder));
    EXPECT_TRUE(failed_naming(report(scratch_ / "no" / "folder", {}), {"folder"}));
    EXPECT_TRUE(failed_naming(report(folder, {"--truth", scratch_ / "none_%03d.png"}), {"none_000.png"}));
    EXPECT_FALSE(fs::exists(folder));
}

TEST_F(ReportTest, StabilityNeedsNoScene) {
    // tests/gpu/stability_test.cpp holds every case to its bound; here some parts show what the report makes of them.
    const fs::path folder = scratch_ / "report";
    const RunResult result =
        run_matchlight({"report", "--stability", "--parts", "streaks;bright pass;transfer", "-o", folder, "--json"});
    ASSERT_TRUE(succeeded(result));
    const json written = json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(written, json::parse(result.standard_output));
    EXPECT_FALSE(written.contains("effects"));
    std::map<std::string, int> cases;
    for (const json& row : written["stability"]) {
        ++cases[row["effect"]];
        EXPECT_TRUE(row["case"].is_string() && row["bound"].is_string());
        EXPECT_TRUE(row["value"].is_number()) << row;
        EXPECT_EQ(row["pass"], true) << row;
    }
    EXPECT_EQ(cases.size(), 3u);
    EXPECT_GE(cases["streaks"], 10);
    EXPECT_NE(bytes_of(folder / "report.html").find("8192"), std::string::npos);

    EXPECT_TRUE(failed_naming(run_matchlight({"report", "--stability", "--parts", "bloom", "-o", scratch_ / "other"}),
                              {"--parts", "no part \"bloom\"", "bloom, pyramid"}));
    EXPECT_FALSE(fs::exists(scratch_ / "other" / "report.html"));
    EXPECT_TRUE(refused_call(report(scratch_ / "other", {"--parts", "streaks"})));
    const std::string other = scratch_ / "other";
    EXPECT_TRUE(failed_naming(run_matchlight({"report", "--spheres", "C1", "--parts", "bloom", "-o", other}),
                              {"--parts", "\"bloom\"", "visibility; light"}));
}

TEST_F(ReportTest, TrackingIsTimedAndScored) {
    // A truth that the solve can be held against: what level final finds itself.
    track();
    json truth;
    const json solve = json::parse(bytes_of(shot_ / "table.solve.json"));
    for (const json& frame : solve["frames"]) {
        truth["poses"].push_back(
            {{"frame", frame["frame"]}, {"cam_from_world", frame["camera_from_world"]}, {"ev", 0}});
    }
    const fs::path exact = scratch_.write("truth.json", truth.dump());
    const fs::path folder = scratch_ / "report";
    const RunResult result = report(folder, {"--track", "--quick", "--truth", exact, "--json", "-q"});
    ASSERT_TRUE(succeeded(result));
    const json written = json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(written, json::parse(result.standard_output));
    EXPECT_EQ(written["track"]["frames"], 12);
    std::map<std::string, json> points;
    for (const json& point : written["track"]["points"]) points[point["name"]] = point;
    ASSERT_EQ(points.size(), 8u);
    for (const auto& [name, point] : points) {
        EXPECT_GT(point["ms_median"], 0) << name;
        EXPECT_EQ(point["posed"], 12) << name;
        EXPECT_LE(point["median_px"], point["max_px"]) << name;
        EXPECT_GT(point["leave_one_out_px"], 0) << name;
    }
    EXPECT_LT(points["final"]["max_px"], 1e-3);  // the same bits but for the file's digits
    EXPECT_GT(points["fast"]["mean_px"], 1e-3);
    EXPECT_LT(points["fast"]["mean_px"], points["AprilTag pose, codes"]["mean_px"]);
    EXPECT_NEAR(points["final"]["nees_median"], 0, 1e-3);
    EXPECT_LT(points["final"]["leave_one_out_px"], points["solvePnP, codes"]["leave_one_out_px"]);
    const std::string page = bytes_of(folder / "report.html");
    EXPECT_NE(page.find("registration error"), std::string::npos);
    EXPECT_NE(page.find("<svg"), std::string::npos);
    const std::string csv = bytes_of(folder / "report.csv");
    EXPECT_EQ(std::ranges::count(csv, '\n'), 9);
}

TEST_F(ReportTest, RefusesWhatIsNoTruthOfTheFootage) {
    const fs::path folder = scratch_ / "report";
    EXPECT_TRUE(failed_naming(report(folder, {"--track", "--truth", scratch_ / "none.json"}), {"none.json"}));
    const fs::path broken = scratch_.write("broken.json", "{\"poses\": [{\"frame\": 2}]}");
    EXPECT_TRUE(failed_naming(report(folder, {"--track", "--truth", broken}), {"broken.json", "frame 2"}));
    EXPECT_FALSE(fs::exists(folder));
    EXPECT_TRUE(refused_call(run_matchlight({"report", "--track", "-o", folder})));
}

TEST_F(ReportTest, BudgetsAreKeptByTheTableOfTheMachine) {
    track();
    RunOptions options;
    options.environment["XDG_CACHE_HOME"] = scratch_.path().string();
    options.timeout = std::chrono::seconds(280);
    const std::vector<std::string> render{
        "render", scene_, "-o", scratch_ / "out_%03d.png", "--frames", "0-0", "--overwrite", "--budget-ms", "1e5"};
    EXPECT_TRUE(warned_of(run_matchlight(render, options), {"budget_ms", "report --calibrate-machine"}));
    const std::string at_final = bytes_of(scratch_ / "out_000.png");

    const RunResult calibrated =
        run_matchlight({"report", "--calibrate-machine", "--quick", "--repeats", "1", "--json"}, options);
    ASSERT_TRUE(succeeded(calibrated));
    const json table = json::parse(bytes_of(scratch_ / "matchlight" / "levels.json"));
    EXPECT_EQ(table["matchlight_levels"], 1);
    ASSERT_EQ(table["machines"].size(), 1u);
    const json& effects = table["machines"][0]["effects"];
    EXPECT_EQ(effects, json::parse(calibrated.standard_output)["effects"]);
    for (const char* part : {"frame", "surface", "bloom"}) ASSERT_TRUE(effects.contains(part)) << part;
    // The dearest level is the reference, and its error the least.
    EXPECT_GT(effects["surface"][0]["flip"], effects["surface"][1]["flip"]);
    EXPECT_EQ(effects["surface"][2]["level"], "reference");
    EXPECT_EQ(effects["surface"][2]["flip"], 0);

    // Time without end chooses the finest level, and no time the coarsest.
    ASSERT_TRUE(succeeded(run_matchlight(render, options)));
    const std::string with_much = bytes_of(scratch_ / "out_000.png");
    EXPECT_NE(with_much, at_final);
    std::vector<std::string> hasty = render;
    hasty.back() = "0.001";
    EXPECT_TRUE(warned_of(run_matchlight(hasty, options), {"the quickest levels need about"}));
    EXPECT_NE(bytes_of(scratch_ / "out_000.png"), with_much);

    // The report sets what was predicted beside what came out.
    const fs::path folder = scratch_ / "report";
    ASSERT_TRUE(succeeded(run_matchlight(
        {"report", scene_, "-o", folder, "--quick", "--repeats", "1", "--effects", "reflection", "-q"}, options)));
    const json budgets = json::parse(bytes_of(folder / "report.json"))["budget"];
    ASSERT_EQ(budgets.size(), 3u);
    for (const json& row : budgets) {
        EXPECT_GT(row["predicted_ms"], 0);
        EXPECT_GT(row["measured_ms"], 0);
        EXPECT_NE(row["choice"].get<std::string>().find("surface"), std::string::npos);
    }
}

TEST_F(ReportTest, StudiesDepthOfFieldBySizeAndMethod) {
    const fs::path scene = shot_ / "virtual.toml";
    const auto written = [&](const std::string& more) {
        std::ofstream(scene) << "[camera]\nwidth = 16\nheight = 16\norbit = {radius = 2}\n"
                                "lens = {f_number = 1.4, focus_distance_m = 1}\n[light]\nprobe = \"probe.exr\"\n"
                                "[[object]]\nshape = \"box\"\nscale = 0.3\n[quality]\nlevel = \"draft\"\n"
                             << more;
        return scene;
    };
    const auto study = [&](const std::vector<std::string>& more) {
        std::vector<std::string> call{"report", scene, "-o", scratch_ / "study", "--study", "depth", "--repeats", "1"};
        call.insert(call.end(), more.begin(), more.end());
        return run_matchlight(call);
    };
    written("[effects]\ndepth_of_field = {lens_samples = 2}\n");
    ASSERT_TRUE(succeeded(study({})));
    const json rows = json::parse(bytes_of(scratch_ / "study" / "report.json"))["depth_of_field_study"];
    // Seven methods at three sizes.
    ASSERT_EQ(rows.size(), 21u);
    std::map<std::string, double> widest_px;
    for (const json& row : rows) {
        EXPECT_GT(row["without"]["ms_median"], 0);
        EXPECT_GT(row["with"]["ms_median"], 0);
        EXPECT_EQ(row["cost_ms"].get<double>(),
                  row["with"]["ms_median"].get<double>() - row["without"]["ms_median"].get<double>());  // of one pair
        widest_px[std::to_string(row["width"].get<int>()) + "x" + std::to_string(row["height"].get<int>())] =
            row["widest_coc_px"];
    }
    // The lens and the angle of view are kept vertically: a wider picture blurs alike, one of twice the height twice.
    EXPECT_NEAR(widest_px.at("1024x512") / widest_px.at("512x512"), 1, 1e-9);
    EXPECT_NEAR(widest_px.at("1024x1024") / widest_px.at("512x512"), 2, 1e-9);
    const std::string csv = bytes_of(scratch_ / "study" / "report.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 22);
    EXPECT_NE(bytes_of(scratch_ / "study" / "report.html").find("1024×512"), std::string::npos);

    written("");
    EXPECT_TRUE(failed_naming(study({"--overwrite"}), {"virtual.toml", "no depth of field"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"report", scene_, "-o", scratch_ / "other", "--study", "depth"}),
                              {"table.toml", "footage"}));
    EXPECT_TRUE(refused_call(study({"--track"})));
    EXPECT_TRUE(refused_call(run_matchlight({"report", scene, "-o", scratch_ / "other", "--study", "death"})));
}

TEST_F(ReportTest, RefusesWrongCalls) {
    EXPECT_TRUE(refused_call(run_matchlight({"report", scene_})));
    EXPECT_TRUE(refused_call(run_matchlight({"report", "-o", scratch_ / "report"})));
    EXPECT_TRUE(refused_call(report(scratch_ / "report", {"--effects", "blum"})));
    EXPECT_TRUE(refused_call(report(scratch_ / "report", {"--repeats", "0"})));
    EXPECT_TRUE(refused_call(report(scratch_ / "report", {"--frame", "-1"})));
    for (const char* budget : {"0", "-3", "nan", "x"}) {
        EXPECT_TRUE(refused_call(run_matchlight({"render", scene_, "-o", scratch_ / "a.mp4", "--budget-ms", budget})));
    }
}

TEST_F(ReportTest, SphereSetsAreMeasuredOverOrbits) {
    const fs::path few = scratch_.write("few.csv", "x,y,z,radius\n0,0,0,0.5\n0.6,0,0,0.4\n0,0.7,0.2,0.3\n");
    const fs::path folder = scratch_ / "report";
    RunOptions options;
    options.timeout = std::chrono::seconds(280);
    const RunResult result =
        run_matchlight({"report", "--spheres", few, "-o", folder, "--quick", "--frames", "2", "--json"}, options);
    ASSERT_TRUE(succeeded(result));
    const json written = json::parse(bytes_of(folder / "report.json"));
    EXPECT_EQ(written, json::parse(result.standard_output));
    EXPECT_EQ(written["scene"], "few");
    std::map<std::string, int> ways;
    for (const json& way : written["sphere_study"]["ways"]) {
        ++ways[way["part"]];
        EXPECT_EQ(way["set"], "few");
        EXPECT_EQ(way["spheres"], 3);
        EXPECT_GT(way["ms_median"], 0);
    }
    EXPECT_EQ(ways, (std::map<std::string, int>{
                        {"visibility", 6}, {"light", 8}, {"maps", 8}, {"layers", 2}, {"peeling", 12}}));
    ASSERT_EQ(written["sphere_study"]["checks"].size(), 2U);
    for (const json& check : written["sphere_study"]["checks"]) {
        EXPECT_GT(check["pixels"], 1000);
        EXPECT_LE(check["largest_codes"], 1);
        EXPECT_EQ(check["over_a_sixteenth"], 0);
    }
    // What stopping early leaves out is at most half the tolerance of 8, in the codes that it is meant for.
    for (const json& way : written["sphere_study"]["ways"]) {
        if (way["way"] == "t = 8" || way["way"] == "dual, t = 8" || way["way"] == "lists, t = 8") {
            EXPECT_LE(way["beside"]["srgb_codes_left"], 4);
        }
    }
    EXPECT_EQ(written["effects"]["transparency of few"]["points"].size(), 12U);
    const json& occlusion = written["effects"]["occlusion of few"]["points"];
    ASSERT_EQ(occlusion.size(), 4U);
    EXPECT_LT(occlusion[3]["relative_rms"], occlusion[0]["relative_rms"]);
    const json& halos = written["effects"]["halos of few"]["points"];
    ASSERT_EQ(halos.size(), 5U);
    EXPECT_LT(halos[4]["relative_rms"], 0.01);
    EXPECT_EQ(written["effects"]["edges of few"]["points"].size(), 6U);
    EXPECT_EQ(written["effects"]["detail of few"]["points"].size(), 5U);
    EXPECT_NE(bytes_of(folder / "report.html").find("<svg"), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 3);
}

TEST_F(ReportTest, SphereSetsThatAreNotThereLeaveNothingBehind) {
    const fs::path folder = scratch_ / "report";
    EXPECT_TRUE(
        failed_naming(run_matchlight({"report", "--spheres", scratch_ / "none.ply", "-o", folder}), {"none.ply"}));
    EXPECT_FALSE(fs::exists(folder));
    EXPECT_TRUE(refused_call(run_matchlight({"report", scene_, "--spheres", "C1", "-o", folder})));
    EXPECT_TRUE(refused_call(run_matchlight({"report", scene_, "--frames", "3", "-o", folder})));
}

}  // namespace
}  // namespace matchlight::test
