// Sums light over the visible normals of each lobe.
#include "report/material_reference.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "render/sheen.h"

namespace matchlight {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Even points of the unit square (Roberts 2018).
Vector2d even_point(int i, int count) {
    constexpr double golden_section = 0.6180339887498949;
    const double turn = i * golden_section;
    return {(i + 0.5) / count, turn - std::floor(turn)};
}

/// Of the GGX distribution with a width along x and along y.
Vector3d visible_normal(const Vector3d& eye, const Vector2d& alpha, const Vector2d& u) {
    const Vector3d stretched = Vector3d(alpha.x() * eye.x(), alpha.y() * eye.y(), eye.z()).normalized();
    const double length2 = stretched.head<2>().squaredNorm();
    Vector3d t1 = Vector3d::UnitX();
    if (length2 > 0) t1 = Vector3d(-stretched.y(), stretched.x(), 0) / std::sqrt(length2);
    const Vector3d t2 = stretched.cross(t1);
    const double radius = std::sqrt(u.x());
    const double angle = 2 * std::numbers::pi * u.y();
    const double x = radius * std::cos(angle);
    const double s = (1 + stretched.z()) / 2;
    const double y = (1 - s) * std::sqrt(std::max(0.0, 1 - x * x)) + s * radius * std::sin(angle);
    const Vector3d normal = x * t1 + y * t2 + std::sqrt(std::max(0.0, 1 - x * x - y * y)) * stretched;
    return Vector3d(alpha.x() * normal.x(), alpha.y() * normal.y(), std::max(1e-9, normal.z())).normalized();
}

double smith_lambda(const Vector3d& direction, const Vector2d& alpha) {
    const double spread2 = (alpha.cwiseProduct(direction.head<2>())).squaredNorm();
    return (std::sqrt(1 + spread2 / (direction.z() * direction.z())) - 1) / 2;
}

/// What a lobe shows, by how its Fresnel term weighs it: scale · F0 + bias · F90 of light and of white light.
struct Lobe {
    Vector3d scale_light = Vector3d::Zero(), bias_light = Vector3d::Zero();
    double scale = 0, bias = 0;
};

class Integrals {
public:
    Integrals(const ReferencePoint& point, const RadianceFrom& radiance, int samples)
        : point_(point),
          radiance_(radiance),
          samples_(samples),
          eye_(point.world_from_surface.transpose() * point.to_eye) {}

    double cosine() const { return eye_.z(); }

    /// What a thin wall lets pass straight on, spread as its lobe spreads what it mirrors; of white light 1.
    Vector3d passed(const Vector2d& alpha) const {
        Vector3d sum = Vector3d::Zero();
        double weights = 0;
        const double eye_lambda = smith_lambda(eye_, alpha);
        for (int i = 0; i < samples_; ++i) {
            const Vector3d half = visible_normal(eye_, alpha, even_point(i, samples_));
            const Vector3d light = 2 * eye_.dot(half) * half - eye_;
            if (light.z() <= 0) continue;
            const double weight = (1 + eye_lambda) / (1 + eye_lambda + smith_lambda(light, alpha));
            sum += weight * radiance_(point_.world_from_surface * Vector3d(light.x(), light.y(), -light.z()));
            weights += weight;
        }
        return weights > 0 ? Vector3d(sum / weights) : Vector3d::Zero().eval();
    }
    Lobe lobe(const Vector2d& alpha) const {
        Lobe lobe;
        const double eye_lambda = smith_lambda(eye_, alpha);
        for (int i = 0; i < samples_; ++i) {
            const Vector3d half = visible_normal(eye_, alpha, even_point(i, samples_));
            const double v_dot_h = std::clamp(eye_.dot(half), 0.0, 1.0);
            const Vector3d light = 2 * v_dot_h * half - eye_;
            if (light.z() <= 0) continue;
            const double weight = (1 + eye_lambda) / (1 + eye_lambda + smith_lambda(light, alpha)) / samples_;
            const double fresnel = std::pow(1 - v_dot_h, 5);
            const Vector3d seen = radiance_(point_.world_from_surface * light);
            lobe.scale += (1 - fresnel) * weight;
            lobe.bias += fresnel * weight;
            lobe.scale_light += (1 - fresnel) * weight * seen;
            lobe.bias_light += fresnel * weight * seen;
        }
        return lobe;
    }
    /// Irradiance over π.
    Vector3d diffuse() const {
        Vector3d sum = Vector3d::Zero();
        for (int i = 0; i < samples_; ++i) sum += radiance_(point_.world_from_surface * cosine_direction(i));
        return sum / samples_;
    }
    /// Light and, in `albedo`, white light.
    Vector3d sheen(double roughness, double& albedo) const {
        Vector3d sum = Vector3d::Zero();
        albedo = 0;
        for (int i = 0; i < samples_; ++i) {
            const Vector3d light = cosine_direction(i);
            const double half_cosine = (light + eye_).normalized().z();
            const double weight = std::numbers::pi / samples_ * sheen_brdf(light.z(), eye_.z(), half_cosine, roughness);
            sum += weight * radiance_(point_.world_from_surface * light);
            albedo += weight;
        }
        // More than all of the light is none that a surface sends.
        const double excess = std::max(albedo, 1.0);
        albedo /= excess;
        return sum / excess;
    }

private:
    Vector3d cosine_direction(int i) const {
        const Vector2d u = even_point(i, samples_);
        const double angle = 2 * std::numbers::pi * u.y();
        return {std::sqrt(u.x()) * std::cos(angle), std::sqrt(u.x()) * std::sin(angle), std::sqrt(1 - u.x())};
    }

    const ReferencePoint& point_;
    const RadianceFrom& radiance_;
    int samples_;
    Vector3d eye_;
};

/// What of white light comes back after one meeting, and after several.
struct Returned {
    Vector3d single, multiple;
};
Returned returned(const Lobe& lobe, const Vector3d& f0, double f90) {
    const Vector3d single = f0 * lobe.scale + Vector3d::Constant(f90 * lobe.bias);
    const double missing = 1 - lobe.scale - lobe.bias;
    const Vector3d mean = f0 + (Vector3d::Constant(f90) - f0) / 21;
    const Vector3d again = (Vector3d::Ones() - mean * missing).cwiseInverse();
    return {single, missing * single.cwiseProduct(mean).cwiseProduct(again)};
}

Vector3d widened(const Rgb& color) {
    return {color[0], color[1], color[2]};
}

}  // namespace

Vector3d material_reference(const ModelMaterial& material, const ReferencePoint& point, const RadianceFrom& radiance,
                            int samples) {
    const Integrals light(point, radiance, samples);
    const double roughness = material.roughness;
    constexpr double least_alpha = 1e-4;  // a mirror, but for rounding
    Vector2d alpha = Vector2d::Constant(std::max(roughness * roughness, least_alpha));
    Eigen::Matrix3d turned = point.world_from_surface;
    if (material.anisotropy) {
        const double strength = material.anisotropy->strength, angle = material.anisotropy->rotation_rad;
        alpha.x() += (1 - alpha.x()) * strength * strength;
        turned.col(0) =
            std::cos(angle) * point.world_from_surface.col(0) + std::sin(angle) * point.world_from_surface.col(1);
        turned.col(1) = turned.col(2).cross(turned.col(0));
    }
    const ReferencePoint along{turned, point.to_eye};
    const Lobe lobe = Integrals(along, radiance, samples).lobe(alpha);

    const Vector3d base(material.base_color[0], material.base_color[1], material.base_color[2]);
    const double metallic = material.metallic;
    const double ratio = (static_cast<double>(material.ior) - 1) / (static_cast<double>(material.ior) + 1);
    Vector3d f0 = Vector3d::Constant(ratio * ratio);
    double f90 = 1;
    if (material.specular) {
        f90 = material.specular->strength;
        f0 = f90 * f0.cwiseProduct(widened(material.specular->color)).cwiseMin(1);
    }
    const Returned dielectric = returned(lobe, f0, f90);
    const Returned metal = returned(lobe, base, 1);
    const auto shown = [&](const Vector3d& head_on, double edge_on) {
        return Vector3d(head_on.cwiseProduct(lobe.scale_light) + edge_on * lobe.bias_light);
    };
    const Vector3d taken = dielectric.single + dielectric.multiple;
    const Vector3d below = (1 - metallic) * base * (1 - taken.maxCoeff());
    const Vector3d diffuse = (1 - metallic) * dielectric.multiple + metallic * metal.multiple + below;
    Vector3d sent = (1 - metallic) * shown(f0, f90) + metallic * shown(base, 1) + diffuse.cwiseProduct(light.diffuse());
    if (material.transmission) {
        const Vector3d through = material.transmission->strength * below;
        sent += through.cwiseProduct(light.passed(alpha) - light.diffuse());
    }
    if (material.sheen) {
        const Vector3d color = widened(material.sheen->color);
        double albedo = 0;
        const Vector3d fibres = light.sheen(material.sheen->roughness, albedo);
        sent = (1 - color.maxCoeff() * albedo) * sent + color.cwiseProduct(fibres);
    }
    if (material.coat) {
        const double coat_roughness = material.coat->roughness;
        const Lobe coat = light.lobe(Vector2d::Constant(std::max(coat_roughness * coat_roughness, least_alpha)));
        constexpr double coat_f0 = 0.04;
        const double strength = material.coat->strength;
        sent = (1 - strength * (coat_f0 * coat.scale + coat.bias)) * sent +
               strength * (coat_f0 * coat.scale_light + coat.bias_light);
    }
    return sent;
}

}  // namespace matchlight
