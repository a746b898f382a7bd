// A plane and a ball under one analytic light, seen from above: drawn, and in double precision.
#pragma once

#include <optional>

#include "core/image.h"
#include "gl/shader_library.h"
#include "render/lamps.h"
#include "scene/classic_shading.h"
#include "scene/effects.h"
#include "scene/lamp.h"
#include "scene/model.h"

namespace matchlight {

struct LampTrialSetup {
    LampSettings lamp;
    double ambient = 0;                              // radiance that comes from everywhere
    double ball_radius_m = 0.05;                     // above the plane z = 0
    ClassicShading shading = {};                     // of the ball; the plane is white and dull
    std::optional<DepthCueSettings> depth_cue = {};  // of both
    bool measures_ball = false;                      // else the plane
};

class LampTrial {
public:
    /// A context must be current, and is until this goes.
    LampTrial(ShaderLibrary& shaders, const LampTrialSetup& setup);

    /// RGB light, 0 at pixels that do not see what is measured.
    ImageF drawn(const LampQuality& quality) const;
    /// The same in double precision, the lamp as `rays` rays.
    ImageF reference(int rays) const;
    static constexpr int size_px = 100;

private:
    struct Seen {
        Eigen::Vector3d at_m, normal, to_eye;
    };
    std::optional<Seen> seen_by(int x, int y) const;
    Eigen::Vector3d light_at(const Seen& seen, int rays) const;

    ShaderLibrary& shaders_;
    LampTrialSetup setup_;
    Model plane_, ball_;
};

}  // namespace matchlight
