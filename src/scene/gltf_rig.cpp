// Reads nodes, skins, animations and what vertices hang on, checked key by key.
#include "scene/gltf_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/memory.h"

namespace matchlight {
namespace {

using nlohmann::json;

constexpr int float_type = 5126;

class RigReader {
public:
    RigReader(const GltfDocument& document, const GltfAccessors& accessors, Warnings& warnings)
        : document_(document), accessors_(accessors), warnings_(warnings) {}

    std::shared_ptr<const CheckedRig> read(const std::vector<LoadedPrimitive>& primitives) {
        read_nodes();
        read_skins();
        for (const LoadedPrimitive& loaded : primitives) read_primitive(loaded);
        for (std::size_t i = 0; i < document_.list("animations").size(); ++i) read_animation(i);
        find_moved();
        report();
        const bool any = !read_.rig.animations.empty() || !read_.primitives.empty();
        return any ? std::make_shared<const CheckedRig>(std::move(read_)) : nullptr;
    }

private:
    void read_nodes();
    void read_skins();
    void read_primitive(const LoadedPrimitive& loaded);
    void read_influences(const json& attributes, const std::string& where, CheckedPrimitive& to);
    void normalise_weights(CheckedPrimitive& to);
    void check_joints(const CheckedPrimitive& primitive, std::size_t mesh, const std::string& where) const;
    std::vector<Eigen::Vector3f> read_deltas(const json& target, const char* name, std::size_t vertex_count,
                                             const std::string& where);
    void read_animation(std::size_t number);
    std::optional<RigChannel> read_channel(const json& channel, const json& samplers, const std::string& where);
    void find_moved();
    void report();

    const json& array_of(const json& object, const char* key, const std::string& where) const {
        static const json none = json::array();
        const auto found = object.find(key);
        if (found == object.end()) return none;
        if (!found->is_array()) document_.fail(fmt::format("{}.{} is no array", where, key));
        return *found;
    }
    const json& object_in(const json& array, std::size_t index, const std::string& where) const {
        if (!array[index].is_object()) document_.fail(where + " is no object");
        return array[index];
    }
    /// How many morph targets a mesh has: as many as its first primitive.
    std::size_t target_count(std::size_t mesh) const {
        const json& primitives = document_.item("meshes", mesh).at("primitives");
        const std::string where = place_in("meshes", mesh);
        return primitives.empty() ? 0 : array_of(primitives[0], "targets", where).size();
    }
    std::vector<float> finite_floats(std::size_t accessor, const std::string& where) const {
        std::vector<float> values = accessors_.floats(accessor);
        if (!std::ranges::all_of(values, [](float value) { return std::isfinite(value); })) {
            document_.fail(where + " holds values that are not finite");
        }
        return values;
    }
    /// A float that can be used, counted where it could not.
    float repaired(float value) {
        if (std::isfinite(value)) return value;
        ++repaired_values_;
        return 0;
    }

    const GltfDocument& document_;
    const GltfAccessors& accessors_;
    Warnings& warnings_;
    CheckedRig read_;
    std::size_t repaired_values_ = 0;
    std::size_t repaired_rotations_ = 0;
    std::size_t weightless_vertices_ = 0;
    std::size_t unknown_channels_ = 0;
};

void RigReader::read_nodes() {
    ModelRig& rig = read_.rig;
    const std::size_t count = document_.list("nodes").size();
    rig.nodes.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string where = place_in("nodes", i);
        const json& source = document_.item("nodes", i);
        RigNode& node = rig.nodes[i];
        const auto numbers = [&](const char* key, std::size_t size) {
            const json given = document_.numbers_of(source, key, size, where);
            return given.is_null() ? std::vector<double>() : given.get<std::vector<double>>();
        };
        if (const auto given = numbers("translation", 3); !given.empty())
            node.rest.translation = {given[0], given[1], given[2]};
        if (const auto given = numbers("scale", 3); !given.empty()) node.rest.scale = {given[0], given[1], given[2]};
        if (const auto given = numbers("rotation", 4); !given.empty()) {
            const Eigen::Quaterniond rotation(given[3], given[0], given[1], given[2]);
            if (rotation.norm() > 0) {
                node.rest.rotation = rotation.normalized();
            } else {
                ++repaired_rotations_;
            }
        }
        if (const auto given = numbers("matrix", 16); !given.empty()) node.matrix = Eigen::Matrix4d(given.data());
        for (const json& child : array_of(source, "children", where)) {
            rig.nodes[child.get<std::size_t>()].parent = i;  // checked to be one, with one parent
        }
        if (const auto mesh = document_.index_of(source, "mesh", "meshes", where)) {
            const std::size_t targets = target_count(*mesh);
            const auto weights_of = [&](const json& object, const std::string& of) {
                const json given = document_.numbers_of(object, "weights", targets, of);
                return given.is_null() ? std::vector<double>() : given.get<std::vector<double>>();
            };
            node.rest.weights = weights_of(source, where);
            if (node.rest.weights.empty()) {
                node.rest.weights = weights_of(document_.item("meshes", *mesh), place_in("meshes", *mesh));
            }
            node.rest.weights.resize(targets, 0.0);
        }
        read_.skins.push_back(document_.index_of(source, "skin", "skins", where));
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!rig.nodes[i].parent) rig.parents_first.push_back(i);
    }
    // Below a node are those that come after it; the checks found no cycle.
    for (std::size_t i = 0; i < rig.parents_first.size(); ++i) {
        const std::size_t parent = rig.parents_first[i];
        const json& source = document_.item("nodes", parent);
        for (const json& child : array_of(source, "children", place_in("nodes", parent)))
            rig.parents_first.push_back(child.get<std::size_t>());
    }
}

void RigReader::read_skins() {
    for (std::size_t i = 0; i < document_.list("skins").size(); ++i) {
        const std::string where = place_in("skins", i);
        const json& source = document_.item("skins", i);
        RigSkin& skin = read_.rig.skins.emplace_back();
        for (const json& joint : array_of(source, "joints", where)) {
            skin.joints.push_back(*document_.index_of({{"joint", joint}}, "joint", "nodes", where));
        }
        if (skin.joints.empty()) document_.fail(where + " has no joints");
        skin.joint_from_vertex.assign(skin.joints.size(), Eigen::Matrix4d::Identity());
        const auto inverse_bind = document_.index_of(source, "inverseBindMatrices", "accessors", where);
        if (!inverse_bind) continue;  // then they are the identity
        const std::string matrices = where + ".inverseBindMatrices";
        const GltfAccessor& accessor = accessors_.accessors()[*inverse_bind];
        if (accessor.components != 16 || accessor.component_type != float_type) {
            document_.fail(matrices + " holds no matrices of floats");
        }
        if (accessor.count < skin.joints.size()) {
            document_.fail(
                fmt::format("{} has {} matrices for {} joints", matrices, accessor.count, skin.joints.size()));
        }
        const std::vector<float> values = finite_floats(*inverse_bind, matrices);
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            skin.joint_from_vertex[j] = Eigen::Map<const Eigen::Matrix4f>(values.data() + 16 * j).cast<double>();
        }
    }
}

void RigReader::read_primitive(const LoadedPrimitive& loaded) {
    const std::string where = fmt::format("meshes[{}].primitives[{}]", loaded.mesh, loaded.primitive);
    const json& source = document_.item("meshes", loaded.mesh).at("primitives").at(loaded.primitive);
    const json& attributes = source["attributes"];
    CheckedPrimitive read;
    read.vertex_count = accessors_.accessors()[*document_.index_of(attributes, "POSITION", "accessors", where)].count;
    read_influences(attributes, where, read);
    const json& targets = array_of(source, "targets", where);
    if (targets.size() != target_count(loaded.mesh)) {
        document_.fail(where + " has another number of morph targets than the first of its mesh");
    }
    constexpr std::size_t bytes_a_vertex = 2 * 3 * sizeof(Eigen::Vector3f);  // here, and with the mesh
    if (targets.size() > available_memory_bytes() / bytes_a_vertex / read.vertex_count) {
        document_.fail(fmt::format("{}: {} morph targets do not fit into memory", where, targets.size()));
    }
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const std::string target_where = fmt::format("{}.targets[{}]", where, i);
        const json& target = object_in(targets, i, target_where);
        read.targets.push_back({.positions = read_deltas(target, "POSITION", read.vertex_count, target_where),
                                .normals = read_deltas(target, "NORMAL", read.vertex_count, target_where),
                                .tangents = read_deltas(target, "TANGENT", read.vertex_count, target_where)});
    }
    if (read.influences > 0) check_joints(read, loaded.mesh, where);
    if (read.influences > 0 || !read.targets.empty()) read_.primitives.emplace(loaded.name, std::move(read));
}

void RigReader::read_influences(const json& attributes, const std::string& where, CheckedPrimitive& to) {
    constexpr std::size_t set_size = 4;
    struct Set {
        std::vector<float> joints, weights;
    };
    std::vector<Set> sets;
    for (std::size_t number = 0;; ++number) {
        const auto read = [&](const std::string& name, bool is_joint) {
            const auto accessor_number = document_.index_of(attributes, name.c_str(), "accessors", where);
            if (!accessor_number) return std::vector<float>();
            const GltfAccessor& accessor = accessors_.accessors()[*accessor_number];
            const bool is_unsigned = accessor.component_type == 5121 || accessor.component_type == 5123;
            if (accessor.components != static_cast<int>(set_size) || (is_joint && !is_unsigned)) {
                document_.fail(fmt::format("{}.{} is of a wrong type", where, name));
            }
            if (accessor.count != to.vertex_count) {
                document_.fail(
                    fmt::format("{}.{} has {} elements for {} vertices", where, name, accessor.count, to.vertex_count));
            }
            return accessors_.floats(*accessor_number);
        };
        Set set{read(fmt::format("JOINTS_{}", number), true), read(fmt::format("WEIGHTS_{}", number), false)};
        if (set.joints.empty() != set.weights.empty()) {
            document_.fail(fmt::format("{} has joints without weights, or weights without joints", where));
        }
        if (set.joints.empty()) break;
        sets.push_back(std::move(set));
    }
    to.influences = set_size * sets.size();
    for (std::size_t vertex = 0; vertex < to.vertex_count; ++vertex) {
        for (const Set& set : sets) {
            for (std::size_t i = set_size * vertex; i < set_size * (vertex + 1); ++i) {
                to.joints.push_back(static_cast<std::uint32_t>(set.joints[i]));
                to.weights.push_back(set.weights[i]);
            }
        }
    }
    normalise_weights(to);
}

/// Weights that are quantised add to about 1; those that say nothing give the vertex to its first joint.
void RigReader::normalise_weights(CheckedPrimitive& to) {
    for (std::size_t first = 0; first < to.weights.size(); first += to.influences) {
        const std::span<float> weights = std::span(to.weights).subspan(first, to.influences);
        double sum = 0;
        for (float& weight : weights) {
            weight = std::max(repaired(weight), 0.0F);
            sum += static_cast<double>(weight);
        }
        if (!(sum > std::numeric_limits<float>::min())) {
            ++weightless_vertices_;
            std::ranges::fill(weights, 0.0F);
            weights[0] = 1;
            continue;
        }
        for (float& weight : weights) weight = static_cast<float>(static_cast<double>(weight) / sum);
    }
}

void RigReader::check_joints(const CheckedPrimitive& primitive, std::size_t mesh, const std::string& where) const {
    std::size_t joints = std::numeric_limits<std::size_t>::max();
    for (std::size_t node = 0; node < read_.skins.size(); ++node) {
        const json& source = document_.item("nodes", node);
        if (read_.skins[node] && document_.index_of(source, "mesh", "meshes", place_in("nodes", node)) == mesh) {
            joints = std::min(joints, read_.rig.skins[*read_.skins[node]].joints.size());
        }
    }
    for (std::size_t i = 0; i < primitive.joints.size(); ++i) {
        if (primitive.weights[i] > 0 && primitive.joints[i] >= joints) {
            document_.fail(
                fmt::format("{}: joint {} is beyond the {} joints of its skin", where, primitive.joints[i], joints));
        }
    }
}

std::vector<Eigen::Vector3f> RigReader::read_deltas(const json& target, const char* name, std::size_t vertex_count,
                                                    const std::string& where) {
    const auto number = document_.index_of(target, name, "accessors", where);
    if (!number) return {};
    const GltfAccessor& accessor = accessors_.accessors()[*number];
    if (accessor.components != 3 || accessor.count != vertex_count) {
        document_.fail(fmt::format("{}.{} is not one vector for each of {} vertices", where, name, vertex_count));
    }
    const std::vector<float> values = accessors_.floats(*number);
    std::vector<Eigen::Vector3f> deltas;
    for (std::size_t i = 0; i < values.size(); i += 3) {
        deltas.emplace_back(repaired(values[i]), repaired(values[i + 1]), repaired(values[i + 2]));
    }
    return deltas;
}

void RigReader::read_animation(std::size_t number) {
    const std::string where = place_in("animations", number);
    const json& source = document_.item("animations", number);
    RigAnimation animation;
    animation.name = source.contains("name") ? document_.text_of(source, "name", where).substr(0, 100) : where;
    const json& samplers = array_of(source, "samplers", where);
    const json& channels = array_of(source, "channels", where);
    for (std::size_t i = 0; i < channels.size(); ++i) {
        const std::string channel_where = fmt::format("{}.channels[{}]", where, i);
        if (auto channel = read_channel(object_in(channels, i, channel_where), samplers, channel_where)) {
            animation.duration_s = std::max(animation.duration_s, static_cast<double>(channel->time_s.back()));
            animation.channels.push_back(std::move(*channel));
        }
    }
    read_.rig.animations.push_back(std::move(animation));
}

std::optional<RigChannel> RigReader::read_channel(const json& channel, const json& samplers, const std::string& where) {
    const auto unknown = [&]() -> std::optional<RigChannel> {
        ++unknown_channels_;
        return std::nullopt;
    };
    const std::uint64_t number = document_.unsigned_of(channel, "sampler", where);
    if (number >= samplers.size()) {
        document_.fail(fmt::format("{}.sampler is {}, but there are {} samplers", where, number, samplers.size()));
    }
    const std::string sampler_where = fmt::format("{}: samplers[{}]", where, number);
    const json& sampler = object_in(samplers, number, sampler_where);
    if (!channel.contains("target") || !channel["target"].is_object()) document_.fail(where + " has no target");
    const auto node = document_.index_of(channel["target"], "node", "nodes", where);
    static const std::map<std::string, RigPath> paths = {{"translation", RigPath::translation},
                                                         {"rotation", RigPath::rotation},
                                                         {"scale", RigPath::scale},
                                                         {"weights", RigPath::weights}};
    const auto path = paths.find(document_.text_of(channel["target"], "path", where));
    if (!node || path == paths.end()) return unknown();  // of extensions
    RigChannel read;
    read.node = *node;
    read.path = path->second;
    std::size_t targets = 1;
    if (read.path == RigPath::weights) {
        read.width = targets = read_.rig.nodes[*node].rest.weights.size();
        if (targets == 0) return unknown();
    } else {
        if (read_.rig.nodes[*node].matrix) return unknown();
        read.width = read.path == RigPath::rotation ? 4 : 3;
    }
    static const std::map<std::string, RigInterpolation> kinds = {{"STEP", RigInterpolation::step},
                                                                  {"LINEAR", RigInterpolation::linear},
                                                                  {"CUBICSPLINE", RigInterpolation::cubic_spline}};
    const auto kind = kinds.find(
        sampler.contains("interpolation") ? document_.text_of(sampler, "interpolation", sampler_where) : "LINEAR");
    if (kind == kinds.end()) document_.fail(sampler_where + ".interpolation is unknown");
    read.interpolation = kind->second;

    const auto input = document_.index_of(sampler, "input", "accessors", sampler_where);
    const auto output = document_.index_of(sampler, "output", "accessors", sampler_where);
    if (!input || !output) document_.fail(sampler_where + " has no input and output");
    const GltfAccessor& times = accessors_.accessors()[*input];
    const GltfAccessor& values = accessors_.accessors()[*output];
    if (times.components != 1 || times.component_type != float_type) {
        document_.fail(sampler_where + ".input holds no times");
    }
    const std::size_t parts = read.interpolation == RigInterpolation::cubic_spline ? 3 : 1;
    const std::size_t components = read.path == RigPath::weights ? 1 : read.width;
    if (values.components != static_cast<int>(components) || values.count != times.count * parts * targets) {
        document_.fail(fmt::format("{}.output is not {} values of {} numbers for {} times", sampler_where,
                                   times.count * parts * targets, components, times.count));
    }
    read.time_s = finite_floats(*input, sampler_where + ".input");
    const auto ascends = [](float before, float after) { return before >= after; };
    if (std::ranges::adjacent_find(read.time_s, ascends) != read.time_s.end()) {
        document_.fail(sampler_where + ".input: its times do not ascend");
    }
    read.values = finite_floats(*output, sampler_where + ".output");
    return read;
}

void RigReader::find_moved() {
    const ModelRig& rig = read_.rig;
    read_.moves.assign(rig.nodes.size(), 0);
    for (const RigAnimation& animation : rig.animations) {
        for (const RigChannel& channel : animation.channels) {
            if (channel.path != RigPath::weights) read_.moves[channel.node] = 1;
        }
    }
    for (const std::size_t node : rig.parents_first) {
        if (rig.nodes[node].parent && read_.moves[*rig.nodes[node].parent]) read_.moves[node] = 1;
    }
}

void RigReader::report() {
    const auto count = [&](std::size_t number, const char* what) {
        if (number > 0) warnings_.add(fmt::format("{}: {} {}", document_.path().string(), number, what));
    };
    count(repaired_values_, "weights and morph targets that are not finite, taken as 0");
    count(repaired_rotations_, "rotations of length 0, taken as none");
    count(weightless_vertices_, "vertices whose weights add to nothing follow their first joint");
    count(unknown_channels_, "animation channels of unknown or unmovable things, left out");
}

}  // namespace

bool has_gltf_rig(const GltfDocument& document) {
    if (!document.list("animations").empty() || !document.list("skins").empty()) return true;
    const json& meshes = document.list("meshes");
    return std::ranges::any_of(meshes, [](const json& mesh) {
        const json primitives = mesh.is_object() ? mesh.value("primitives", json::array()) : json::array();
        return std::ranges::any_of(primitives,
                                   [](const json& one) { return one.is_object() && one.contains("targets"); });
    });
}

std::shared_ptr<const CheckedRig> read_gltf_rig(const GltfDocument& document, const GltfAccessors& accessors,
                                                const std::vector<LoadedPrimitive>& primitives, Warnings& warnings) {
    return RigReader(document, accessors, warnings).read(primitives);
}

}  // namespace matchlight
