// The scene's objects as autofocus meets them, and those with a focus of their own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compositor/autofocus.h"
#include "compositor/layer_effects.h"
#include "render/surface.h"
#include "scene/scene_file.h"

namespace matchlight {

class SceneFocus {
public:
    /// `surfaces` holds the scene's objects in its order; both references must outlive this.
    SceneFocus(const Scene& scene, const Camera& camera, const SurfaceRenderer& surfaces);

    /// The same objects, with other names and focus of their own, or another surface.
    void set_scene(const Scene& scene);

    /// See autofocus_depth_m(); objects stand as `surfaces` has them now.
    std::optional<double> depth_m(const DepthOfFieldSettings& settings, const RigidTransform& camera_from_world,
                                  Warnings& warnings);
    /// Objects that the scene gives a focus of their own.
    const std::vector<ObjectFocus>& apart() const { return apart_; }

private:
    void read_objects();

    const Camera& camera_;
    const SurfaceRenderer& surfaces_;
    std::optional<double> surface_z_m_;
    std::vector<std::string> names_;
    std::vector<ObjectFocus> apart_;
    std::vector<FocusObject> objects_;  // read back when a ray is first needed
    std::size_t read_at_ = 0;           // as SurfaceRenderer counts deformations
};

}  // namespace matchlight
