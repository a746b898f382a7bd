// Robust joint fit of exposures, offsets and fall-off.
#include "tracking/vignette_fit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/median.h"

namespace matchlight {

namespace {

double fall_off(const std::array<double, 2>& gain, double radius) {
    const double r2 = radius * radius;
    // A step of the solver may overshoot; light never falls to nothing.
    constexpr double darkest = 0.05;
    return std::max(darkest, 1 + gain[0] * r2 + gain[1] * r2 * r2);
}

/// The unknowns that are left when exposures have been eliminated: an offset for each surface and channel, then as many
/// terms of the fall-off as are asked for.
class JointFit {
public:
    JointFit(const std::vector<LogReading>& readings, std::size_t frame_count, int terms)
        : readings_(readings), frame_count_(frame_count), terms_(terms) {
        for (const LogReading& reading : readings) {
            column_.emplace(std::pair{reading.surface, reading.channel}, static_cast<Eigen::Index>(column_.size()));
        }
        offset_.setZero(static_cast<Eigen::Index>(column_.size()));
        exposure_.assign(3 * frame_count, 0);
        weight_.assign(3 * frame_count, 0);
    }

    void solve() {
        start();
        // Weights wide at first: a start that is off must not make outliers of what is right (graduated
        // non-convexity, Blake & Zisserman 1987).
        for (const double knee : {8.0, 4.0, 2.0}) {
            constexpr int rounds = 15;
            for (int round = 0; round < rounds; ++round) step(knee);
        }
    }

    double cost() const {
        double sum = 0;
        for (const LogReading& reading : readings_) {
            const double residual = residual_of(reading);
            sum += std::log1p(residual * residual / (final_knee * final_knee * reading.variance));
        }
        return sum * final_knee * final_knee;  // of χ² where the errors are small
    }

    const std::array<double, 2>& gain() const { return gain_; }

    /// Readings of one tag at about one radius share their errors (gloss, print, coding): they count as one.
    double corner_sigma() const {
        std::set<std::tuple<CardSurface, std::size_t, int>> places;
        constexpr double same_place = 0.05;
        for (const LogReading& reading : readings_) {
            places.emplace(reading.surface, reading.channel, static_cast<int>(reading.radius / same_place));
        }
        const double repeats = static_cast<double>(readings_.size()) / static_cast<double>(places.size());
        const Eigen::MatrixXd covariance = normal_.ldlt().solve(Eigen::MatrixXd::Identity(count(), count()));
        const Eigen::VectorXd slope = Eigen::VectorXd::Ones(terms_) / fall_off(gain_, 1);
        const double variance = slope.dot(covariance.bottomRightCorner(terms_, terms_) * slope);
        return std::sqrt(std::max(0.0, repeats * variance));
    }

    LightFit result() const {
        LightFit fit;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            fit.exposure[channel].resize(frame_count_);
            fit.exposure_sigma[channel].assign(frame_count_, 0);
            for (std::size_t f = 0; f < frame_count_; ++f) {
                const std::size_t row = 3 * f + channel;
                if (weight_[row] <= 0) continue;
                fit.exposure[channel][f] = exposure_[row];
                fit.exposure_sigma[channel][f] = 1 / std::sqrt(weight_[row]);
            }
        }
        for (const auto& [key, column] : column_) fit.offset[key.second][key.first] = offset_[column];
        return fit;
    }

private:
    static constexpr double final_knee = 2;

    Eigen::Index count() const { return offset_.size() + terms_; }
    Eigen::Index column_of(const LogReading& reading) const { return column_.at({reading.surface, reading.channel}); }
    double residual_of(const LogReading& reading) const {
        return reading.value - exposure_[row_of(reading)] - offset_[column_of(reading)] -
               std::log(fall_off(gain_, reading.radius));
    }
    static std::size_t row_of(const LogReading& reading) { return 3 * reading.frame + reading.channel; }

    /// Exposures from medians, then offsets from medians against those.
    void start() {
        std::map<std::size_t, std::vector<double>> by_row;
        for (const LogReading& reading : readings_) {
            if (!reading.surface.ink) by_row[row_of(reading)].push_back(reading.value);
        }
        for (auto& [row, values] : by_row) exposure_[row] = upper_median(std::move(values));
        std::vector<std::vector<double>> by_column(static_cast<std::size_t>(offset_.size()));
        for (const LogReading& reading : readings_) {
            if (!by_row.contains(row_of(reading))) continue;
            by_column[static_cast<std::size_t>(column_of(reading))].push_back(reading.value -
                                                                              exposure_[row_of(reading)]);
        }
        for (std::size_t c = 0; c < by_column.size(); ++c) {
            if (!by_column[c].empty()) offset_[static_cast<Eigen::Index>(c)] = upper_median(std::move(by_column[c]));
        }
        std::map<std::size_t, std::vector<double>> ink_rows;
        for (const LogReading& reading : readings_) {
            if (by_row.contains(row_of(reading))) continue;
            ink_rows[row_of(reading)].push_back(reading.value - offset_[column_of(reading)]);
        }
        for (auto& [row, values] : ink_rows) exposure_[row] = upper_median(std::move(values));
    }

    /// One step of Gauss and Newton with the weights of the present residuals.
    void step(double knee) {
        const Eigen::Index n = count();
        const std::size_t rows = exposure_.size();
        Eigen::MatrixXd row_mean = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows), n);
        std::vector<double> row_residual(rows, 0);
        std::fill(weight_.begin(), weight_.end(), 0);
        struct Term {
            double weight = 0, residual = 0;
            Eigen::Index column = 0;
            std::array<double, 2> slope{};
        };
        std::vector<Term> terms;
        terms.reserve(readings_.size());
        for (const LogReading& reading : readings_) {
            Term term;
            term.residual = residual_of(reading);
            term.weight = 1 / (reading.variance + term.residual * term.residual / (knee * knee));
            term.column = column_of(reading);
            const double r2 = reading.radius * reading.radius, gain = fall_off(gain_, reading.radius);
            term.slope = {r2 / gain, r2 * r2 / gain};
            const std::size_t row = row_of(reading);
            const auto r = static_cast<Eigen::Index>(row);
            row_mean(r, term.column) += term.weight;
            for (int t = 0; t < terms_; ++t) {
                row_mean(r, offset_.size() + t) += term.weight * term.slope[static_cast<std::size_t>(t)];
            }
            row_residual[row] += term.weight * term.residual;
            weight_[row] += term.weight;
            terms.push_back(term);
        }
        normal_.setZero(n, n);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
        for (const Term& term : terms) {
            normal_(term.column, term.column) += term.weight;
            right[term.column] += term.weight * term.residual;
            for (int t = 0; t < terms_; ++t) {
                const double slope = term.slope[static_cast<std::size_t>(t)];
                const Eigen::Index at = offset_.size() + t;
                normal_(at, term.column) += term.weight * slope;
                normal_(term.column, at) += term.weight * slope;
                right[at] += term.weight * slope * term.residual;
                for (int u = 0; u < terms_; ++u) {
                    normal_(at, offset_.size() + u) += term.weight * slope * term.slope[static_cast<std::size_t>(u)];
                }
            }
        }
        for (std::size_t row = 0; row < rows; ++row) {
            if (weight_[row] <= 0) continue;
            const auto mean = row_mean.row(static_cast<Eigen::Index>(row)).transpose();
            normal_.noalias() -= mean * mean.transpose() / weight_[row];
            right.noalias() -= mean * (row_residual[row] / weight_[row]);
        }
        add_prior(right);
        const Eigen::VectorXd change = normal_.ldlt().solve(right);
        for (std::size_t row = 0; row < rows; ++row) {
            if (weight_[row] <= 0) continue;
            exposure_[row] +=
                (row_residual[row] - row_mean.row(static_cast<Eigen::Index>(row)).dot(change)) / weight_[row];
        }
        offset_ += change.head(offset_.size());
        for (int t = 0; t < terms_; ++t) gain_[static_cast<std::size_t>(t)] += change[offset_.size() + t];
    }

    /// A common part of all offsets is the exposures' as well, and so it is of tags that are never seen with the
    /// others: such parts stay as they started. Lenses lose a stop in the corner at most, where no tag near the rim
    /// says more.
    void add_prior(Eigen::VectorXd& right) {
        normal_.diagonal().head(offset_.size()).array() += 1;
        constexpr double gain_sigma = 0.5;
        for (int t = 0; t < terms_; ++t) {
            const Eigen::Index at = offset_.size() + t;
            normal_(at, at) += 1 / (gain_sigma * gain_sigma);
            right[at] -= gain_[static_cast<std::size_t>(t)] / (gain_sigma * gain_sigma);
        }
    }

    const std::vector<LogReading>& readings_;
    std::size_t frame_count_;
    int terms_;
    std::map<std::pair<CardSurface, std::size_t>, Eigen::Index> column_;
    Eigen::VectorXd offset_;
    std::vector<double> exposure_, weight_;  // by frame and channel
    std::array<double, 2> gain_{};
    Eigen::MatrixXd normal_;
};

}  // namespace

LightFit fit_light(const std::vector<LogReading>& readings, std::size_t frame_count) {
    JointFit even(readings, frame_count, 0);
    if (readings.empty()) return even.result();
    even.solve();
    JointFit square(readings, frame_count, 1);
    square.solve();
    // Beyond this a correction in the corner may be worse than none: half a tenth of a stop.
    constexpr double most_corner_sigma = 0.05;
    const double sigma = square.corner_sigma();
    if (!(sigma <= most_corner_sigma) || !(square.cost() <= even.cost())) return even.result();
    Vignette vignette{square.gain(), sigma};
    LightFit fit = square.result();
    // The term of fourth degree only where it is seen as well.
    JointFit quartic(readings, frame_count, 2);
    quartic.solve();
    const double quartic_sigma = quartic.corner_sigma();
    const double gained = square.cost() - quartic.cost();
    const double evidence = std::log(static_cast<double>(readings.size()));  // Schwarz 1978
    if (quartic_sigma <= most_corner_sigma && gained > 4 * evidence) {
        vignette = {quartic.gain(), quartic_sigma};
        fit = quartic.result();
    }
    fit.vignette = vignette;
    return fit;
}

}  // namespace matchlight
