// From photographs of a mirror ball, already merged, to a probe: outline, rig, place of the ball, unwrapping.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/warnings.h"
#include "lighting/ball_fit.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_view.h"
#include "lighting/clipped_parts.h"
#include "lighting/diffuse_ball.h"
#include "scene/scene_file.h"

namespace matchlight {

/// A diffuse ball that tells what clipped lights send: name, radiance, clipped and camera of its view, in the units of
/// the mirror ball's. With tags it shows one whole; without, the camera stands where it stood for the first view.
struct DiffuseBallOptions {
    BallView view;
    std::optional<OutlineCircle> circle;    // by hand
    std::optional<Eigen::Vector3d> albedo;  // DiffuseBall
};

struct BallBuildOptions {
    double ball_radius_m = 0;
    std::optional<TagSettings> tags;                 // absent: the world is the first photographer's
    std::vector<OutlineCircle> circles;              // by hand: none, or one a view
    std::optional<Eigen::Vector3d> reflectance;      // head on; absent: by the plane and its mirror image, else 1
    std::optional<Eigen::Vector3d> place_m;          // that the probe is for; absent: the ball's centre
    bool plane = true;                               // look up what lies on the rig's plane where it is
    BallParallax parallax = BallParallax::full;      // BallProbeOptions
    int samples_a_side = 2;                          // BallProbeOptions
    bool sun_from_tags = true;                       // solve the energy of clipped lights by the tags' paper
    std::optional<DiffuseBallOptions> diffuse_ball;  // or by this ball
    int height = 0;                                  // rows of the lat-long map; 0: what the ball holds
    double camera_deg = 8;                           // BallProbeOptions
};

struct BallBuild {
    BallProbe probe;
    std::vector<BallView> views;
    MirrorBall ball;  // world
    Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d reflectance = Eigen::Vector3d::Ones();
    std::string reflectance_by;  // "given", "measured by the plane", "taken as 1"
    std::optional<BallFit> fit;  // by the rig's plane
    std::vector<int> tags;       // that have a place
    bool plane_used = false;
    std::vector<ClippedLight> clipped_lights;  // whose energy was solved
    std::string clipped_lights_by;             // "the tags' paper", "the diffuse ball"
    std::optional<BallView> diffuse_view;      // of the diffuse ball
};

/// `views` hold name, radiance, sigma, clipped and camera. With tags the probe turns with the rig. Without, +y is the
/// first photographer's forward and +z his camera's up, and further views are registered by rotation (ball_register.h).
/// Throws InputError.
BallBuild build_ball_probe(std::vector<BallView> views, const BallBuildOptions& options, Warnings& warnings);

}  // namespace matchlight
