// How focus may change from frame to frame.
#pragma once

#include <cstddef>

#include <Eigen/SparseCore>

namespace matchlight {

/// Normal priors on a sequence's values, its first and its second differences, as standard deviations.
struct FocusPrior {
    double mean = 0, spread = 1;
    double step = 1;  // a frame
    double bend = 1;  // a frame²

    /// Of all three together.
    Eigen::SparseMatrix<double> precision(std::size_t frames) const;
};

}  // namespace matchlight
