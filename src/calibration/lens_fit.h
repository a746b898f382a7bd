// Bundle adjustment of a lens, the board's shape and the board's place in every view.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/board.h"
#include "calibration/board_detector.h"
#include "calibration/camera.h"
#include "calibration/lens_projection.h"

namespace matchlight {

/// A picture of the board, as the adjustment sees it.
struct LensView {
    std::string name;         // "left01.jpg", "frame 12"
    std::int64_t number = 0;  // of the photograph or frame, from 0
    std::vector<BoardCorner> corners;
};

/// What all views share.
struct LensData {
    BoardSpec board;
    int width = 0, height = 0;  // of the pictures
    std::vector<LensView> views;
};

/// A model that may describe the lens: how many radial terms, and whether the board is taken to be flat.
struct LensCandidate {
    LensModel lens = LensModel::radtan;
    int radial_terms = 2;     // of radtan, 2 to 6; a fisheye lens has four
    bool bent_board = false;  // the board is bent along its sides and twisted: three numbers

    /// "radtan3", "fisheye"; "radtan3, bent board".
    std::string name() const;
    std::string lens_name() const;
    /// Free numbers that all views share.
    int parameter_count() const;
    /// Whether a number of LensParameters is estimated.
    bool estimates(int parameter) const;
    bool operator==(const LensCandidate&) const = default;
};

/// Angle-axis and translation (m) of the board's frame in the camera's.
using BoardPose = std::array<double, 6>;

struct LensFit {
    LensCandidate candidate;
    LensParameters lens{};
    std::array<double, 3> bend_m{};  // height of the middle over the ends, along x and y; height of a corner by twist
    std::vector<BoardPose> poses;    // one a view
    double rms_px = 0;               // of the distance between corner and projection, as OpenCV counts it
    bool converged = false;
};

/// A fit made without a guess, and the views it could place the board in.
struct LensStart {
    LensFit fit;
    std::vector<char> posed;  // one a view; the pose of any other is meaningless
};

/// The lens as the rest of the program has it.
Camera camera_of(const LensCandidate& candidate, const LensParameters& lens, int width, int height);

/// Corners of view `view` minus their projections, pixels.
std::vector<Eigen::Vector2d> residuals_of(const LensData& data, const LensFit& fit, std::size_t view);

/// A first fit without any guess: several focal lengths are tried. Throws InputError when no focal length gives a fit.
LensStart start_fit(const LensData& data, const LensCandidate& candidate);

struct AdjustOptions {
    double robust_px = 0;      // scale of a Cauchy loss; 0 for plain least squares
    std::vector<char> in_use;  // one a view; empty for all
};
/// Improves everything together from where `fit` stands.
void adjust(const LensData& data, LensFit& fit, const AdjustOptions& options = {});
/// Improves the pose of one view alone, by least squares.
void adjust_pose(const LensData& data, LensFit& fit, std::size_t view);

/// The lens and bend of another candidate's fit as a start for `candidate`, poses kept.
LensFit started_from(const LensFit& fit, const LensCandidate& candidate);

/// Normal matrix of the shared parameters (those the candidate estimates, in order, then the bend), with all poses
/// eliminated; per square pixel of a corner coordinate.
Eigen::MatrixXd shared_information(const LensData& data, const LensFit& fit);

}  // namespace matchlight
