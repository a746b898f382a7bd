// How much solid angle the pixels of one layout share with those of another.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/parallel.h"
#include "lighting/mappings.h"

namespace matchlight {

/// A source pixel's share in a target pixel.
struct PixelOverlap {
    std::uint32_t source;
    float solid_angle;
};

/// The matrix of solid angles that target pixels share with source pixels.
class PixelOverlaps {
public:
    /// `points_a_side`: of the lattice in a pixel of the finer image, at least.
    PixelOverlaps(const ProbeLayout& from, const ProbeLayout& to, int points_a_side);

    /// Whether it is small enough to be kept; otherwise every pass over it makes it anew.
    bool kept() const { return kept_; }
    const ProbeLayout& from() const { return from_; }
    const std::vector<double>& from_solid_angles() const { return from_solid_angles_; }

    /// Calls body(band, target, overlaps) for every target pixel; calls of one band come in order, on one thread.
    template <class Body>
    void for_each_pixel(const Body& body) const {
        parallel_for(bands_, [&](int band) {
            for (int y = first_row(band); y < first_row(band + 1); ++y) {
                Row made;
                if (!kept_) {
                    made = make_row(y);
                    add_missed(y, made);
                }
                const Row& row = kept_ ? rows_[static_cast<std::size_t>(y)] : made;
                for (int x = 0; x < to_.width; ++x) {
                    const std::size_t first = row.first[static_cast<std::size_t>(x)];
                    const std::size_t last = row.first[static_cast<std::size_t>(x) + 1];
                    body(band, index_in(to_, x, y), std::span(row.entries).subspan(first, last - first));
                }
            }
        });
    }

    /// What every source pixel hands out in all with these gains, when every target pixel is scaled to receive its own
    /// solid angle.
    std::vector<float> handed_out(const std::vector<float>& source_gain) const;
    /// How handed_out() changes with the logarithms of the gains, in this direction.
    std::vector<float> change_handed_out(const std::vector<float>& source_gain,
                                         const std::vector<float>& direction) const;
    /// The matrix of change_handed_out() between groups of source pixels.
    Eigen::MatrixXd change_between_groups(const std::vector<float>& source_gain,
                                          const std::vector<std::uint16_t>& group_of, int groups) const;

private:
    struct Row {
        std::vector<std::size_t> first;  // per target pixel, one more at the end
        std::vector<PixelOverlap> entries;
    };
    /// A share that the lattice of points missed.
    struct Missed {
        std::uint32_t target;
        PixelOverlap overlap;
    };

    static std::uint32_t index_in(const ProbeLayout& layout, int x, int y) {
        return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(layout.width) + static_cast<std::uint32_t>(x);
    }
    int first_row(int band) const { return static_cast<int>(static_cast<std::int64_t>(to_.height) * band / bands_); }

    template <class Add>
    std::vector<float> sums_of_sources(const Add& add) const;
    bool is_read(int x, int y) const;
    Row make_row(int y) const;
    Eigen::Vector2d lattice_point(int x, int y, int i, int j) const;
    void add_points(int x, int y, std::size_t first, std::vector<PixelOverlap>& entries) const;
    void add_points_beyond(int x, int y, std::size_t first, std::vector<PixelOverlap>& entries) const;
    void add_point(const Eigen::Vector2d& point, std::size_t first, std::vector<PixelOverlap>& entries) const;
    void scatter_missed();
    void add_missed(int y, Row& row) const;

    ProbeLayout from_, to_;
    std::vector<double> from_solid_angles_, to_solid_angles_;
    int points_ = 4;
    int bands_ = 1;
    bool kept_ = false;
    std::vector<Row> rows_;
    std::vector<Missed> missed_;             // by target
    std::vector<std::size_t> first_missed_;  // of every row of the target, one more at the end
};

}  // namespace matchlight
