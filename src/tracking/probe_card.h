// The tags that a probe shows: what they really send, gloss and cast light included, in the probe's own units.
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "calibration/tag_family.h"
#include "core/transforms.h"
#include "lighting/probe.h"

namespace matchlight {

/// Where a tag's sheet lies as seen from a probe.
struct TagPlace {
    double size_m = 0;
    RigidTransform world_from_tag = RigidTransform::Identity();
};

/// Paper minus ink of a tag in the probe, at the tag's centre, per channel; the probe was taken at `probe_place_m`.
/// Cells seen more than 60° from the side of their normal are left out: paper is no perfect diffuser there. nullopt
/// where the probe does not resolve the cells, or does not show that tag there: a probe of a mirror ball shows what is
/// near from elsewhere, and a stand may hide it.
std::optional<std::array<double, 3>> card_in_probe(const Probe& probe, const Eigen::Vector3d& probe_place_m,
                                                   const TagPattern& pattern, const TagPlace& place);

}  // namespace matchlight
