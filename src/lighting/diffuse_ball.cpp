// The energy of lamps that no photograph could hold, from a grey or white ball that they light.
#include "lighting/diffuse_ball.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/parallel.h"
#include "lighting/mirror_ball.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

/// Patches across the ball, the least that tell anything, and how many share their errors: a print, a smudge or a
/// reflected wall covers a few times the width of a patch.
constexpr double patches_across = 40;
constexpr std::size_t fewest_patches = 50;
constexpr double alike = 20;
/// Of the normal with the line of sight, at least: nearer the rim a pixel mixes ball and background.
constexpr double least_cosine = 0.3;

/// A part of the picture in which the ball's light is read.
struct SeenPatch {
    Eigen::Vector3d radiance = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // world, unit length
};

/// The mean over a square of pixels; nullopt where one is clipped or shows no ball, or the rim.
std::optional<SeenPatch> patch_at(const BallView& view, const Region& square) {
    const MirrorBall unit{view.outline.axis / std::sin(view.outline.half_angle), 1};  // camera frame
    SeenPatch patch;
    for (int y = square.y; y < square.y + square.height; ++y) {
        for (int x = square.x; x < square.x + square.width; ++x) {
            if (x < 0 || y < 0 || x >= view.radiance.width() || y >= view.radiance.height()) return std::nullopt;
            if (!view.clipped.empty() && view.clipped.at(x, y) != 0) return std::nullopt;
            const Eigen::Vector3d ray = view.camera.normalized_from_pixel({x, y}).homogeneous().normalized();
            const auto hit = hit_ball(unit, Eigen::Vector3d::Zero(), ray);
            if (!hit || hit->cosine < least_cosine) return std::nullopt;
            patch.normal += hit->normal;
            patch.radiance += Eigen::Map<const Eigen::Vector3f>(view.radiance.pixel(x, y)).cast<double>();
        }
    }
    patch.radiance /= static_cast<double>(square.width) * square.height;
    if (!(patch.radiance.minCoeff() > 0) || !patch.radiance.allFinite()) return std::nullopt;
    patch.normal = view.camera_from_world->linear().transpose() * patch.normal.normalized();
    return patch;
}

std::vector<SeenPatch> patches_of(const BallView& view) {
    const Eigen::Vector2d centre = view.camera.pixel_from_camera(view.outline.axis);
    const double radius_px = view.outline.radius_px(view.camera);
    const int side = std::max(1, static_cast<int>(std::lround(2 * radius_px / patches_across)));
    // An ellipse is longer than its mean radius.
    const auto reach = static_cast<int>(std::ceil(1.5 * radius_px / side));
    const int x0 = static_cast<int>(std::lround(centre.x())), y0 = static_cast<int>(std::lround(centre.y()));
    std::vector<SeenPatch> patches;
    for (int row = -reach; row < reach; ++row) {
        for (int column = -reach; column < reach; ++column) {
            if (const auto patch = patch_at(view, {x0 + column * side, y0 + row * side, side, side})) {
                patches.push_back(*patch);
            }
        }
    }
    return patches;
}

Probe below_horizon(Probe probe) {
    for (int y = 0; y < probe.latlong.height() / 2; ++y) {
        std::fill_n(probe.latlong.pixel(0, y), 3 * static_cast<std::size_t>(probe.latlong.width()), 0.F);
    }
    return probe;
}

Eigen::Vector3d irradiance_of(const ClippedPart& part, const Eigen::Vector3d& normal) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const ClippedPart::Pixel& pixel : part.pixels) sum += std::max(0.0, pixel.towards.dot(normal)) * pixel.light;
    return sum;
}

}  // namespace

std::vector<ClippedLight> solve_clipped_lights(BallProbe& probe, const DiffuseBall& ball) {
    std::vector<ClippedPart> parts = clipped_parts(probe);
    // Irradiance varies slowly: a small map gives it within a thousandth.
    const Probe rest = resized(light_without(probe, parts), 64);
    const double whole_irradiance = irradiance(rest, Eigen::Vector3d::UnitZ()).sum();
    std::erase_if(parts, [&](const ClippedPart& part) { return part.bound() < 1e-4 * whole_irradiance; });
    if (parts.empty()) return {};

    const std::vector<SeenPatch> seen = patches_of(ball.view);
    if (seen.size() < fewest_patches) {
        throw InputError(ball.view.name,
                         fmt::format("the diffuse ball can be read in {} places only, of {} that are needed",
                                     seen.size(), fewest_patches),
                         "photograph it larger, and also with shorter exposures, which do not clip it");
    }
    const Probe below = below_horizon(rest);
    std::vector<LitPatch> patches(seen.size());
    parallel_for(static_cast<int>(seen.size()), [&](int i) {
        const SeenPatch& from = seen[static_cast<std::size_t>(i)];
        LitPatch& patch = patches[static_cast<std::size_t>(i)];
        patch.radiance = from.radiance;
        patch.rest = irradiance(rest, from.normal) / std::numbers::pi;
        Eigen::Vector3d whole = patch.rest;
        for (const ClippedPart& part : parts) {
            patch.parts.push_back(irradiance_of(part, from.normal) / std::numbers::pi);
            whole += patch.parts.back();
        }
        // Paint is even, and Lambertian, within a twentieth.
        const Eigen::Vector3d from_below = irradiance(below, from.normal) / std::numbers::pi;
        for (int c = 0; c < 3; ++c) {
            patch.relative_sigma[c] = whole[c] > 0 ? std::hypot(0.05, 0.5 * from_below[c] / whole[c]) : 1;
        }
    });
    std::optional<AlbedoPrior> prior;
    if (ball.albedo) prior = AlbedoPrior{*ball.albedo, 0.02};
    solve_gains(parts, patches, prior, alike);
    return apply_gains(probe, parts);
}

}  // namespace matchlight
