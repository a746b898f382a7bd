// The render graph: order, regions, reuse, and what it leaves out.
#include "render/graph.h"

#include <gmock/gmock.h>

#include "gl/shader_library.h"
#include "gl_fixture.h"

namespace matchlight {
namespace {

using testing::ElementsAre;

class RenderGraphTest : public GlTest {
protected:
    void SetUp() override { graph_.begin_frame(640, 360); }

    /// A pass that writes one texture and notes when it was drawn.
    GraphTexture add(const std::string& name, std::vector<PassInput> reads, int scale = 1,
                     std::optional<Region> region = {}) {
        return graph_.add_pass({.name = name,
                                .reads = std::move(reads),
                                .writes = {GL_RGBA16F},
                                .scale = scale,
                                .region = region,
                                .draw = [this, name](PassRun& run) {
                                    drawn_.push_back(name);
                                    textures_[name] = &run.written();
                                }})[0];
    }
    PassReport report_of(const std::string& name) const {
        for (const PassReport& report : graph_.reports()) {
            if (report.name == name) return report;
        }
        ADD_FAILURE() << "no report of " << name;
        return {};
    }

    RenderGraph graph_;
    std::vector<std::string> drawn_;
    std::map<std::string, const Texture2D*> textures_;
};

TEST_F(RenderGraphTest, DrawsWhatTheOutputNeedsInOrder) {
    const GraphTexture a = add("a", {}, 1, Region{0, 0, 64, 64});
    const GraphTexture unwanted = add("unwanted", {{a}});
    const GraphTexture b = add("b", {{a}});
    const GraphTexture c = add("c", {{b}, {a}});
    EXPECT_TRUE(unwanted);
    graph_.output(c);
    graph_.run();
    EXPECT_THAT(drawn_, ElementsAre("a", "b", "c"));
    EXPECT_FALSE(report_of("unwanted").drawn);
    EXPECT_EQ(report_of("unwanted").why, "nothing needs it");
}

TEST_F(RenderGraphTest, ASecondRunDrawsOnlyWhatWasAdded) {
    const GraphTexture a = add("a", {}, 1, Region{0, 0, 64, 64});
    graph_.output(a);
    graph_.run();
    graph_.output(add("b", {{a}}));
    graph_.run();
    EXPECT_THAT(drawn_, ElementsAre("a", "b"));
}

TEST_F(RenderGraphTest, APassCoversWhatItsInputsReach) {
    const GraphTexture source = add("source", {}, 1, Region{100, 50, 30, 20});
    // 30 pixels from 100 on are texels 25 to 32 of four pixels; ten more either side.
    EXPECT_EQ(graph_.shape(add("spread", {{source, 10}}, 4)).region, (Region{15, 2, 28, 26}));
    // At the frame's edge the region ends, and with two inputs it holds both.
    const GraphTexture corner = add("corner", {}, 1, Region{630, 350, 50, 50});
    EXPECT_EQ(graph_.shape(corner).region, (Region{630, 350, 10, 10}));
    EXPECT_EQ(graph_.shape(add("both", {{source}, {corner, 5}})).region, (Region{100, 50, 540, 310}));
    EXPECT_EQ(graph_.shape(add("up again", {{source, 2}}, 2)).region, (Region{48, 23, 19, 14}));
}

TEST_F(RenderGraphTest, NothingReachedIsLeftOutDownstream) {
    const GraphTexture nothing = add("source", {}, 1, Region{700, 0, 10, 10});
    EXPECT_FALSE(nothing);
    const GraphTexture spread = add("spread", {{nothing, 5}});
    EXPECT_FALSE(spread);
    graph_.output(spread);
    graph_.run();
    EXPECT_TRUE(drawn_.empty());
    EXPECT_EQ(report_of("spread").why, "its inputs are empty");
}

TEST_F(RenderGraphTest, TexturesAreReusedAfterTheirLastReader) {
    const GraphTexture a = add("a", {}, 1, Region{0, 0, 60, 60});
    const GraphTexture b = add("b", {{a}});
    const GraphTexture c = add("c", {{b}});
    const GraphTexture d = add("d", {{c}, {b}});
    graph_.output(d);
    graph_.run();
    EXPECT_EQ(textures_["c"], textures_["a"]) << "nothing reads a after b";
    EXPECT_NE(textures_["d"], textures_["b"]) << "d reads b";
    EXPECT_NE(textures_["b"], textures_["a"]);
}

TEST_F(RenderGraphTest, OutputsOutliveTheRun) {
    const GraphTexture kept = graph_.add_pass(
        {.name = "kept", .writes = {GL_RGBA32F}, .region = Region{0, 0, 8, 8}, .draw = [](PassRun& run) {
             run.target().clear_color(0, 3, 2, 1, 0);
         }})[0];
    graph_.output(kept);
    graph_.output(add("other", {}, 1, Region{0, 0, 8, 8}));
    graph_.run();
    EXPECT_EQ((graph_.texture(kept).read<float>({0, 0, 1, 1}, 4).at(0, 0, 0)), 3);
}

TEST_F(RenderGraphTest, WhatAPassLeavesCanBeWatched) {
    graph_.watch("a");
    const GraphTexture a = graph_.add_pass(
        {.name = "a", .writes = {GL_RGBA16F}, .scale = 2, .region = Region{10, 20, 8, 4}, .draw = [](PassRun& run) {
             run.target().clear_color(0, 0.25f, 0.5f, 0.75f, 1);
         }})[0];
    graph_.output(add("b", {{a}}));
    graph_.run();
    ASSERT_TRUE(graph_.watched());
    const WatchedTexture& watched = *graph_.watched();
    EXPECT_EQ(watched.pass, "a");
    EXPECT_EQ(watched.shape.region, (Region{10, 20, 8, 4}));
    ASSERT_EQ(watched.texels.width(), 8);
    ASSERT_EQ(watched.texels.height(), 4);
    EXPECT_EQ(watched.texels.at(7, 3, 2), 0.75f);
    graph_.begin_frame(640, 360);
    EXPECT_FALSE(graph_.watched());
}

TEST_F(RenderGraphTest, WhatIsMadeOnceIsKept) {
    for (int frame = 0; frame < 3; ++frame) {
        graph_.begin_frame(640, 360);
        const GraphTexture map = graph_.import(nullptr, {.format = GL_NONE, .region = {}});
        graph_.add_pass(
            {.name = "map", .provides = {map}, .once = true, .draw = [this](PassRun&) { drawn_.emplace_back("map"); }});
        graph_.output(add("frame", {{map}}, 1, Region{0, 0, 8, 8}));
        graph_.run();
        EXPECT_EQ(report_of("map").drawn, frame == 0);
    }
    EXPECT_THAT(drawn_, ElementsAre("map", "frame", "frame", "frame"));
    EXPECT_THAT(report_of("map").why, testing::HasSubstr("once"));
    graph_.forget_kept("map");
    graph_.begin_frame(640, 360);
    const GraphTexture map = graph_.import(nullptr, {.format = GL_NONE, .region = {}});
    graph_.add_pass(
        {.name = "map", .provides = {map}, .once = true, .draw = [this](PassRun&) { drawn_.emplace_back("again"); }});
    graph_.output(map);
    graph_.run();
    EXPECT_EQ(drawn_.back(), "again");
}

class ConditionTest : public RenderGraphTest {
protected:
    /// Meets the condition where `light` is above zero, then draws a pass that needs it; returns that pass's red.
    float draw(float light) {
        graph_.begin_frame(64, 64);
        const GraphTexture source = graph_.add_pass(
            {.name = "source", .writes = {GL_RGBA32F}, .region = Region{0, 0, 64, 64}, .draw = [light](PassRun& run) {
                 run.target().clear_color(0, light, 0, 0, 0);
             }})[0];
        const GraphTexture bright =
            graph_.add_pass({.name = "bright",
                             .reads = {{source}},
                             .writes = {GL_RGBA32F},
                             .sets = &condition_,
                             .draw = [this, source](PassRun& run) {
                                 Program& program = shaders_.full_screen("../tests/gpu/shaders/find_light.frag");
                                 program.use();
                                 run.bind(program, "source", 0, source);
                                 run.draw(program);
                             }})[0];
        const GraphTexture spread =
            graph_.add_pass({.name = "spread",
                             .reads = {{bright, 3}},
                             .writes = {GL_RGBA32F},
                             .needs = &condition_,
                             .draw = [this, bright](PassRun& run) {
                                 run.target().clear_color(0, -1, 0, 0, 0);
                                 Program& program = shaders_.full_screen("../tests/gpu/shaders/find_light.frag");
                                 program.use();
                                 run.bind(program, "source", 0, bright);
                                 run.draw(program);
                             }})[0];
        graph_.output(spread);
        graph_.run();
        return graph_.texture(spread).read<float>({5, 5, 1, 1}, 4).at(0, 0, 0);
    }

    ShaderLibrary shaders_{std::filesystem::path(MATCHLIGHT_SOURCE_DIR) / "shaders"};
    GpuCondition condition_{"no light"};
};

TEST_F(ConditionTest, TheGpuSkipsWhatItRulesOut) {
    EXPECT_EQ(draw(0.5F), 0.5F);
    EXPECT_TRUE(condition_.is_met());
    EXPECT_TRUE(report_of("spread").drawn);
    EXPECT_EQ(draw(0), -1) << "the pass's triangle must not have been drawn";
    EXPECT_FALSE(condition_.is_met()) << "the next frame starts unmet";
    EXPECT_FALSE(report_of("spread").drawn);
    EXPECT_EQ(report_of("spread").why, "no light");
    EXPECT_EQ(draw(2), 2);
}

TEST_F(RenderGraphTest, TimedRunsReportMillisecondsAndBytes) {
    const GraphTexture a = add("a", {}, 1, Region{0, 0, 100, 10});
    const GraphTexture b = add("b", {{a}}, 2);
    graph_.output(b);
    graph_.run(true);
    const PassReport report = report_of("b");
    EXPECT_EQ(report.bytes, 100 * 10 * 8 + 50 * 5 * 8);
    EXPECT_GT(report.ms, 0);
    EXPECT_GT(report.bandwidth_bounds, 0);
    EXPECT_EQ(report.frame_pixels, (Region{0, 0, 100, 10}));
}

}  // namespace
}  // namespace matchlight
