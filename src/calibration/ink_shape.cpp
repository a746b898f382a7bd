// Rectangles on a grid of all their edges; the outline runs between covered and uncovered cells of it.
#include "calibration/ink_shape.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace matchlight {
namespace {

/// Edges that are meant to be one differ by rounding, in the order of 1e-13 mm.
constexpr double same_edge_mm = 1e-6;

class EdgeList {
public:
    void add(double at) { at_.push_back(at); }
    void finish() {
        std::ranges::sort(at_);
        const auto same = [](double a, double b) { return b - a < same_edge_mm; };
        at_.erase(std::unique(at_.begin(), at_.end(), same), at_.end());
    }
    int index_of(double at) const {
        return static_cast<int>(std::ranges::lower_bound(at_, at - same_edge_mm) - at_.begin());
    }
    int count() const { return static_cast<int>(at_.size()); }
    double operator[](int index) const { return at_[static_cast<std::size_t>(index)]; }

private:
    std::vector<double> at_;
};

/// Directions in the order of right turns, y down.
constexpr std::array<std::array<int, 2>, 4> steps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

/// Covered cells of the grid; outlines run around them clockwise.
class Cover {
public:
    Cover(int columns, int rows)
        : columns_(columns), rows_(rows), covered_(size_of(columns, rows)), leaving_(size_of(columns + 1, rows + 1)) {}

    void cover(int left, int top, int right, int bottom) {
        for (int y = top; y < bottom; ++y) {
            for (int x = left; x < right; ++x) covered_[index(x, y)] = 1;
        }
    }

    /// Vertices of the grid where each outline turns.
    std::vector<std::vector<std::array<int, 2>>> outlines() {
        find_edges();
        std::vector<std::vector<std::array<int, 2>>> all;
        for (int y = 0; y <= rows_; ++y) {
            for (int x = 0; x <= columns_; ++x) {
                while (leaving_[vertex(x, y)] != 0) all.push_back(walk(x, y));
            }
        }
        return all;
    }

private:
    static std::size_t size_of(int width, int height) {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    std::size_t index(int x, int y) const { return size_of(columns_, y) + static_cast<std::size_t>(x); }
    std::size_t vertex(int x, int y) const { return size_of(columns_ + 1, y) + static_cast<std::size_t>(x); }
    bool is_covered(int x, int y) const {
        return x >= 0 && y >= 0 && x < columns_ && y < rows_ && covered_[index(x, y)] != 0;
    }
    void leave(int x, int y, int direction) {
        leaving_[vertex(x, y)] = static_cast<std::uint8_t>(leaving_[vertex(x, y)] | 1u << direction);
    }

    void find_edges() {
        for (int y = 0; y < rows_; ++y) {
            for (int x = 0; x < columns_; ++x) {
                if (!is_covered(x, y)) continue;
                if (!is_covered(x, y - 1)) leave(x, y, 0);
                if (!is_covered(x + 1, y)) leave(x + 1, y, 1);
                if (!is_covered(x, y + 1)) leave(x + 1, y + 1, 2);
                if (!is_covered(x - 1, y)) leave(x, y + 1, 3);
            }
        }
    }

    /// Around one area. Where two areas touch at a corner the right turn stays with the area it came along.
    std::vector<std::array<int, 2>> walk(int x, int y) {
        std::vector<std::array<int, 2>> turns;
        int direction = -1;
        for (int next = std::countr_zero(leaving_[vertex(x, y)]); next >= 0; next = way_on(x, y, direction)) {
            if (next != direction) turns.push_back({x, y});
            direction = next;
            std::uint8_t& open = leaving_[vertex(x, y)];
            open = static_cast<std::uint8_t>(open & ~(1u << direction));
            x += steps[static_cast<std::size_t>(direction)][0];
            y += steps[static_cast<std::size_t>(direction)][1];
        }
        return turns;
    }
    int way_on(int x, int y, int direction) const {
        for (const int turn : {1, 0, 3}) {
            const int next = (direction + turn) % 4;
            if ((leaving_[vertex(x, y)] >> next & 1) != 0) return next;
        }
        return -1;
    }

    int columns_, rows_;
    std::vector<std::uint8_t> covered_;
    std::vector<std::uint8_t> leaving_;  // bit d: an edge runs from this vertex in direction d
};

}  // namespace

InkShape united(const std::vector<InkRectangle>& rectangles) {
    EdgeList xs, ys;
    for (const InkRectangle& r : rectangles) {
        for (const double x : {r.left, r.right}) xs.add(x);
        for (const double y : {r.top, r.bottom}) ys.add(y);
    }
    xs.finish();
    ys.finish();
    InkShape shape;
    if (xs.count() < 2 || ys.count() < 2) return shape;
    Cover cover(xs.count() - 1, ys.count() - 1);
    for (const InkRectangle& r : rectangles) {
        cover.cover(xs.index_of(r.left), ys.index_of(r.top), xs.index_of(r.right), ys.index_of(r.bottom));
    }
    for (const auto& turns : cover.outlines()) {
        InkOutline& outline = shape.emplace_back();
        for (const auto& [x, y] : turns) outline.emplace_back(xs[x], ys[y]);
    }
    return shape;
}

}  // namespace matchlight
