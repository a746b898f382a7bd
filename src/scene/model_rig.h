// How a model moves: its nodes, what animates them, and what the vertices of its meshes hang on. In the file's own
// axes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace matchlight {

/// A node beside its parent: scale first, then rotation, then translation.
struct NodePose {
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
    std::vector<double> weights;  // of the morph targets of its mesh
};

struct RigNode {
    std::optional<std::size_t> parent;
    NodePose rest;
    std::optional<Eigen::Matrix4d> matrix;  // in place of rest's, of a node that nothing animates
};

enum class RigPath { translation, rotation, scale, weights };
enum class RigInterpolation { step, linear, cubic_spline };

/// What moves one part of a node's pose.
struct RigChannel {
    std::size_t node = 0;
    RigPath path = RigPath::translation;
    RigInterpolation interpolation = RigInterpolation::linear;
    std::size_t width = 3;      // numbers a key
    std::vector<float> time_s;  // of the keys, ascending
    std::vector<float> values;  // `width` a key; of a cubic spline three times as many: in-tangent, value, out-tangent
};

struct RigAnimation {
    std::string name;
    double duration_s = 0;  // to the last key of all channels
    std::vector<RigChannel> channels;
};

struct RigSkin {
    std::vector<std::size_t> joints;                 // nodes
    std::vector<Eigen::Matrix4d> joint_from_vertex;  // inverse bind matrices
};

struct BoundVertex {
    Eigen::Vector3f position, normal;
    Eigen::Vector4f tangent;  // zero where none is needed
};

/// What a morph target adds, a vertex each; empty where it changes nothing.
struct MorphTarget {
    std::vector<Eigen::Vector3f> positions, normals, tangents;
};

/// A mesh whose vertices follow nodes.
struct MeshBinding {
    std::size_t node = 0;             // its own: where it is without a skin, and whose weights morph it
    std::optional<std::size_t> skin;  // in place of the node's transform
    std::vector<BoundVertex> vertices;
    std::size_t influences = 0;         // a vertex, of a skin
    std::vector<std::uint32_t> joints;  // numbers in the skin
    std::vector<float> weights;         // add to 1 a vertex
    std::vector<MorphTarget> targets;
};

struct ModelRig {
    std::vector<RigNode> nodes;
    std::vector<std::size_t> parents_first;  // numbers of all nodes
    std::vector<RigSkin> skins;
    std::vector<RigAnimation> animations;
    std::vector<MeshBinding> bindings;
};

}  // namespace matchlight
