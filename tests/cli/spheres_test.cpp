// matchlight spheres: sets made, told about and converted, and files that are not what they should be.
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "run_matchlight.h"

namespace matchlight::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class SpheresCommand : public CommandTest {
protected:
    std::string path(const std::string& name) const { return (scratch_ / name).string(); }
    RunResult info(const std::string& name, const std::vector<std::string>& more = {},
                   const RunOptions& options = {}) const {
        std::vector<std::string> call{"spheres", "info", path(name)};
        call.insert(call.end(), more.begin(), more.end());
        return run_matchlight(call, options);
    }
};

TEST_F(SpheresCommand, MakesTellsAndConverts) {
    EXPECT_TRUE(succeeded(run_matchlight({"spheres", "generate", "C2", "-o", path("a.ply"), "--count", "2000"})));
    const RunResult told = info("a.ply", {"--json"});
    EXPECT_TRUE(succeeded(told));
    const json facts = json::parse(told.standard_output);
    EXPECT_EQ(facts["count"], 2000);
    EXPECT_EQ(facts["memory_bytes"], 32000);
    EXPECT_EQ(facts["columns"], json({"x", "y", "z", "radius"}));
    EXPECT_EQ(facts["radius"]["least"], facts["radius"]["greatest"]);
    EXPECT_LT(facts["box"]["to"][0], 0.6);
    EXPECT_TRUE(succeeded(run_matchlight({"spheres", "generate", "C2", "-o", path("b.ply"), "--count", "2000"})));
    EXPECT_EQ(bytes_of(path("a.ply")), bytes_of(path("b.ply")));
    EXPECT_TRUE(succeeded(run_matchlight(
        {"spheres", "generate", "C2", "-o", path("b.ply"), "--count", "2000", "--seed", "2", "--overwrite"})));
    EXPECT_NE(bytes_of(path("a.ply")), bytes_of(path("b.ply")));

    const std::vector<std::string> mapped = {"--color-column", "z", "--color-map", "grey", "--opacity", "0.5"};
    std::vector<std::string> call{"spheres", "convert", path("a.ply"), "-o", path("a.csv")};
    call.insert(call.end(), mapped.begin(), mapped.end());
    EXPECT_TRUE(succeeded(run_matchlight(call)));
    EXPECT_THAT(bytes_of(path("a.csv")), HasSubstr("x,y,z,radius,red,green,blue,opacity\n"));
    EXPECT_TRUE(json::parse(info("a.csv", {"--json"}).standard_output)["blends"]);
    // Straight there and around are the same.
    EXPECT_TRUE(succeeded(run_matchlight({"spheres", "convert", path("a.ply"), "-o", path("a.xyz")})));
    EXPECT_TRUE(succeeded(run_matchlight({"spheres", "convert", path("a.xyz"), "-o", path("c.ply")})));
    EXPECT_EQ(bytes_of(path("a.ply")), bytes_of(path("c.ply")));
}

TEST_F(SpheresCommand, BadFilesGetOneLine) {
    const std::string names = "x,y,z,radius\n";
    const std::vector<std::pair<std::string, std::vector<std::string>>> rows = {
        {names + "0,0,0,1\n0,0,0,0\n", {"bad.csv:3", "radius 0"}},
        {names + "0,0,0,-2\n", {"bad.csv:2", "radius -2"}},
        {names + "0,0,0,nan\n", {"bad.csv:2", "radius nan"}},
        {names + "0,0\n", {"bad.csv:2", "2 of 4 columns"}},
        {"a,b\n1,2\n", {"bad.csv:1", "x, y and z"}},
        {"x,y,z\n1,2,3\n", {"bad.csv", "how large"}},
        {"", {"bad.csv", "is empty"}},
    };
    for (const auto& [text, words] : rows) {
        scratch_.write("bad.csv", text);
        EXPECT_TRUE(failed_naming(info("bad.csv"), words)) << text;
        const RunResult converted = run_matchlight({"spheres", "convert", path("bad.csv"), "-o", path("out.ply")});
        EXPECT_TRUE(failed_naming(converted, words)) << text;
        EXPECT_TRUE(nothing_left_of(path("out.ply")));
    }
    scratch_.write("bad.csv", names + "0,0,0,1\n");
    EXPECT_TRUE(failed_naming(info("bad.csv", {"--color-column", "radios"}), {"radios", "did you mean 'radius'?"}));
    EXPECT_TRUE(failed_naming(info("none.xyz"), {"none.xyz", "no such file"}));
    scratch_.write("lie.xyz", "1000000000\n\nO 0 0 0\n");
    const RunResult lie = info("lie.xyz");
    EXPECT_TRUE(failed_naming(lie, {"lie.xyz:1", "1000000000 atoms"}));
    EXPECT_LT(lie.peak_memory_bytes, 400 << 20);  // nothing was taken for them; the program alone has about 150 MiB
    scratch_.write("lie.ply",
                   "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n"
                   "property float y\nproperty float z\nproperty float radius\nend_header\n1234");
    EXPECT_TRUE(failed_naming(info("lie.ply"), {"lie.ply", "9 vertices"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"spheres", "generate", "C9", "-o", path("c.ply")}), {"C9", "C1"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"spheres", "generate", "C1", "-o", path("c.abc")}), {"c.abc", ".ply"}));
    EXPECT_TRUE(refused_call(run_matchlight({"spheres", "info", path("bad.csv"), "--color-map", "rainbow"})));
}

TEST_F(SpheresCommand, FullDisksLeaveNothing) {
    RunOptions options;
    options.file_size_limit_bytes = 100'000;
    const RunResult result =
        run_matchlight({"spheres", "generate", "C1", "-o", path("full.ply"), "--count", "100000"}, options);
    EXPECT_TRUE(failed_naming(result, {"full.ply"}));
    EXPECT_TRUE(nothing_left_of(path("full.ply")));
    EXPECT_TRUE(succeeded(run_matchlight({"spheres", "generate", "C1", "-o", path("a.ply"), "--count", "9"})));
    EXPECT_TRUE(failed_naming(run_matchlight({"spheres", "generate", "C1", "-o", path("a.ply")}), {"exists already"}));
    EXPECT_TRUE(failed_naming(run_matchlight({"spheres", "convert", path("a.ply"), "-o", path("a.ply"), "--overwrite"}),
                              {"the output is the input"}));
}

TEST_F(SpheresCommand, WhatCanBeReadInSpiteIsCounted) {
    scratch_.write("größe -1 .csv", "x,y,z,radius\r\n0.5,0,0,1.5\r\nnan,0,0,1\r\n");
    RunOptions options;
    options.environment["LC_ALL"] = "de_DE.UTF-8";  // decimal commas, where the machine has such a locale
    const RunResult result = info("größe -1 .csv", {"--json"}, options);
    EXPECT_TRUE(succeeded(result));
    EXPECT_TRUE(warned_of(result, {"1 spheres whose place is not finite"}));
    EXPECT_EQ(json::parse(result.standard_output)["radius"]["least"], 1.5);
    scratch_.write("none.xyz", "0\n\n");
    const RunResult none = info("none.xyz");
    EXPECT_TRUE(succeeded(none));
    EXPECT_TRUE(warned_of(none, {"none.xyz", "it holds no spheres"}));
    scratch_.write("odd.xyz", "2\n\nXq 0 0 0\nO 0 0 3\n");
    EXPECT_TRUE(warned_of(info("odd.xyz"), {"odd.xyz", "1 atoms of no known element"}));
}

}  // namespace
}  // namespace matchlight::test
