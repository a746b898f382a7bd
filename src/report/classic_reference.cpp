// The papers' equations, lamp by lamp.
#include "report/classic_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace matchlight {

namespace {

double highlight(const ClassicShading& shading, const ClassicPoint& point, const Eigen::Vector3d& to_lamp) {
    const Eigen::Vector3d& n = point.normal;
    if (n.dot(to_lamp) <= 0) return 0;
    const Eigen::Vector3d mirrored = 2 * n.dot(to_lamp) * n - to_lamp;
    const double cosine = shading.model == ShadingModel::blinn_phong ? n.dot((to_lamp + point.to_eye).normalized())
                                                                     : mirrored.dot(point.to_eye);
    return std::pow(std::max(cosine, 0.0), shading.shininess);
}

double tone(double cosine, int tones) {
    if (tones == 1) return 1;
    const int step = std::min(static_cast<int>(std::floor(cosine * tones)), tones - 1);
    return static_cast<double>(step) / (tones - 1);
}

Eigen::Vector3d gooch(const ClassicShading& shading, const ClassicPoint& point, std::span<const ClassicLamp> lamps) {
    Eigen::Vector3d white = point.ambient, glints = Eigen::Vector3d::Zero();
    double towards = 0, weights = 0;
    for (const ClassicLamp& lamp : lamps) {
        const Eigen::Vector3d light = lamp.irradiance / std::numbers::pi;
        white += light;
        towards += light.sum() * point.normal.dot(lamp.to_lamp);
        weights += light.sum();
        if (highlight(shading, point, lamp.to_lamp) >= 0.5) glints += light;
    }
    const double warmth = (1 + (weights > 0 ? towards / weights : point.normal.z())) / 2;
    const Eigen::Vector3d cool = Eigen::Vector3d(shading.cool.data()) + shading.cool_share * point.diffuse;
    const Eigen::Vector3d warm = Eigen::Vector3d(shading.warm.data()) + shading.warm_share * point.diffuse;
    return ((1 - warmth) * cool + warmth * warm).cwiseProduct(white) + point.specular.cwiseProduct(glints);
}

}  // namespace

Eigen::Vector3d classic_reference(const ClassicShading& shading, const ClassicPoint& point,
                                  std::span<const ClassicLamp> lamps) {
    if (shading.model == ShadingModel::physical) return Eigen::Vector3d::Zero();
    if (shading.model == ShadingModel::gooch) return gooch(shading, point, lamps);
    Eigen::Vector3d sum = point.diffuse.cwiseProduct(point.ambient);
    for (const ClassicLamp& lamp : lamps) {
        const Eigen::Vector3d light = lamp.irradiance / std::numbers::pi;
        const double cosine = point.normal.dot(lamp.to_lamp);
        if (cosine <= 0) continue;
        double glint = highlight(shading, point, lamp.to_lamp), lit = cosine;
        if (shading.model == ShadingModel::cartoon) {
            glint = glint >= 0.5 ? 1 : 0;
            lit = tone(cosine, shading.tones);
        }
        sum += light.cwiseProduct(lit * point.diffuse + glint * point.specular);
    }
    return sum;
}

}  // namespace matchlight
