// Two explanations of the same blur, with and without defocus, each brought to its best.
#include "tracking/optics_solve.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

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

    /// Finds the spreads as well.
    void learn() {
        constexpr int most_rounds = 30;
        model_.linearise(state_);
        for (int round = 0; round < most_rounds; ++round) {
            model_.weigh(spread_);
            const bool is_spread_settled = choose_spread();
            if (step() < settled && is_spread_settled) break;
        }
    }

    /// With the spreads of another fit, from its state.
    void follow(const OpticsFit& other) {
        spread_ = other.spread_;
        state_.shared.head<OpticsState::field>() = other.state_.shared.head<OpticsState::field>();
        const auto count = static_cast<Eigen::Index>(model_.frames());
        state_.local.head(count) = other.state_.local.head(count);
        constexpr int most_rounds = 8;
        model_.linearise(state_);
        for (int round = 0; round < most_rounds; ++round) {
            model_.weigh(spread_);
            if (step() < settled) break;
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

    static constexpr double settled = 1e-3;

    /// One step of Gauss–Newton; returns how far it went, in units of what is solved for.
    double step() {
        const auto solution = model_.solve(spread_);
        if (!solution) return 0;
        log_evidence_ = solution->log_evidence;
        const double moved = move(solution->change);
        model_.linearise(state_);
        return moved;
    }

    double evidence_of(const OpticsSpread& spread) {
        const auto solution = model_.solve(spread);
        return solution ? solution->log_evidence : -std::numeric_limits<double>::infinity();
    }

    /// Climbs the evidence, one spread at a time and by ever smaller factors; true where it is at the top.
    bool choose_spread() {
        double best = evidence_of(spread_);
        const auto consider = [&](const OpticsSpread& candidate) {
            const double evidence = evidence_of(candidate);
            if (!(evidence > best)) return false;
            best = evidence;
            spread_ = candidate;
            return true;
        };
        bool is_settled = true;
        for (LearnedSpread& learned : learned_) {
            bool is_better = false;
            for (const double factor : {learned.factor, 1 / learned.factor}) {
                OpticsSpread candidate = spread_;
                candidate.*learned.value = std::clamp(candidate.*learned.value * factor, learned.least, learned.most);
                is_better = candidate.*learned.value != spread_.*learned.value && consider(candidate);
                if (is_better) break;
            }
            constexpr double smallest_factor = 1.2;
            is_settled = is_settled && !is_better && learned.factor <= smallest_factor;
            if (!is_better) learned.factor = std::max(smallest_factor, std::sqrt(learned.factor));
        }
        if (!can_focus_) return is_settled;
        const std::vector<FocusPrior> priors = focus_priors();
        const std::size_t now = focus_prior_;
        for (const std::size_t next : {std::size_t{0}, now - 1, now + 1}) {
            if (next >= priors.size() || next == focus_prior_) continue;
            OpticsSpread candidate = spread_;
            candidate.focus = priors[next];
            if (!consider(candidate)) continue;
            focus_prior_ = next;
            is_settled = false;
        }
        return is_settled;
    }

    /// Goes along the step, no farther than the linearisation reaches; returns its length.
    double move(const OpticsState& change) {
        double& coc_scale = state_.shared[OpticsState::coc_scale];
        const double focus_change = change.local.head(static_cast<Eigen::Index>(model_.frames())).cwiseAbs().maxCoeff();
        double reach = 1;
        if (can_focus_) {
            constexpr double most_growth = 0.5, most_focus_share = 0.25;
            reach = std::min(
                1.0, most_growth * coc_scale / std::max(std::abs(change.shared[OpticsState::coc_scale]), 1e-12));
            reach = std::min(reach, most_focus_share * range_.mean / std::max(focus_change, 1e-12));
        }
        state_.shared += reach * change.shared;
        state_.local += reach * change.local;
        auto focus = state_.local.head(static_cast<Eigen::Index>(model_.frames()));
        focus = focus.cwiseMax(0.0);  // no nearer than infinity from the other side
        double moved = std::abs(change.shared[OpticsState::softness]) + std::abs(change.shared[OpticsState::shutter2]);
        if (can_focus_) {
            moved += std::abs(change.shared[OpticsState::coc_scale]) / coc_scale + focus_change / range_.mean;
        }
        return moved;
    }

    struct LearnedSpread {
        double OpticsSpread::*value;
        double least, most;
        double factor = 2;
    };
    /// Softness that differs by more than half a square pixel over a plate is rather a lens out of focus.
    std::array<LearnedSpread, 5> learned_{{{&OpticsSpread::reading, 1e-3, 2},
                                           {&OpticsSpread::frame, 1e-3, 2},
                                           {&OpticsSpread::field, 1e-3, 0.5},
                                           {&OpticsSpread::place, 1e-3, 0.5},
                                           {&OpticsSpread::kernel, 2e-3, 0.2}}};

    OpticsModel model_;
    DepthRange range_;
    OpticsState state_;
    OpticsSpread spread_;
    bool can_focus_ = false;
    std::size_t focus_prior_ = 0;  // in focus_priors
    double log_evidence_ = 0;
};

/// Odds of 20,000 to 1; and because the model is never quite right, which shows when readings are many, a little of
/// each reading.
double enough_evidence(const std::vector<TagBlurReadings>& tags) {
    constexpr double log_odds = 10, of_a_reading = 0.005;
    std::size_t readings = 0;
    for (const TagBlurReadings& tag : tags) readings += tag.readings.size();
    return log_odds + of_a_reading * static_cast<double>(readings);
}

/// Whether defocus where it is strongest (the 95th percentile) adds about as much as the blur that is there anyhow, by
/// the pixel and by softness.
bool shows_defocus(const std::vector<TagBlurReadings>& tags, const OpticsState& state) {
    std::vector<double> disc_px2;
    const double scale = state.shared[OpticsState::coc_scale];
    for (const TagBlurReadings& tag : tags) {
        for (const BlurReading& reading : tag.readings) {
            const double defocus = state.local[static_cast<Eigen::Index>(tag.frame)] - reading.inverse_depth;
            disc_px2.push_back(scale * scale * defocus * defocus / 16);
        }
    }
    const auto strong = disc_px2.begin() + static_cast<std::ptrdiff_t>(disc_px2.size() * 19 / 20);
    std::nth_element(disc_px2.begin(), strong, disc_px2.end());
    constexpr double pixel_px2 = 1.0 / 12;
    constexpr double share = 0.75;
    return *strong > share * (pixel_px2 + std::max(0.0, state.shared[OpticsState::softness]));
}

void take(OpticsFit& fit, bool defocus, OpticsSolution& solution) {
    const OpticsModel::Sigmas sigmas = fit.sigmas();
    const OpticsState& state = fit.state();
    // An aperture that is not quite a disc, an exposure that is not quite even: errors that all readings share.
    constexpr double kernel_error = 0.05;
    const auto estimate = [&](int column, double shared_error) {
        const double value = state.shared[column];
        return Estimate{value, std::hypot(sigmas.shared[column], shared_error * value)};
    };
    solution.softness_px2 = estimate(OpticsState::softness, 0);
    solution.shutter2 = estimate(OpticsState::shutter2, kernel_error);
    solution.scatter_px2 = fit.spread().reading;
    solution.frame_px2 = fit.spread().frame;
    solution.unevenness_px2 = std::hypot(fit.spread().field, fit.spread().place);
    if (!defocus) return;
    solution.coc_scale = estimate(OpticsState::coc_scale, kernel_error / 2);
    for (Eigen::Index t = 0; t < sigmas.focus.size(); ++t) {
        solution.focus.push_back({state.local[t], sigmas.focus[t]});
    }
}

/// Every second, third, … frame, so many that spreads can be learned in reasonable time.
std::vector<TagBlurReadings> thinned(const std::vector<TagBlurReadings>& tags) {
    constexpr std::size_t most_readings = 1500;
    std::size_t readings = 0;
    for (const TagBlurReadings& tag : tags) readings += tag.readings.size();
    const std::size_t every = (readings + most_readings - 1) / most_readings;
    std::vector<TagBlurReadings> kept;
    for (const TagBlurReadings& tag : tags) {
        if (tag.frame % every == 0) kept.push_back(tag);
    }
    return kept.empty() ? tags : kept;
}

}  // namespace

OpticsSolution solve_optics(const std::vector<TagBlurReadings>& tags, std::size_t frames) {
    assert(!tags.empty() && frames > 0);
    const std::vector<TagBlurReadings> few = thinned(tags);
    OpticsFit sharp(few, frames, nullptr);
    sharp.learn();
    OpticsSolution solution;
    if (const std::optional<OpticsStart> start = find_optics_start(few, frames)) {
        OpticsFit focused(few, frames, &*start);
        focused.learn();
        solution.defocus_evidence = focused.log_evidence() - sharp.log_evidence();
        solution.defocus_seen = solution.defocus_evidence > enough_evidence(few) && shows_defocus(few, focused.state());
        if (solution.defocus_seen) {
            OpticsFit all(tags, frames, &*start);
            all.follow(focused);
            take(all, true, solution);
            return solution;
        }
    }
    OpticsFit all(tags, frames, nullptr);
    all.follow(sharp);
    take(all, false, solution);
    return solution;
}

}  // namespace matchlight
