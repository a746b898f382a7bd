// One camera pose from tags whose places are known: robust, in double precision, with its covariance.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/transforms.h"
#include "tracking/tag_fit.h"

namespace matchlight {

using PoseCovariance = Eigen::Matrix<double, 6, 6>;  // rotation vector (rad), then translation (m), on the world side

/// A tag seen in a frame and where it is in the world.
struct PlacedObservation {
    const TagObservation* seen = nullptr;
    double size_m = 0;
    RigidTransform world_from_tag = RigidTransform::Identity();
};

struct CameraPose {
    RigidTransform camera_from_world = RigidTransform::Identity();
    double cost = 0;  // robust, ½ Σ ρ: what branches are compared by
    PoseCovariance covariance = PoseCovariance::Zero();
};

/// camera_from_world · Exp(ξ), the perturbation that covariances are about: rotation vector, then translation.
RigidTransform perturbed(const RigidTransform& camera_from_world, const Eigen::Matrix<double, 6, 1>& perturbation);
/// The ξ that takes `from` to `to`.
Eigen::Matrix<double, 6, 1> perturbation_between(const RigidTransform& from, const RigidTransform& to);

/// Σ of the observation in normalised coordinates with what the fit does not know of added: lens model, flatness of
/// the sheet, coding.
TagCovariance effective_covariance(const TagObservation& seen);
/// A, with AᵀA = effective_covariance⁻¹.
TagCovariance whitening(const TagObservation& seen);

/// Both poses that explain a single flat tag (IPPE; Collins & Bartoli 2014, Infinitesimal Plane-Based Pose
/// Estimation), each refined; best first, camera_from_tag.
std::vector<CameraPose> planar_poses(const TagObservation& seen, double size_m);

/// Levenberg–Marquardt over all tags from `start`, with a robust weight for each tag. nullopt when a tag would lie
/// behind the camera.
std::optional<CameraPose> refine_pose(const std::vector<PlacedObservation>& tags, const RigidTransform& start);

/// The one or two distinct local minima of the joint pose, best first.
std::vector<CameraPose> candidate_poses(const std::vector<PlacedObservation>& tags);

/// Standard deviation (px, both directions together), by the pose's covariance, of where a point would be drawn.
double projection_sigma_px(const CameraPose& pose, const Camera& camera, const Eigen::Vector3d& point_world_m);

/// Reprojection residuals in plate pixels, through the exact lens: RMS over all corners.
double reprojection_rms_px(const std::vector<PlacedObservation>& tags, const RigidTransform& camera_from_world,
                           const Camera& camera);

}  // namespace matchlight
