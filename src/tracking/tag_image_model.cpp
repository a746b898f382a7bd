// Homography, blurred pattern and light put together.
#include "tracking/tag_image_model.h"

#include <cmath>

namespace matchlight {

Eigen::Matrix3d homography_of(const TagParameters::Vector& p) {
    Eigen::Matrix3d homography;
    homography << p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], 1;
    return homography;
}

TagImageModel::Place TagImageModel::place(const TagParameters::Vector& p, double x, double y) const {
    Place place;
    place.w = p[6] * x + p[7] * y + 1;
    place.a = (p[0] * x + p[1] * y + p[2]) / place.w;
    place.b = (p[3] * x + p[4] * y + p[5]) / place.w;
    const double scale = 1 / (place.w * local.unit_px);
    const Eigen::Vector2d gradient_a(p[0] - place.a * p[6], p[1] - place.a * p[7]);
    const Eigen::Vector2d gradient_b(p[3] - place.b * p[6], p[4] - place.b * p[7]);
    const double length_a = gradient_a.norm(), length_b = gradient_b.norm();
    place.cells_per_px_a = length_a * std::abs(scale);
    place.cells_per_px_b = length_b * std::abs(scale);
    place.axes_cosine = gradient_a.dot(gradient_b) / (length_a * length_b);
    // Far outside the grid the homography may swing through infinity.
    place.in_view = place.w > 0.05 && std::abs(place.a) < 100 && std::abs(place.b) < 100;
    return place;
}

bool TagImageModel::evaluate(const TagParameters::Vector& p, const TagPixel& pixel, PixelModel& model) const {
    const double x = pixel.x, y = pixel.y;
    const Place at = place(p, x, y);
    if (!at.in_view) return false;
    const double blur_a = std::exp(p[TagParameters::blur]) * at.cells_per_px_a;
    const double blur_b = std::exp(p[TagParameters::blur + 1]) * at.cells_per_px_b;
    const double px2 = at.cells_per_px_a * at.cells_per_px_b;
    constexpr double pixel_variance = 1.0 / 12;  // of the pixel's box, in any direction
    const PatternSample sample = pattern.at(at.a, at.b, {at.cells_per_px_a, blur_a}, {at.cells_per_px_b, blur_b},
                                            (p[TagParameters::covariance] + pixel_variance * at.axes_cosine) * px2);
    const double paper_light =
        p[TagParameters::paper] + p[TagParameters::paper + 1] * x + p[TagParameters::paper + 2] * y;
    const double ink_light = p[TagParameters::ink] + p[TagParameters::ink + 1] * x + p[TagParameters::ink + 2] * y;
    const double contrast = paper_light - ink_light;
    model.paper = sample.paper;
    model.light = ink_light + contrast * sample.paper;
    const double by_a = contrast * sample.by_a / at.w;
    const double by_b = contrast * sample.by_b / at.w;
    const double by_w = -(by_a * at.a + by_b * at.b);
    model.gradient << by_a * x, by_a * y, by_a, by_b * x, by_b * y, by_b, by_w * x, by_w * y,
        contrast * sample.by_blur_a * blur_a, contrast * sample.by_blur_b * blur_b,
        contrast * sample.by_covariance * px2, sample.paper, sample.paper * x, sample.paper * y, 1 - sample.paper,
        (1 - sample.paper) * x, (1 - sample.paper) * y;
    return true;
}

}  // namespace matchlight
