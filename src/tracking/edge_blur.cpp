// Gauss–Newton over a tag's pixels with a blur for each strip.
#include "tracking/edge_blur.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace matchlight {

namespace {

/// 1/depth over the tag's pixels, as multiples of that at its centre, cut into strips of equal width.
struct DepthStrips {
    double nearest = 1, farthest = 1;  // largest and smallest
    int count = 1;

    int index_of(double w) const {
        const double place = (nearest - w) / std::max(nearest - farthest, 1e-12) * count;
        return std::clamp(static_cast<int>(place), 0, count - 1);
    }
};

DepthStrips depth_strips(const TagImageModel& model, const TagParameters::Vector& p,
                         const std::vector<TagPixel>& pixels) {
    DepthStrips strips;
    strips.nearest = 0, strips.farthest = std::numeric_limits<double>::infinity();
    for (const TagPixel& pixel : pixels) {
        if (pixel.hidden) continue;
        const TagImageModel::Place at = model.place(p, pixel.x, pixel.y);
        if (!at.in_view) continue;
        strips.nearest = std::max(strips.nearest, at.w);
        strips.farthest = std::min(strips.farthest, at.w);
    }
    // Narrower strips than 3 % of the depth tell nothing more about focus; more than four are noise.
    constexpr double strip_depth = 0.03;
    constexpr int most_strips = 4;
    strips.count = std::clamp(static_cast<int>(std::ceil(std::log(strips.nearest / strips.farthest) / strip_depth)), 1,
                              most_strips);
    return strips;
}

/// The system of the fit in which homography, light and the blur's covariance are followed by the variances of the
/// strips, first across the one, then across the other set of edges.
class StripSystem {
public:
    StripSystem(const TagImageModel& model, const TagFitState& state, const std::vector<TagPixel>& pixels,
                double clipped_light)
        : model_(model),
          pixels_(pixels),
          clipped_(clipped_light),
          parameters_(state.parameters),
          strips_(depth_strips(model, state.parameters, pixels)) {
        for (int axis = 0; axis < 2; ++axis) {
            const double variance = std::exp(2 * parameters_[TagParameters::blur + axis]);
            for (int i = 0; i < strips_.count; ++i) variances_.push_back(variance);
        }
        cut_ = std::max(6 * state.residual_scale, 0.6 * std::abs(contrast_of(parameters_)));
    }

    /// False where there is no solution.
    bool solve() {
        constexpr int steps = 2;
        for (int i = 0; i < steps; ++i) {
            if (!step()) return false;
        }
        return linearise(true);
    }

    int strips() const { return strips_.count; }
    double variance(int axis, int strip) const { return variances_[index(axis, strip)]; }
    Eigen::Vector2d centre(int axis, int strip) const {
        return centres_.col(static_cast<Eigen::Index>(index(axis, strip)));
    }
    const TagParameters::Vector& parameters() const { return parameters_; }

    /// Of the strips' variances, model px⁴. Residuals may be uneven and the model not quite theirs: the sandwich of
    /// Huber (1967), The Behavior of Maximum Likelihood Estimates under Nonstandard Conditions.
    Eigen::MatrixXd covariance() const {
        const Eigen::MatrixXd inverse = normal_.ldlt().solve(Eigen::MatrixXd::Identity(size(), size()));
        const Eigen::MatrixXd all = inverse * scatter_ * inverse;
        return all.bottomRightCorner(2 * strips_.count, 2 * strips_.count);
    }

private:
    static constexpr int shared = TagParameters::count - 2;  // all but the two blurs
    /// Below, the box of the pixel hides the blur and its derivative grows without bound.
    static constexpr double least_variance_px2 = 0.02;

    double bounded(int axis, int strip) const { return std::max(variance(axis, strip), least_variance_px2); }
    std::size_t index(int axis, int strip) const { return static_cast<std::size_t>(axis * strips_.count + strip); }
    Eigen::Index size() const { return shared + 2 * strips_.count; }

    bool linearise(bool with_scatter) {
        const Eigen::Index n = size();
        normal_ = Eigen::MatrixXd::Zero(n, n);
        scatter_ = Eigen::MatrixXd::Zero(n, n);
        right_ = Eigen::VectorXd::Zero(n);
        centres_ = Eigen::Matrix2Xd::Zero(2, 2 * strips_.count);
        Eigen::VectorXd weights = Eigen::VectorXd::Zero(2 * strips_.count), gradient(n);
        PixelModel at;
        std::vector<TagImage> images;  // by strip
        for (int strip = 0; strip < strips_.count; ++strip) {
            TagParameters::Vector here = parameters_;
            for (int axis = 0; axis < 2; ++axis)
                here[TagParameters::blur + axis] = 0.5 * std::log(bounded(axis, strip));
            images.emplace_back(model_, here);
        }
        for (const TagPixel& pixel : pixels_) {
            if (pixel.hidden || pixel.light >= clipped_) continue;
            const int strip = strips_.index_of(model_.place(parameters_, pixel.x, pixel.y).w);
            double excess_light = 0;  // of variances that lie below the least
            if (!images[static_cast<std::size_t>(strip)].at(pixel, at)) continue;
            gradient.setZero();
            gradient.head<TagParameters::blur>() = at.gradient.head<TagParameters::blur>();
            gradient.segment<shared - TagParameters::blur>(TagParameters::blur) =
                at.gradient.tail<shared - TagParameters::blur>();
            for (int axis = 0; axis < 2; ++axis) {
                // d(log σ) = dσ² / 2σ²
                const double by_variance = at.gradient[TagParameters::blur + axis] / (2 * bounded(axis, strip));
                const auto column = static_cast<Eigen::Index>(index(axis, strip));
                gradient[shared + column] = by_variance;
                excess_light += by_variance * (variance(axis, strip) - bounded(axis, strip));
                const double information = by_variance * by_variance;
                weights[column] += information;
                centres_.col(column) += information * Eigen::Vector2d(pixel.x, pixel.y);
            }
            const double residual = pixel.light - at.light - excess_light;
            const double t = residual / cut_;
            if (std::abs(t) >= 1) continue;
            const double weight = (1 - t * t) * (1 - t * t);
            normal_.selfadjointView<Eigen::Lower>().rankUpdate(gradient, weight);
            right_ += weight * residual * gradient;
            if (with_scatter) {
                scatter_.selfadjointView<Eigen::Lower>().rankUpdate(gradient, weight * weight * residual * residual);
            }
        }
        if (!(weights.minCoeff() > 0)) return false;
        centres_ = centres_ * weights.cwiseInverse().asDiagonal();
        normal_.triangularView<Eigen::StrictlyUpper>() = normal_.transpose();
        scatter_.triangularView<Eigen::StrictlyUpper>() = scatter_.transpose();
        normal_.diagonal().array() *= 1 + 1e-9;
        return normal_.allFinite();
    }

    bool step() {
        if (!linearise(false)) return false;
        const Eigen::VectorXd change = normal_.ldlt().solve(right_);
        if (!change.allFinite()) return false;
        parameters_.head<TagParameters::blur>() += change.head<TagParameters::blur>();
        parameters_.tail<shared - TagParameters::blur>() +=
            change.segment<shared - TagParameters::blur>(TagParameters::blur);
        for (std::size_t i = 0; i < variances_.size(); ++i) {
            variances_[i] += change[shared + static_cast<Eigen::Index>(i)];
        }
        return true;
    }

    const TagImageModel& model_;
    const std::vector<TagPixel>& pixels_;
    double clipped_;
    double cut_ = 0;
    TagParameters::Vector parameters_;
    DepthStrips strips_;
    std::vector<double> variances_;
    Eigen::Matrix2Xd centres_;  // local coordinates
    Eigen::MatrixXd normal_, scatter_;
    Eigen::VectorXd right_;
};

/// ∂pixel/∂normalised of the exact lens.
Eigen::Matrix2d plate_from_normalized(const Camera& camera, const Eigen::Vector2d& at) {
    const double step = 0.5 / camera.fx;  // half a pixel either way
    Eigen::Matrix2d jacobian;
    for (int i = 0; i < 2; ++i) {
        const Eigen::Vector2d offset = step * Eigen::Vector2d::Unit(i);
        jacobian.col(i) =
            (camera.pixel_from_normalized(at + offset) - camera.pixel_from_normalized(at - offset)) / (2 * step);
    }
    return jacobian;
}

}  // namespace

TagBlur measure_edge_blur(const TagImageModel& model, const TagFitState& state, const std::vector<TagPixel>& pixels,
                          double clipped_light, const Camera& camera) {
    TagBlur blur;
    StripSystem system(model, state, pixels, clipped_light);
    if (!system.solve()) return blur;
    const Eigen::MatrixXd covariance = system.covariance();
    const int count = 2 * system.strips();
    Eigen::VectorXd scale(count);
    const double model_px = model.local.scale / model.local.unit_px;  // normalised length of a model's pixel
    for (int axis = 0; axis < 2; ++axis) {
        for (int strip = 0; strip < system.strips(); ++strip) {
            const Eigen::Vector2d centre = system.centre(axis, strip);
            const TagParameters::Vector& p = system.parameters();
            const TagImageModel::Place place = model.place(p, centre.x(), centre.y());
            const Eigen::Vector2d across = axis == 0 ? Eigen::Vector2d(p[0] - place.a * p[6], p[1] - place.a * p[7])
                                                     : Eigen::Vector2d(p[3] - place.b * p[6], p[4] - place.b * p[7]);
            EdgeBlur edge;
            edge.normalized = centre * model.local.scale + model.local.centre;
            // An edge's normal is a covector: with n' = J⁻ᵀ n, n'ᵀ (J Σ Jᵀ) n' = nᵀ Σ n.
            const Eigen::Vector2d normal =
                plate_from_normalized(camera, edge.normalized).transpose().inverse() * across.normalized();
            edge.normal = normal.normalized();
            const double plate_px2 = model_px * model_px / normal.squaredNorm();  // of a model's square pixel
            constexpr double pixel_variance = 1.0 / 12;
            edge.variance_px2 = (system.variance(axis, strip) + pixel_variance) * plate_px2 - pixel_variance;
            scale[axis * system.strips() + strip] = plate_px2;
            blur.edges.push_back(edge);
            const double cell_px = axis == 0 ? 1 / place.cells_per_px_a : 1 / place.cells_per_px_b;
            blur.cell_px = blur.cell_px > 0 ? std::min(blur.cell_px, cell_px) : cell_px;
        }
    }
    blur.covariance = scale.asDiagonal() * covariance * scale.asDiagonal();
    if (!blur.covariance.allFinite()) return {};
    return blur;
}

}  // namespace matchlight
