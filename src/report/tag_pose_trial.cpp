// Renders or invents the observations, solves them, and bounds what could be known.
#include "report/tag_pose_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include <Eigen/Cholesky>

#include "core/parallel.h"
#include "report/pose_peers.h"
#include "report/tag_view_reference.h"
#include "tracking/camera_path.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_follower.h"

namespace matchlight {

namespace {

constexpr double focal_px = 800;
constexpr double size_m = 0.1;
constexpr double fps = 24;
constexpr int tag_id = 7;
/// What effective_covariance allows every corner beside its noise: lens model, flatness of the sheet, coding.
constexpr double corner_allowance_px = 0.02;
constexpr double radians = std::numbers::pi / 180;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Information = Eigen::Matrix<double, 6, 6>;

/// The camera's path: it circles the tag and sways by some degrees, as a hand does.
struct Shot {
    TagPoseTrial trial;

    RigidTransform camera_from_tag(double frame) const {
        const double distance_m = focal_px * size_m / trial.side_px;
        RigidTransform above = RigidTransform::Identity();
        above.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
        above.translation() = Eigen::Vector3d(0, 0, distance_m);
        // Beyond 85° the far side is what a hand's sway would show.
        const double tilt_deg = std::min(trial.tilt_deg + 2 * std::sin(0.5 * frame), 85.0);
        RigidTransform turned = RigidTransform::Identity();
        turned.linear() = rotation_from_degrees({tilt_deg, 0, 0}) * rotation_from_degrees({0, 0, 20 + 4 * frame});
        RigidTransform rolled = RigidTransform::Identity();
        rolled.linear() = rotation_from_degrees({0, 0, 15});
        return rolled * above * turned;
    }

    /// While the shutter is open, at `moment` of −½ … ½, the camera also shakes: the tag moves across the picture.
    RigidTransform exposed(double frame, double moment) const {
        const double distance_m = focal_px * size_m / trial.side_px;
        const Eigen::Vector3d across(std::cos(0.4), std::sin(0.4), 0);
        RigidTransform pose = camera_from_tag(frame);
        pose.pretranslate(across * (trial.motion_px * moment * distance_m / focal_px));
        return pose;
    }

    /// A camera whose frame holds the tag in every picture, with the distortion of an ordinary lens.
    Camera camera() const {
        Camera camera;
        camera.fx = camera.fy = focal_px;
        camera.distortion = {-0.1, 0.03, 0.0004, -0.0003};
        Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
        for (int f = 0; f < trial.frames; ++f) {
            const Eigen::Matrix<double, 3, 4> corners = camera_from_tag(f) * tag_corners_m(1.3 * size_m);
            for (int i = 0; i < 4; ++i) {
                const Eigen::Vector2d px = camera.pixel_from_camera(corners.col(i));
                low = low.cwiseMin(px), high = high.cwiseMax(px);
            }
        }
        const double margin = 40 + trial.defocus_px + trial.motion_px;
        camera.width = static_cast<int>(high.x() - low.x() + 2 * margin) + 1;
        camera.height = static_cast<int>(high.y() - low.y() + 2 * margin) + 1;
        camera.cx = margin - low.x() + 0.3, camera.cy = margin - low.y() + 0.4;
        return camera;
    }
};

/// One frame: what we observe, and corners as AprilTag finds them in light and in codes.
struct TrialFrame {
    std::optional<TagObservation> seen;
    std::optional<TagCorners> light_corners, code_corners;
};

TagView view_of(const Shot& shot, const Camera& camera, int frame) {
    const TagPoseTrial& trial = shot.trial;
    TagView view;
    view.camera = camera;
    view.exposure_s = trial.motion_px > 0 ? 0.5 / fps : 0;
    view.camera_from_world = [frame, &shot](double time_s) { return shot.exposed(frame, time_s * fps / 0.5); };
    const double distance_m = focal_px * size_m / trial.side_px;
    view.focus_distance_m = 0.8 * distance_m;
    view.aperture_m = trial.defocus_px / (focal_px * std::abs(1 / view.focus_distance_m - 1 / distance_m));
    if (trial.defocus_px + trial.motion_px > 0) view.rays = 129;
    TagSheet tag;
    tag.pattern = TagFamily("tag36h11").pattern(tag_id);
    tag.id = tag_id;
    tag.size_m = size_m;
    view.tags.push_back(tag);
    return view;
}

/// Code values of one channel, as whoever knows nothing of the response takes them.
Image8 code_picture(const PlateFrame& frame) {
    const ImageF codes = frame.gray_code({0, 0, frame.format().width, frame.format().height});
    Image8 picture(codes.width(), codes.height(), 1);
    std::ranges::transform(codes.samples(), picture.samples().begin(), [](float code) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0f, 1.0f)));
    });
    return picture;
}

std::optional<TagCorners> detected(const TagDetector& detector, const Image8& picture, const Camera& camera) {
    for (const TagDetection& detection : detector.detect(picture)) {
        if (detection.id == tag_id) return normalized_corners(detection, camera);
    }
    return std::nullopt;
}

Recording recording_of(const TagPoseTrial& trial, int frame) {
    Recording recording;
    recording.code_noise = trial.noise_codes;
    recording.seed = static_cast<unsigned>(frame) + 1;
    return recording;
}

/// Pictures of every frame, and what AprilTag finds in them; a detector serves one thread, and is dear to make.
std::vector<TrialFrame> photographed(const Shot& shot, const Camera& camera) {
    const int count = shot.trial.frames;
    std::vector<TrialFrame> frames(static_cast<std::size_t>(count));
    std::vector<std::optional<PlateFrame>> plates(frames.size());
    const PlateLight plate_light(Response::srgb(), Transfer::camera);
    constexpr int workers = 2;
    parallel_for(workers, [&](int worker) {
        const TagDetector detector("tag36h11", {});
        for (int f = worker; f < count; f += workers) {
            const auto index = static_cast<std::size_t>(f);
            const Image8 picture =
                recorded_picture(reference_light(view_of(shot, camera, f)), recording_of(shot.trial, f));
            plates[index].emplace(recorded_frame(picture, f, f / fps));
            frames[index].code_corners = detected(detector, code_picture(*plates[index]), camera);
            const ImageF light = plate_light.gray(*plates[index], picture.bounds());
            frames[index].light_corners = detected(detector, detection_image(light), camera);
        }
    });
    const TagDetector detector("tag36h11", {});
    const std::set<int> wanted{tag_id};
    const LensGrid lens(camera);
    TagFollower follower({detector, wanted, plate_light, lens});
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const FrameFindings findings = follower.examine(*plates[f]);
        if (!findings.observations.tags.empty()) frames[f].seen = findings.observations.tags.front();
    }
    return frames;
}

TrialFrame invented(const Shot& shot, const Camera& camera, int frame) {
    std::mt19937_64 random(static_cast<std::uint64_t>(frame) + 1);
    std::normal_distribution<double> noise(0, shot.trial.noise_px / focal_px);
    const Eigen::Matrix<double, 3, 4> points = shot.camera_from_tag(frame) * tag_corners_m(size_m);
    TagObservation seen;
    seen.id = tag_id;
    for (int i = 0; i < 4; ++i) {
        const double dx = noise(random), dy = noise(random);
        seen.corners_normalized.col(i) = points.col(i).hnormalized() + Eigen::Vector2d(dx, dy);
        seen.corners_px.col(i) = camera.pixel_from_normalized(seen.corners_normalized.col(i));
    }
    seen.covariance = TagCovariance::Identity() * std::pow(shot.trial.noise_px / focal_px, 2);
    seen.side_px = shot.trial.side_px;
    seen.contrast = 0.7, seen.correlation = 0.99, seen.decision_margin = 60;
    seen.refined = true;
    return {seen, seen.corners_normalized, std::nullopt};
}

/// ∂(normalised image point)/∂ξ of a point of the tag, ξ as in PoseCovariance.
Eigen::Matrix<double, 2, 6> image_by_pose(const RigidTransform& camera_from_tag, const Eigen::Vector3d& point) {
    const Eigen::Vector3d at = camera_from_tag * point;
    Eigen::Matrix<double, 2, 3> by_camera;
    by_camera << 1 / at.z(), 0, -at.x() / (at.z() * at.z()), 0, 1 / at.z(), -at.y() / (at.z() * at.z());
    Eigen::Matrix<double, 3, 6> by_pose;
    for (int k = 0; k < 3; ++k) by_pose.col(k) = Eigen::Vector3d::Unit(k).cross(point);
    by_pose.rightCols<3>().setIdentity();
    return by_camera * camera_from_tag.linear() * by_pose;
}

/// Fisher's information on the pose in four corners with noise of this standard deviation on each coordinate.
Information corner_information(const Shot& shot, double frame, double noise_px) {
    Information information = Information::Zero();
    const RigidTransform pose = shot.camera_from_tag(frame);
    const Eigen::Matrix<double, 3, 4> corners = tag_corners_m(size_m);
    for (int i = 0; i < 4; ++i) {
        const Eigen::Matrix<double, 2, 6> by_pose = focal_px * image_by_pose(pose, corners.col(i));
        information += by_pose.transpose() * by_pose / (noise_px * noise_px);
    }
    return information;
}

/// Variance of the decoded light at a level: the noise of its code and its rounding.
double light_variance(const Recording& recording, double light) {
    constexpr double step = 1e-4;
    const double code = recording.response.code_from_linear(light, 1);
    const double by_code =
        (recording.response.linear_from_code(code + step, 1) - recording.response.linear_from_code(code - step, 1)) /
        (2 * step);
    const double code_variance = (recording.code_noise * recording.code_noise + 1.0 / 12) / (255 * 255);
    return by_code * by_code * code_variance;
}

/// Fisher's information on the pose in a picture whose blur and light are known: Σ (∂L/∂ξ)ᵀ(∂L/∂ξ)/σ². The gradient of
/// light is taken over two pixels, which makes a little less of sharp edges than there is.
Information picture_information(const Shot& shot, const Camera& camera, int frame) {
    const TagView view = view_of(shot, camera, frame);
    const ImageF light = reference_light(view);
    const Recording recording = recording_of(shot.trial, frame);
    const RigidTransform camera_from_tag = shot.camera_from_tag(frame), tag_from_camera = camera_from_tag.inverse();
    const LensGrid lens(camera);
    Information information = Information::Zero();
    for (int y = 1; y + 1 < light.height(); ++y) {
        for (int x = 1; x + 1 < light.width(); ++x) {
            const Eigen::RowVector2d gradient(light.at(x + 1, y) - light.at(x - 1, y),
                                              light.at(x, y + 1) - light.at(x, y - 1));
            if (gradient.isZero(1e-6)) continue;
            const Eigen::Vector3d ray = lens.normalized_from_pixel(x, y).homogeneous();
            const Eigen::Vector3d from = tag_from_camera.translation(), along = tag_from_camera.linear() * ray;
            const Eigen::Vector3d point = from - from.z() / along.z() * along;
            // The lens hardly changes the scale: its Jacobian is left out.
            const Eigen::RowVector<double, 6> by_pose = gradient / 2 * focal_px * image_by_pose(camera_from_tag, point);
            information += by_pose.transpose() * by_pose / light_variance(recording, light.at(x, y));
        }
    }
    return information;
}

Eigen::Vector2d point_above_px(const RigidTransform& camera_from_tag) {
    return focal_px * (camera_from_tag * Eigen::Vector3d(0, 0, size_m)).hnormalized();
}

Eigen::Matrix<double, 2, 6> point_by_pose(const RigidTransform& camera_from_tag) {
    return focal_px * image_by_pose(camera_from_tag, Eigen::Vector3d(0, 0, size_m));
}

/// Whether the tag's normal is nearer to the other planar solution's, its mirror image about the line of sight. Head-on
/// the two are one.
bool is_mirrored(const RigidTransform& found, const RigidTransform& truth) {
    const Eigen::Vector3d sight = truth.translation().normalized();
    const Eigen::Vector3d normal = truth.linear().col(2), mirrored = 2 * normal.dot(sight) * sight - normal;
    constexpr double least_deg = 3;  // below it noise decides which is nearer
    if (std::acos(std::min(1.0, std::abs(normal.dot(sight)))) < least_deg * radians) return false;
    return found.linear().col(2).dot(mirrored) > found.linear().col(2).dot(normal);
}

struct ErrorSum {
    double squares = 0;
    int count = 0, mirrored = 0;
    void add(const RigidTransform& found, const RigidTransform& truth) {
        squares += (point_above_px(found) - point_above_px(truth)).squaredNorm();
        ++count;
        mirrored += is_mirrored(found, truth);
    }
    std::optional<double> rms() const { return count > 0 ? std::optional(std::sqrt(squares / count)) : std::nullopt; }
};

}  // namespace

TagPoseErrors try_tag_pose(const TagPoseTrial& trial) {
    const Shot shot{trial};
    const Camera camera = shot.camera();
    std::vector<TrialFrame> frames;
    if (trial.noise_px > 0) {
        for (int f = 0; f < trial.frames; ++f) frames.push_back(invented(shot, camera, f));
    } else {
        frames = photographed(shot, camera);
    }

    std::vector<FrameObservations> clip;
    for (int f = 0; f < trial.frames; ++f) {
        FrameObservations& seen = clip.emplace_back();
        seen.frame = f;
        seen.time_s = f / fps;
        if (const auto& tag = frames[static_cast<std::size_t>(f)].seen) seen.tags.push_back(*tag);
    }
    const std::vector<RigTag> rig{{tag_id, size_m, RigidTransform::Identity()}};
    const CameraPath path = solve_path(rig, {{tag_id, RigidTransform::Identity()}}, clip, camera);

    TagPoseErrors errors;
    ErrorSum ours, light, codes, ippe;
    for (int f = 0; f < trial.frames; ++f) {
        const auto index = static_cast<std::size_t>(f);
        const RigidTransform truth = shot.camera_from_tag(f);
        if (const auto& pose = path.frames[index].pose; pose && !path.frames[index].bridged) {
            ours.add(pose->camera_from_world, truth);
            const auto by_pose = point_by_pose(pose->camera_from_world);
            const double claimed = std::sqrt((by_pose * pose->covariance * by_pose.transpose()).trace());
            const double error = (point_above_px(pose->camera_from_world) - point_above_px(truth)).norm();
            errors.over_claimed = std::max(errors.over_claimed, error / claimed);
        }
        const TrialFrame& frame = frames[index];
        if (frame.light_corners) {
            light.add(apriltag_pose(*frame.light_corners, size_m), truth);
            if (const auto pose = ippe_pose(*frame.light_corners, size_m)) ippe.add(*pose, truth);
        }
        if (frame.code_corners) codes.add(apriltag_pose(*frame.code_corners, size_m), truth);
    }
    errors.ours = ours.rms(), errors.apriltag_light = light.rms();
    errors.apriltag_codes = codes.rms(), errors.ippe = ippe.rms();
    errors.found = ours.count, errors.found_in_codes = codes.count;
    errors.mirrored = ours.mirrored, errors.ippe_mirrored = ippe.mirrored;

    const int middle = trial.frames / 2;
    const auto by_pose = point_by_pose(shot.camera_from_tag(middle));
    const auto variance_of = [&by_pose](const Information& information) {
        return (by_pose * information.ldlt().solve(by_pose.transpose())).trace();
    };
    errors.noise_px = std::sqrt(variance_of(trial.noise_px > 0 ? corner_information(shot, middle, trial.noise_px)
                                                               : picture_information(shot, camera, middle)));
    errors.allowance_px = std::sqrt(variance_of(corner_information(shot, middle, corner_allowance_px)));
    if (trial.noise_px == 0) {
        // A step of light through a Gaussian of the same variance as box, disc and streak together: the information on
        // its place in one row of pixels is contrast² / (2·√π·s·σ²).
        const double spread =
            std::sqrt(1.0 / 12 + trial.defocus_px * trial.defocus_px / 16 + trial.motion_px * trial.motion_px / 12);
        const TagSheet sheet;
        const double sigma = std::sqrt(light_variance(recording_of(trial, 0), (sheet.paper + sheet.ink) / 2));
        errors.edge_noise_px = sigma / (sheet.paper - sheet.ink) * std::sqrt(2 * std::sqrt(std::numbers::pi) * spread);
    }
    return errors;
}

}  // namespace matchlight
