// Looks where the ray of each clipped pixel meets the surface.
#include "compositor/clipped_plate.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tracking/plate_light.h"

namespace matchlight {

namespace {

struct GatheredLight {
    Eigen::Vector3d radiance = Eigen::Vector3d::Zero();
    double knowledge = 0;
    bool clipped = false;
};

/// Bilinear between texels, by their knowledge.
GatheredLight gathered_light(const GatheredSurface& gathered, const Eigen::Vector2d& place_m) {
    const Eigen::Vector2d at =
        (place_m - gathered.rectangle_m.min()) / gathered.texel_m() - Eigen::Vector2d::Constant(0.5);
    const int width = gathered.radiance.width(), height = gathered.radiance.height();
    GatheredLight light;
    if (!(at.x() >= 0 && at.y() >= 0 && at.x() < width - 1.0 && at.y() < height - 1.0)) return light;
    const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
    for (int i = 0; i < 4; ++i) {
        const int x = column + i % 2, y = row + i / 2;
        const float* texel = gathered.radiance.pixel(x, y);
        const double weight = (1 - std::abs(at.x() - x)) * (1 - std::abs(at.y() - y)) * texel[3];
        light.radiance += weight * Eigen::Vector3d(texel[0], texel[1], texel[2]);
        light.knowledge += weight;
        light.clipped = light.clipped || (weight > 0 && gathered.clipped.at(x, y) > 0);
    }
    if (light.knowledge > 0) light.radiance /= light.knowledge;
    return light;
}

constexpr auto clipped_code = static_cast<float>(PlateLight::clipped_code);

bool is_clipped(const float* pixel) {
    return std::max({pixel[0], pixel[1], pixel[2]}) >= clipped_code;
}

/// The light of a pixel some of whose channels clip, in the footage's primaries: those are to the others as they are in
/// the nearest pixels that do not clip at all. Nullopt where all of its channels clip, or no such pixel is near.
std::optional<Eigen::Vector3d> light_by_neighbours(const ImageF& code, int column, int row, const ClippedView& view) {
    const auto light_of = [&](const float* pixel) -> Eigen::Vector3d {
        return {view.light_from_code(pixel[0], 0), view.light_from_code(pixel[1], 1),
                view.light_from_code(pixel[2], 2)};
    };
    const float* own = code.pixel(column, row);
    const auto clips = [&](int channel) { return own[channel] >= clipped_code; };
    if (clips(0) && clips(1) && clips(2)) return std::nullopt;
    Eigen::Vector3d light = light_of(own);
    // A few, so that noise and single specks do not tell the colour.
    constexpr int enough = 8, farthest_px = 24;
    Eigen::Vector3d around = Eigen::Vector3d::Zero();
    int found = 0;
    const auto look_at = [&](int x, int y) {
        if (!code.bounds().contains(x, y)) return;
        const float* pixel = code.pixel(x, y);
        // What was not decoded is 0, and black has no colour.
        if (is_clipped(pixel) || std::max({pixel[0], pixel[1], pixel[2]}) <= 0) return;
        around += light_of(pixel);
        ++found;
    };
    for (int radius = 1; radius <= farthest_px && found < enough; ++radius) {
        for (int i = -radius; i <= radius; ++i) {
            look_at(column + i, row - radius);
            look_at(column + i, row + radius);
            if (std::abs(i) == radius) continue;
            look_at(column - radius, row + i);
            look_at(column + radius, row + i);
        }
    }
    if (found < enough) return std::nullopt;
    double own_sum = 0, around_sum = 0;
    for (int c = 0; c < 3; ++c) {
        if (clips(c)) continue;
        own_sum += light[c];
        around_sum += around[c];
    }
    if (!(around_sum > 0) || !(own_sum > 0)) return std::nullopt;
    for (int c = 0; c < 3; ++c) {
        if (clips(c)) light[c] = std::max(light[c], around[c] * own_sum / around_sum);
    }
    return light;
}

/// Where the surface is seen through a pixel.
std::optional<Eigen::Vector2d> place_on_surface(const Eigen::Vector2d& normalized, const ClippedView& view) {
    const RigidTransform world_from_camera = view.optics.camera_from_world.inverse();
    const Eigen::Vector3d direction = world_from_camera.linear() * normalized.homogeneous();
    const Eigen::Vector3d eye_m = world_from_camera.translation();
    const double distance = (view.surface_z_m - eye_m.z()) / direction.z();
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    return Eigen::Vector2d((eye_m + distance * direction).head<2>());
}

}  // namespace

ClippedPlate unclip_plate(const ImageF& code, const Region& region, const std::vector<Region>& runs,
                          const ClippedView& view) {
    ClippedPlate result;
    const FrameOptics& optics = view.optics;
    const Eigen::Vector2d centre((optics.frame_width - 1) / 2.0, (optics.frame_height - 1) / 2.0);
    const double corner_px = std::hypot(optics.frame_width, optics.frame_height) / 2;
    const auto put = [&](int column, int row, const Eigen::Vector3d& light, double knowledge) {
        if (result.known.empty()) result.known = ImageF(region.width, region.height, 4);
        float* out = result.known.pixel(column, row);
        for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(light[c]);
        out[3] = static_cast<float>(knowledge);
    };
    const auto look_at = [&](int x, int y) {
        const Eigen::Vector2d normalized = view.lens_map.normalized(x, y);
        if (!normalized.allFinite()) return;
        const std::optional<Eigen::Vector2d> place_m = place_on_surface(normalized, view);
        if (!place_m || !view.in_shadow(Eigen::AlignedBox2d(*place_m))) return;
        const GatheredLight light = view.gathered ? gathered_light(*view.gathered, *place_m) : GatheredLight{};
        const int column = x - region.x, row = y - region.y;
        if (light.knowledge > 0) {
            const double r2 = (Eigen::Vector2d(x, y) - centre).squaredNorm() / (corner_px * corner_px);
            const double falloff = 1 + optics.vignette[0] * r2 + optics.vignette[1] * r2 * r2;
            const Eigen::Vector3d seen = falloff / optics.plate_gain * optics.gain.cwiseProduct(light.radiance);
            put(column, row, seen, light.knowledge);
        }
        constexpr double mostly = 0.5;
        if (light.knowledge >= mostly && !light.clipped) return;
        if (result.bound.empty()) result.bound = ImageF(region.width, region.height, 1);
        if (const auto by_colour = light_by_neighbours(code, column, row, view)) {
            const Eigen::Vector3d seen = view.rec709_from_footage * *by_colour;
            put(column, row, seen, 1);
            result.bound.at(column, row) = 0.5F;
            ++result.neighbours;
            return;
        }
        result.bound.at(column, row) = 1;
        ++result.bounds;
    };
    for (const Region& run : runs) {
        for (int y = run.y; y < run.y + run.height; ++y) {
            for (int x = run.x; x < run.x + run.width; ++x) {
                if (is_clipped(code.pixel(x - region.x, y - region.y))) look_at(x, y);
            }
        }
    }
    return result;
}

}  // namespace matchlight
