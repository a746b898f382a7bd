// A rigged model's vertices at a time.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/model.h"
#include "scene/model_rig.h"

namespace matchlight {

struct AnimationSettings;

/// Every node's pose and place at a time of an animation; its rest where there is none. Places are in the file's axes.
struct RigPose {
    std::vector<NodePose> nodes;
    std::vector<Eigen::Matrix4d> file_from_node;
};
RigPose rig_pose(const ModelRig& rig, const RigAnimation* animation, double time_s);

/// Whether what the first vertex follows mirrors it.
bool mirrors(const MeshBinding& binding, const ModelRig& rig, const RigPose& pose);

/// Gives a mesh of the rig, which ends with what its binding tells of, the vertices that the pose has (linear blend
/// skinning; normals by the inverse transpose of the blend). Vertices of halved edges and of back sides follow.
/// Triangles stay wound as for the pose at rest.
void take_pose(ModelMesh& mesh, const ModelRig& rig, const RigPose& pose);

/// The meshes of a model that an animation moves.
class PosedModel {
public:
    /// Of an animation's name, or else its number; the first where `name` is empty, none where it is "none". Throws
    /// InputError where the model has no such.
    PosedModel(const Model& model, const std::string& name, const std::filesystem::path& reported);

    bool moves() const { return !moving_.empty(); }
    /// The animation's time at a time of the clip: cyclic, or held at its ends.
    double animation_time_s(const AnimationSettings& settings, double clip_time_s) const;
    /// Where a node is in the model's own axes, z up.
    Eigen::Matrix4d model_from_node(std::size_t node, double animation_time_s) const;
    /// All meshes of the model, posed where they move; what they need besides vertices is as in the model.
    const std::vector<ModelMesh>& at(double animation_time_s);

private:
    std::shared_ptr<const ModelRig> rig_;
    const RigAnimation* animation_ = nullptr;
    std::vector<ModelMesh> meshes_;
    std::vector<std::size_t> moving_;  // among them
    std::optional<double> posed_at_s_;
};

}  // namespace matchlight
