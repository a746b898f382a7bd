// The scene's objects on the GPU, where they stand at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "core/warnings.h"
#include "render/ray_scene.h"
#include "render/surface.h"
#include "scene/model_pose.h"
#include "scene/object_motion.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// What objects' moving from one placement to another changes.
struct PlacementChange {
    bool any = false;      // an object stands otherwise: what objects do to each other's light
    bool casters = false;  // among them one that casts a shadow
};

/// The world or the tag that an object stands on. Throws InputError where the solve does not know the tag.
Eigen::Affine3d world_from_parent(const ObjectSettings& object, const Solve& solve, const std::filesystem::path& scene);

/// An object's model or shape, or the mesh that a holdout of spheres is. Throws InputError, also where those are more
/// than a mesh is made of.
Model load_object_model(const ObjectSettings& object, const std::filesystem::path& scene, Warnings& warnings);

/// How the scene's objects are made ready.
struct ObjectPreparation {
    bool fine_meshes = false;  // long edges are divided, so that light between objects, kept at vertices, shows
    bool traced = false;       // rays meet them
};

class SceneObjects {
public:
    /// Loads the scene's objects into `surfaces`, which outlives this, as they stand at `time`. Throws InputError.
    SceneObjects(SurfaceRenderer& surfaces, const Scene& scene, const Solve& solve, const ClipTime& time,
                 const ObjectPreparation& preparation, Warnings& warnings);

    /// Null where nothing is traced.
    RayScene* rays() { return rays_ ? &*rays_ : nullptr; }

    /// Other placements of the same objects, as they stand at `time`. Throws InputError.
    void set_scene(const Scene& scene, const Solve& solve, const ClipTime& time);

    /// The analytic lights of all models, as they stand now, in the world and in probe units.
    std::vector<LampSettings> lamps() const;
    bool any_lamps() const { return !model_lamps_.empty(); }

    bool any_moves() const { return !moving_.empty(); }
    /// Puts every object that moves where it is at `time`.
    void place(const ClipTime& time);
    Eigen::Matrix4d world_from_model(std::size_t object, const ClipTime& time) const;
    /// Whether its vertices move against each other, by an animation of its model.
    bool deforms(std::size_t object) const;
    /// Of such an object, in its model's axes.
    std::vector<Eigen::Vector3d> positions_m(std::size_t object, const ClipTime& time);
    /// Where the vertices of those objects are at the ends of what SurfaceRenderer::draw_ways() draws.
    void set_ways(const ClipTime& opening, const ClipTime& closing);

    /// What the light's maps were made for: changed by place() and set_scene(), until they are made anew.
    PlacementChange change_since_lit() const;
    void mark_lit() {
        lit_ = placed_;
        lit_poses_ = poses_;
    }

private:
    struct Object {
        ObjectSettings settings;
        Eigen::Affine3d world_from_parent;
    };
    struct Deforming {
        std::size_t object = 0;
        PosedModel model;
    };
    bool is_moving(std::size_t object) const { return moves(objects_[object].settings) || deforms(object); }
    struct LampOfObject {
        std::size_t object = 0;
        ModelLamp lamp;
    };
    const std::vector<ModelMesh>& meshes_at(Deforming& deforming, const ClipTime& time) const;
    void deform(const ClipTime& time);
    void place_rays();
    void add_spheres(const SurfaceObject& added, const ObjectSettings& object, const std::filesystem::path& scene,
                     Warnings& warnings);

    SurfaceRenderer& surfaces_;
    std::optional<RayScene> rays_;
    std::vector<Object> objects_;
    std::vector<std::size_t> moving_;      // indices of objects
    std::vector<Eigen::Matrix4d> placed_;  // one an object
    std::vector<Eigen::Matrix4d> lit_;
    std::vector<Deforming> deforming_;
    std::vector<LampOfObject> model_lamps_;
    std::vector<double> poses_, lit_poses_;  // their animations' times as placed_ and lit_ are; NaN: none yet
};

}  // namespace matchlight
