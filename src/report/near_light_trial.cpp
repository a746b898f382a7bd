// The lamp's faces in double precision, and the same scene through the compositor.
#include "report/near_light_trial.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/parallel.h"
#include "media/blank_source.h"
#include "report/near_light_reference.h"

namespace matchlight {

namespace {

constexpr double lamp_light = 1;
/// Of the probe, where the surface is lit: the lamp sends 16 times as much.
constexpr float even_light = 1.0F / 16;
constexpr double slab_m = 0.3;

SolvedFrame frame_before_the_lamp() {
    const Eigen::Vector3d eye(0, -0.4, 0.3), target(0, 0, 0);
    SolvedFrame frame;
    frame.camera_from_world = camera_looking_along(eye, (target - eye).normalized());
    frame.exposure_ev = 0;
    return frame;
}

/// The corners of a box of side 1 about the origin, in the order of their bits.
std::vector<Eigen::Vector3d> box_corners(double shear) {
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i) {
        const double z = ((i >> 2) & 1) - 0.5;
        corners.emplace_back((i & 1) - 0.5 + shear * z, ((i >> 1) & 1) - 0.5, z);
    }
    return corners;
}

/// Wound outwards.
const std::vector<std::uint32_t>& box_triangles() {
    static const std::vector<std::uint32_t> triangles{0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return triangles;
}

/// As a Wavefront file, whose y points up.
void write_box(const std::filesystem::path& path, double shear) {
    std::string text;
    for (const Eigen::Vector3d& corner : box_corners(shear))
        text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", corner.x(), corner.z(), -corner.y());
    const std::vector<std::uint32_t>& triangles = box_triangles();
    for (std::size_t i = 0; i < triangles.size(); i += 3)
        text += fmt::format("f {} {} {}\n", triangles[i] + 1, triangles[i + 1] + 1, triangles[i + 2] + 1);
    write_text_file(path, text);
}

ObjectSettings slab_of(double roughness) {
    constexpr double thickness_m = 0.01;
    ObjectSettings slab;
    slab.shape = "box";
    slab.name = "slab";
    slab.translate_m = {0, 0, -thickness_m / 2};
    slab.scale = {slab_m, slab_m, thickness_m};
    slab.material.base_color = {1, 1, 1};
    slab.material.metallic = 1;
    slab.material.roughness = roughness;
    return slab;
}

}  // namespace

NearLightTrial::NearLightTrial(GlContext& context, const NearLightSetup& setup) : context_(context), setup_(setup) {
    probe_ = std::make_unique<ScratchProbe>(ImageF(64, 32, 3, is_lit() ? even_light : 0.0F));
    solve_.footage_file = "near light";
    solve_.frame_count = 1;
    Camera& camera = solve_.camera;
    camera.width = 96;
    camera.height = 64;
    camera.fx = camera.fy = 110;
    camera.cx = (camera.width - 1) / 2.0;
    camera.cy = (camera.height - 1) / 2.0;
    solve_.frames.push_back(frame_before_the_lamp());
    scene_.path = "near light";
    scene_.probe.emplace();
    scene_.probe->path = probe_->path();
    add_lamp();
    const bool has_slab =
        setup.kind == NearLightKind::mirrored_by_object || setup.kind == NearLightKind::shadow_on_holdout;
    scene_.surface.present = !has_slab;
    scene_.surface.shadow = is_lit();
    if (has_slab) {
        scene_.objects.push_back(slab_of(setup.roughness));
        scene_.objects.back().holdout = setup.kind == NearLightKind::shadow_on_holdout;
    }
    if (setup.kind == NearLightKind::mirrored_by_surface) {
        scene_.surface.reflection = 1;
        scene_.surface.reflection_roughness = setup.roughness;
    }
}

void NearLightTrial::add_lamp() {
    ObjectSettings lamp;
    lamp.name = "lamp";
    lamp.shape = "box";
    if (setup_.shear != 0) {
        lamp.model = probe_->path().parent_path() / "lamp.obj";
        write_box(lamp.model, setup_.shear);
    }
    lamp.translate_m = setup_.lamp_at_m;
    lamp.scale = setup_.lamp_m;
    lamp.material.base_color = {0, 0, 0};
    lamp.material.metallic = 0;
    lamp.material.roughness = 1;
    if (glows()) lamp.material.emissive = {lamp_light, lamp_light, lamp_light};
    scene_.objects.push_back(lamp);
    std::vector<Eigen::Vector3d> corners = box_corners(setup_.shear);
    for (Eigen::Vector3d& corner : corners) corner = corner.cwiseProduct(setup_.lamp_m) + setup_.lamp_at_m;
    lamp_.add_mesh(corners, box_triangles());
    lamp_.build();
}

bool NearLightTrial::glows() const {
    return setup_.kind != NearLightKind::shadow_on_holdout;
}

bool NearLightTrial::is_lit() const {
    return setup_.kind == NearLightKind::bounced_to_surface || setup_.kind == NearLightKind::shadow_on_holdout;
}

Eigen::Vector3d NearLightTrial::point_at(double x, double y) const {
    const RigidTransform world_from_camera = solve_.frames.front().camera_from_world->inverse();
    const Eigen::Vector3d eye_m = world_from_camera.translation();
    const Eigen::Vector3d direction =
        world_from_camera.linear() * solve_.camera.normalized_from_pixel({x, y}).homogeneous();
    return eye_m - eye_m.z() / direction.z() * direction;
}

bool NearLightTrial::lamp_is_met(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction) const {
    return lamp_.nearest(from_m, direction, 0).has_value();
}

bool NearLightTrial::is_measured(int x, int y) const {
    const Eigen::Vector3d eye_m = solve_.frames.front().camera_from_world->inverse().translation();
    // Not beside an edge, where a pixel shows more than what is measured.
    for (int i = 0; i < 9; ++i) {
        const int beside = i % 3 - 1, below = i / 3 - 1;
        const Eigen::Vector3d point_m = point_at(x + beside, y + below);
        if (point_m.head<2>().cwiseAbs().maxCoeff() > slab_m / 2 || lamp_is_met(eye_m, point_m - eye_m)) return false;
    }
    return true;
}

ImageF NearLightTrial::drawn(const Quality& quality) const {
    Warnings warnings;
    warnings.set_quiet(true);
    Compositor compositor(context_, scene_, solve_, {.settings = quality, .layers = true}, warnings);
    BlankSource source({.path = "near light", .width = width(), .height = height(), .frames = 1, .fps = 25});
    const CompositedFrame frame = compositor.composite(*source.next());
    ImageF picture(width(), height(), 3);
    if (!frame.layers) return picture;
    const FrameLayers& layers = *frame.layers;
    const auto light_at = [&](int column, int row, int channel) {
        switch (setup_.kind) {
            case NearLightKind::mirrored_by_object:
                return layers.virtual_rgba.at(column, row, channel);
            case NearLightKind::mirrored_by_surface:
                return layers.reflection.at(column, row, channel);
            case NearLightKind::bounced_to_surface:
            case NearLightKind::shadow_on_holdout:
                break;
        }
        return even_light * layers.shadow.at(column, row, channel);
    };
    for (int y = 0; y < height(); ++y) {
        for (int x = 0; x < width(); ++x) {
            if (!layers.region.contains(x, y) || !is_measured(x, y)) continue;
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = light_at(x - layers.region.x, y - layers.region.y, c);
        }
    }
    return picture;
}

ImageF NearLightTrial::reference(int strata) const {
    const Eigen::Vector3d eye_m = solve_.frames.front().camera_from_world->inverse().translation();
    ImageF picture(width(), height(), 3);
    parallel_for(height(), [&](int y) {
        for (int x = 0; x < width(); ++x) {
            if (!is_measured(x, y)) continue;
            Eigen::Vector3d point_m = point_at(x, y);
            Eigen::Vector3d light;
            if (is_lit()) {
                light = reference_gathered(Eigen::Vector3d::UnitZ(), strata,
                                           [&](const Eigen::Vector3d& along) -> Eigen::Vector3d {
                                               const double sent = glows() ? lamp_light : 0;
                                               const double seen = lamp_is_met(point_m, along) ? sent : even_light;
                                               return Eigen::Vector3d::Constant(seen);
                                           });
            } else if (setup_.roughness > 0) {
                light = reference_mirrored({.towards_eye = eye_m - point_m, .roughness = setup_.roughness}, strata,
                                           [&](const Eigen::Vector3d& along) -> Eigen::Vector3d {
                                               const double seen = lamp_is_met(point_m, along) ? lamp_light : 0;
                                               return Eigen::Vector3d::Constant(seen);
                                           });
            } else {
                // A lobe of one direction: the rays are spread over the pixel.
                int met = 0;
                for (int i = 0; i < strata * strata; ++i) {
                    const int column = i % strata, row = i / strata;
                    point_m = point_at(x + (column + 0.5) / strata - 0.5, y + (row + 0.5) / strata - 0.5);
                    Eigen::Vector3d along = point_m - eye_m;
                    along.z() = -along.z();
                    met += lamp_is_met(point_m, along) ? 1 : 0;
                }
                light.setConstant(lamp_light * met / (static_cast<double>(strata) * strata));
            }
            Eigen::Map<Eigen::Vector3f>(picture.pixel(x, y)) = light.cast<float>();
        }
    });
    return picture;
}

}  // namespace matchlight
