// Cross-validation over views.
#include "calibration/lens_choice.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/parallel.h"

namespace matchlight {
namespace {

double mean_square(const std::vector<Eigen::Vector2d>& residuals) {
    double sum = 0;
    for (const Eigen::Vector2d& residual : residuals) sum += residual.squaredNorm();
    return sum / static_cast<double>(residuals.size());
}

/// Whether the camera finds the way back from every corner's pixel; a polynomial that folds inside the picture does
/// not.
bool reaches(const LensData& data, const LensFit& fit) {
    const Camera camera = camera_of(fit.candidate, fit.lens, data.width, data.height);
    for (const LensView& view : data.views) {
        for (const BoardCorner& corner : view.corners) {
            if (!camera.normalized_from_pixel(corner.px).allFinite()) return false;
        }
    }
    return true;
}

/// Held-out error over all corners, every corner counting alike.
double root_mean(const LensData& data, const std::vector<double>& squares) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t v = 0; v < squares.size(); ++v) {
        sum += squares[v] * static_cast<double>(data.views[v].corners.size());
        count += data.views[v].corners.size();
    }
    return std::sqrt(sum / static_cast<double>(count));
}

void choose(std::vector<CandidateScore>& scores) {
    CandidateScore* best = nullptr;
    for (CandidateScore& score : scores) {
        if (score.reaches_corners && (!best || score.held_out_px < best->held_out_px)) best = &score;
    }
    if (!best) best = &scores.front();
    for (CandidateScore& score : scores) {
        const std::size_t n = score.held_out_square_px.size();
        double mean = 0, square = 0;
        for (std::size_t v = 0; v < n; ++v) {
            const double d = score.held_out_square_px[v] - best->held_out_square_px[v];
            mean += d / static_cast<double>(n);
            square += d * d / static_cast<double>(n);
        }
        score.excess_px2 = mean;
        score.excess_error_px2 = std::sqrt(std::max(0.0, square - mean * mean) / std::max<double>(1, double(n) - 1));
    }
    // Differences between nearly equal models can be told apart long before they matter: a hundredth of the error does
    // not, while a parameter that buys no more is free to be anything outside the views.
    const double not_worth_px2 = 0.02 * best->held_out_px * best->held_out_px;
    CandidateScore* chosen = best;
    for (CandidateScore& score : scores) {
        if (!score.reaches_corners || score.excess_px2 > std::max(score.excess_error_px2, not_worth_px2)) continue;
        // Of equally many parameters the first listed: radtan, which every other program reads.
        if (score.candidate.parameter_count() < chosen->candidate.parameter_count()) chosen = &score;
    }
    chosen->chosen = true;
}

}  // namespace

std::size_t fold_count(std::size_t views) {
    constexpr std::size_t most_folds = 10;
    return views <= 15 ? views : most_folds;  // few views: each alone
}

std::vector<double> held_out_squares(const LensData& data, const LensFit& fit, std::vector<LensFit>& fits) {
    const std::size_t folds = fold_count(data.views.size());
    std::vector<double> squares(data.views.size());
    fits.assign(folds, fit);
    parallel_for(static_cast<int>(folds), [&](int index) {
        const auto fold = static_cast<std::size_t>(index);
        LensFit& without = fits[fold];
        AdjustOptions options;
        options.in_use.assign(data.views.size(), 1);
        for (std::size_t v = fold; v < data.views.size(); v += folds) options.in_use[v] = 0;
        adjust(data, without, options);
        for (std::size_t v = fold; v < data.views.size(); v += folds) {
            adjust_pose(data, without, v);
            squares[v] = mean_square(residuals_of(data, without, v));
        }
    });
    return squares;
}

std::vector<CandidateScore> score_candidates(const LensData& data, const std::vector<LensCandidate>& candidates,
                                             const std::vector<LensFit>& starts) {
    std::vector<CandidateScore> scores(candidates.size());
    parallel_for(static_cast<int>(candidates.size()), [&](int index) {
        CandidateScore& score = scores[static_cast<std::size_t>(index)];
        score.candidate = candidates[static_cast<std::size_t>(index)];
        const auto start =
            std::ranges::find(starts, score.candidate.lens, [](const LensFit& fit) { return fit.candidate.lens; });
        assert(start != starts.end());
        score.fit = started_from(*start, score.candidate);
        adjust(data, score.fit);
        score.reaches_corners = reaches(data, score.fit);
    });
    for (CandidateScore& score : scores) {
        score.held_out_square_px = held_out_squares(data, score.fit, score.fold_fits);
        score.held_out_px = root_mean(data, score.held_out_square_px);
    }
    choose(scores);
    return scores;
}

}  // namespace matchlight
