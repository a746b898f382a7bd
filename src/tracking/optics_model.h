// The blur of a clip's tags as a linear function near an estimate, with its Bayesian solution.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "tracking/focus_prior.h"
#include "tracking/optics_readings.h"

namespace matchlight {

/// What is solved for.
struct OpticsState {
    static constexpr int softness = 0, coc_scale = 1, shutter2 = 2, drift = 3, field = 5;

    /// Of every frame its focus (1/m), then its own blur beside the clip's (xx, yy, xy; px²), then of every reading its
    /// place's deviation from the field (px²).
    Eigen::VectorXd local;
    /// softness px², coc_scale px·m, shutter², drift, then the field of softness, px². The drift is the covariance
    /// (px · frame time) of time in the exposure with place on the pixel: a stabilised sensor moves by itself, and
    /// rendered footage may spread few samples over pixel and time alike. With it blur has a part that is linear in
    /// the motion and changes sign with its direction.
    Eigen::VectorXd shared;
};

/// What the solve learns about its own errors and priors: standard deviations in px², but for the kernel's.
struct OpticsSpread {
    double reading = 0.02;  // readings beyond their own errors
    double frame = 0.02;    // blur from frame to frame: coding, a hand's tremor
    double field = 0.05;    // softness over the plate, smoothly: lenses
    double place = 0.05;    // softness from place to place: patterns of resampling
    /// Blur in proportion to itself: exposures are not quite steady, apertures not quite discs.
    double kernel = 0.05;
    FocusPrior focus;
};

class OpticsModel {
public:
    /// Without `defocus` focus and coc_scale stay as they are and explain nothing.
    OpticsModel(const std::vector<TagBlurReadings>& tags, std::size_t frames, bool defocus);

    std::size_t frames() const { return frames_; }
    /// Starts with an even field.
    OpticsState state(double softness_px2, double coc_scale, double shutter2, const Eigen::VectorXd& focus) const;
    void linearise(const OpticsState& state);
    /// Weighs each tag by its distance under multivariate Student-t errors of `spread`.
    void weigh(const OpticsSpread& spread);

    struct Solution {
        OpticsState change;
        double log_evidence = 0;  // up to a constant that is the same for the same tags
    };
    /// nullopt where the equations have no solution.
    std::optional<Solution> solve(const OpticsSpread& spread);

    struct Sigmas {
        Eigen::VectorXd focus, shared;
    };
    Sigmas sigmas(const OpticsSpread& spread);

private:
    using Index = Eigen::Index;

    /// A reading's share in a column of the field.
    struct FieldPart {
        int column = 0;
        double weight = 0;
    };
    struct LinearTag {
        const TagBlurReadings* tag = nullptr;
        std::vector<std::vector<FieldPart>> field;  // by reading
        std::vector<int> columns;                   // of `shared` that this tag touches
        Index first_place = 0;                      // row in `local` of the first reading's deviation
        Index before = -1;                          // that of the tag's readings when it was last seen, or -1
        std::vector<double> likeness;               // by reading, with the one before: correlation of deviations
        Eigen::MatrixXd by_shared;                  // readings × columns
        Eigen::MatrixXd by_frame;                   // readings × the frame's rows
        Eigen::VectorXd by_place, residual;         // by reading
        Eigen::VectorXd blur_px2;                   // what does not come from softness
        double weight = 1;
        double log_weight = 0;  // what makes the weighted normal density touch Student's
    };
    static constexpr int rows_a_frame = 4;
    using FrameRows = std::array<Index, rows_a_frame>;
    struct System;

    void place_in_field(LinearTag& linear);
    void link_to_before(LinearTag& linear, const LinearTag* before);
    void linearise(LinearTag& linear, const OpticsState& state) const;
    FrameRows rows_of(std::size_t frame) const;
    Eigen::MatrixXd error_covariance(const LinearTag& linear, const OpticsSpread& spread) const;
    Eigen::VectorXd shared_precision(const OpticsSpread& spread) const;
    /// The precision of the prior on `local`, and half its log determinant.
    Eigen::SparseMatrix<double> local_precision(const OpticsSpread& spread, double& half_log_determinant) const;
    std::optional<System> assemble(const OpticsSpread& spread);

    std::size_t frames_;
    bool defocus_;
    std::vector<LinearTag> tags_;
    Index local_rows_ = 0;
    std::map<std::array<int, 2>, int> nodes_;  // first column of each node of the field
    Eigen::VectorXd shared_sigma_;             // priors so wide that they only keep what is unknown from infinity
    std::vector<double> frame_blur_px2_;       // mean of each frame's blur_px2
    OpticsState at_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> local_;  // of the equations last assembled
    bool is_analysed_ = false;
};

}  // namespace matchlight
