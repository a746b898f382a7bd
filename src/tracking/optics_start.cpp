// Viterbi over focus, least squares over the rest.
#include "tracking/optics_start.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

namespace matchlight {

namespace {

constexpr int focus_steps = 64;
/// From infinity to less than half the distance of the nearest tag.
constexpr double nearest_focus = 2.5;

struct Reading {
    double inverse_depth = 0, motion2 = 0, variance = 0, weight = 0;
};

class StartSearch {
public:
    StartSearch(const std::vector<TagBlurReadings>& tags, std::size_t frames) : by_frame_(frames) {
        double sum = 0;
        std::size_t count = 0;
        for (const TagBlurReadings& tag : tags) {
            for (std::size_t i = 0; i < tag.readings.size(); ++i) {
                const BlurReading& reading = tag.readings[i];
                const auto k = static_cast<Eigen::Index>(i);
                // Softness differs over a picture by some tenths of a pixel², and no kernel is quite what it is taken
                // for.
                constexpr double uneven_px2 = 0.05, uneven_share = 0.1;
                const double variance =
                    tag.covariance(k, k) + uneven_px2 * uneven_px2 + std::pow(uneven_share * reading.variance_px2, 2);
                by_frame_[tag.frame].push_back({reading.inverse_depth, reading.motion_px * reading.motion_px / 12,
                                                reading.variance_px2, 1 / variance});
                largest_ = std::max(largest_, reading.inverse_depth);
                sum += reading.inverse_depth;
                ++count;
            }
        }
        if (count > 0) mean_ = sum / static_cast<double>(count);
    }

    bool has_readings() const { return mean_ > 0; }
    double mean_inverse_depth() const { return mean_; }

    /// From one scale of the circle of confusion; nullopt when blur turns out not to grow with defocus.
    std::optional<OpticsStart> from(double coc_scale, double& cost) const {
        OpticsStart start;
        start.focus.assign(by_frame_.size(), mean_);
        start.coc_scale = coc_scale;
        start.softness_px2 = smallest_variance();
        constexpr int rounds = 4;
        for (int i = 0; i < rounds; ++i) {
            cost = follow_focus(start);
            if (!fit_scales(start)) return std::nullopt;
        }
        cost = follow_focus(start);
        return start;
    }

private:
    double focus_at(int step) const { return nearest_focus * largest_ * step / (focus_steps - 1); }

    /// The tenth percentile: what is in focus.
    double smallest_variance() const {
        std::vector<double> variances;
        for (const auto& frame : by_frame_) {
            for (const Reading& reading : frame) variances.push_back(reading.variance);
        }
        const auto tenth = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 10);
        std::nth_element(variances.begin(), tenth, variances.end());
        return *tenth;
    }

    static double robust(double squares) {
        constexpr double cut2 = 25;  // five standard deviations
        return std::min(squares, cut2);
    }

    /// Sets the focus of every frame and returns the path's cost.
    double follow_focus(OpticsStart& start) const {
        constexpr int reach = 3;  // grid steps that focus may move in a frame
        const double scale = start.coc_scale * start.coc_scale / 16;
        std::vector<double> cost(focus_steps, 0.0), next(focus_steps);
        std::vector<std::array<signed char, focus_steps>> from(by_frame_.size());
        for (std::size_t t = 0; t < by_frame_.size(); ++t) {
            for (int k = 0; k < focus_steps; ++k) {
                double best = std::numeric_limits<double>::infinity();
                for (int move = t > 0 ? -reach : 0; move <= (t > 0 ? reach : 0); ++move) {
                    const int before = k + move;
                    if (before < 0 || before >= focus_steps) continue;
                    const double candidate = cost[static_cast<std::size_t>(before)] + move * move;
                    if (candidate >= best) continue;
                    best = candidate;
                    from[t][static_cast<std::size_t>(k)] = static_cast<signed char>(move);
                }
                for (const Reading& reading : by_frame_[t]) {
                    const double defocus = focus_at(k) - reading.inverse_depth;
                    const double off = reading.variance - start.softness_px2 - scale * defocus * defocus -
                                       start.shutter2 * reading.motion2;
                    best += robust(off * off * reading.weight);
                }
                next[static_cast<std::size_t>(k)] = best;
            }
            cost.swap(next);
        }
        const auto end = std::min_element(cost.begin(), cost.end());
        int k = static_cast<int>(end - cost.begin());
        for (std::size_t t = by_frame_.size(); t-- > 0;) {
            start.focus[t] = focus_at(k);
            k += from[t][static_cast<std::size_t>(k)];
        }
        return *end;
    }

    bool fit_scales(OpticsStart& start) const {
        const double scale = start.coc_scale * start.coc_scale / 16;
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        for (std::size_t t = 0; t < by_frame_.size(); ++t) {
            for (const Reading& reading : by_frame_[t]) {
                const double defocus = start.focus[t] - reading.inverse_depth;
                const Eigen::Vector3d row(1, defocus * defocus, reading.motion2);
                const double off =
                    reading.variance - row.dot(Eigen::Vector3d(start.softness_px2, scale, start.shutter2));
                if (robust(off * off * reading.weight) < off * off * reading.weight) continue;
                normal += reading.weight * row * row.transpose();
                right += reading.weight * reading.variance * row;
            }
        }
        normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff() + 1e-12;
        // A shutter that stays open longer than a frame does not exist; without motion its share is free.
        normal(2, 2) += 1;
        const Eigen::Vector3d fitted = normal.ldlt().solve(right);
        if (!fitted.allFinite() || !(fitted[1] > 0)) return false;
        start.softness_px2 = fitted[0];
        start.coc_scale = 4 * std::sqrt(fitted[1]);
        start.shutter2 = std::clamp(fitted[2], 0.0, 1.0);
        return true;
    }

    std::vector<std::vector<Reading>> by_frame_;
    double mean_ = 0, largest_ = 0;
};

}  // namespace

std::optional<OpticsStart> find_optics_start(const std::vector<TagBlurReadings>& tags, std::size_t frames) {
    const StartSearch search(tags, frames);
    if (!search.has_readings()) return std::nullopt;
    std::optional<OpticsStart> best;
    double least = std::numeric_limits<double>::infinity();
    // Circles of confusion of 1 to 512 px at infinity, were the tags in focus.
    for (double at_infinity_px = 1; at_infinity_px <= 512; at_infinity_px *= 2) {
        double cost = 0;
        const auto start = search.from(at_infinity_px / search.mean_inverse_depth(), cost);
        if (!start || cost >= least) continue;
        least = cost;
        best = start;
    }
    return best;
}

}  // namespace matchlight
