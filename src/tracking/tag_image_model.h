// The image of a tag as a function of where it is, how blurred and how lit.
#pragma once

#include <Eigen/Core>

#include "tracking/blurred_pattern.h"

namespace matchlight {

/// What is fitted to a tag's pixels: the eight free entries of grid_from_local (the ninth is 1), log blur (standard
/// deviation, px) along the grid's axes and its covariance (px²), light of paper and of ink as planes over the local
/// coordinates (1, x, y).
struct TagParameters {
    static constexpr int count = 17;
    static constexpr int blur = 8, covariance = 10, paper = 11, ink = 14;

    using Vector = Eigen::Matrix<double, count, 1>;
    using Matrix = Eigen::Matrix<double, count, count>;
};

Eigen::Matrix3d homography_of(const TagParameters::Vector& parameters);
inline double contrast_of(const TagParameters::Vector& parameters) {
    return parameters[TagParameters::paper] - parameters[TagParameters::ink];
}

/// Coordinates in which a fit is well conditioned: normalised ones moved to the tag's centre and scaled to its half
/// side.
struct LocalFrame {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // normalised
    double scale = 1;                                  // normalised length of one local unit
    double unit_px = 1;                                // pixels of one local unit

    Eigen::Vector2d from_normalized(const Eigen::Vector2d& point) const { return (point - centre) / scale; }
    Eigen::Matrix3d local_from_normalized() const {
        Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
        matrix.topLeftCorner<2, 2>() /= scale;
        matrix.topRightCorner<2, 1>() = -centre / scale;
        return matrix;
    }
};

/// A pixel in local coordinates.
struct TagPixel {
    double x = 0, y = 0;
    double light = 0;
    bool hidden = false;  // by something in front of the tag
    /// TagImageModel::Place there: it changes little while a fit moves, and costs as much as the rest.
    double cells_per_px_a = 0, cells_per_px_b = 0, axes_cosine = 0;
};

/// Model light at one pixel and its derivatives by all parameters.
struct PixelModel {
    double light = 0;
    double paper = 0;  // share
    TagParameters::Vector gradient;
};

struct TagImageModel {
    const BlurredPattern& pattern;
    LocalFrame local;

    /// Where on the grid, and how many cells a pixel spans there.
    struct Place {
        double a = 0, b = 0, w = 1;
        double cells_per_px_a = 0, cells_per_px_b = 0;
        double axes_cosine = 0;  // of the angle between the axes' gradients, seen in the image
        bool in_view = false;    // not near or beyond the tag plane's horizon
    };

    Place place(const TagParameters::Vector& parameters, double x, double y) const;
    /// Sets what a pixel holds of its place.
    void locate(const TagParameters::Vector& parameters, TagPixel& pixel) const;
};

/// The model's picture for one set of parameters.
class TagImage {
public:
    TagImage(const TagImageModel& model, const TagParameters::Vector& parameters);

    /// False where the pixel is not in view of the tag's plane.
    bool at(const TagPixel& pixel, PixelModel& result) const;

private:
    const BlurredPattern& pattern_;
    TagParameters::Vector p_;
    double blur_a_px_, blur_b_px_;
};

}  // namespace matchlight
