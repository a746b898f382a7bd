// Cases on the CPU: curves, lens, depth, poses, sampled light, metrics.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "calibration/camera.h"
#include "calibration/response.h"
#include "core/transfer.h"
#include "core/transforms.h"
#include "lighting/probe.h"
#include "render/effects/bright_light.h"
#include "render/effects/exposure.h"
#include "report/exposure_reference.h"
#include "report/flip.h"
#include "report/hdr_flip.h"
#include "report/image_error.h"
#include "report/stability_cases.h"
#include "tracking/camera_pose.h"

namespace matchlight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Largest |there(back(code)) − code| over every code of 16 bits.
double round_trip(const std::function<double(double)>& linear_from_code,
                  const std::function<double(double)>& code_from_linear) {
    constexpr int codes = 65535;
    double worst = 0;
    for (int code = 0; code <= codes; ++code) {
        const double value = static_cast<double>(code) / codes;
        worst = std::max(worst, std::abs(code_from_linear(linear_from_code(value)) - value));
    }
    return worst;
}

void add_curve_cases(std::vector<StabilityCase>& cases) {
    const auto add = [&](const std::string& name, double bound, double (*linear)(double), double (*code)(double)) {
        cases.push_back(
            {"transfer", name + ", every code of 16 bits there and back", "largest error", {0, bound}, {}, [=] {
                 return StabilityOutcome{round_trip(linear, code), {}};
             }});
    };
    add("sRGB", 1e-12, linear_from_srgb_code, srgb_code_from_linear);
    // ST 2084 gives no light the code c₁^m₂ = 7.31e-7, which is a tenth of half a code.
    add("PQ", 7.32e-7, linear_from_pq_code, pq_code_from_linear);
    add("HLG", 1e-12, linear_from_hlg_code, hlg_code_from_linear);
    const auto add_response = [&](const std::string& name, const Response& response) {
        cases.push_back(
            {"response", name + ", every code of 16 bits there and back", "largest error", {0, 1e-9}, {}, [response] {
                 return StabilityOutcome{round_trip([&](double code) { return response.linear_from_code(code, 1); },
                                                    [&](double light) { return response.code_from_linear(light, 1); }),
                                         {}};
             }});
    };
    add_response("gamma 2.2", Response::gamma(2.2));
    add_response("shoulder to infinity", Response::shoulder({}, "stability"));
    add_response("shoulder to white 8", Response::shoulder({.knee = 0.5, .white = 8}, "stability"));
}

void add_depth_cases(std::vector<StabilityCase>& cases) {
    // A float depth buffer with reversed z: near 0.01 m, what is at z m and what comes back from its depth.
    for (const double z_m : {0.011, 1.0, 1000.0, 1e6}) {
        cases.push_back({"depth buffer",
                         fmt::format("reversed z, near 0.01 m, a point at {:g} m", z_m),
                         "relative error of its distance",
                         {0, 1.2e-7},  // half a step of a float
                         {},
                         [z_m] {
                             const PinholeView view{
                                 .fx = 1000, .fy = 1000, .width = 1920, .height = 1080, .near_m = 0.01};
                             const Eigen::Matrix4f clip = clip_from_camera(view).cast<float>();
                             const Eigen::Vector4f at = clip * Eigen::Vector4f(0, 0, static_cast<float>(z_m), 1);
                             const float depth = at.z() / at.w();
                             return StabilityOutcome{std::abs(view.near_m / depth - z_m) / z_m, {}};
                         }});
    }
}

void add_lens_cases(std::vector<StabilityCase>& cases) {
    for (const double k1 : {-0.35, 0.0, 0.4}) {
        cases.push_back({"lens",
                         fmt::format("k1 = {:g}, pixels of the whole frame there and back", k1),
                         "largest error in pixels",
                         {0, 1e-6},
                         {},
                         [k1] {
                             Camera camera;
                             camera.width = 1920;
                             camera.height = 1080;
                             camera.fx = camera.fy = 1600;
                             camera.cx = 959.5;
                             camera.cy = 539.5;
                             camera.distortion = {k1, 0, 0, 0};
                             double worst = 0;
                             for (int y = 0; y < camera.height; y += 20) {
                                 for (int x = 0; x < camera.width; x += 20) {
                                     const Eigen::Vector2d pixel(x, y);
                                     const Eigen::Vector2d back =
                                         camera.pixel_from_normalized(camera.normalized_from_pixel(pixel));
                                     worst = std::max(worst, (back - pixel).norm());
                                 }
                             }
                             return StabilityOutcome{worst, {}};
                         }});
    }
}

/// A single tag seen by a camera, its corners exact, with the covariance of `noise_px` of noise.
TagObservation exact_tag(const RigidTransform& camera_from_tag, double size_m, double noise_px) {
    constexpr double focal_px = 1000;
    TagObservation seen;
    const Eigen::Matrix<double, 3, 4> corners = tag_corners_m(size_m);
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector3d at = camera_from_tag * Eigen::Vector3d(corners.col(i));
        seen.corners_normalized.col(i) = at.head<2>() / at.z();
        seen.corners_px.col(i) = focal_px * seen.corners_normalized.col(i);
    }
    seen.side_px = focal_px * size_m / camera_from_tag.translation().z();
    seen.refined = true;
    seen.covariance = TagCovariance::Identity() * std::pow(noise_px / focal_px, 2);
    return seen;
}

void add_pose_cases(std::vector<StabilityCase>& cases) {
    for (const double tilt_deg : {0.5, 10.0, 45.0, 80.0}) {
        cases.push_back(
            {"planar pose",
             fmt::format("exact corners of a tag 25 px wide, tilted by {:g}°", tilt_deg),
             "error of the better of two solutions in degrees",
             {0, 0.01},
             {},
             [tilt_deg] {
                 RigidTransform truth = RigidTransform::Identity();
                 truth.linear() =
                     Eigen::AngleAxisd(std::numbers::pi - tilt_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitX())
                         .toRotationMatrix();
                 truth.translation() = Eigen::Vector3d(0.05, 0.03, 3.2);
                 const TagObservation seen = exact_tag(truth, 0.08, 0.3);
                 double least = infinity;
                 for (const CameraPose& pose : planar_poses(seen, 0.08)) {
                     const Eigen::AngleAxisd turn(pose.camera_from_world.linear().transpose() * truth.linear());
                     least = std::min(least, std::abs(turn.angle()) * 180 / std::numbers::pi);
                 }
                 return StabilityOutcome{least, {}};
             }});
    }
}

Probe one_pixel_sun(double radiance, float walls) {
    Probe probe{ImageF(512, 256, 3, walls)};
    for (int c = 0; c < 3; ++c) probe.latlong.at(300, 60, c) = static_cast<float>(radiance);
    return probe;
}

void add_light_cases(std::vector<StabilityCase>& cases) {
    for (const double sun : {1e-8, 65504.0, 1e9}) {
        cases.push_back({"sampled light",
                         fmt::format("64 directions of a one-pixel sun of {:g} in the dark", sun),
                         "directions without a finite light",
                         {0, 0},
                         Bound{1 - 1e-9, 1 + 1e-9},
                         [sun] {
                             const Probe probe = one_pixel_sun(sun, 0);
                             double bad = 0, sampled = 0;
                             for (const DirectionalSample& sample : sample_directions(probe, 64, -1, false)) {
                                 bad += sample.radiance_times_solid_angle.allFinite() ? 0 : 1;
                                 sampled += sample.radiance_times_solid_angle.sum();
                             }
                             const double above = std::cos(60 * std::numbers::pi / 256);
                             const double below = std::cos(61 * std::numbers::pi / 256);
                             const double there = 3 * static_cast<double>(static_cast<float>(sun)) * 2 *
                                                  std::numbers::pi / 512 * (above - below);
                             return StabilityOutcome{bad, sampled / there};
                         }});
    }
    cases.push_back({"sampled light", "a black probe", "light of all directions", {0, 0}, {}, [] {
                         double sum = 0;
                         for (const DirectionalSample& sample : sample_directions(one_pixel_sun(0, 0), 64, -1, false)) {
                             sum += sample.radiance_times_solid_angle.sum();
                         }
                         return StabilityOutcome{sum, {}};
                     }});
    cases.push_back({"irradiance",
                     "a one-pixel sun of 1e9 beside walls of 1e-8, summed in double",
                     "relative error of the walls' share on the far side",
                     {0, 1e-12},
                     {},
                     [] {
                         const Eigen::Vector3d away = -latlong_direction(300, 60, 512, 256);
                         const double with_sun = irradiance(one_pixel_sun(1e9, 1e-8F), away).x();
                         const double walls = irradiance(one_pixel_sun(1e-8, 1e-8F), away).x();
                         return StabilityOutcome{std::abs(with_sun / walls - 1), {}};
                     }});
}

void add_bright_curve_cases(std::vector<StabilityCase>& cases) {
    for (const double threshold : {0.0, 1e-8, 1.0, 65504.0}) {
        cases.push_back({"bright pass",
                         fmt::format("the knee at a threshold of {:g}, light from 1e-12 to 1e12", threshold),
                         "largest fall from one light to a brighter one, relative",
                         {0, 1e-12},
                         {},
                         [threshold] {
                             double worst = 0, last = 0;
                             for (int i = -4000; i <= 4000; ++i) {
                                 const double light = std::pow(10, i * 0.003);
                                 const double out = light * bright_share(light, threshold, 0.5);
                                 worst = std::isfinite(out) ? std::max(worst, (last - out) / light) : infinity;
                                 last = out;
                             }
                             return StabilityOutcome{worst, {}};
                         }});
    }
}

void add_metric_cases(std::vector<StabilityCase>& cases) {
    struct Pair {
        const char* name;
        float reference, test;
    };
    for (const Pair& pair : {Pair{"black against 1e9", 0, 1e9F}, Pair{"1e-8 against 2e-8", 1e-8F, 2e-8F},
                             Pair{"65504 against 0", 65504, 0}, Pair{"1e9 against 1e9", 1e9F, 1e9F}}) {
        cases.push_back({"HDR-FLIP", pair.name, "largest error", {0, 1}, {}, [pair] {
                             ImageF reference(40, 40, 3, 0.1F * pair.reference), test(40, 40, 3, 0.1F * pair.reference);
                             for (int c = 0; c < 3; ++c) {
                                 reference.at(20, 20, c) = pair.reference;
                                 test.at(20, 20, c) = pair.test;
                             }
                             double largest = 0;
                             const ImageF map = hdr_flip_error_map(reference, test);
                             for (const float error : map.samples()) {
                                 largest =
                                     std::isfinite(error) ? std::max(largest, static_cast<double>(error)) : infinity;
                             }
                             return StabilityOutcome{largest, {}};
                         }});
    }
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {8192, 33}}) {
        cases.push_back({"FLIP",
                         fmt::format("a picture of {}×{} against its negative", width, height),
                         "mean error",
                         {0.1, 1},
                         {},
                         [width = width, height = height] {
                             const Image8 black(width, height, 3, 0), white(width, height, 3, 255);
                             return StabilityOutcome{masked_mean(flip_error_map(black, white)).value_or(-1), {}};
                         }});
    }
}

void add_adaptation_cases(std::vector<StabilityCase>& cases) {
    for (const double steps : {1e-3, 1.0, 2.1, 1e3, 1e6}) {
        cases.push_back({"adaptation",
                         fmt::format("100 frames of {:g} time constants each, over 40 EV", steps),
                         "largest error in EV against the closed form",
                         {0, 1e-9},
                         {},
                         [steps] {
                             const ExposureSettings settings;
                             constexpr double start = -20, target = 20;
                             const double dt_s = steps * settings.to_light_s;
                             double now = start, worst = 0;
                             for (int frame = 1; frame <= 100; ++frame) {
                                 now = adapted(now, target, dt_s, settings);
                                 const double expected =
                                     reference_adaptation(start, target, frame * dt_s, settings.to_light_s);
                                 worst = std::isfinite(now) ? std::max(worst, std::abs(now - expected)) : infinity;
                             }
                             return StabilityOutcome{worst, {}};
                         }});
    }
}

}  // namespace

std::vector<StabilityCase> number_cases() {
    std::vector<StabilityCase> cases;
    add_curve_cases(cases);
    add_depth_cases(cases);
    add_lens_cases(cases);
    add_pose_cases(cases);
    add_light_cases(cases);
    add_bright_curve_cases(cases);
    add_metric_cases(cases);
    add_adaptation_cases(cases);
    return cases;
}

}  // namespace matchlight
