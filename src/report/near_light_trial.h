// Small scenes whose light is known in double precision: a lamp mirrored by an object or by the real surface, or
// shining on it, and a dark box before a real one.
#pragma once

#include <memory>

#include "compositor/compositor.h"
#include "compositor/quality.h"
#include "gl/context.h"
#include "report/scratch_probe.h"
#include "scene/ray_caster.h"

namespace matchlight {

enum class NearLightKind {
    mirrored_by_object,   // a slab of white metal in the dark
    mirrored_by_surface,  // the real surface, in the dark
    bounced_to_surface,   // the real surface in even light, and the shadow that the lamp casts there
    shadow_on_holdout     // a real slab in even light, and the shadow of a box that does not glow
};

struct NearLightSetup {
    NearLightKind kind = NearLightKind::mirrored_by_object;
    double roughness = 0;                      // of what mirrors
    Eigen::Vector3d lamp_m{0.08, 0.05, 0.06};  // its sides; below 0: mirrored
    Eigen::Vector3d lamp_at_m{0.01, 0.07, 0.06};
    double shear = 0;  // of the box: x by so much for each z
};

class NearLightTrial {
public:
    /// `context` outlives this.
    NearLightTrial(GlContext& context, const NearLightSetup& setup);

    /// As it is drawn: RGB light over the frame, 0 at pixels that are not measured.
    ImageF drawn(const Quality& quality) const;
    /// As it is by rays in double precision, strata² of them a pixel.
    ImageF reference(int strata) const;
    int width() const { return solve_.camera.width; }
    int height() const { return solve_.camera.height; }

private:
    void add_lamp();
    bool glows() const;
    bool is_lit() const;  // by even light from everywhere; else it is dark but for the lamp
    bool is_measured(int x, int y) const;
    /// The point of the plane z = 0 that a pixel sees.
    Eigen::Vector3d point_at(double x, double y) const;
    bool lamp_is_met(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction) const;

    GlContext& context_;
    NearLightSetup setup_;
    std::unique_ptr<ScratchProbe> probe_;
    Solve solve_;
    Scene scene_;
    RayCaster lamp_;
};

}  // namespace matchlight
