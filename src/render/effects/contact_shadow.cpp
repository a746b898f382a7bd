// Flattens the casters along four directions at a time into the channels of one mask, then takes their light away.
#include "render/effects/contact_shadow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "core/transfer.h"
#include "gl/framebuffer.h"
#include "render/lamps.h"

namespace matchlight {

void ContactShadowSettings::check() const {
    if (directions < 1 || directions > 1024) {
        throw std::invalid_argument(fmt::format("contact shadow: directions must be 1..1024, not {}", directions));
    }
    if (resolution < 16 || resolution > 4096) {
        throw std::invalid_argument(fmt::format("contact shadow: resolution must be 16..4096, not {}", resolution));
    }
    if (!(lost_share >= 0 && lost_share < 1)) {
        throw std::invalid_argument(fmt::format("contact shadow: lost_share must be in [0, 1), not {}", lost_share));
    }
}

namespace {

/// What a direction brings to the surface: radiance · solid angle · cos θ, RGB.
Eigen::Vector3d irradiance_of(const DirectionalSample& sample) {
    return sample.radiance_times_solid_angle * std::max(sample.direction.z(), 0.0);
}

Eigen::AlignedBox2d flattened(const Eigen::AlignedBox3d& bounds_m, double surface_z_m,
                              const Eigen::Vector3d& direction) {
    Eigen::AlignedBox2d rectangle;
    const double low = std::max(bounds_m.min().z(), surface_z_m) - surface_z_m;
    const double high = bounds_m.max().z() - surface_z_m;
    for (const double height : {low, high}) {
        const Eigen::Vector2d offset = direction.head<2>() * (height / direction.z());
        rectangle.extend(Eigen::Vector2d(bounds_m.min().head<2>() - offset));
        rectangle.extend(Eigen::Vector2d(bounds_m.max().head<2>() - offset));
    }
    return rectangle;
}

/// One direction and the RGB share of the surface's light that it brings.
struct ShadowLight {
    Eigen::Vector3d direction;
    Eigen::Vector3d share;
    double returned = 0;  // share that a white caster sends back instead
};

/// The texels that a part of the rectangle can touch.
Region texels_of(const Eigen::AlignedBox2d& part_m, const Eigen::AlignedBox2d& rectangle_m, int width, int height) {
    const Eigen::AlignedBox2d inside = part_m.intersection(rectangle_m);
    if (inside.isEmpty()) return {};
    const Eigen::Array2d scale = Eigen::Array2d(width, height) / rectangle_m.sizes().array();
    const Eigen::Array2i low = ((inside.min() - rectangle_m.min()).array() * scale).floor().cast<int>();
    const Eigen::Array2i high = ((inside.max() - rectangle_m.min()).array() * scale).ceil().cast<int>();
    return Region{low.x(), low.y(), high.x() - low.x(), high.y() - low.y()}.grown(1).intersected({0, 0, width, height});
}

}  // namespace

SphereProjection flattening_view(const Eigen::Vector3d& to_light, double surface_z_m, double highest_m,
                                 const ShadowMap& map) {
    const Eigen::Vector2d low_m = map.rectangle_m.min(), size_m = map.rectangle_m.sizes();
    const Eigen::Vector2d lean = to_light.head<2>() / to_light.z();
    SphereProjection view{.width = map.loss.width(), .height = map.loss.height(), .is_parallel = true};
    view.clip_from_world.setIdentity();
    for (int axis = 0; axis < 2; ++axis) {
        const double sign = axis == 0 ? 1 : -1;  // row 0 holds the smallest y
        const double scale = sign * 2 / size_m[axis];
        view.clip_from_world.row(axis).setZero();
        view.clip_from_world(axis, axis) = scale;
        view.clip_from_world(axis, 2) = -scale * lean[axis];
        view.clip_from_world(axis, 3) = scale * (lean[axis] * surface_z_m - low_m[axis]) - sign;
    }
    // Twice as high as anything is: what a sphere's bounds add stays within the clip space.
    const double per_m = 1 / (4 * std::max(highest_m - surface_z_m, 1e-9));
    view.clip_from_world(2, 2) = per_m;
    view.clip_from_world(2, 3) = 0.5 - per_m * surface_z_m;
    return view;
}

namespace {

ShadowMap draw_map(ShaderLibrary& shaders, const ShadowCasters& casters, double surface_z_m,
                   std::span<const ShadowLight> lights, const Eigen::AlignedBox2d& rectangle_m, int resolution) {
    const Eigen::Vector2d size_m = rectangle_m.sizes();
    const double texel_m = size_m.maxCoeff() / resolution;
    const int width = std::max(2, static_cast<int>(std::ceil(size_m.x() / texel_m)));
    const int height = std::max(2, static_cast<int>(std::ceil(size_m.y() / texel_m)));
    const Texture2D masks({.format = GL_RGBA8, .width = width, .height = height});
    ShadowMap map{Texture2D({.format = GL_RGBA32F, .width = width, .height = height}), rectangle_m};
    const Framebuffer mask_target({masks});
    const Framebuffer loss_target({map.loss});
    loss_target.clear_color(0, 0, 0, 0, 0);

    Program& flatten = shaders.program({{GL_VERTEX_SHADER, "effects/contact_shadow/flatten.vert"},
                                        {GL_FRAGMENT_SHADER, "effects/contact_shadow/flatten.frag"}});
    Program& accumulate = shaders.full_screen("effects/contact_shadow/accumulate.frag");
    flatten.use();
    flatten.set("surface_z_m", surface_z_m);
    flatten.set("rectangle_min_m", Eigen::Vector2f(rectangle_m.min().cast<float>()));
    flatten.set("rectangle_size_m", Eigen::Vector2f(size_m.cast<float>()));
    const FullScreenTriangle triangle;

    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_SCISSOR_TEST);
    for (std::size_t first = 0; first < lights.size(); first += 4) {
        const std::span<const ShadowLight> batch =
            lights.subspan(first, std::min<std::size_t>(4, lights.size() - first));
        Eigen::AlignedBox2d footprint_m;
        for (const ShadowLight& light : batch) {
            footprint_m.extend(flattened(casters.bounds_m, surface_z_m, light.direction));
        }
        const Region footprint = texels_of(footprint_m, rectangle_m, width, height);
        if (footprint.empty()) continue;
        glScissor(footprint.x, footprint.y, footprint.width, footprint.height);

        mask_target.bind();
        mask_target.clear_color(0, 0, 0, 0, 0);
        glDisable(GL_BLEND);
        glEnable(GL_CLIP_DISTANCE0);
        flatten.use();
        std::array<Eigen::Vector3f, 4> lost_share;
        lost_share.fill(Eigen::Vector3f::Zero());
        Eigen::Vector4f returned_share = Eigen::Vector4f::Zero();
        for (std::size_t channel = 0; channel < batch.size(); ++channel) {
            lost_share[channel] = batch[channel].share.cast<float>();
            returned_share[static_cast<int>(channel)] = static_cast<float>(batch[channel].returned);
            glColorMask(channel == 0, channel == 1, channel == 2, channel == 3);
            flatten.set("direction_to_light", Eigen::Vector3f(batch[channel].direction.cast<float>()));
            casters.draw(flatten);
            if (!casters.cast_spheres) continue;
            casters.cast_spheres(
                {.view = flattening_view(batch[channel].direction, surface_z_m, casters.bounds_m.max().z(), map),
                 .fragment = "effects/contact_shadow/flatten.frag",
                 .set_up = {}});
            flatten.use();
        }
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDisable(GL_CLIP_DISTANCE0);

        loss_target.bind();
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        accumulate.use();
        accumulate.bind_texture("masks", 0, masks);
        accumulate.set("lost_share", std::span<const Eigen::Vector3f>(lost_share));
        accumulate.set("returned_share", returned_share);
        triangle.draw();
        glDisable(GL_BLEND);
    }
    glDisable(GL_SCISSOR_TEST);
    return map;
}

void bind_map(Program& program, const ShadowMap& map, const std::string& name, GLuint unit) {
    program.bind_texture(name, unit, map.loss);
    const Eigen::Vector2d low = map.rectangle_m.min();
    const Eigen::Vector2d size = map.rectangle_m.sizes();
    program.set(name + "_rectangle_m",
                Eigen::Vector4f(Eigen::Vector4d(low.x(), low.y(), size.x(), size.y()).cast<float>()));
}

}  // namespace

void ContactShadow::bind(Program& program, GLuint first_unit) const {
    bind_map(program, fine, "shadow_fine", first_unit);
    bind_map(program, far, "shadow_far", first_unit + 1);
    if (!lamps) return;
    const Eigen::Vector3d reference = lamps->reference();
    lamps->lamps->bind(program);
    program.set("lamp_surface_z_m", surface_z_m);
    program.set("inverse_reference", Eigen::Vector3f(reference.cwiseInverse().cast<float>()));
    program.set("probe_share", Eigen::Vector3f(lamps->probe_irradiance.cwiseQuotient(reference).cast<float>()));
}

ContactShadow ContactShadow::copy() const {
    const auto copied = [](const ShadowMap& map) {
        ShadowMap result{Texture2D(map.loss.shape()), map.rectangle_m};
        glCopyImageSubData(map.loss.name(), GL_TEXTURE_2D, 0, 0, 0, 0, result.loss.name(), GL_TEXTURE_2D, 0, 0, 0, 0,
                           map.loss.width(), map.loss.height(), 1);
        return result;
    };
    return {.fine = copied(fine), .far = copied(far), .surface_z_m = surface_z_m, .lamps = lamps};
}

Eigen::AlignedBox2d contact_shadow_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m,
                                         const std::vector<DirectionalSample>& samples, double lost_share) {
    double total = 0;
    std::vector<const DirectionalSample*> steepest_first;
    for (const DirectionalSample& sample : samples) {
        if (sample.direction.z() <= 0) continue;
        steepest_first.push_back(&sample);
        total += irradiance_of(sample).sum();
    }
    std::stable_sort(steepest_first.begin(), steepest_first.end(),
                     [](const auto* a, const auto* b) { return a->direction.z() > b->direction.z(); });
    // The flattest directions throw the longest shadows: leave out as many as bring less than the share.
    double left_out = 0;
    while (!steepest_first.empty()) {
        left_out += irradiance_of(*steepest_first.back()).sum();
        if (left_out > lost_share * total) break;
        steepest_first.pop_back();
    }
    Eigen::AlignedBox2d reach;
    for (const DirectionalSample* sample : steepest_first) {
        reach.extend(flattened(caster_bounds_m, surface_z_m, sample->direction));
    }
    return reach;
}

SurfaceLight make_surface_light(const Probe& probe, double z_m, int directions) {
    SurfaceLight surface;
    surface.z_m = z_m;
    surface.samples = sample_directions(probe, directions, 0, true);
    const Eigen::Vector3d from_above = irradiance(probe, Eigen::Vector3d::UnitZ());
    // Seen from the probe the surface fills the lower half: its mean radiance is the irradiance from below over π.
    const Eigen::Vector3d radiance = irradiance(probe, -Eigen::Vector3d::UnitZ()) / std::numbers::pi;
    const double light = luminance_rec709(from_above.x(), from_above.y(), from_above.z());
    if (light > 0) {
        const double albedo_over_pi = luminance_rec709(radiance.x(), radiance.y(), radiance.z()) / light;
        // No surface sends back more than it gets; what lies lower than the probe may be lit better than the surface.
        surface.radiance_per_irradiance = std::min(albedo_over_pi, 1 / std::numbers::pi);
    }
    return surface;
}

std::optional<ContactShadow> make_contact_shadow(ShaderLibrary& shaders, const ShadowCasters& casters,
                                                 const SurfaceLight& surface, const ContactShadowSettings& settings) {
    settings.check();
    const double surface_z_m = surface.z_m;
    const std::vector<DirectionalSample>& samples = surface.samples;
    if (casters.bounds_m.isEmpty() || casters.bounds_m.max().z() <= surface_z_m) return std::nullopt;
    const Eigen::AlignedBox2d reach =
        contact_shadow_reach(casters.bounds_m, surface_z_m, samples, settings.lost_share).merged(surface.lamp_reach_m);
    if (reach.isEmpty()) return std::nullopt;

    // The fine map takes every direction whose whole shadow lies within the casters' height around their feet; the
    // flatter ones, whose shadows are long and weak, share the far map. Each direction is drawn once.
    const double height_m = casters.bounds_m.max().z() - surface_z_m;
    Eigen::AlignedBox2d feet(casters.bounds_m.min().head<2>(), casters.bounds_m.max().head<2>());
    feet.min().array() -= height_m;
    feet.max().array() += height_m;
    Eigen::Vector3d total = Eigen::Vector3d::Zero();
    for (const DirectionalSample& sample : samples) total += irradiance_of(sample);
    std::vector<ShadowLight> steep, flat;
    for (const DirectionalSample& sample : samples) {
        if (sample.direction.z() <= 0) continue;
        const ShadowLight light{sample.direction, irradiance_of(sample).cwiseQuotient(total.cwiseMax(1e-300)),
                                surface.radiance_per_irradiance * sample.solid_angle_sr * sample.direction.z()};
        if (!(light.share.maxCoeff() > 0)) continue;
        const bool within = feet.contains(flattened(casters.bounds_m, surface_z_m, sample.direction));
        (within ? steep : flat).push_back(light);
    }
    // Neighbours in azimuth share a batch, so that a batch touches few texels.
    const auto by_azimuth = [](const ShadowLight& a, const ShadowLight& b) {
        return std::atan2(a.direction.y(), a.direction.x()) < std::atan2(b.direction.y(), b.direction.x());
    };
    std::stable_sort(steep.begin(), steep.end(), by_azimuth);
    std::stable_sort(flat.begin(), flat.end(), by_azimuth);
    ContactShadow shadow;
    shadow.surface_z_m = surface_z_m;
    shadow.fine = draw_map(shaders, casters, surface_z_m, steep, feet, settings.resolution);
    shadow.far = draw_map(shaders, casters, surface_z_m, flat, reach.merged(feet), settings.resolution);
    return shadow;
}

}  // namespace matchlight
