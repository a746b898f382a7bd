// Triangles are read back from the GPU once, in their models' axes.
#include "compositor/scene_focus.h"

#include <algorithm>
#include <utility>

namespace matchlight {

SceneFocus::SceneFocus(const Scene& scene, const Camera& camera, const SurfaceRenderer& surfaces)
    : camera_(camera), surfaces_(surfaces) {
    set_scene(scene);
}

void SceneFocus::set_scene(const Scene& scene) {
    surface_z_m_.reset();
    apart_.clear();
    names_.clear();
    if (scene.surface.present) surface_z_m_ = scene.surface.z_m;
    for (const ObjectSettings& object : scene.objects) {
        if (object.focus) apart_.push_back({.object = names_.size(), .distance_m = object.focus->distance_m});
        names_.push_back(object.name);
    }
    for (std::size_t i = 0; i < objects_.size(); ++i) objects_[i].name = names_[i];
}

void SceneFocus::read_objects() {
    objects_.clear();
    read_at_ = surfaces_.deformations();
    for (const std::string& name : names_) objects_.push_back({.name = name, .triangles = {}, .box_m = {}});
    for (PlacedMesh& mesh : surfaces_.read_meshes()) {
        FocusObject& object = objects_.at(mesh.object);
        const Eigen::Affine3d model_from_world(surfaces_.world_from_model(mesh.object).inverse());
        for (Eigen::Vector3d& position_m : mesh.positions_m) {
            position_m = model_from_world * position_m;
            object.box_m.extend(position_m);
        }
        object.triangles.add_mesh(mesh.positions_m, mesh.indices);
    }
    for (FocusObject& object : objects_) object.triangles.build();
}

std::optional<double> SceneFocus::depth_m(const DepthOfFieldSettings& settings, const RigidTransform& camera_from_world,
                                          Warnings& warnings) {
    const bool casts_rays = settings.focus_on == FocusTarget::middle || settings.focus_on == FocusTarget::object;
    if (casts_rays && (objects_.empty() || read_at_ != surfaces_.deformations())) read_objects();
    for (std::size_t i = 0; i < objects_.size(); ++i) objects_[i].world_from_model = surfaces_.world_from_model(i);
    return autofocus_depth_m(settings, {camera_, camera_from_world, objects_, surface_z_m_}, warnings);
}

}  // namespace matchlight
