// The order of a calibration: start, outliers, candidates, what is known of the chosen one.
#include "calibration/lens_calibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "calibration/lens_uncertainty.h"
#include "calibration/view_choice.h"
#include "core/error.h"
#include "core/median.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Fewer say nothing that could be checked on a view left out.
constexpr std::size_t least_views = 4, good_views = 10;
/// A view with fewer hardly holds its own pose.
constexpr std::size_t least_corners = 8;

/// A symmetric board may be taken the wrong way round from view to view; then its bend has no direction.
bool bend_is_defined(const BoardSpec& board) {
    return board.kind != BoardKind::chessboard || board.columns != board.rows;
}

std::vector<LensCandidate> candidates_of(const BoardSpec& board, const LensOptions& options) {
    std::vector<LensCandidate> candidates;
    for (const bool bent : {false, true}) {
        if (bent && !bend_is_defined(board)) continue;
        if (!options.lens || *options.lens == LensModel::radtan) {
            for (int terms = options.least_radial_terms; terms <= options.most_radial_terms; ++terms) {
                candidates.push_back({LensModel::radtan, terms, bent});
            }
        }
        if (!options.lens || *options.lens == LensModel::fisheye) {
            candidates.push_back({LensModel::fisheye, 4, bent});
        }
    }
    return candidates;
}

/// The candidate of each lens that bends most freely: to tell outliers from what a stiffer model cannot follow.
LensCandidate freest(const std::vector<LensCandidate>& candidates, LensModel lens) {
    LensCandidate best;
    int most = -1;
    for (const LensCandidate& candidate : candidates) {
        if (candidate.lens != lens || candidate.parameter_count() <= most) continue;
        most = candidate.parameter_count();
        best = candidate;
    }
    return best;
}

/// Keeps the views (and poses) for which `keep` is set.
void keep_views(LensData& data, const std::vector<LensFit*>& fits, const std::vector<char>& keep) {
    std::size_t kept = 0;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        if (keep[v] == 0) continue;
        if (kept != v) {
            data.views[kept] = std::move(data.views[v]);
            for (LensFit* fit : fits) fit->poses[kept] = fit->poses[v];
        }
        ++kept;
    }
    data.views.resize(kept);
    for (LensFit* fit : fits) fit->poses.resize(kept);
}

struct Outliers {
    std::vector<std::string> views;
    int corners = 0;
};

/// Leaves out corners beyond five robust standard deviations, and views that fit four times worse than the middle one
/// or lose half their corners. True when something was left out.
bool drop_outliers(LensData& data, const std::vector<LensFit*>& fits, const LensFit& judge, Outliers& dropped) {
    std::vector<std::vector<double>> distances(data.views.size());
    std::vector<double> all, by_view;
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        double sum = 0;
        for (const Vector2d& residual : residuals_of(data, judge, v)) {
            distances[v].push_back(residual.norm());
            sum += residual.squaredNorm();
        }
        all.insert(all.end(), distances[v].begin(), distances[v].end());
        by_view.push_back(std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, distances[v].size()))));
    }
    // The median length of a Gaussian error of two coordinates is 1.1774 of their sigma (Rayleigh).
    const double sigma_px = upper_median(all) / 1.1774;
    constexpr double floor_px = 0.1;  // rendered pictures: what is left is rounding, not a distribution
    const double most_px = std::max(5 * sigma_px, floor_px);
    const double most_view_px = std::max(4 * upper_median(by_view), floor_px);
    bool any = false;
    std::vector<char> keep(data.views.size(), 1);
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        LensView& view = data.views[v];
        std::vector<BoardCorner> good;
        for (std::size_t i = 0; i < view.corners.size(); ++i) {
            if (distances[v][i] <= most_px) good.push_back(view.corners[i]);
        }
        // Its own outliers may be what makes a view bad: judged again without them.
        double sum = 0;
        for (const double distance : distances[v]) sum += distance <= most_px ? distance * distance : 0;
        const double rest = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, good.size())));
        if (good.size() < least_corners || 2 * good.size() < view.corners.size() || rest > most_view_px) {
            keep[v] = 0;
            dropped.views.push_back(view.name);
            any = true;
        } else if (good.size() < view.corners.size()) {
            dropped.corners += static_cast<int>(view.corners.size() - good.size());
            view.corners = std::move(good);
            any = true;
        }
    }
    keep_views(data, fits, keep);
    return any;
}

void require_views(const LensData& data, const char* which) {
    if (data.views.size() >= least_views) return;
    throw InputError(
        {},
        fmt::format("a lens needs at least {} views that {}, and there {} {}", least_views, which,
                    data.views.size() == 1 ? "is" : "are", data.views.size()),
        "take 15 or more, the board tilted 30 to 45 degrees this way and that, in all parts of the picture");
}

std::vector<double> tilts_deg(const LensFit& fit, const BoardSpec& board) {
    const std::vector<Vector3d> corners = board_corners_m(board);
    const Vector3d middle = (corners.front() + corners.back()) / 2;
    std::vector<double> tilts;
    for (const BoardPose& pose : fit.poses) {
        const Vector3d axis(pose[0], pose[1], pose[2]);
        const Eigen::Matrix3d rotation = axis.norm() > 0
                                             ? Eigen::AngleAxisd(axis.norm(), axis.normalized()).toRotationMatrix()
                                             : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
        const Vector3d at = rotation * middle + Vector3d(pose[3], pose[4], pose[5]);
        const double cosine = std::abs(rotation.col(2).dot(at.normalized()));
        tilts.push_back(std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
    }
    return tilts;
}

/// Views that all look straight at the board say nothing of the focal length: a longer lens from further away shows
/// the same.
void require_focal_length(const LensFit& fit, const Eigen::MatrixXd& covariance, const std::vector<double>& tilts) {
    constexpr double most_doubt = 0.05;  // of the focal length: beyond, the number is a guess
    const double doubt = std::sqrt(
        std::max(covariance(0, 0) / (fit.lens[0] * fit.lens[0]), covariance(1, 1) / (fit.lens[1] * fit.lens[1])));
    if (doubt <= most_doubt) return;
    throw InputError(
        {},
        fmt::format("the views do not determine the focal length{}: the board is tilted by at most "
                    "{:.0f} degrees",
                    std::isfinite(doubt) ? fmt::format(" (one sigma is {:.0f} % of it)", 100 * doubt) : std::string(),
                    *std::ranges::max_element(tilts)),
        "add views in which it is tilted 30 to 45 degrees, about both its axes");
}

std::vector<std::string> parameter_names(const Camera& camera) {
    std::vector<std::string> names = {"fx", "fy", "cx", "cy"};
    const std::vector<std::string> coefficients =
        camera.lens == LensModel::fisheye ? std::vector<std::string>{"k1", "k2", "k3", "k4"}
                                          : std::vector<std::string>{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    names.insert(names.end(), coefficients.begin(),
                 coefficients.begin() + static_cast<std::ptrdiff_t>(camera.distortion.size()));
    return names;
}

void describe_parameters(LensCalibration& result, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& jackknife) {
    const std::vector<std::string> names = parameter_names(result.camera);
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        ParameterEstimate estimate;
        estimate.name = names[i];
        estimate.value = result.fit.lens[i];
        if (result.fit.candidate.estimates(static_cast<int>(i))) {
            estimate.sigma_of_noise = std::sqrt(covariance(at, at));
            estimate.sigma_of_views = std::sqrt(jackknife(at, at));
            estimate.sigma = std::max(estimate.sigma_of_noise, estimate.sigma_of_views);
            ++at;
        }
        result.parameters.push_back(estimate);
    }
    for (; at < covariance.rows(); ++at) {
        result.bend_sigma_m.push_back(std::sqrt(std::max(covariance(at, at), jackknife(at, at))));
    }
    CameraSigmas sigmas{result.parameters[0].sigma,
                        result.parameters[1].sigma,
                        result.parameters[2].sigma,
                        result.parameters[3].sigma,
                        {}};
    for (std::size_t i = 4; i < names.size(); ++i) sigmas.distortion.push_back(result.parameters[i].sigma);
    result.camera.sigmas = sigmas;
}

}  // namespace

std::vector<int> coverage_counts(const LensData& data, int columns, int rows) {
    std::vector<int> counts(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    for (const LensView& view : data.views) {
        for (const BoardCorner& corner : view.corners) {
            const int column = static_cast<int>((corner.px.x() + 0.5) * columns / data.width);
            const int row = static_cast<int>((corner.px.y() + 0.5) * rows / data.height);
            ++counts[static_cast<std::size_t>(std::clamp(row, 0, rows - 1)) * static_cast<std::size_t>(columns) +
                     static_cast<std::size_t>(std::clamp(column, 0, columns - 1))];
        }
    }
    return counts;
}

LensCalibration calibrate_lens(LensData data, const LensOptions& options, Warnings& warnings) {
    std::erase_if(data.views, [](const LensView& view) { return view.corners.size() < least_corners; });
    require_views(data, "show enough of the board");
    const std::vector<LensCandidate> candidates = candidates_of(data.board, options);

    // A start for each kind of lens; the freest of each judges outliers, the better one decides.
    LensCalibration result;
    Outliers dropped;
    std::vector<LensFit> starts;
    std::vector<char> posed(data.views.size(), 1);
    for (const LensModel lens : {LensModel::radtan, LensModel::fisheye}) {
        if (options.lens && *options.lens != lens) continue;
        LensStart start = start_fit(data, {lens, lens == LensModel::fisheye ? 4 : 2, false});
        std::ranges::transform(posed, start.posed, posed.begin(), [](char a, char b) { return a && b ? 1 : 0; });
        starts.push_back(std::move(start.fit));
    }
    std::vector<LensFit*> kept_together;
    for (LensFit& start : starts) kept_together.push_back(&start);
    for (std::size_t v = 0; v < posed.size(); ++v) {
        if (posed[v] == 0) dropped.views.push_back(data.views[v].name);
    }
    keep_views(data, kept_together, posed);
    require_views(data, "show the board as a lens could");
    std::vector<LensFit> judges;
    for (const LensFit& start : starts) judges.push_back(started_from(start, freest(candidates, start.candidate.lens)));
    for (LensFit& judge : judges) kept_together.push_back(&judge);
    constexpr int most_rounds = 5;
    for (int round = 0; round < most_rounds; ++round) {
        const double robust_px = round == 0 ? std::max(data.width, data.height) / 1000.0 : 0;
        for (LensFit& judge : judges) adjust(data, judge, {robust_px, {}});
        const auto judge = std::ranges::min_element(judges, {}, &LensFit::rms_px);
        if (!drop_outliers(data, kept_together, *judge, dropped)) break;
        require_views(data, "fit with the others");
    }

    result.candidates = score_candidates(data, candidates, starts);
    const CandidateScore& chosen = *std::ranges::find_if(result.candidates, &CandidateScore::chosen);
    result.fit = chosen.fit;
    result.held_out_px = chosen.held_out_px;
    result.camera = camera_of(result.fit.candidate, result.fit.lens, data.width, data.height);
    result.view_tilt_deg = tilts_deg(result.fit, data.board);

    const double sigma_px = corner_sigma_px(data, result.fit);
    constexpr double least_sigma_px = 0.05;  // no real corner is better known: noise-free pictures may still be frontal
    require_focal_length(result.fit, shared_covariance(data, result.fit, std::max(sigma_px, least_sigma_px)),
                         result.view_tilt_deg);
    // Views that are alike count once.
    result.distinct_views = std::clamp<std::size_t>(distinct_views(data), 1, data.views.size());
    const double alike = static_cast<double>(data.views.size()) / static_cast<double>(result.distinct_views);
    const Eigen::MatrixXd covariance = alike * shared_covariance(data, result.fit, sigma_px);
    const Eigen::MatrixXd jackknife = alike * jackknife_covariance(result.fit, chosen.fold_fits);
    describe_parameters(result, covariance, jackknife);
    result.pixels = pixel_uncertainty(data, result.fit, covariance, jackknife);
    for (std::size_t v = 0; v < data.views.size(); ++v) {
        double sum = 0;
        const std::vector<Vector2d> residuals = residuals_of(data, result.fit, v);
        for (const Vector2d& residual : residuals) sum += residual.squaredNorm();
        result.view_rms_px.push_back(std::sqrt(sum / static_cast<double>(residuals.size())));
    }
    constexpr int columns = 8, rows = 6;
    const std::vector<int> counts = coverage_counts(data, columns, rows);
    result.coverage =
        static_cast<double>(std::ranges::count_if(counts, [](int n) { return n > 0; })) / (columns * rows);
    result.dropped_views = dropped.views;
    result.dropped_corners = dropped.corners;
    result.data = std::move(data);

    if (dropped.corners > 0) {
        warnings.add(
            fmt::format("{} corners lie far from where every lens model has them and were left out", dropped.corners));
    }
    for (const std::string& name : dropped.views) {
        warnings.add(fmt::format("{}: does not fit with the other views and was left out", printable(name)));
    }
    if (result.distinct_views < good_views) {
        warnings.add(fmt::format(
            "only {} of {} views differ (the board is tilted by {:.0f} to {:.0f} degrees): 15 or "
            "more make a lens well known",
            result.distinct_views, result.data.views.size(), *std::ranges::min_element(result.view_tilt_deg),
            *std::ranges::max_element(result.view_tilt_deg)));
    }
    constexpr double enough = 0.6;
    if (result.coverage < enough) {
        warnings.add(fmt::format("corners cover only {:.0f} % of the picture: elsewhere the lens is extrapolated",
                                 100 * result.coverage));
    }
    if (!chosen.reaches_corners) {
        warnings.add("the lens model folds back inside the picture: another --model will serve better");
    }
    return result;
}

}  // namespace matchlight
