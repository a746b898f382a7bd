// matchlight compare, as a user runs it: known figures, every kind of input, and what bad input gets.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path pair_folder = fs::path(MATCHLIGHT_TEST_DATA) / "compare";
const fs::path sample_folder = fs::path(MATCHLIGHT_SOURCE_DIR) / "samples" / "table";

class Compare : public CommandTest {
protected:
    const std::string truth_ = pair_folder / "truth.png";
    const std::string plate_ = pair_folder / "plate.png";
    const json expected_ = json::parse(std::ifstream(pair_folder / "expected.json"));

    static json compare_json(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"compare", "--json"});
        const RunResult result = run_matchlight(arguments);
        EXPECT_TRUE(succeeded(result));
        return json::parse(result.standard_output, nullptr, false);
    }
    void copy_as(const std::string& picture, const std::string& name) const { fs::copy_file(picture, scratch_ / name); }
    std::string in_scratch(const std::string& name) const { return (scratch_ / name).string(); }
};

TEST_F(Compare, TwoPicturesGiveTheKnownFigures) {
    const json result = compare_json({truth_, plate_});
    ASSERT_EQ(result["frames"].size(), 1u);
    EXPECT_NEAR(result["mean"]["flip"].get<double>(), expected_["flip"][0]["mean"].get<double>(), 1e-5);
    EXPECT_NEAR(result["mean"]["psnr_db"].get<double>(), expected_["psnr_db"].get<double>(), 1e-9);
    EXPECT_EQ(result["frames"][0]["flip"], result["mean"]["flip"]);
    EXPECT_FALSE(result["mean"].contains("inside"));
}

TEST_F(Compare, PixelsPerDegreeAreHonoured) {
    const json result = compare_json({truth_, plate_, "--ppd", "40"});
    EXPECT_NEAR(result["mean"]["flip"].get<double>(), expected_["flip"][1]["mean"].get<double>(), 1e-5);
}

TEST_F(Compare, APictureWithItselfDoesNotDiffer) {
    const json result = compare_json({truth_, truth_});
    EXPECT_EQ(result["mean"]["flip"], 0);
    EXPECT_EQ(result["mean"]["psnr_db"], 99);
    EXPECT_NEAR(result["mean"]["ssim"].get<double>(), 1, 1e-12);
}

TEST_F(Compare, RegionIsMeasuredApart) {
    const json result = compare_json({truth_, plate_, "--region", plate_});
    EXPECT_NEAR(result["mean"]["inside"]["share"].get<double>(), expected_["region"]["share"].get<double>(), 1e-12);
    EXPECT_NEAR(result["mean"]["inside"]["flip"].get<double>(), expected_["region"]["flip"].get<double>(), 1e-5);
    EXPECT_NEAR(result["mean"]["inside"]["psnr_db"].get<double>(), expected_["region"]["psnr_db"].get<double>(), 1e-9);
    EXPECT_EQ(result["mean"]["outside"]["plate_psnr_db"], 99);  // the test is the plate
}

TEST_F(Compare, MaskSeparatesItsSides) {
    // The whole picture as mask: inside equals whole, outside is empty.
    const json all = compare_json({truth_, plate_, "--mask", truth_});
    EXPECT_EQ(all["mean"]["inside"]["share"], 1);
    EXPECT_EQ(all["mean"]["inside"]["flip"], all["mean"]["flip"]);
    EXPECT_EQ(all["mean"]["inside"]["psnr_db"], all["mean"]["psnr_db"]);
    EXPECT_TRUE(all["mean"]["outside"]["flip"].is_null());
}

TEST_F(Compare, TextNamesFramesAndMean) {
    const RunResult result = run_matchlight({"compare", truth_, plate_});
    ASSERT_TRUE(succeeded(result));
    for (const char* word : {"FLIP", "PSNR", "SSIM", "mean", "0.55047", "12.49"}) {
        EXPECT_NE(result.standard_output.find(word), std::string::npos) << word << "\n" << result.standard_output;
    }
}

TEST_F(Compare, SequencesArePairedByNumber) {
    for (const int number : {3, 4, 5}) copy_as(number == 4 ? plate_ : truth_, "a_00" + std::to_string(number) + ".png");
    for (const int number : {4, 5}) copy_as(truth_, "b_" + std::to_string(number) + ".png");
    const RunResult result = run_matchlight({"compare", in_scratch("a_%03d.png"), in_scratch("b_%d.png"), "--json"});
    ASSERT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"b_%d.png", "1 frame", "no partner"}));
    const json frames = json::parse(result.standard_output)["frames"];
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0]["frame"], 4);
    EXPECT_GT(frames[0]["flip"].get<double>(), 0.5);
    EXPECT_EQ(frames[1]["frame"], 5);
    EXPECT_EQ(frames[1]["flip"], 0);

    // Frames that lack a partner are an error when strict, and no matter when they are not asked for.
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("a_%03d.png"), in_scratch("b_%d.png"), "--strict"}),
                              {"b_%d.png", "no partner"}));
    const RunResult part =
        run_matchlight({"compare", in_scratch("a_%03d.png"), in_scratch("b_%d.png"), "--strict", "--frames", "5-9"});
    EXPECT_TRUE(succeeded(part));

    // Names that count from elsewhere.
    const json moved =
        compare_json({in_scratch("a_%03d.png"), in_scratch("b_%d.png"), "--first-reference", "3", "--first-test", "4"});
    EXPECT_EQ(moved["frames"][0]["frame"], 0);
    EXPECT_EQ(moved["frames"][0]["flip"], 0);  // a_003 and b_4
    EXPECT_GT(moved["frames"][1]["flip"].get<double>(), 0.5);
}

TEST_F(Compare, VideoAgainstSequence) {
    const json result = compare_json(
        {(sample_folder / "truth_%03d.png").string(), (sample_folder / "plate.mp4").string(), "--frames", "0-6", "-q"});
    ASSERT_EQ(result["frames"].size(), 2u);  // of the truth the sample holds frames 0, 6 and 11
    EXPECT_EQ(result["frames"][1]["frame"], 6);
    // The clip shows the table without the objects: those are most of the difference. Decoding costs a little beside
    // the uncompressed plate's 0.0869 and 0.0816.
    EXPECT_NEAR(result["frames"][0]["flip"].get<double>(), 0.0869, 0.03);
    EXPECT_NEAR(result["frames"][1]["flip"].get<double>(), 0.0816, 0.03);
}

TEST_F(Compare, VideoAgainstItselfDoesNotDiffer) {
    const std::string clip = sample_folder / "plate.mp4";
    const json result = compare_json({clip, clip, "--frames", "2-4"});
    ASSERT_EQ(result["frames"].size(), 3u);
    EXPECT_EQ(result["frames"][0]["frame"], 2);
    EXPECT_EQ(result["mean"]["flip"], 0);
}

TEST_F(Compare, LinearPicturesAreAlsoComparedAsLight) {
    const std::string probe = sample_folder / "probe.exr";
    const json result = compare_json({probe, probe});
    EXPECT_EQ(result["mean"]["relative_rms"], 0);
    EXPECT_EQ(result["mean"]["flip"], 0);
}

TEST_F(Compare, FlipMapIsWritten) {
    ASSERT_TRUE(succeeded(run_matchlight({"compare", truth_, plate_, "--flip-map", in_scratch("map.png")})));
    const std::string map = bytes_of(scratch_ / "map.png");
    EXPECT_EQ(map.substr(1, 3), "PNG");
    // Existing output is kept unless told otherwise.
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", truth_, plate_, "--flip-map", in_scratch("map.png")}),
                              {"map.png", "exists"}));
    EXPECT_TRUE(
        succeeded(run_matchlight({"compare", truth_, plate_, "--flip-map", in_scratch("map.png"), "--overwrite"})));
    EXPECT_EQ(bytes_of(scratch_ / "map.png"), map);

    copy_as(truth_, "a_0.png");
    copy_as(plate_, "a_1.png");
    const std::string sequence = in_scratch("a_%d.png");
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", sequence, sequence, "--flip-map", in_scratch("one.png")}),
                              {"one.png", "pattern"}));
    EXPECT_TRUE(succeeded(run_matchlight({"compare", sequence, sequence, "--flip-map", in_scratch("map_%02d.png")})));
    EXPECT_TRUE(fs::exists(scratch_ / "map_00.png"));
    EXPECT_TRUE(fs::exists(scratch_ / "map_01.png"));
}

TEST_F(Compare, FlipMapNeverReplacesAnInput) {
    copy_as(truth_, "truth.png");
    const std::string before = bytes_of(scratch_ / "truth.png");
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("truth.png"), plate_, "--flip-map",
                                              in_scratch("./truth.png"), "--overwrite"}),
                              {"truth.png", "input"}));
    EXPECT_EQ(bytes_of(scratch_ / "truth.png"), before);
}

TEST_F(Compare, BadInputsAreNamed) {
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", truth_, in_scratch("none.png")}), {"none.png", "no such"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("none.mp4"), truth_}), {"none.mp4"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight({"compare", truth_, in_scratch("none_%03d.png")}), {"none_%03d.png", "no file"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("no folder/a_%03d.png"), truth_}), {"no folder"}));
    scratch_.write("empty.png", "");
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", truth_, in_scratch("empty.png")}), {"empty.png"}));
    scratch_.write("noise.png", "this is no picture at all");
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("noise.png"), truth_}), {"noise.png"}));
    scratch_.write("noise.mp4", std::string(5000, 'x'));
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("noise.mp4"), truth_}), {"noise.mp4"}));
    const std::string other_size = sample_folder / "truth_000.png";
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", truth_, other_size}), {"truth_000.png", "640x360", "128x96"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight({"compare", truth_, plate_, "--mask", other_size}), {"truth_000.png", "640x360"}));
    EXPECT_TRUE(
        failed_naming(run_matchlight({"compare", truth_, plate_, "--region", in_scratch("none.png")}), {"none.png"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", truth_, plate_, "--flip-map", in_scratch("none/map.png")}),
                              {"map.png"}));

    copy_as(truth_, "a_1.png");
    copy_as(truth_, "b_2.png");
    EXPECT_TRUE(failed_naming(run_matchlight({"compare", in_scratch("a_%d.png"), in_scratch("b_%d.png")}),
                              {"b_%d.png", "in common"}));
    EXPECT_TRUE(failed_naming(
        run_matchlight({"compare", in_scratch("a_%d.png"), in_scratch("a_%d.png"), "--mask", in_scratch("b_%d.png")}),
        {"b_%d.png", "frame 1"}));
}

TEST_F(Compare, WrongCalls) {
    EXPECT_TRUE(refused_call(run_matchlight({"compare"})));
    EXPECT_TRUE(refused_call(run_matchlight({"compare", truth_})));
    EXPECT_TRUE(refused_call(run_matchlight({"compare", truth_, plate_, "--frames", "5-3"})));
    EXPECT_TRUE(refused_call(run_matchlight({"compare", truth_, plate_, "--ppd", "0"})));
    EXPECT_TRUE(refused_call(run_matchlight({"compare", truth_, plate_, "--ppd", "nan"})));
    EXPECT_TRUE(refused_call(run_matchlight({"compare", truth_, plate_, "--mask", truth_, "--region", plate_})));
}

class CompareSharedData : public SharedDataTest {};

TEST_F(CompareSharedData, AgreesWithTheMetricAuthorsTool) {
    const fs::path table = data_ / "table";
    const json expected = json::parse(std::ifstream(table / "flip_reference.json"))["mean_flip"];
    const std::string truth = table / "truth_%03d.png", plate = table / "plate_%03d.png";
    const RunResult result = run_matchlight({"compare", truth, plate, "--region", plate, "--json"});
    ASSERT_TRUE(succeeded(result));
    const json found = json::parse(result.standard_output);
    ASSERT_EQ(found["frames"].size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(found["frames"][i]["flip"].get<double>(), expected[i].get<double>(), 1e-4) << i;
    }
    EXPECT_NEAR(found["mean"]["inside"]["flip"].get<double>(), 0.4957, 1e-4);
}

}  // namespace
}  // namespace matchlight::test
