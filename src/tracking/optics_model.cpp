// Linearisation, weights, and the solution by Schur's complement: what belongs to frames is sparse, the rest small.
#include "tracking/optics_model.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/parallel.h"
#include "tracking/blur_kernel.h"

namespace matchlight {

namespace {

/// Nodes of the smooth field of softness to the plate's width.
constexpr double field_nodes = 4;
/// How far, in widths of the plate, deviations from it reach: about the size of what a reading averages over.
constexpr double place_reach = 1.0 / 32;
/// Degrees of freedom of Student's t.
constexpr double freedom = 4;

using Triplet = Eigen::Triplet<double, Eigen::Index>;

/// nᵀ Σ n is the scalar product of this with Σ's (xx, yy, xy).
Eigen::Vector3d across(const Eigen::Vector2d& n) {
    return {n.x() * n.x(), n.y() * n.y(), 2 * n.x() * n.y()};
}

/// Of a random symmetric matrix whose nᵀ Σ n varies alike in all directions: xx, yy, and xy at half the variance.
constexpr std::array<double, 3> component_precision{1, 1, 2};

}  // namespace

struct OpticsModel::System {
    Eigen::MatrixXd local_to_shared;     // local block⁻¹ · coupling
    Eigen::LLT<Eigen::MatrixXd> shared;  // of Schur's complement
    OpticsState change;
    double log_evidence = 0;
};

OpticsModel::OpticsModel(const std::vector<TagBlurReadings>& tags, std::size_t frames, bool defocus)
    : frames_(frames), defocus_(defocus), local_rows_(static_cast<Index>(rows_a_frame * frames)) {
    double depth_sum = 0;
    std::size_t count = 0;
    std::map<int, std::size_t> last_seen;
    for (const TagBlurReadings& tag : tags) {
        LinearTag linear;
        linear.tag = &tag;
        linear.first_place = local_rows_;
        local_rows_ += static_cast<Index>(tag.readings.size());
        place_in_field(linear);
        const auto before = last_seen.find(tag.id);
        link_to_before(linear, before != last_seen.end() ? &tags_[before->second] : nullptr);
        last_seen[tag.id] = tags_.size();
        for (const BlurReading& reading : tag.readings) depth_sum += reading.inverse_depth, ++count;
        tags_.push_back(std::move(linear));
    }
    // A pixel's own square has a variance of 1/12; lenses reach some hundred pixels at infinity.
    constexpr double softness_px2 = 10, at_infinity_px = 500, shutter2 = 1, drift = 0.2;
    shared_sigma_ = Eigen::VectorXd::Ones(OpticsState::field + static_cast<Index>(3 * nodes_.size()));
    shared_sigma_[OpticsState::softness] = softness_px2;
    shared_sigma_[OpticsState::coc_scale] = at_infinity_px * static_cast<double>(count) / depth_sum;
    shared_sigma_[OpticsState::shutter2] = shutter2;
    shared_sigma_.segment<2>(OpticsState::drift).setConstant(drift);
}

void OpticsModel::place_in_field(LinearTag& linear) {
    linear.columns = {OpticsState::softness, OpticsState::coc_scale, OpticsState::shutter2, OpticsState::drift,
                      OpticsState::drift + 1};
    for (const BlurReading& reading : linear.tag->readings) {
        std::vector<FieldPart>& parts = linear.field.emplace_back();
        const Eigen::Vector2d at = field_nodes * reading.place;
        const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
        for (int corner = 0; corner < 4; ++corner) {
            const int dx = corner % 2, dy = corner / 2;
            const double share = std::abs(1 - dx - (at.x() - x)) * std::abs(1 - dy - (at.y() - y));
            const int first = OpticsState::field + 3 * static_cast<int>(nodes_.size());
            const int column = nodes_.try_emplace({x + dx, y + dy}, first).first->second;
            // Softness is a covariance matrix: resampling and coding blur rows and columns apart.
            const Eigen::Vector3d weights = share * across(reading.normal);
            for (int i = 0; i < 3; ++i) parts.push_back({column + i, weights[i]});
        }
        for (const FieldPart& part : parts) linear.columns.push_back(part.column);
    }
    std::sort(linear.columns.begin(), linear.columns.end());
    linear.columns.erase(std::unique(linear.columns.begin(), linear.columns.end()), linear.columns.end());
}

void OpticsModel::link_to_before(LinearTag& linear, const LinearTag* before) {
    const std::vector<BlurReading>& readings = linear.tag->readings;
    if (!before || before->tag->readings.size() != readings.size()) return;
    linear.before = before->first_place;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const double way = (readings[i].place - before->tag->readings[i].place).norm();
        constexpr double most = 0.9995;  // what stands still is all but the same
        linear.likeness.push_back(std::min(most, std::exp(-way / place_reach)));
    }
}

OpticsState OpticsModel::state(double softness_px2, double coc_scale, double shutter2,
                               const Eigen::VectorXd& focus) const {
    OpticsState state;
    state.shared = Eigen::VectorXd::Zero(shared_sigma_.size());
    state.shared[OpticsState::softness] = softness_px2;
    state.shared[OpticsState::coc_scale] = coc_scale;
    state.shared[OpticsState::shutter2] = shutter2;
    state.local = Eigen::VectorXd::Zero(local_rows_);
    state.local.head(focus.size()) = focus;
    return state;
}

OpticsModel::FrameRows OpticsModel::rows_of(std::size_t frame) const {
    FrameRows rows;
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<Index>(i * frames_ + frame);
    return rows;
}

void OpticsModel::linearise(const OpticsState& state) {
    at_ = state;
    parallel_for(static_cast<int>(tags_.size()), [&](int i) { linearise(tags_[static_cast<std::size_t>(i)], state); });
    frame_blur_px2_.assign(frames_, 0);
    std::vector<double> counts(frames_, 0);
    for (const LinearTag& linear : tags_) {
        frame_blur_px2_[linear.tag->frame] += linear.blur_px2.sum();
        counts[linear.tag->frame] += static_cast<double>(linear.blur_px2.size());
    }
    for (std::size_t t = 0; t < frames_; ++t) frame_blur_px2_[t] /= std::max(1.0, counts[t]);
}

void OpticsModel::linearise(LinearTag& linear, const OpticsState& state) const {
    const TagBlurReadings& tag = *linear.tag;
    const auto count = static_cast<Index>(tag.readings.size());
    linear.by_shared = Eigen::MatrixXd::Zero(count, static_cast<Index>(linear.columns.size()));
    linear.by_frame = Eigen::MatrixXd::Zero(count, rows_a_frame);
    linear.residual = linear.by_place = linear.blur_px2 = Eigen::VectorXd::Zero(count);
    const FrameRows rows = rows_of(tag.frame);
    const Eigen::Vector3d frame_blur(state.local[rows[1]], state.local[rows[2]], state.local[rows[3]]);
    const double scale = state.shared[OpticsState::coc_scale];
    for (Index i = 0; i < count; ++i) {
        const BlurReading& reading = tag.readings[static_cast<std::size_t>(i)];
        const auto& field = linear.field[static_cast<std::size_t>(i)];
        const double defocus = state.local[rows[0]] - reading.inverse_depth;
        const double motion2 = reading.motion_px * reading.motion_px / 12;
        EdgeKernel kernel;
        kernel.normal = reading.normal;
        kernel.gaussian = state.shared[OpticsState::softness] + across(reading.normal).dot(frame_blur) +
                          state.local[linear.first_place + i];
        kernel.gaussian += 2 * reading.motion_px * reading.normal.dot(state.shared.segment<2>(OpticsState::drift));
        for (const FieldPart& part : field) kernel.gaussian += part.weight * state.shared[part.column];
        kernel.disc = defocus_ ? scale * scale * defocus * defocus / 16 : 0;
        kernel.motion = state.shared[OpticsState::shutter2] * motion2;
        const FittedVariance fitted = fitted_variance(kernel);
        linear.residual[i] = reading.variance_px2 - fitted.value;
        linear.blur_px2[i] = kernel.disc + std::max(0.0, kernel.motion);
        // The first columns are the first of `shared`.
        const Eigen::Vector2d by_drift = 2 * reading.motion_px * reading.normal;
        linear.by_shared.row(i).segment<2>(OpticsState::drift) = fitted.by_gaussian * by_drift.transpose();
        linear.by_shared(i, OpticsState::softness) = fitted.by_gaussian;
        linear.by_shared(i, OpticsState::shutter2) = fitted.by_motion * motion2;
        linear.by_frame.row(i).tail<3>() = fitted.by_gaussian * across(reading.normal).transpose();
        linear.by_place[i] = fitted.by_gaussian;
        if (defocus_) {
            linear.by_shared(i, OpticsState::coc_scale) = fitted.by_disc * scale * defocus * defocus / 8;
            linear.by_frame(i, 0) = fitted.by_disc * scale * scale * defocus / 8;
        }
        for (const FieldPart& part : field) {
            const auto column = std::lower_bound(linear.columns.begin(), linear.columns.end(), part.column);
            linear.by_shared(i, column - linear.columns.begin()) += fitted.by_gaussian * part.weight;
        }
    }
}

Eigen::MatrixXd OpticsModel::error_covariance(const LinearTag& linear, const OpticsSpread& spread) const {
    Eigen::MatrixXd covariance = linear.tag->covariance;
    covariance.diagonal().array() +=
        spread.reading * spread.reading + (spread.kernel * linear.blur_px2.array()).square();
    return covariance;
}

void OpticsModel::weigh(const OpticsSpread& spread) {
    for (LinearTag& linear : tags_) {
        const auto count = static_cast<double>(linear.residual.size());
        const Eigen::LLT<Eigen::MatrixXd> factor(error_covariance(linear, spread));
        const double distance2 = linear.residual.dot(factor.solve(linear.residual));
        linear.weight = (freedom + count) / (freedom + distance2);
        linear.log_weight = 0.5 * linear.weight * distance2 - 0.5 * (freedom + count) * std::log1p(distance2 / freedom);
    }
}

Eigen::VectorXd OpticsModel::shared_precision(const OpticsSpread& spread) const {
    Eigen::VectorXd precision = shared_sigma_.array().square().inverse();
    for (Index i = OpticsState::field; i < precision.size(); ++i) {
        precision[i] =
            component_precision[static_cast<std::size_t>(i - OpticsState::field) % 3] / (spread.field * spread.field);
    }
    return precision;
}

Eigen::SparseMatrix<double> OpticsModel::local_precision(const OpticsSpread& spread,
                                                         double& half_log_determinant) const {
    const Eigen::SparseMatrix<double> focus = spread.focus.precision(frames_);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> focus_factor(focus);
    half_log_determinant = 0.5 * focus_factor.vectorD().array().log().sum();
    std::vector<Triplet> entries;
    for (Index column = 0; column < focus.cols(); ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator entry(focus, column); entry; ++entry) {
            entries.emplace_back(entry.row(), column, entry.value());
        }
    }
    for (std::size_t t = 0; t < frames_; ++t) {
        const FrameRows rows = rows_of(t);
        const double sigma = std::hypot(spread.frame, spread.kernel * frame_blur_px2_[t]);
        for (std::size_t i = 1; i < rows.size(); ++i) {
            const double precision = component_precision[i - 1] / (sigma * sigma);
            entries.emplace_back(rows[i], rows[i], precision);
            half_log_determinant += 0.5 * std::log(precision);
        }
    }
    const double place_precision = 1 / (spread.place * spread.place);
    for (const LinearTag& linear : tags_) {
        for (std::size_t i = 0; i < linear.tag->readings.size(); ++i) {
            const Index row = linear.first_place + static_cast<Index>(i);
            double precision = place_precision;
            if (linear.before >= 0) {
                // As a first-order Markov chain: deviation = likeness · the one before + what is new.
                const Index before = linear.before + static_cast<Index>(i);
                const double likeness = linear.likeness[i];
                precision = place_precision / (1 - likeness * likeness);
                entries.emplace_back(before, before, likeness * likeness * precision);
                entries.emplace_back(row, before, -likeness * precision);
                entries.emplace_back(before, row, -likeness * precision);
            }
            entries.emplace_back(row, row, precision);
            half_log_determinant += 0.5 * std::log(precision);
        }
    }
    // What the data will tie together, so that the pattern is always the same.
    for (const LinearTag& linear : tags_) {
        const FrameRows rows = rows_of(linear.tag->frame);
        std::vector<Index> tied(rows.begin(), rows.end());
        for (Index i = 0; i < static_cast<Index>(linear.tag->readings.size()); ++i)
            tied.push_back(linear.first_place + i);
        for (const Index a : tied) {
            for (const Index b : tied) entries.emplace_back(a, b, 0.0);
        }
    }
    Eigen::SparseMatrix<double> precision(local_rows_, local_rows_);
    precision.setFromTriplets(entries.begin(), entries.end());
    return precision;
}

std::optional<OpticsModel::System> OpticsModel::assemble(const OpticsSpread& spread) {
    const Eigen::VectorXd precision = shared_precision(spread);
    double log_likelihood = 0;
    Eigen::SparseMatrix<double> local = local_precision(spread, log_likelihood);
    log_likelihood += 0.5 * precision.array().log().sum();
    Eigen::MatrixXd shared = precision.asDiagonal();
    Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(local_rows_, shared.cols());
    Eigen::VectorXd from_mean = at_.local;
    from_mean.head(static_cast<Index>(frames_)).array() -= spread.focus.mean;
    OpticsState right{-(local * from_mean), -(precision.cwiseProduct(at_.shared))};
    log_likelihood += 0.5 * (from_mean.dot(right.local) + at_.shared.dot(right.shared));
    for (const LinearTag& linear : tags_) {
        const auto count = linear.residual.size();
        const Eigen::LLT<Eigen::MatrixXd> error(error_covariance(linear, spread));
        const double root = std::sqrt(linear.weight);
        const Eigen::MatrixXd by_shared = error.matrixL().solve(linear.by_shared) * root;
        const Eigen::VectorXd residual = error.matrixL().solve(linear.residual) * root;
        Eigen::MatrixXd own(count, rows_a_frame + count);
        own << linear.by_frame, Eigen::MatrixXd(linear.by_place.asDiagonal());
        own = error.matrixL().solve(own) * root;
        log_likelihood += linear.log_weight - 0.5 * residual.squaredNorm();
        log_likelihood -= error.matrixLLT().diagonal().array().log().sum();

        const FrameRows frame_rows = rows_of(linear.tag->frame);
        std::vector<Index> rows(frame_rows.begin(), frame_rows.end());
        for (Index i = 0; i < count; ++i) rows.push_back(linear.first_place + i);
        const Eigen::MatrixXd own_square = own.transpose() * own, cross = own.transpose() * by_shared;
        const Eigen::VectorXd own_gradient = own.transpose() * residual;
        for (std::size_t a = 0; a < rows.size(); ++a) {
            const auto row = static_cast<Index>(a);
            right.local[rows[a]] += own_gradient[row];
            for (std::size_t b = 0; b < rows.size(); ++b) {
                local.coeffRef(rows[a], rows[b]) += own_square(row, static_cast<Index>(b));
            }
            for (std::size_t i = 0; i < linear.columns.size(); ++i) {
                coupling(rows[a], linear.columns[i]) += cross(row, static_cast<Index>(i));
            }
        }
        const Eigen::MatrixXd square = by_shared.transpose() * by_shared;
        const Eigen::VectorXd gradient = by_shared.transpose() * residual;
        for (std::size_t i = 0; i < linear.columns.size(); ++i) {
            const auto k = static_cast<Index>(i);
            right.shared[linear.columns[i]] += gradient[k];
            for (std::size_t j = 0; j < linear.columns.size(); ++j) {
                shared(linear.columns[i], linear.columns[j]) += square(k, static_cast<Index>(j));
            }
        }
    }

    if (!is_analysed_) local_.analyzePattern(local);
    is_analysed_ = true;
    local_.factorize(local);
    if (local_.info() != Eigen::Success || !(local_.vectorD().minCoeff() > 0)) return std::nullopt;
    System system;
    system.local_to_shared = local_.solve(coupling);
    system.shared.compute(shared - coupling.transpose() * system.local_to_shared);
    if (system.shared.info() != Eigen::Success) return std::nullopt;
    system.change.shared = system.shared.solve(right.shared - system.local_to_shared.transpose() * right.local);
    system.change.local = local_.solve(right.local) - system.local_to_shared * system.change.shared;
    // The quadratic's maximum, and the Gaussian integral about it.
    log_likelihood += 0.5 * (system.change.local.dot(right.local) + system.change.shared.dot(right.shared));
    log_likelihood -=
        0.5 * local_.vectorD().array().log().sum() + system.shared.matrixLLT().diagonal().array().log().sum();
    system.log_evidence = log_likelihood;
    if (!std::isfinite(log_likelihood)) return std::nullopt;
    return system;
}

std::optional<OpticsModel::Solution> OpticsModel::solve(const OpticsSpread& spread) {
    std::optional<System> system = assemble(spread);
    if (!system) return std::nullopt;
    return Solution{std::move(system->change), system->log_evidence};
}

OpticsModel::Sigmas OpticsModel::sigmas(const OpticsSpread& spread) {
    Sigmas sigmas;
    const std::optional<System> system = assemble(spread);
    const auto frames = static_cast<Index>(frames_);
    sigmas.focus = Eigen::VectorXd::Constant(frames, spread.focus.spread);
    sigmas.shared = shared_sigma_;
    if (!system) return sigmas;
    const auto count = sigmas.shared.size();
    const Eigen::MatrixXd shared = system->shared.solve(Eigen::MatrixXd::Identity(count, count));
    sigmas.shared = shared.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (Index t = 0; t < frames; ++t) {
        const Eigen::VectorXd own = local_.solve(Eigen::VectorXd::Unit(local_rows_, t));
        const Eigen::RowVectorXd through_shared = system->local_to_shared.row(t);
        sigmas.focus[t] = std::sqrt(std::max(0.0, own[t] + through_shared.dot(through_shared * shared)));
    }
    return sigmas;
}

}  // namespace matchlight
