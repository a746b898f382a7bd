// Curves through keys, places of nodes, blended vertices.
#include "scene/model_pose.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "core/transforms.h"
#include "scene/mesh_geometry.h"
#include "scene/scene_file.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Affine = Eigen::Matrix<double, 3, 4>;

/// Where a time lies among a channel's keys.
struct KeyPlace {
    std::size_t from = 0, to = 0;  // the same before the first key, after the last and on a step
    double share = 0;              // of the way from one to the other
    double step_s = 0;
};

KeyPlace place_of(const RigChannel& channel, double time_s) {
    const std::vector<float>& times = channel.time_s;
    const auto after = std::ranges::upper_bound(times, time_s, {}, [](float key) { return static_cast<double>(key); });
    if (after == times.begin()) return {};
    const auto from = static_cast<std::size_t>(after - times.begin()) - 1;
    if (after == times.end() || channel.interpolation == RigInterpolation::step) return {.from = from, .to = from};
    const double start_s = static_cast<double>(times[from]), step_s = static_cast<double>(*after) - start_s;
    return {.from = from, .to = from + 1, .share = (time_s - start_s) / step_s, .step_s = step_s};
}

/// The numbers of a channel at a time (glTF 2.0 specification, appendix C), rotations aside from their length.
std::vector<double> value_at(const RigChannel& channel, double time_s) {
    const KeyPlace place = place_of(channel, time_s);
    const bool is_cubic = channel.interpolation == RigInterpolation::cubic_spline;
    /// `part` of a cubic key: 0 in-tangent, 1 value, 2 out-tangent.
    const auto number = [&](std::size_t key, std::size_t part, std::size_t i) {
        const std::size_t element = is_cubic ? 3 * key + part : key;
        return static_cast<double>(channel.values[element * channel.width + i]);
    };
    std::vector<double> value(channel.width);
    const double t = place.share, t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const double from = number(place.from, 1, i), to = number(place.to, 1, i);
        if (!is_cubic || place.from == place.to) {
            value[i] = from + t * (to - from);
            continue;
        }
        value[i] = (2 * t3 - 3 * t2 + 1) * from + place.step_s * (t3 - 2 * t2 + t) * number(place.from, 2, i) +
                   (3 * t2 - 2 * t3) * to + place.step_s * (t3 - t2) * number(place.to, 0, i);
    }
    return value;
}

Eigen::Quaterniond quaternion_of(const double* xyzw) {
    const Eigen::Quaterniond quaternion(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
    // Between opposite keys a cubic curve may pass through zero, which turns nothing.
    return quaternion.norm() > 0 ? quaternion.normalized() : Eigen::Quaterniond::Identity();
}

Eigen::Quaterniond rotation_at(const RigChannel& channel, double time_s) {
    if (channel.interpolation == RigInterpolation::cubic_spline) return quaternion_of(value_at(channel, time_s).data());
    const KeyPlace place = place_of(channel, time_s);
    const auto key = [&](std::size_t number) {
        std::array<double, 4> xyzw;
        std::copy_n(channel.values.begin() + static_cast<std::ptrdiff_t>(4 * number), 4, xyzw.begin());
        return quaternion_of(xyzw.data());
    };
    return key(place.from).slerp(place.share, key(place.to));  // the shorter way
}

void take_channel(NodePose& pose, const RigChannel& channel, double time_s) {
    if (channel.path == RigPath::rotation) {
        pose.rotation = rotation_at(channel, time_s);
        return;
    }
    const std::vector<double> value = value_at(channel, time_s);
    if (channel.path == RigPath::weights) {
        pose.weights = value;
    } else {
        (channel.path == RigPath::scale ? pose.scale : pose.translation) = Vector3d(value.data());
    }
}

Affine affine_of(const Matrix4d& matrix) {
    return matrix.topRows<3>();
}

/// What takes the vertices of a binding to the world's axes: of its node, or one a joint.
std::vector<Affine> world_from_vertex(const MeshBinding& binding, const ModelRig& rig, const RigPose& pose) {
    Matrix4d world_from_file = Matrix4d::Identity();
    world_from_file.topLeftCorner<3, 3>() = world_from_model_axes();
    if (!binding.skin) return {affine_of(world_from_file * pose.file_from_node[binding.node])};
    const RigSkin& skin = rig.skins[*binding.skin];
    std::vector<Affine> matrices;
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        matrices.push_back(
            affine_of(world_from_file * pose.file_from_node[skin.joints[i]] * skin.joint_from_vertex[i]));
    }
    return matrices;
}

std::array<float, 3> narrowed(const Vector3d& v) {
    std::array<float, 3> result{};
    for (Eigen::Index i = 0; i < 3; ++i) {
        // Places that floats cannot hold are of scales that multiply along a chain of nodes.
        constexpr double farthest = 1e30;
        const double within = std::clamp(v[i], -farthest, farthest);
        result[static_cast<std::size_t>(i)] = std::isfinite(within) ? static_cast<float>(within) : 0.0F;
    }
    return result;
}

Vector3d unit(const Vector3d& v, const Vector3d& otherwise) {
    const double length = v.norm();
    return length > 0 && std::isfinite(length) ? Vector3d(v / length) : otherwise;
}

/// Morphed, then blended.
void pose_vertex(const MeshBinding& binding, const std::vector<double>& target_weights,
                 const std::vector<Affine>& matrices, std::size_t number, ModelVertex& to) {
    const BoundVertex& from = binding.vertices[number];
    Vector3d position = from.position.cast<double>(), normal = from.normal.cast<double>(),
             tangent = from.tangent.head<3>().cast<double>();
    for (std::size_t t = 0; t < std::min(binding.targets.size(), target_weights.size()); ++t) {
        const MorphTarget& target = binding.targets[t];
        const double weight = target_weights[t];
        if (weight == 0) continue;
        if (!target.positions.empty()) position += weight * target.positions[number].cast<double>();
        if (!target.normals.empty()) normal += weight * target.normals[number].cast<double>();
        if (!target.tangents.empty()) tangent += weight * target.tangents[number].cast<double>();
    }
    Affine matrix = Affine::Zero();
    if (binding.skin) {
        for (std::size_t i = number * binding.influences; i < (number + 1) * binding.influences; ++i) {
            if (binding.weights[i] > 0) matrix += static_cast<double>(binding.weights[i]) * matrices[binding.joints[i]];
        }
    } else {
        matrix = matrices[0];
    }
    const Matrix3d linear = matrix.leftCols<3>();
    const double side = linear.determinant() < 0 ? -1 : 1;
    // The cofactors turn normals as the inverse transpose does, and exist where a scale is zero.
    const Vector3d turned =
        side * (normal.x() * linear.col(1).cross(linear.col(2)) + normal.y() * linear.col(2).cross(linear.col(0)) +
                normal.z() * linear.col(0).cross(linear.col(1)));
    to.position = narrowed(matrix * position.homogeneous());
    to.normal = narrowed(unit(turned, Vector3d::UnitZ()));
    if (from.tangent.head<3>().isZero(0)) return;
    const std::array<float, 3> along =
        narrowed(unit(linear * tangent, Vector3d(to.normal[0], to.normal[1], to.normal[2]).unitOrthogonal()));
    to.tangent = {along[0], along[1], along[2], side < 0 ? -from.tangent.w() : from.tangent.w()};
}

/// Whether an animation moves a node, itself or with what it hangs on.
std::vector<char> moved_nodes(const ModelRig& rig, const RigAnimation& animation) {
    std::vector<char> moved(rig.nodes.size(), 0);
    for (const RigChannel& channel : animation.channels) {
        if (channel.path != RigPath::weights) moved[channel.node] = 1;
    }
    for (const std::size_t node : rig.parents_first) {
        if (rig.nodes[node].parent && moved[*rig.nodes[node].parent]) moved[node] = 1;
    }
    return moved;
}

bool is_moved(const MeshBinding& binding, const ModelRig& rig, const RigAnimation& animation,
              const std::vector<char>& moved) {
    const bool morphs = std::ranges::any_of(animation.channels, [&](const RigChannel& channel) {
        return channel.path == RigPath::weights && channel.node == binding.node && !binding.targets.empty();
    });
    if (morphs) return true;
    if (!binding.skin) return moved[binding.node] != 0;
    return std::ranges::any_of(rig.skins[*binding.skin].joints, [&](std::size_t joint) { return moved[joint] != 0; });
}

/// Null where the model has no animation and none is asked for.
const RigAnimation* animation_of(const ModelRig* rig, const std::string& name, const std::filesystem::path& reported) {
    static const std::vector<RigAnimation> none;
    const std::vector<RigAnimation>& all = rig != nullptr ? rig->animations : none;
    if (name.empty()) return all.empty() ? nullptr : &all.front();
    const auto named = std::ranges::find(all, name, &RigAnimation::name);
    if (named != all.end()) return &*named;
    if (name == "none") return nullptr;
    std::string known;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (std::to_string(i) == name) return &all[i];
        known += fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, all[i].name);
    }
    throw InputError(reported, fmt::format("it has no animation '{}'", name),
                     all.empty() ? "it has none: leave 'animation' out" : fmt::format("its animations are {}", known));
}

}  // namespace

bool mirrors(const MeshBinding& binding, const ModelRig& rig, const RigPose& pose) {
    const std::vector<Affine> matrices = world_from_vertex(binding, rig, pose);
    const std::size_t first = binding.joints.empty() ? 0 : binding.joints.front();
    return matrices[first].leftCols<3>().determinant() < 0;
}

RigPose rig_pose(const ModelRig& rig, const RigAnimation* animation, double time_s) {
    RigPose pose;
    for (const RigNode& node : rig.nodes) pose.nodes.push_back(node.rest);
    if (animation != nullptr) {
        for (const RigChannel& channel : animation->channels) take_channel(pose.nodes[channel.node], channel, time_s);
    }
    pose.file_from_node.resize(rig.nodes.size());
    for (const std::size_t node : rig.parents_first) {
        const NodePose& own = pose.nodes[node];
        const Eigen::Affine3d parts = Eigen::Translation3d(own.translation) * own.rotation * Eigen::Scaling(own.scale);
        const Matrix4d parent_from_node = rig.nodes[node].matrix.value_or(parts.matrix());
        const std::optional<std::size_t>& parent = rig.nodes[node].parent;
        pose.file_from_node[node] = parent ? pose.file_from_node[*parent] * parent_from_node : parent_from_node;
    }
    return pose;
}

void take_pose(ModelMesh& mesh, const ModelRig& rig, const RigPose& pose) {
    assert(mesh.binding);
    const MeshBinding& binding = rig.bindings[*mesh.binding];
    const std::size_t bound = binding.vertices.size();
    assert(mesh.vertices.size() == bound + mesh.derived.size());
    const std::vector<Affine> matrices = world_from_vertex(binding, rig, pose);
    const std::vector<double>& weights = pose.nodes[binding.node].weights;
    constexpr std::size_t block = 1024;
    parallel_for(static_cast<int>((bound + block - 1) / block), [&](int number) {
        const std::size_t first = static_cast<std::size_t>(number) * block;
        for (std::size_t i = first; i < std::min(first + block, bound); ++i) {
            pose_vertex(binding, weights, matrices, i, mesh.vertices[i]);
        }
    });
    for (std::size_t i = 0; i < mesh.derived.size(); ++i) {
        const auto [a, b] = mesh.derived[i];
        ModelVertex& derived = mesh.vertices[bound + i];
        derived = a == b ? back_of(mesh.vertices[a]) : middle_of_edge(mesh.vertices[a], mesh.vertices[b]);
    }
}

PosedModel::PosedModel(const Model& model, const std::string& name, const std::filesystem::path& reported)
    : rig_(model.rig), animation_(animation_of(model.rig.get(), name, reported)) {
    if (animation_ == nullptr) return;
    const std::vector<char> moved = moved_nodes(*rig_, *animation_);
    for (std::size_t i = 0; i < model.meshes.size(); ++i) {
        const std::optional<std::size_t>& binding = model.meshes[i].binding;
        if (binding && is_moved(rig_->bindings[*binding], *rig_, *animation_, moved)) moving_.push_back(i);
    }
    if (moves()) meshes_ = model.meshes;
}

double PosedModel::animation_time_s(const AnimationSettings& settings, double clip_time_s) const {
    const double time_s = settings.start_s + settings.speed * clip_time_s;
    const double duration_s = animation_ != nullptr ? animation_->duration_s : 0;
    if (!settings.loop || !(duration_s > 0)) return std::clamp(time_s, 0.0, duration_s);
    return time_s - duration_s * std::floor(time_s / duration_s);
}

Eigen::Matrix4d PosedModel::model_from_node(std::size_t node, double animation_time_s) const {
    Eigen::Matrix4d model_from_file = Eigen::Matrix4d::Identity();
    model_from_file.topLeftCorner<3, 3>() = world_from_model_axes();
    return model_from_file * rig_pose(*rig_, animation_, animation_time_s).file_from_node.at(node);
}

const std::vector<ModelMesh>& PosedModel::at(double animation_time_s) {
    if (posed_at_s_ == animation_time_s) return meshes_;
    const RigPose pose = rig_pose(*rig_, animation_, animation_time_s);
    for (const std::size_t mesh : moving_) take_pose(meshes_[mesh], *rig_, pose);
    posed_at_s_ = animation_time_s;
    return meshes_;
}

}  // namespace matchlight
