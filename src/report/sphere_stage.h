// A sphere set on the GPU under plain light, drawn from any view: what its measurements are taken from.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/image.h"
#include "gl/shader_library.h"
#include "render/effects/object_shadow.h"
#include "render/environment.h"
#include "render/surface.h"
#include "report/sphere_reference.h"
#include "report/sphere_trial.h"
#include "scene/sphere_set.h"

namespace matchlight {

/// Spheres are grey and matt, under light that grows evenly from below to above: three and more harmonics would only
/// measure the light.
class SphereStage {
public:
    /// Neither is needed afterwards. Needs a current context, as everything here.
    explicit SphereStage(const SphereSet& set);

    void draw(const ReferenceView& view, const SphereVisibility& visibility);
    /// Of the last draw: RGBA, premultiplied.
    ImageF picture() const;
    /// Which spheres are seen alone, without light; waits for nothing.
    void see(const ReferenceView& view, const SphereVisibility& visibility);
    std::vector<Knob> drawn_cells();
    /// Where spheres let light through: how they are peeled from now on, and how many layers the last draw took.
    void set_peeling(double residual, int most_layers, TransparencyMethod method) {
        renderer_.set_peeling(residual, most_layers, method);
    }
    /// SurfaceView::sphere_detail_px from now on; 0 at first.
    void set_detail_px(double radius_px) { detail_px_ = radius_px; }
    std::vector<Knob> drawn_spheres();
    /// Places along a pixel's side at edges from now on; 0 at first.
    void set_edge_places(int places) { edge_places_ = places; }
    int peeled_layers() const { return renderer_.peeled_layers(); }
    /// Past the other spheres from now on, by the corners of an octahedron that is divided so often; absent, as at
    /// first: all light arrives. Their maps are made when first asked for, and kept until forget_maps().
    struct Occlusion {
        int divisions = 2;
        int resolution = 256;
        bool operator<(const Occlusion& other) const {
            return std::pair(divisions, resolution) < std::pair(other.divisions, other.resolution);
        }
    };
    void set_occlusion(std::optional<Occlusion> occlusion) { occlusion_ = occlusion; }
    void make_maps(const Occlusion& occlusion) { maps_of(occlusion); }
    void forget_maps() { maps_.clear(); }
    /// From now on; none at first. Looked for at every `step_px` pixels.
    void set_halo(const SphereHalo& halo, int step_px) {
        renderer_.set_halo(0, halo);
        halo_step_px_ = step_px;
    }
    /// No point of any sphere sends more.
    double most_light() const;

    /// What the reference gives a point of it.
    Eigen::Vector3d light_of(const SpherePoint& point) const;
    /// What it gives it past the others, by `side` × `side` directions.
    Eigen::Vector3d occluded_light_of(const SphereCaster& rays, const SpherePoint& point, int side) const;

private:
    const ObjectShadow& maps_of(const Occlusion& occlusion);

    ShaderLibrary shaders_;
    Probe sky_;
    Environment environment_;
    SurfaceRenderer renderer_;
    SurfacePicture drawn_;
    int edge_places_ = 0;
    double detail_px_ = 0;
    int halo_step_px_ = 1;
    std::optional<Occlusion> occlusion_;
    std::map<Occlusion, ObjectShadow> maps_;
};

}  // namespace matchlight
