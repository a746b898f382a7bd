// Levenberg–Marquardt over the pixels of one tag.
#include "tracking/tag_minimiser.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/median.h"

namespace matchlight {

namespace {

using Vector = TagParameters::Vector;
using Matrix = TagParameters::Matrix;

/// Tukey's biweight: what is many scales away counts nothing.
double biweight(double residual, double cut) {
    const double t = residual / cut;
    return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

double biweight_cost(double residual, double cut) {
    const double t = std::min(1.0, residual * residual / (cut * cut));
    return cut * cut / 6 * (1 - (1 - t) * (1 - t) * (1 - t));
}

/// Where the biweight ends: beyond noise, and beyond what the shape of a motion's blur leaves at edges. Hidden cells
/// are found by their even parts instead.
double cut_for(const TagFitState& state) {
    return std::max(6 * state.residual_scale, 0.6 * std::abs(contrast_of(state.parameters)));
}

constexpr Eigen::Index block_size = 64;  // gradients that are squared at once
constexpr double least_blur_px = 0.05;   // below, the box of the pixel hides it

/// Keeps the blur where it can be told from a sharp edge, and its covariance that of an ellipse.
void hold_blur(Vector& p) {
    for (int axis = 0; axis < 2; ++axis) {
        double& log_blur = p[TagParameters::blur + axis];
        log_blur = std::max(log_blur, std::log(least_blur_px));
    }
    const double bound = 0.9 * std::exp(p[TagParameters::blur] + p[TagParameters::blur + 1]);
    p[TagParameters::covariance] = std::clamp(p[TagParameters::covariance], -bound, bound);
}

}  // namespace

TagMinimiser::TagMinimiser(const TagImageModel& model, std::vector<TagPixel>& pixels, double clipped_light,
                           double cell_px)
    : model_(model), pixels_(pixels), clipped_(clipped_light), cell_px_(cell_px) {
    residuals_.reserve(pixels.size());
    gradients_.resize(TagParameters::count, block_size);
}

bool TagMinimiser::is_sane(const Vector& p) const {
    const double largest = std::log(2 * cell_px_);
    return p.allFinite() && p[TagParameters::blur] < largest && p[TagParameters::blur + 1] < largest;
}

TagFitState TagMinimiser::linearized(const Vector& parameters, double cut, Light light) {
    TagFitState state;
    state.parameters = parameters;
    residuals_.clear();
    const TagImage image(model_, parameters);
    PixelModel at;
    Eigen::Index filled = 0;
    const auto add_block = [&] {
        state.normal.selfadjointView<Eigen::Lower>().rankUpdate(gradients_.leftCols(filled));
        filled = 0;
    };
    double sum = 0, squares = 0, unexplained = 0;
    for (const TagPixel& pixel : pixels_) {
        if (pixel.hidden) continue;
        if (!image.at(pixel, at)) {
            state.cost += biweight_cost(cut, cut);
            residuals_.push_back(cut);
            continue;
        }
        // A clipped pixel says no more than that its light is at least that.
        const bool clipped = at.light >= clipped_ && pixel.light >= clipped_;
        const double observed = std::min(pixel.light, clipped_);
        const double residual = clipped ? 0 : observed - at.light;
        residuals_.push_back(std::abs(residual));
        state.cost += biweight_cost(residual, cut);
        sum += observed, squares += observed * observed, unexplained += residual * residual;
        const double weight = biweight(residual, cut);
        if (weight == 0 || clipped) continue;
        if (light == Light::even) {
            at.gradient.segment<2>(TagParameters::paper + 1).setZero();
            at.gradient.segment<2>(TagParameters::ink + 1).setZero();
        }
        gradients_.col(filled++) = std::sqrt(weight) * at.gradient;
        if (filled == gradients_.cols()) add_block();
        state.right += weight * residual * at.gradient;
        state.weight_sum += weight;
    }
    add_block();
    const auto count = static_cast<double>(std::max<std::size_t>(1, residuals_.size()));
    const double variance = squares - sum * sum / count;
    state.correlation = variance > 0 ? std::sqrt(std::max(0.0, 1 - unexplained / variance)) : 0;
    state.residual_scale = 1.4826 * (residuals_.empty() ? 0 : upper_median_in_place(residuals_));
    state.normal.triangularView<Eigen::StrictlyUpper>() = state.normal.transpose();
    return state;
}

std::optional<TagFitState> TagMinimiser::minimise(const Vector& start, Light light) {
    for (TagPixel& pixel : pixels_) model_.locate(start, pixel);
    double cut = std::abs(contrast_of(start));
    TagFitState state = linearized(start, cut, light);
    double damping = 1e-3;
    constexpr int most_iterations = 20, most_attempts = 5;
    for (int iteration = 0; iteration < most_iterations; ++iteration) {
        const double tighter = cut_for(state);
        if (tighter < 0.95 * cut) {  // costs compare only under one cut
            cut = tighter;
            state = linearized(state.parameters, cut, light);
        }
        bool lowered = false;
        double moved_px = 0;
        for (int attempt = 0; attempt < most_attempts && !lowered; ++attempt) {
            Matrix damped = state.normal;
            damped.diagonal().array() += damping * state.normal.diagonal().array() + 1e-12 * state.weight_sum;
            Vector next = state.parameters + damped.ldlt().solve(state.right);
            hold_blur(next);
            if (is_sane(next)) {
                const TagFitState candidate = linearized(next, cut, light);
                if (candidate.cost < state.cost) {
                    const TagImageModel::Place centre = model_.place(next, 0, 0);
                    moved_px = (next - state.parameters).head<8>().cwiseAbs().maxCoeff() / centre.cells_per_px_a;
                    state = candidate;
                    lowered = true;
                    damping = std::max(damping * 0.1, 1e-9);
                    continue;
                }
            }
            damping = std::max(damping * 10, 1e-6);
        }
        constexpr double settled_px = 5e-3;
        if (!lowered || (moved_px < settled_px && iteration > 1)) break;
    }
    if (!(contrast_of(state.parameters) > 0)) return std::nullopt;
    return state;
}

Vector TagMinimiser::instrumented_step(const Vector& parameters, const Vector& wider, double cut) const {
    Matrix system = Matrix::Zero();
    Vector right = Vector::Zero();
    const TagImage image(model_, parameters), wider_image(model_, wider);
    PixelModel at, instrument;
    for (const TagPixel& pixel : pixels_) {
        if (pixel.hidden || pixel.light >= clipped_) continue;
        if (!image.at(pixel, at) || !wider_image.at(pixel, instrument)) continue;
        const double residual = pixel.light - at.light;
        const double weight = biweight(residual, cut);
        if (weight == 0) continue;
        system += weight * instrument.gradient * at.gradient.transpose();
        right += weight * residual * instrument.gradient;
    }
    for (int i = TagParameters::blur; i <= TagParameters::covariance; ++i) {  // held
        system.row(i).setZero();
        system.col(i).setZero();
        system(i, i) = 1;
        right[i] = 0;
    }
    return system.partialPivLu().solve(right);
}

TagFitState TagMinimiser::centred_on_mean(TagFitState state) const {
    constexpr double least_wider_px = 1.2;  // covers the steps of a short exposure's blur
    const double widest_px = 0.35 * cell_px_;
    const double cut = cut_for(state);
    constexpr int steps = 2;
    for (int i = 0; i < steps; ++i) {
        Vector wider = state.parameters;
        for (int axis = 0; axis < 2; ++axis) {
            const double blur = std::exp(wider[TagParameters::blur + axis]);
            const double wanted = std::min(std::hypot(blur, 1.5 * blur + least_wider_px), widest_px);
            wider[TagParameters::blur + axis] = std::log(std::max(blur, wanted));
        }
        const Vector step = instrumented_step(state.parameters, wider, cut);
        if (!step.allFinite()) break;
        state.parameters += step;
    }
    return state;
}

}  // namespace matchlight
