// The pentadiagonal precision of a smooth sequence.
#include "tracking/focus_prior.h"

#include <vector>

namespace matchlight {

Eigen::SparseMatrix<double> FocusPrior::precision(std::size_t frames) const {
    const auto count = static_cast<int>(frames);
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int first, std::initializer_list<double> weights, double sigma) {
        int i = first;
        for (const double a : weights) {
            int j = first;
            for (const double b : weights) entries.emplace_back(i, j++, a * b / (sigma * sigma));
            ++i;
        }
    };
    for (int t = 0; t < count; ++t) add(t, {1}, spread);
    for (int t = 0; t + 1 < count; ++t) add(t, {-1, 1}, step);
    for (int t = 0; t + 2 < count; ++t) add(t, {1, -2, 1}, bend);
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

}  // namespace matchlight
