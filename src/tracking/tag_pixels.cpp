// Gathering and judging pixels.
#include "tracking/tag_pixels.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace matchlight {

namespace {

/// Means of residuals over half cells of the grid.
class HalfCells {
public:
    explicit HalfCells(int cells) : side_(2 * cells), sums_(count()), counts_(count()), hidden_(count()) {}

    void add(double a, double b, double residual) {
        const std::size_t index = index_of(a, b);
        sums_[index] += residual;
        ++counts_[index];
    }
    template <class Visit>
    void visit_means(Visit visit) {
        constexpr int fewest = 3;
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            if (counts_[i] >= fewest) visit(i, sums_[i] / counts_[i], counts_[i]);
        }
    }
    void hide_around(std::size_t index) {
        const int x = static_cast<int>(index) % side_, y = static_cast<int>(index) / side_;
        for (int v = std::max(0, y - 1); v <= std::min(side_ - 1, y + 1); ++v) {
            for (int u = std::max(0, x - 1); u <= std::min(side_ - 1, x + 1); ++u) {
                hidden_[static_cast<std::size_t>(v * side_ + u)] = 1;
            }
        }
    }
    bool is_hidden(double a, double b) const { return hidden_[index_of(a, b)] != 0; }

private:
    std::size_t count() const { return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_); }
    std::size_t index_of(double a, double b) const {
        const int x = std::clamp(static_cast<int>(2 * a), 0, side_ - 1);
        const int y = std::clamp(static_cast<int>(2 * b), 0, side_ - 1);
        return static_cast<std::size_t>(y * side_ + x);
    }

    int side_;
    std::vector<double> sums_;
    std::vector<int> counts_;
    std::vector<char> hidden_;
};

}  // namespace

Region region_of_grid(const Eigen::Matrix3d& grid_from_normalized, int cells, const Camera& camera) {
    const Eigen::Matrix3d normalized_from_grid = grid_from_normalized.inverse();
    constexpr double beyond_any_frame_px = 1e5;
    const double side = cells;
    Region box;
    double sign = 0;
    for (const auto& [a, b] : {std::pair{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}}) {
        const Eigen::Vector3d corner = normalized_from_grid * Eigen::Vector3d(a, b, 1);
        if (sign * corner.z() < 0) return {};
        sign = corner.z();
        const Eigen::Vector2d px = camera.pixel_from_normalized(corner.head<2>() / corner.z());
        if (!px.allFinite() || px.cwiseAbs().maxCoeff() > beyond_any_frame_px) return {};
        box = box.united(Region{static_cast<int>(std::floor(px.x())), static_cast<int>(std::floor(px.y())), 2, 2});
    }
    return box;
}

namespace {

/// Every `step`th pixel of a row (whole numbers or not), rows shifted against each other by the golden ratio so that no
/// edge is met in one phase only.
template <class Visit>
void visit_pixels(const Region& box, double step, Visit visit) {
    for (int y = box.y; y < box.y + box.height; ++y) {
        double shift = 0;
        if (step > 1) shift = step * std::fmod((y - box.y) * (std::numbers::phi - 1), 1.0);
        for (double offset = shift; offset < box.width; offset += step) visit(box.x + static_cast<int>(offset), y);
    }
}

}  // namespace

std::vector<TagPixel> gather_pixels(const FitSource& source, const TagImageModel& model,
                                    const TagParameters::Vector& start, const PixelChoice& choice) {
    Region box = region_of_grid(homography_of(start) * model.local.local_from_normalized(), model.pattern.cells(),
                                source.lens.camera());
    const Region bounds = source.light.bounds().moved(source.x, source.y);
    box = box.grown(2).intersected(bounds);
    const auto gather = [&](double step) {
        std::vector<TagPixel> pixels;
        int even = 0;
        visit_pixels(box, step, [&](int x, int y) {
            const Eigen::Vector2d local = model.local.from_normalized(source.lens.normalized_from_pixel(x, y));
            if (!local.allFinite()) return;
            const TagImageModel::Place at = model.place(start, local.x(), local.y());
            if (!at.in_view || !model.pattern.is_known(at.a, at.b)) return;
            const double px_per_cell = 1 / std::max(at.cells_per_px_a, at.cells_per_px_b);
            const bool near_edge = model.pattern.distance_to_edge(at.a, at.b) * px_per_cell < choice.band_px;
            constexpr int even_step = 16;  // of those that see no edge, enough to tell the light
            if (!near_edge && even++ % even_step != 0) return;
            pixels.push_back({local.x(), local.y(), source.light.at(x - source.x, y - source.y), false,
                              at.cells_per_px_a, at.cells_per_px_b, at.axes_cosine});
        });
        return pixels;
    };
    // A tag that fills a 4K frame has more edge pixels than its corners need: a sparse look tells how many.
    const double area = static_cast<double>(box.width) * box.height;
    const double sparse = std::max(1.0, area / 2000);
    std::vector<TagPixel> pixels = gather(sparse);
    const double step = std::max(1.0, static_cast<double>(pixels.size()) * sparse / static_cast<double>(choice.most));
    if (step < sparse) pixels = gather(step);
    return pixels;
}

FlatLight fit_flat_light(const TagImageModel& model, const TagParameters::Vector& p,
                         const std::vector<TagPixel>& pixels) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double total = 0;
    const TagImage image(model, p);
    PixelModel at;
    for (const TagPixel& pixel : pixels) {
        if (!image.at(pixel, at)) continue;
        const Eigen::Vector2d shares(at.paper, 1 - at.paper);
        normal += shares * shares.transpose();
        right += shares * pixel.light;
        total += pixel.light * pixel.light;
    }
    normal.diagonal().array() += 1e-9;
    const Eigen::Vector2d light = normal.ldlt().solve(right);
    return {light[0], light[1], total - light.dot(right)};
}

CellCheck check_cells(const TagImageModel& model, const TagParameters::Vector& parameters, double residual_scale,
                      std::vector<TagPixel>& pixels) {
    HalfCells halves(model.pattern.cells());
    const TagImage image(model, parameters);
    PixelModel at;
    for (const TagPixel& pixel : pixels) {
        if (!image.at(pixel, at)) continue;
        constexpr double nearly = 0.03;  // of all paper or all ink
        if (at.paper > nearly && at.paper < 1 - nearly) continue;
        const TagImageModel::Place place = model.place(parameters, pixel.x, pixel.y);
        halves.add(place.a, place.b, pixel.light - at.light);
    }
    const double contrast = contrast_of(parameters);
    CellCheck check;
    int judged = 0, hidden = 0, inverted = 0;
    halves.visit_means([&](std::size_t index, double mean, int pixel_count) {
        // Uneven light and ink stay below an eighth of the contrast; noise below four standard deviations of the mean.
        const double most = std::max(0.125 * contrast, 4 * residual_scale / std::sqrt(pixel_count));
        ++judged;
        if (std::abs(mean) > 0.7 * contrast) ++inverted;
        if (std::abs(mean) <= most) return;
        ++hidden;
        halves.hide_around(index);
    });
    if (judged > 0) {
        check.hidden_share = static_cast<double>(hidden) / judged;
        check.inverted_share = static_cast<double>(inverted) / judged;
    }
    for (TagPixel& pixel : pixels) {
        const TagImageModel::Place place = model.place(parameters, pixel.x, pixel.y);
        const bool now = place.in_view && halves.is_hidden(place.a, place.b);
        check.changed = check.changed || now != pixel.hidden;
        pixel.hidden = now;
    }
    return check;
}

}  // namespace matchlight
