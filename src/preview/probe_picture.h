// The probe as it is looked at in the window: unrolled, or in three balls.
#pragma once

#include <Eigen/Core>

#include "core/image.h"
#include "lighting/probe.h"

namespace matchlight {

enum class ProbeForm { latlong, balls };

struct ProbeLook {
    ProbeForm form = ProbeForm::latlong;
    int width = 0, height = 0;
    double exposure_ev = 0;  // scene-linear light · 2^ev is what the sRGB curve gets
    /// What the balls are seen along, from infinitely far away.
    Eigen::Matrix3d world_from_camera = Eigen::Matrix3d::Identity();
};

/// As large as asked for, black around it. The balls are a mirror, a rough one, and a white diffuse one (a ball of
/// paper): what they show is what objects of such materials get from this light.
Image8 probe_picture(const Probe& probe, const ProbeLook& look);

}  // namespace matchlight
