// Flattens the casters from four points of a lamp at a time, then takes its light away where they cover the surface.
#include "render/effects/lamp_shadow.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gl/framebuffer.h"

namespace matchlight {

namespace {

/// Shadows that are longer than so many heights (a lamp lower than one degree) are cut off: the surface has 1/57 of the
/// light there that faces the lamp.
constexpr double longest_shadow = 57;

double cosine_of(const LampArrival& arrival) {
    return std::max(arrival.to_lamp.z(), 0.0);
}

/// A lamp's own points, from which the casters are flattened: directions of a directional light.
std::vector<Eigen::Vector3d> points_of(const LampSettings& lamp, const Eigen::Vector3d& seen_from_m, int count) {
    const bool is_placed = lamp.type != LampType::directional;
    const Eigen::Vector3d to_lamp =
        is_placed ? Eigen::Vector3d((lamp.position_m - seen_from_m).normalized()) : -lamp.direction.normalized();
    const double size = is_placed ? lamp.radius_m : std::tan(lamp.angle_deg / 2 * std::numbers::pi / 180);
    if (size == 0) count = 1;
    const Eigen::Vector3d right = to_lamp.unitOrthogonal(), up = to_lamp.cross(right);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) {
        // Vogel 1979, "A Better Way to Construct the Sunflower Head".
        const double radius = size == 0 ? 0 : size * std::sqrt((i + 0.5) / count);
        const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
        const Eigen::Vector3d aside = radius * (std::cos(angle) * right + std::sin(angle) * up);
        points.push_back(is_placed ? Eigen::Vector3d(lamp.position_m + aside)
                                   : Eigen::Vector3d((to_lamp + aside).normalized()));
    }
    return points;
}

/// From a point above the surface onto the map; clip w = metres below the point.
SphereProjection flattening_from(const Eigen::Vector3d& point_m, double surface_z_m, const ShadowMap& map) {
    constexpr double near_m = 1e-3;
    const double height_m = point_m.z() - surface_z_m;
    const Eigen::Vector2d low_m = map.rectangle_m.min(), size_m = map.rectangle_m.sizes();
    SphereProjection view{.width = map.loss.width(), .height = map.loss.height()};
    Eigen::Matrix4d& clip = view.clip_from_world;
    clip.setZero();
    clip.row(3) << 0, 0, -1, point_m.z();
    clip(2, 3) = near_m;
    for (int axis = 0; axis < 2; ++axis) {
        const double sign = axis == 0 ? 1 : -1;  // row 0 holds the smallest y
        const double scale = 2 / size_m[axis];
        clip(axis, axis) = sign * scale * height_m;
        clip(axis, 2) = -sign * scale * point_m[axis];
        clip(axis, 3) = sign * scale * point_m[axis] * surface_z_m;
        clip.row(axis) -= sign * (scale * low_m[axis] + 1) * clip.row(3);
    }
    return view;
}

struct LampCast {
    const ShadowCasters& casters;
    double surface_z_m;
    const SurfaceLamps& lamps;
    int points;
};

void set_map(Program& program, const ShadowMap& map) {
    const Eigen::Vector2d low = map.rectangle_m.min(), size = map.rectangle_m.sizes();
    program.set("rectangle_m", Eigen::Vector4f(Eigen::Vector4d(low.x(), low.y(), size.x(), size.y()).cast<float>()));
}

/// What casters take of all lamps, over the rectangle and with the texels of `like`.
ShadowMap draw_loss(ShaderLibrary& shaders, const LampCast& cast, const ShadowMap& like) {
    ShadowMap map{Texture2D(like.loss.shape()), like.rectangle_m};
    const Texture2D masks({.format = GL_RGBA8, .width = map.loss.width(), .height = map.loss.height()});
    const Framebuffer mask_target({masks}), loss_target({map.loss});
    loss_target.clear_color(0, 0, 0, 0, 0);
    Program& flatten = shaders.program({{GL_VERTEX_SHADER, "effects/lamp_shadow/flatten.vert"},
                                        {GL_FRAGMENT_SHADER, "effects/contact_shadow/flatten.frag"}});
    Program& accumulate = shaders.full_screen("effects/lamp_shadow/accumulate.frag");
    const FullScreenTriangle triangle;
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    const std::vector<LampSettings>& lamps = cast.lamps.lamps->settings();
    const Eigen::Vector3d centre_m = cast.casters.bounds_m.center();
    for (std::size_t i = 0; i < lamps.size(); ++i) {
        const LampSettings& lamp = lamps[i];
        if (!lamp.casts_shadow || lamp.of_probe) continue;
        const bool is_placed = lamp.type != LampType::directional;
        const std::vector<Eigen::Vector3d> points = points_of(lamp, centre_m, cast.points);
        for (std::size_t first = 0; first < points.size(); first += 4) {
            const std::size_t end = std::min(first + 4, points.size());
            mask_target.bind();
            mask_target.clear_color(0, 0, 0, 0, 0);
            glDisable(GL_BLEND);
            for (std::size_t at = first; at < end; ++at) {
                const Eigen::Vector3d& point = points[at];
                if ((is_placed ? point.z() - cast.surface_z_m : point.z()) <= 0) continue;
                const SphereProjection view =
                    is_placed ? flattening_from(point, cast.surface_z_m, map)
                              : flattening_view(point, cast.surface_z_m, cast.casters.bounds_m.max().z(), map);
                const std::size_t channel = at - first;
                glColorMask(channel == 0, channel == 1, channel == 2, channel == 3);
                flatten.use();
                flatten.set("surface_z_m", cast.surface_z_m);
                flatten.set("clip_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
                glEnable(GL_CLIP_DISTANCE0);
                cast.casters.draw(flatten);
                glDisable(GL_CLIP_DISTANCE0);
                if (!cast.casters.cast_spheres) continue;
                cast.casters.cast_spheres(
                    {.view = view, .fragment = "effects/contact_shadow/flatten.frag", .set_up = [&](Program& program) {
                         if (is_placed)
                             program.set("surface_depth", view.clip_from_world(2, 3) / (point.z() - cast.surface_z_m));
                     }});
            }
            glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
            loss_target.bind();
            glEnable(GL_BLEND);
            glBlendFunc(GL_ONE, GL_ONE);
            accumulate.use();
            cast.lamps.lamps->bind(accumulate);
            accumulate.bind_texture("masks", 0, masks);
            accumulate.set("lamp", static_cast<int>(i));
            accumulate.set("point_share", 1.0 / static_cast<double>(points.size()));
            accumulate.set("lamp_surface_z_m", cast.surface_z_m);
            accumulate.set("inverse_reference", Eigen::Vector3f(cast.lamps.reference().cwiseInverse().cast<float>()));
            set_map(accumulate, map);
            triangle.draw();
            glDisable(GL_BLEND);
        }
    }
    return map;
}

void add_loss(ShaderLibrary& shaders, const ShadowMap& map, const ShadowMap& loss, const ShadowMap* coarse) {
    Program& add = shaders.full_screen("effects/lamp_shadow/add.frag");
    const FullScreenTriangle triangle;
    const Framebuffer target({map.loss});
    target.bind();
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    add.use();
    add.bind_texture("lamp_loss", 0, loss.loss);
    add.bind_texture("coarse_loss", 1, coarse != nullptr ? coarse->loss : loss.loss);
    Eigen::Vector4f rectangle = Eigen::Vector4f::Zero();
    if (coarse != nullptr) {
        const Eigen::Vector2d low = coarse->rectangle_m.min(), size = coarse->rectangle_m.sizes();
        rectangle = Eigen::Vector4d(low.x(), low.y(), size.x(), size.y()).cast<float>();
    }
    add.set("coarse_rectangle_m", rectangle);
    set_map(add, map);
    triangle.draw();
    glDisable(GL_BLEND);
}

bool lights_surface(const SurfaceLamps& lamps, double surface_z_m) {
    return std::ranges::any_of(lamps.lamps->settings(), [&](const LampSettings& lamp) {
        if (lamp.of_probe) return false;
        return lamp.type == LampType::directional ? lamp.direction.z() < 0 : lamp.position_m.z() > surface_z_m;
    });
}

/// How far from the place below it a lamp brings more than a share of what the probe does.
double reach_of(const LampSettings& lamp, double height_m, const Eigen::Vector3d& probe_irradiance, double share) {
    double reach_m = longest_shadow * height_m;
    if (lamp.range_m) reach_m = std::min(reach_m, *lamp.range_m);
    // Of each channel I h / d³ against the share.
    const Eigen::Array3d light = (lamp.intensity * lamp.color).array();
    const Eigen::Array3d distance = (light * height_m / (share * probe_irradiance.array()).max(1e-30)).pow(1.0 / 3);
    return std::min(reach_m, distance.maxCoeff());
}

}  // namespace

Eigen::Vector3d SurfaceLamps::reference() const {
    return (probe_irradiance.array() > 0).select(probe_irradiance, Eigen::Vector3d::Ones());
}

bool SurfaceLamps::light(const Eigen::AlignedBox2d& box_m, double surface_z_m, double least_share) const {
    return std::ranges::any_of(lamps->settings(), [&](const LampSettings& lamp) {
        if (lamp.of_probe || lamp.in_footage.value_or(false)) return false;
        Eigen::Vector2d nearest = box_m.center();
        if (lamp.type != LampType::directional)
            nearest = lamp.position_m.head<2>().cwiseMax(box_m.min()).cwiseMin(box_m.max());
        // A spot's cone may hold the rest of the box where it leaves out this place.
        LampSettings around = lamp;
        if (lamp.type == LampType::spot) around.type = LampType::point;
        const LampArrival arrival = lamp_arrival(around, {nearest.x(), nearest.y(), surface_z_m});
        const Eigen::Array3d brought = (cosine_of(arrival) * arrival.irradiance).array();
        return (brought > 0 && brought >= least_share * probe_irradiance.array()).any();
    });
}

Eigen::AlignedBox2d lamp_shadow_reach(const Eigen::AlignedBox3d& caster_bounds_m, double surface_z_m,
                                      const SurfaceLamps& lamps, double lost_share) {
    Eigen::AlignedBox2d reach;
    if (caster_bounds_m.isEmpty() || caster_bounds_m.max().z() <= surface_z_m) return reach;
    for (const LampSettings& lamp : lamps.lamps->settings()) {
        if (!lamp.casts_shadow || lamp.of_probe) continue;
        const bool is_placed = lamp.type != LampType::directional;
        Eigen::AlignedBox2d of_lamp;
        for (const Eigen::Vector3d& point : points_of(lamp, caster_bounds_m.center(), 16)) {
            const double height_m = is_placed ? point.z() - surface_z_m : point.z();
            if (height_m <= 0) continue;
            for (int i = 0; i < 8; ++i) {
                Eigen::Vector3d corner = caster_bounds_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
                const double above_m = std::max(corner.z() - surface_z_m, 0.0);
                Eigen::Vector2d step = Eigen::Vector2d::Zero();
                if (!is_placed) {
                    step = -point.head<2>() * (above_m / point.z());
                } else {
                    const double left_m = std::max(height_m - above_m, height_m / longest_shadow);
                    step = (corner.head<2>() - point.head<2>()) * (above_m / left_m);
                }
                const double longest_m = longest_shadow * above_m;
                if (step.norm() > longest_m) step *= longest_m / step.norm();
                of_lamp.extend(Eigen::Vector2d(corner.head<2>() + step));
            }
        }
        if (is_placed && !of_lamp.isEmpty()) {
            const double height_m = lamp.position_m.z() + lamp.radius_m - surface_z_m;
            const double lit_m = reach_of(lamp, height_m, lamps.probe_irradiance, lost_share);
            const Eigen::Vector2d foot = lamp.position_m.head<2>();
            of_lamp = of_lamp.intersection({foot.array() - lit_m, foot.array() + lit_m});
        }
        if (!of_lamp.isEmpty()) reach.extend(of_lamp);
    }
    return reach;
}

std::optional<ContactShadow> with_lamps(ShaderLibrary& shaders, std::optional<ContactShadow> of_probe,
                                        const ShadowCasters& casters, double surface_z_m, const SurfaceLamps& lamps,
                                        int points) {
    if (of_probe) of_probe->lamps = lamps;
    if (!lights_surface(lamps, surface_z_m)) return of_probe;
    if (!of_probe) {
        // Only virtual lamps change the surface: their light is in no map.
        const auto blank = [] {
            ShadowMap map{Texture2D({.format = GL_RGBA32F, .width = 2, .height = 2}),
                          {Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()}};
            map.loss.clear(0, 0, 0, 0);
            return map;
        };
        return ContactShadow{.fine = blank(), .far = blank(), .surface_z_m = surface_z_m, .lamps = lamps};
    }
    const LampCast cast{casters, surface_z_m, lamps, points};
    const bool far_is_wider = !of_probe->fine.rectangle_m.contains(of_probe->far.rectangle_m);
    const ShadowMap fine = draw_loss(shaders, cast, of_probe->fine);
    if (!far_is_wider) {
        add_loss(shaders, of_probe->fine, fine, nullptr);
        return of_probe;
    }
    const ShadowMap far = draw_loss(shaders, cast, of_probe->far);
    add_loss(shaders, of_probe->fine, fine, &far);
    add_loss(shaders, of_probe->far, far, nullptr);
    return of_probe;
}

}  // namespace matchlight
