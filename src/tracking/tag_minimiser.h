// Robust non-linear least squares over the pixels of one tag.
#pragma once

#include <optional>
#include <vector>

#include "tracking/tag_image_model.h"

namespace matchlight {

/// The fit's parameters with its normal equations there.
struct TagFitState {
    TagParameters::Vector parameters = TagParameters::Vector::Zero();
    TagParameters::Matrix normal = TagParameters::Matrix::Zero();
    TagParameters::Vector right = TagParameters::Vector::Zero();
    double cost = 0;            // Σ of the biweight's ρ
    double residual_scale = 0;  // robust standard deviation, in light
    double weight_sum = 0;
    double correlation = 0;  // of the visible pixels' light with the model's
};

/// Levenberg–Marquardt with Tukey's biweight. Pixels marked hidden take no part.
class TagMinimiser {
public:
    /// `pixels` may be re-marked between calls, but not added to; each call locates them anew. `cell_px` bounds the
    /// blur.
    TagMinimiser(const TagImageModel& model, std::vector<TagPixel>& pixels, double clipped_light, double cell_px);

    enum class Light { even, planes };

    /// With even light the planes keep the slopes of `start`. nullopt when paper would be no lighter than ink.
    std::optional<TagFitState> minimise(const TagParameters::Vector& start, Light light);

    /// Least squares with a symmetric blur finds the steepest place of an edge; an exposure that accelerates or a lens
    /// with coma has its mean elsewhere, and the mean is where the tag was. So the residual is made orthogonal not to
    /// the model's own derivative but to that of a wider edge, which weighs the whole transition alike (an estimating
    /// equation with instruments; Godambe 1960, An Optimum Property of Regular Maximum Likelihood Estimation). The
    /// wider edge is only the weight: the residual stays that of the fitted blur.
    TagFitState centred_on_mean(TagFitState state) const;

private:
    TagFitState linearized(const TagParameters::Vector& parameters, double cut, Light light);
    TagParameters::Vector instrumented_step(const TagParameters::Vector& parameters, const TagParameters::Vector& wider,
                                            double cut) const;
    bool is_sane(const TagParameters::Vector& parameters) const;

    const TagImageModel& model_;
    std::vector<TagPixel>& pixels_;
    double clipped_;
    double cell_px_;
    // Scratch of linearized.
    std::vector<double> residuals_;
    Eigen::Matrix<double, TagParameters::count, Eigen::Dynamic> gradients_;
};

}  // namespace matchlight
