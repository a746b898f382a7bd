// Homography, blurred pattern and light put together.
#include "tracking/tag_image_model.h"

#include <cmath>

namespace matchlight {

namespace {

// Far outside the grid the homography may swing through infinity.
constexpr double least_depth = 0.05, farthest_cell = 100;

}  // namespace

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
    place.in_view = place.w > least_depth && std::abs(place.a) < farthest_cell && std::abs(place.b) < farthest_cell;
    return place;
}

void TagImageModel::locate(const TagParameters::Vector& p, TagPixel& pixel) const {
    const Place at = place(p, pixel.x, pixel.y);
    pixel.cells_per_px_a = at.cells_per_px_a;
    pixel.cells_per_px_b = at.cells_per_px_b;
    pixel.axes_cosine = at.axes_cosine;
}

TagImage::TagImage(const TagImageModel& model, const TagParameters::Vector& parameters)
    : pattern_(model.pattern),
      p_(parameters),
      blur_a_px_(std::exp(parameters[TagParameters::blur])),
      blur_b_px_(std::exp(parameters[TagParameters::blur + 1])) {}

bool TagImage::at(const TagPixel& pixel, PixelModel& result) const {
    const double x = pixel.x, y = pixel.y;
    const double w = p_[6] * x + p_[7] * y + 1;
    if (!(w > least_depth)) return false;
    const double a = (p_[0] * x + p_[1] * y + p_[2]) / w;
    const double b = (p_[3] * x + p_[4] * y + p_[5]) / w;
    if (!(std::abs(a) < farthest_cell && std::abs(b) < farthest_cell)) return false;
    const double blur_a = blur_a_px_ * pixel.cells_per_px_a;
    const double blur_b = blur_b_px_ * pixel.cells_per_px_b;
    const double px2 = pixel.cells_per_px_a * pixel.cells_per_px_b;
    constexpr double pixel_variance = 1.0 / 12;  // of the pixel's box, in any direction
    const PatternSample sample =
        pattern_.at(a, b, {pixel.cells_per_px_a, blur_a}, {pixel.cells_per_px_b, blur_b},
                    (p_[TagParameters::covariance] + pixel_variance * pixel.axes_cosine) * px2);
    const double paper_light =
        p_[TagParameters::paper] + p_[TagParameters::paper + 1] * x + p_[TagParameters::paper + 2] * y;
    const double ink_light = p_[TagParameters::ink] + p_[TagParameters::ink + 1] * x + p_[TagParameters::ink + 2] * y;
    const double contrast = paper_light - ink_light;
    result.paper = sample.paper;
    result.light = ink_light + contrast * sample.paper;
    const double by_a = contrast * sample.by_a / w;
    const double by_b = contrast * sample.by_b / w;
    const double by_w = -(by_a * a + by_b * b);
    result.gradient << by_a * x, by_a * y, by_a, by_b * x, by_b * y, by_b, by_w * x, by_w * y,
        contrast * sample.by_blur_a * blur_a, contrast * sample.by_blur_b * blur_b,
        contrast * sample.by_covariance * px2, sample.paper, sample.paper * x, sample.paper * y, 1 - sample.paper,
        (1 - sample.paper) * x, (1 - sample.paper) * y;
    return true;
}

}  // namespace matchlight
