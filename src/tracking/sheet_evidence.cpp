// Evidence of corner offsets and of a common plane, on the linearised clip.
#include "tracking/sheet_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace matchlight {

namespace {

/// A tag that is not on the plane may be anywhere in a room.
constexpr double anywhere_m = 0.3;

/// What print, glue and light that bleeds leave of a fitted corner.
constexpr double usual_bias_px = 0.03;
/// More than this is not the sheets' doing but a wrong lens', which corners must not absorb.
constexpr double most_bias_px = 0.1;

class Evidence {
public:
    Evidence(const SharedNormal& frames_say, const SharedColumns& columns, const ClipModel& model,
             const ModelFreedom& freedom)
        : columns_(columns), model_(model), known_(frames_say) {
        known_ += lens_prior_normal(model, freedom, columns);
        for (const auto& [id, tag] : model.tags) departures_[id] = plane_departure(model, columns, id);
    }

    /// Logarithm of the probability of what was seen, up to a constant.
    double operator()(double bias_px, double plane_sigma_m, const std::set<int>& on_plane) const {
        SharedNormal normal = known_;
        normal += offset_prior_normal(model_, columns_, bias_px);
        double squares = 0, log_precision = 0;
        for (const auto& [id, tag] : model_.tags) {
            const double sigma_px_m = bias_px * tag.metres_per_px;
            squares += tag.corner_offsets_m.squaredNorm() / (sigma_px_m * sigma_px_m);
            log_precision -= 16 * std::log(sigma_px_m);
            const double sigma_m = on_plane.contains(id) ? plane_sigma_m : anywhere_m;
            const PlaneDeparture& departure = departures_.at(id);
            squares += departure.heights_m.squaredNorm() / (sigma_m * sigma_m);
            log_precision -= 6 * std::log(sigma_m);
            normal.add_squares(departure.heights_m / sigma_m, departure.jacobian / sigma_m, departure.columns);
        }
        // Scaled to a unit diagonal: the unknowns have different units.
        const Eigen::VectorXd scale = normal.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
        const Eigen::MatrixXd scaled = scale.asDiagonal() * normal.information * scale.asDiagonal();
        const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
        if (factor.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
        const Eigen::VectorXd gradient = scale.cwiseProduct(normal.gradient);
        const double log_determinant =
            2 * factor.matrixLLT().diagonal().array().log().sum() - 2 * scale.array().log().sum();
        return 0.5 * (gradient.dot(factor.solve(gradient)) - squares + log_precision - log_determinant);
    }

private:
    const SharedColumns& columns_;
    const ClipModel& model_;
    SharedNormal known_;
    std::map<int, PlaneDeparture> departures_;
};

struct Choice {
    double bias_px = 0, plane_sigma_m = 0;
    double evidence = -std::numeric_limits<double>::infinity();
};

Choice best_scales(const Evidence& evidence, const std::set<int>& on_plane) {
    // In steps of √2: finer ones change nothing that could be seen. A hundredth of a pixel is what a fit of pixels
    // reaches at best. Sheets bend by no less than the hundredth of a millimetre of a print on glass; over 3 mm they
    // are on no plane.
    Choice best;
    for (double bias_px = 0.01; bias_px < 0.33; bias_px *= std::sqrt(2.0)) {
        for (double sigma_m = 1e-5; sigma_m < 3e-3; sigma_m *= 2) {
            const double value = evidence(bias_px, sigma_m, on_plane);
            if (value > best.evidence) best = {bias_px, sigma_m, value};
            if (on_plane.empty()) break;
        }
    }
    return best;
}

}  // namespace

RigidTransform likely_plane(const ClipModel& model) {
    const ModelTag* best = nullptr;
    int most = 0;
    for (const auto& entry : model.tags) {
        const ModelTag& tag = entry.second;
        const RigidTransform tag_from_world = tag.world_from_tag.inverse();
        // Rough places are good to a degree or two and a part of the tag's size.
        constexpr double alike_cosine = 0.996;
        const auto near = std::ranges::count_if(model.tags, [&](const auto& other) {
            const RigidTransform relative = tag_from_world * other.second.world_from_tag;
            const double distance_m = relative.translation().head<2>().norm();
            return relative.linear()(2, 2) > alike_cosine &&
                   std::abs(relative.translation().z()) < 0.3 * tag.size_m + 0.05 * distance_m;
        });
        if (near > most) {
            most = static_cast<int>(near);
            best = &tag;
        }
    }
    return best ? best->world_from_tag : RigidTransform::Identity();
}

void choose_sheet_evidence(const SharedNormal& frames_say, const SharedColumns& columns, ClipModel& model,
                           ModelFreedom& freedom) {
    if (model.tags.size() < 2) {
        // A lone tag's corners cannot be told from the lens and the path: what is usual is taken, and no plane.
        freedom.corner_bias_px = usual_bias_px;
        freedom.plane_sigma_m.reset();
        return;
    }
    const Evidence evidence(frames_say, columns, model, freedom);
    std::set<int> on_plane;
    if (!columns.places.empty()) {
        // Far ones only confuse the linearised search: 17° or a size above the plane is no bend of a sheet.
        for (const auto& [id, tag] : model.tags) {
            const Eigen::Vector3d heights = plane_departure(model, columns, id).heights_m;
            if (std::abs(heights[0]) < tag.size_m && heights.tail<2>().norm() < 0.15 * tag.size_m) on_plane.insert(id);
        }
    }
    Choice best = best_scales(evidence, on_plane);
    while (on_plane.size() >= 2) {
        int worst = 0;
        Choice better = best;
        for (const int id : on_plane) {
            std::set<int> fewer = on_plane;
            fewer.erase(id);
            const Choice without = best_scales(evidence, fewer);
            if (without.evidence > better.evidence) {
                better = without;
                worst = id;
            }
        }
        if (!(better.evidence > best.evidence)) break;
        on_plane.erase(worst);
        best = better;
    }
    freedom.corner_bias_px = best.bias_px > most_bias_px ? usual_bias_px : best.bias_px;
    freedom.plane_sigma_m.reset();
    for (auto& [id, tag] : model.tags) tag.on_plane = on_plane.size() >= 2 && on_plane.contains(id);
    if (on_plane.size() >= 2) freedom.plane_sigma_m = best.plane_sigma_m;
}

}  // namespace matchlight
