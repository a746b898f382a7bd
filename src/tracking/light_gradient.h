// How the light on the tags changes over the world.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace matchlight {

struct TagLight {
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
    double log_light = 0;  // natural log
};

/// The gradient of log light (natural, per metre) through tags that need not lie in one plane: robust, and zero along
/// directions in which they do not spread. nullopt where the tags are fewer than three or do not tell it from none.
std::optional<Eigen::Vector3d> fit_light_gradient(const std::vector<TagLight>& tags);

}  // namespace matchlight
