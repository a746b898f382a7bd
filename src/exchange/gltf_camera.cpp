// One buffer of floats: key times, places, turns, the corners of a quad.
#include "exchange/gltf_camera.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base64.h"
#include "core/version.h"

namespace matchlight {
namespace {

using nlohmann::json;

// Numbers of the standard (Khronos, glTF 2.0, 3.6.2 and 3.7.2).
constexpr int component_float = 5126;
constexpr int mode_triangle_fan = 6;
constexpr int target_vertices = 34962;
constexpr std::uint32_t magic_gltf = 0x46546C67, chunk_json = 0x4E4F534A, chunk_binary = 0x004E4942;

static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

class Buffer {
public:
    /// Adds an accessor of floats; returns its index.
    int add(const std::vector<float>& values, int components, const char* type, bool bounds, int target = 0) {
        const std::size_t bytes = values.size() * sizeof(float);
        json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}};
        if (target != 0) view["target"] = target;
        views_.push_back(std::move(view));
        const std::size_t at = bytes_.size();
        bytes_.resize(at + bytes);
        std::memcpy(bytes_.data() + at, values.data(), bytes);
        json accessor{{"bufferView", views_.size() - 1},
                      {"componentType", component_float},
                      {"count", values.size() / static_cast<std::size_t>(components)},
                      {"type", type}};
        if (bounds) {
            for (int c = 0; c < components; ++c) {
                float low = values[static_cast<std::size_t>(c)], high = low;
                for (std::size_t i = static_cast<std::size_t>(c); i < values.size();
                     i += static_cast<std::size_t>(components)) {
                    low = std::min(low, values[i]);
                    high = std::max(high, values[i]);
                }
                accessor["min"].push_back(low);
                accessor["max"].push_back(high);
            }
        }
        accessors_.push_back(std::move(accessor));
        return static_cast<int>(accessors_.size()) - 1;
    }

    const std::vector<std::uint8_t>& bytes() const { return bytes_; }
    const json& views() const { return views_; }
    const json& accessors() const { return accessors_; }

private:
    std::vector<std::uint8_t> bytes_;
    json views_ = json::array(), accessors_ = json::array();
};

json place_json(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}

json turn_json(const Eigen::Quaterniond& q) {
    return {q.x(), q.y(), q.z(), q.w()};
}

struct Keys {
    std::vector<float> times_s, places_m, turns;
    json without_pose = json::array();
};

Keys keys_of(const CameraTrack& track) {
    Keys keys;
    Eigen::Quaterniond before = Eigen::Quaterniond::Identity();
    // glTF's time starts at 0: footage whose time stamps start before it is moved.
    const double early_s = std::min(0.0, track.frames.front().time_s);
    for (const SolvedFrame& frame : track.frames) {
        if (!frame.camera_from_world) {
            keys.without_pose.push_back(frame.frame);
            continue;
        }
        const RigidTransform pose = in_y_up_world(world_from_gl_camera(*frame.camera_from_world));
        Eigen::Quaterniond turn(pose.rotation());
        if (turn.dot(before) < 0) turn.coeffs() *= -1;  // q and −q are one turn: players take the way between signs
        before = turn;
        keys.times_s.push_back(static_cast<float>(frame.time_s - early_s));
        for (const double v : pose.translation()) keys.places_m.push_back(static_cast<float>(v));
        for (const double v : turn.coeffs()) keys.turns.push_back(static_cast<float>(v));
    }
    return keys;
}

json document(const CameraTrack& track, Buffer& buffer) {
    const Keys keys = keys_of(track);
    const PinholePicture& picture = track.pinhole;
    json gltf{{"asset",
               {{"version", "2.0"},
                {"generator", fmt::format("matchlight {}", version)},
                {"extras", {{"source", track.source}, {"fps", track.fps}}}}},
              {"scene", 0}};
    gltf["cameras"] = json::array({{{"name", "camera"},
                                    {"type", "perspective"},
                                    {"perspective",
                                     {{"yfov", 2 * std::atan2(picture.height / 2.0, picture.fy)},
                                      {"aspectRatio", picture.width / picture.fx * picture.fy / picture.height},
                                      {"znear", 0.01}}}}});  // a centimetre: nearer than any lens focuses

    const int times = buffer.add(keys.times_s, 1, "SCALAR", true);
    const int places = buffer.add(keys.places_m, 3, "VEC3", false);
    const int turns = buffer.add(keys.turns, 4, "VEC4", false);
    gltf["animations"] = json::array({{{"name", "camera"},
                                       {"channels",
                                        {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                                         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "rotation"}}}}}},
                                       {"samplers",
                                        {{{"input", times}, {"output", places}, {"interpolation", "LINEAR"}},
                                         {{"input", times}, {"output", turns}, {"interpolation", "LINEAR"}}}}}});

    const auto first = std::ranges::find_if(
        track.frames, [](const SolvedFrame& frame) { return frame.camera_from_world.has_value(); });
    const RigidTransform start = in_y_up_world(world_from_gl_camera(*first->camera_from_world));
    json camera{{"name", "camera"},
                {"camera", 0},
                {"translation", place_json(start.translation())},
                {"rotation", turn_json(Eigen::Quaterniond(start.rotation()))}};
    if (!keys.without_pose.empty()) camera["extras"] = {{"frames_without_pose", keys.without_pose}};
    gltf["nodes"] = json::array({camera});
    json roots = json::array({0});
    if (!track.rig.empty()) {
        const int corners = buffer.add({-0.5f, -0.5f, 0, 0.5f, -0.5f, 0, 0.5f, 0.5f, 0, -0.5f, 0.5f, 0}, 3, "VEC3",
                                       true, target_vertices);
        gltf["materials"] = json::array({{{"name", "tag"}, {"doubleSided", true}}});
        const json fan{{"attributes", {{"POSITION", corners}}}, {"mode", mode_triangle_fan}, {"material", 0}};
        gltf["meshes"] = json::array({{{"name", "tag"}, {"primitives", json::array({fan})}}});
    }
    for (const SolvedTag& tag : track.rig) {
        const RigidTransform pose = in_y_up_world(tag.world_from_tag);
        roots.push_back(gltf["nodes"].size());
        gltf["nodes"].push_back({{"name", fmt::format("tag_{}", tag.id)},
                                 {"mesh", 0},
                                 {"translation", place_json(pose.translation())},
                                 {"rotation", turn_json(Eigen::Quaterniond(pose.rotation()))},
                                 {"scale", {tag.size_m, tag.size_m, tag.size_m}}});
    }
    gltf["scenes"] = json::array({{{"name", "matchlight"}, {"nodes", roots}}});
    gltf["bufferViews"] = buffer.views();
    gltf["accessors"] = buffer.accessors();
    gltf["buffers"] = json::array({{{"byteLength", buffer.bytes().size()}}});
    return gltf;
}

void append(std::string& bytes, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 255u);
}

}  // namespace

std::string gltf_camera_text(const CameraTrack& track) {
    Buffer buffer;
    json gltf = document(track, buffer);
    gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(buffer.bytes());
    return gltf.dump(1) + "\n";
}

std::string glb_camera_bytes(const CameraTrack& track) {
    Buffer buffer;
    std::string text = document(track, buffer).dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');  // chunks end on four bytes; floats do anyway
    const auto json_bytes = static_cast<std::uint32_t>(text.size());
    const auto binary_bytes = static_cast<std::uint32_t>(buffer.bytes().size());
    std::string bytes;
    append(bytes, magic_gltf);
    append(bytes, 2);
    append(bytes, 12 + 8 + json_bytes + 8 + binary_bytes);
    append(bytes, json_bytes);
    append(bytes, chunk_json);
    bytes += text;
    append(bytes, binary_bytes);
    append(bytes, chunk_binary);
    bytes.append(buffer.bytes().begin(), buffer.bytes().end());
    return bytes;
}

}  // namespace matchlight
