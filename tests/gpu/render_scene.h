// Probes, models and views of known answers for the tests of rendering.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/transforms.h"
#include "lighting/probe.h"
#include "render/surface.h"
#include "scene/model.h"

namespace matchlight::test {

template <class RadianceOfDirection>
Probe make_probe(int width, RadianceOfDirection radiance) {
    Probe probe{ImageF(width, width / 2, 3)};
    for (int y = 0; y < probe.latlong.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d value = radiance(latlong_direction(x, y, width, width / 2));
            for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = static_cast<float>(value[c]);
        }
    }
    return probe;
}

inline Probe uniform_probe(double radiance) {
    return make_probe(64, [=](const Eigen::Vector3d&) { return Eigen::Vector3d::Constant(radiance); });
}

/// Another colour in each octant of the world.
inline Eigen::Vector3d octant_color(const Eigen::Vector3d& direction) {
    return {direction.x() > 0 ? 1.0 : 0.25, direction.y() > 0 ? 1.0 : 0.25, direction.z() > 0 ? 1.0 : 0.25};
}

/// To be seen from inside: of a closed shape the back is never met.
inline void turn_inside_out(Model& model) {
    for (ModelMesh& mesh : model.meshes) {
        std::reverse(mesh.indices.begin(), mesh.indices.end());
        for (ModelVertex& vertex : mesh.vertices) {
            for (float& component : vertex.normal) component = -component;
        }
    }
}

/// A sphere about the origin, fine enough for its silhouette to be the analytic one to 2e-4 of its radius.
inline Model make_sphere(double radius_m, int rings = 96) {
    Model model;
    model.name = "sphere";
    ModelMesh mesh;
    const int segments = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        for (int j = 0; j <= segments; ++j) {
            const double polar = std::numbers::pi * i / rings;
            const double azimuth = 2 * std::numbers::pi * j / segments;
            // At the poles and along the seam exactly the same positions: the sphere is closed.
            const double around = i == 0 || i == rings ? 0 : std::sin(polar);
            const double turned = j == segments ? 0 : azimuth;
            const Eigen::Vector3d n(around * std::cos(turned), around * std::sin(turned), std::cos(polar));
            ModelVertex vertex{};
            for (std::size_t k = 0; k < 3; ++k) {
                vertex.position[k] = static_cast<float>(radius_m * n[static_cast<Eigen::Index>(k)]);
                vertex.normal[k] = static_cast<float>(n[static_cast<Eigen::Index>(k)]);
            }
            vertex.tangent = {static_cast<float>(-std::sin(azimuth)), static_cast<float>(std::cos(azimuth)), 0, 1};
            vertex.uv = {static_cast<float>(j) / static_cast<float>(segments),
                         static_cast<float>(i) / static_cast<float>(rings)};
            vertex.color = {1, 1, 1, 1};
            mesh.vertices.push_back(vertex);
        }
    }
    const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(i * (segments + 1) + j); };
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < segments; ++j) {
            // Counter-clockwise seen from outside; one of the two is degenerate at each pole.
            if (i > 0) mesh.indices.insert(mesh.indices.end(), {index(i, j), index(i + 1, j), index(i, j + 1)});
            if (i < rings - 1) {
                mesh.indices.insert(mesh.indices.end(), {index(i, j + 1), index(i + 1, j), index(i + 1, j + 1)});
            }
        }
    }
    model.meshes.push_back(std::move(mesh));
    model.materials.emplace_back();
    model.bounds_m = {Eigen::Vector3d::Constant(-radius_m), Eigen::Vector3d::Constant(radius_m)};
    return model;
}

/// A square of side `size_m` about the origin in the plane z = 0, facing +z.
inline Model make_square(double size_m) {
    Model model;
    model.name = "square";
    ModelMesh mesh;
    const auto half = static_cast<float>(size_m / 2);
    for (const auto& [x, y] : {std::pair{-1.F, -1.F}, {1.F, -1.F}, {1.F, 1.F}, {-1.F, 1.F}}) {
        ModelVertex vertex{};
        vertex.position = {x * half, y * half, 0};
        vertex.normal = {0, 0, 1};
        vertex.tangent = {1, 0, 0, 1};
        vertex.uv = {(x + 1) / 2, (1 - y) / 2};
        vertex.color = {1, 1, 1, 1};
        mesh.vertices.push_back(vertex);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    model.meshes.push_back(std::move(mesh));
    model.materials.emplace_back();
    model.bounds_m = {Eigen::Vector3d(-half, -half, 0), Eigen::Vector3d(half, half, 0)};
    return model;
}

inline ModelMaterial metal(double roughness, double base = 1) {
    ModelMaterial material;
    material.metallic = 1;
    material.roughness = static_cast<float>(roughness);
    const auto value = static_cast<float>(base);
    material.base_color = {value, value, value, 1};
    return material;
}

/// A pinhole camera at `eye` that looks along `forward`, its image's right side towards `right`.
struct TestCamera {
    Eigen::Vector3d eye;
    Eigen::Vector3d forward;
    Eigen::Vector3d right;
    int size = 129;  // odd, so that a pixel centre lies on the axis
    double focal_px = 160;

    Eigen::Matrix3d world_from_camera() const {
        Eigen::Matrix3d axes;
        axes << right, forward.cross(right), forward;
        return axes;
    }
    SurfaceView view(int samples = 4) const {
        PinholeView pinhole;
        pinhole.fx = pinhole.fy = focal_px;
        pinhole.cx = pinhole.cy = (size - 1) / 2.0;
        pinhole.width = pinhole.height = size;
        Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
        camera_from_world.linear() = world_from_camera().transpose();
        camera_from_world.translation() = -(camera_from_world.linear() * eye);
        SurfaceView view;
        view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
        view.eye_world_m = eye;
        view.width = view.height = size;
        view.samples = samples;
        return view;
    }
    /// Unit direction of a pixel, world.
    Eigen::Vector3d ray(double x, double y) const {
        const double centre = (size - 1) / 2.0;
        return world_from_camera() * Eigen::Vector3d((x - centre) / focal_px, (y - centre) / focal_px, 1).normalized();
    }
};

/// Where a ray meets a sphere about the origin first.
inline std::optional<Eigen::Vector3d> hit_sphere(const Eigen::Vector3d& eye, const Eigen::Vector3d& ray,
                                                 double radius) {
    const double b = eye.dot(ray);
    const double discriminant = b * b - eye.squaredNorm() + radius * radius;
    if (discriminant < 0) return std::nullopt;
    return eye + (-b - std::sqrt(discriminant)) * ray;
}

/// Lambert's white, without a highlight.
inline SurfaceObject white_diffuse(const Model& model) {
    SurfaceObject object{.model = &model, .reflection = ReflectionForm::sphere_map};
    object.material.diffuse = {1, 1, 1};
    object.material.specular = {0, 0, 0};
    return object;
}

/// Straight down on 0.4 m of the plane z = 0 from 5 m above, 100 pixels wide; row 0 shows the largest y.
inline SurfaceView from_above() {
    SurfaceView view;
    view.width = view.height = 100;
    view.samples = 1;
    RigidTransform camera_from_world = RigidTransform::Identity();
    camera_from_world.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera_from_world.translation() = Eigen::Vector3d(0, 0, 5);
    PinholeView pinhole;
    pinhole.fx = pinhole.fy = 5 * 100 / 0.4;
    pinhole.cx = pinhole.cy = 49.5;
    pinhole.width = pinhole.height = 100;
    view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
    view.eye_world_m = Eigen::Vector3d(0, 0, 5);
    return view;
}

}  // namespace matchlight::test
