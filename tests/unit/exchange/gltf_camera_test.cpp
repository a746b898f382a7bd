// glTF and GLB read back by the standard's own rules.
#include "exchange/gltf_camera.h"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "made_solve.h"

namespace matchlight::test {
namespace {

using nlohmann::json;

std::string from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0;
    int held = 0;
    for (const char c : text) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<unsigned>(digits.find(c));
        held += 6;
        if (held >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 255u);
    }
    return bytes;
}

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
    std::uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, 4);
    return word;
}

struct Gltf {
    json document;
    std::string buffer;

    std::vector<double> floats(std::size_t accessor) const {
        const json& a = document.at("accessors").at(accessor);
        const json& view = document.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
        std::vector<float> values(view.at("byteLength").get<std::size_t>() / 4);
        std::memcpy(values.data(), buffer.data() + view.at("byteOffset").get<std::size_t>(), values.size() * 4);
        return {values.begin(), values.end()};
    }
};

Gltf read_text(const std::string& text) {
    Gltf gltf{json::parse(text), {}};
    const std::string uri = gltf.document["buffers"][0]["uri"];
    const std::string start = "data:application/octet-stream;base64,";
    EXPECT_TRUE(uri.starts_with(start));
    gltf.buffer = from_base64(uri.substr(start.size()));
    EXPECT_EQ(gltf.buffer.size(), gltf.document["buffers"][0]["byteLength"]);
    return gltf;
}

Gltf read_glb(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word_at(bytes, 4), 2u);
    EXPECT_EQ(word_at(bytes, 8), bytes.size());
    const std::size_t json_bytes = word_at(bytes, 12);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    EXPECT_EQ(json_bytes % 4, 0u);
    EXPECT_EQ(bytes.substr(20 + json_bytes + 4, 4), std::string("BIN\0", 4));
    return {json::parse(bytes.substr(20, json_bytes)), bytes.substr(28 + json_bytes)};
}

Eigen::Vector3d vector_of(const json& v) {
    return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

void expect_the_solves_projections(const Gltf& gltf, const CameraTrack& track) {
    const json& animation = gltf.document["animations"][0];
    ASSERT_EQ(animation["channels"][0]["target"]["path"], "translation");
    ASSERT_EQ(animation["channels"][1]["target"]["path"], "rotation");
    const std::vector<double> times = gltf.floats(animation["samplers"][0]["input"]);
    const std::vector<double> places = gltf.floats(animation["samplers"][0]["output"]);
    const std::vector<double> turns = gltf.floats(animation["samplers"][1]["output"]);
    ASSERT_EQ(times.size(), 8u);  // two frames have no pose
    ASSERT_EQ(turns.size(), 32u);
    const json& lens = gltf.document["cameras"][0]["perspective"];
    const double focal_y = track.pinhole.height / 2.0 / std::tan(lens["yfov"].get<double>() / 2);
    const double focal_x =
        track.pinhole.width / 2.0 / (lens["aspectRatio"].get<double>() * std::tan(lens["yfov"].get<double>() / 2));

    std::size_t key = 0;
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) continue;
        EXPECT_FLOAT_EQ(times[key], frame.time_s);
        const Eigen::Vector3d place(places[3 * key], places[3 * key + 1], places[3 * key + 2]);
        const Eigen::Quaterniond turn(turns[4 * key + 3], turns[4 * key], turns[4 * key + 1], turns[4 * key + 2]);
        EXPECT_NEAR(turn.norm(), 1, 1e-6);
        // The quads of the rig, placed by their nodes.
        for (std::size_t n = 1; n < gltf.document["nodes"].size(); ++n) {
            const json& node = gltf.document["nodes"][n];
            const json& r = node["rotation"];
            const Eigen::Quaterniond tag_turn(r[3], r[0], r[1], r[2]);
            const std::vector<double> quad =
                gltf.floats(gltf.document["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
            for (std::size_t i = 0; i < 4; ++i) {
                const Eigen::Vector3d model(quad[3 * i], quad[3 * i + 1], quad[3 * i + 2]);
                const Eigen::Vector3d y_up =
                    tag_turn * model.cwiseProduct(vector_of(node["scale"])) + vector_of(node["translation"]);
                const Eigen::Vector3d seen = turn.normalized().conjugate() * (y_up - place);
                const Eigen::Vector2d px((track.pinhole.width - 1) / 2.0 + focal_x * seen.x() / -seen.z(),
                                         (track.pinhole.height - 1) / 2.0 - focal_y * seen.y() / -seen.z());
                const Eigen::Vector2d expected = expected_px(track, frame, corners_of(track.rig)[4 * (n - 1) + i]);
                EXPECT_LT((px - expected).norm(), agreement_px) << "frame " << frame.frame;
            }
        }
        ++key;
    }
}

TEST(GltfCamera, ProjectsTheRigAsTheSolveDoes) {
    Solve solve = made_solve();
    solve.camera.cx = 639.5;  // glTF's frusta are symmetric; fx ≠ fy it holds by the aspect
    solve.camera.cy = 359.5;
    const CameraTrack track = track_of(solve);
    expect_the_solves_projections(read_text(gltf_camera_text(track)), track);
    expect_the_solves_projections(read_glb(glb_camera_bytes(track)), track);
}

TEST(GltfCamera, NamesFramesWithoutAPose) {
    const Gltf gltf = read_text(gltf_camera_text(track_of(made_solve())));
    EXPECT_EQ(gltf.document["nodes"][0]["extras"]["frames_without_pose"], json::array({4, 5}));
    EXPECT_EQ(gltf.document["nodes"][2]["name"], "tag_7");
    EXPECT_EQ(gltf.document["scenes"][0]["nodes"], json::array({0, 1, 2}));
}

TEST(GltfCamera, TurnsTakeTheShortWay) {
    const CameraTrack track = track_of(made_solve());
    const Gltf gltf = read_text(gltf_camera_text(track));
    const std::vector<double> turns = gltf.floats(gltf.document["animations"][0]["samplers"][1]["output"]);
    for (std::size_t i = 4; i < turns.size(); i += 4) {
        double dot = 0;
        for (std::size_t c = 0; c < 4; ++c) dot += turns[i + c] * turns[i - 4 + c];
        EXPECT_GE(dot, 0);
    }
}

TEST(GltfCamera, TimeStartsAtNothingLessThanZero) {
    Solve solve = made_solve();
    for (SolvedFrame& frame : solve.frames) frame.time_s -= 0.25;
    const Gltf gltf = read_text(gltf_camera_text(track_of(solve)));
    const std::vector<double> times = gltf.floats(gltf.document["animations"][0]["samplers"][0]["input"]);
    EXPECT_EQ(times.front(), 0);
    EXPECT_FLOAT_EQ(times.back(), 9 / 24.0);
}

TEST(GltfCamera, OneFrameAndNoTagsAreEnough) {
    Solve solve = made_solve();
    solve.frames.resize(1);
    solve.rig.clear();
    const Gltf gltf = read_text(gltf_camera_text(track_of(solve)));
    EXPECT_EQ(gltf.document["accessors"][0]["count"], 1);
    EXPECT_FALSE(gltf.document.contains("meshes"));  // an empty list would not be valid
}

}  // namespace
}  // namespace matchlight::test
