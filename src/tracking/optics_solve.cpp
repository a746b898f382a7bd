// Two explanations of the same blur, with and without defocus, each brought to its best.
#include "tracking/optics_solve.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <limits>

#include "tracking/optics_model.h"
#include "tracking/optics_start.h"

namespace matchlight {

namespace {

/// What the depths of the clip allow focus to be and to do.
struct DepthRange {
    double mean = 0, largest = 0;
};

DepthRange depths_of(const std::vector<TagBlurReadings>& tags) {
    DepthRange range;
    std::size_t count = 0;
    for (const TagBlurReadings& tag : tags) {
        for (const BlurReading& reading : tag.readings) {
            range.mean += reading.inverse_depth;
            range.largest = std::max(range.largest, reading.inverse_depth);
            ++count;
        }
    }
    range.mean /= static_cast<double>(count);
    return range;
}

class OpticsFit {
public:
    OpticsFit(const std::vector<TagBlurReadings>& tags, std::size_t frames, const OpticsStart* start)
        : model_(tags, frames, start != nullptr), range_(depths_of(tags)) {
        const auto count = static_cast<Eigen::Index>(frames);
        Eigen::VectorXd focus = Eigen::VectorXd::Constant(count, range_.mean);
        if (start) focus = Eigen::VectorXd::Map(start->focus.data(), count);
        state_ = model_.state(start ? start->softness_px2 : 0.2, start ? start->coc_scale : 0,
                              start ? start->shutter2 : 0.1, focus);
        focus_prior_ = start ? 4 : 0;
        spread_.focus = focus_priors()[focus_prior_];
        spread_.focus.mean = range_.mean;
        can_focus_ = start != nullptr;
    }

    void run() {
        constexpr int most_rounds = 15;
        model_.linearise(state_);
        for (int round = 0; round < most_rounds; ++round) {
            model_.weigh(spread_);
            choose_spread();
            const auto solution = model_.solve(spread_);
            if (!solution) break;
            log_evidence_ = solution->log_evidence;
            const double moved = move(solution->change);
            model_.linearise(state_);
            constexpr double settled = 1e-3;  // of a standard deviation or so
            if (moved < settled) break;
        }
    }

    const OpticsState& state() const { return state_; }
    const OpticsSpread& spread() const { return spread_; }
    double log_evidence() const { return log_evidence_; }
    OpticsModel::Sigmas sigmas() { return model_.sigmas(spread_); }

private:
    /// Focus that stands still, and focus that is pulled, ever more suddenly, as shares of the mean inverse depth.
    std::vector<FocusPrior> focus_priors() const {
        FocusPrior still;
        still.mean = range_.mean;
        still.spread = 2 * range_.largest;
        still.step = 1e-4 * range_.mean;
        still.bend = range_.mean;
        std::vector<FocusPrior> priors{still};
        FocusPrior pulled = still;
        pulled.step = 0.2 * range_.mean;
        for (const double bend : {1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2}) {
            pulled.bend = bend * range_.mean;
            priors.push_back(pulled);
        }
        return priors;
    }

    double evidence_of(const OpticsSpread& spread) {
        const auto solution = model_.solve(spread);
        return solution ? solution->log_evidence : -std::numeric_limits<double>::infinity();
    }

    /// Climbs the evidence one factor at a time.
    void choose_spread() {
        double best = evidence_of(spread_);
        const auto consider = [&](const OpticsSpread& candidate) {
            const double evidence = evidence_of(candidate);
            if (!(evidence > best)) return false;
            best = evidence;
            spread_ = candidate;
            return true;
        };
        constexpr double least_px2 = 1e-3, most_px2 = 2;
        for (double OpticsSpread::*value :
             {&OpticsSpread::reading, &OpticsSpread::frame, &OpticsSpread::field, &OpticsSpread::place}) {
            for (const double factor : {1.6, 1 / 1.6}) {
                OpticsSpread candidate = spread_;
                candidate.*value = std::clamp(candidate.*value * factor, least_px2, most_px2);
                if (candidate.*value != spread_.*value && consider(candidate)) break;
            }
        }
        if (!can_focus_) return;
        const std::vector<FocusPrior> priors = focus_priors();
        const std::size_t now = focus_prior_;
        for (const std::size_t next : {std::size_t{0}, now - 1, now + 1}) {
            if (next >= priors.size() || next == focus_prior_) continue;
            OpticsSpread candidate = spread_;
            candidate.focus = priors[next];
            if (consider(candidate)) focus_prior_ = next;
        }
    }

    /// Goes along the step, no farther than the linearisation reaches; returns its length.
    double move(const OpticsState& change) {
        double& coc_scale = state_.shared[OpticsState::coc_scale];
        const double focus_change =
            change.local.head(static_cast<Eigen::Index>(model_.frames())).cwiseAbs().maxCoeff();
        double reach = 1;
        if (can_focus_) {
            constexpr double most_growth = 0.5, most_focus_share = 0.25;
            reach = std::min(1.0, most_growth * coc_scale / std::max(std::abs(change.shared[OpticsState::coc_scale]), 1e-12));
            reach = std::min(reach, most_focus_share * range_.mean / std::max(focus_change, 1e-12));
        }
        state_.shared += reach * change.shared;
        state_.local += reach * change.local;
        auto focus = state_.local.head(static_cast<Eigen::Index>(model_.frames()));
        focus = focus.cwiseMax(0.0);  // no nearer than infinity from the other side
        double moved = std::abs(change.shared[OpticsState::softness]) + std::abs(change.shared[OpticsState::shutter2]);
        if (can_focus_) {
            moved += std::abs(change.shared[OpticsState::coc_scale]) / coc_scale +
                     focus_change / range_.mean;
        }
        return moved;
    }

    OpticsModel model_;
    DepthRange range_;
    OpticsState state_;
    OpticsSpread spread_;
    bool can_focus_ = false;
    std::size_t focus_prior_ = 0;  // in focus_priors
    double log_evidence_ = 0;
};

void take(OpticsFit& fit, bool defocus, OpticsSolution& solution) {
    const OpticsModel::Sigmas sigmas = fit.sigmas();
    const OpticsState& state = fit.state();
    const auto estimate = [&](int column) { return Estimate{state.shared[column], sigmas.shared[column]}; };
    solution.softness_px2 = estimate(OpticsState::softness);
    solution.shutter2 = estimate(OpticsState::shutter2);
    solution.scatter_px2 = fit.spread().reading;
    solution.frame_px2 = fit.spread().frame;
    solution.unevenness_px2 = std::hypot(fit.spread().field, fit.spread().place);
    if (!defocus) return;
    solution.coc_scale = estimate(OpticsState::coc_scale);
    for (Eigen::Index t = 0; t < sigmas.focus.size(); ++t) {
        solution.focus.push_back({state.local[t], sigmas.focus[t]});
    }
}

}  // namespace

OpticsSolution solve_optics(const std::vector<TagBlurReadings>& tags, std::size_t frames) {
    assert(!tags.empty() && frames > 0);
    OpticsFit sharp(tags, frames, nullptr);
    sharp.run();
    OpticsSolution solution;
    if (const std::optional<OpticsStart> start = find_optics_start(tags, frames)) {
        OpticsFit focused(tags, frames, &*start);
        focused.run();
        solution.defocus_evidence = focused.log_evidence() - sharp.log_evidence();
        if (solution.defocus_evidence > 0) {
            take(focused, true, solution);
            return solution;
        }
    }
    take(sharp, false, solution);
    return solution;
}

}  // namespace matchlight
