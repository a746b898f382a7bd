// Gathering and judging pixels.
#include "tracking/tag_pixels.h"

#include <algorithm>
#include <cmath>
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
        if (pixel.hidden || !image.at(pixel, at)) continue;
        const Eigen::Vector2d shares(at.paper, 1 - at.paper);
        normal += shares * shares.transpose();
        right += shares * pixel.light;
        total += pixel.light * pixel.light;
    }
    normal.diagonal().array() += 1e-9;
    const Eigen::Vector2d light = normal.ldlt().solve(right);
    return {light[0], light[1], total - light.dot(right)};
}

namespace {

/// Adds to `halves` what the even parts of cells show, by `value` of a pixel and the model there.
template <class Value>
void add_even_parts(const TagImageModel& model, const TagParameters::Vector& parameters,
                    const std::vector<TagPixel>& pixels, HalfCells& halves, Value value) {
    const TagImage image(model, parameters);
    PixelModel at;
    for (const TagPixel& pixel : pixels) {
        if (!image.at(pixel, at)) continue;
        constexpr double nearly = 0.03;  // of all paper or all ink
        if (at.paper > nearly && at.paper < 1 - nearly) continue;
        const TagImageModel::Place place = model.place(parameters, pixel.x, pixel.y);
        halves.add(place.a, place.b, value(pixel, at));
    }
}

/// Takes the marks of the half cells over to the pixels; true where one changes.
bool mark_hidden(const TagImageModel& model, const TagParameters::Vector& parameters, const HalfCells& halves,
                 std::vector<TagPixel>& pixels) {
    bool changed = false;
    for (TagPixel& pixel : pixels) {
        const TagImageModel::Place place = model.place(parameters, pixel.x, pixel.y);
        const bool now = place.in_view && halves.is_hidden(place.a, place.b);
        changed = changed || now != pixel.hidden;
        pixel.hidden = now;
    }
    return changed;
}

}  // namespace

void hide_by_vote(const TagImageModel& model, const TagParameters::Vector& parameters, std::vector<TagPixel>& pixels) {
    HalfCells light(model.pattern.cells()), paper(model.pattern.cells());
    add_even_parts(model, parameters, pixels, light,
                   [](const TagPixel& pixel, const PixelModel&) { return pixel.light; });
    add_even_parts(model, parameters, pixels, paper, [](const TagPixel&, const PixelModel& at) { return at.paper; });
    struct Half {
        std::size_t index = 0;
        double light = 0;
        bool paper = false;
    };
    std::vector<Half> halves;
    light.visit_means([&](std::size_t index, double mean, int) { halves.push_back({index, mean, false}); });
    std::size_t next = 0;
    paper.visit_means([&](std::size_t, double mean, int) { halves[next++].paper = mean > 0.5; });

    // Every pair of a cell that should be paper and one that should be ink proposes its light for all of them.
    constexpr double near = 0.15;  // of the contrast: uneven light stays below
    const auto agrees = [&](const Half& half, double white, double black) {
        return std::abs(half.light - (half.paper ? white : black)) < near * (white - black);
    };
    std::ptrdiff_t most = 0;
    double best_white = 0, best_black = 0;
    constexpr std::size_t enough_proposals = 40;  // of each kind, evenly taken: half of them see the tag
    const std::size_t stride = std::max<std::size_t>(1, halves.size() / (2 * enough_proposals));
    for (std::size_t i = 0; i < halves.size(); i += stride) {
        if (!halves[i].paper) continue;
        for (std::size_t j = 0; j < halves.size(); j += stride) {
            const double white = halves[i].light, black = halves[j].light;
            if (halves[j].paper || !(white > black)) continue;
            const std::ptrdiff_t votes =
                std::ranges::count_if(halves, [&](const Half& half) { return agrees(half, white, black); });
            if (votes <= most) continue;
            most = votes;
            best_white = white;
            best_black = black;
        }
    }
    if (most == 0) return;
    for (const Half& half : halves) {
        if (!agrees(half, best_white, best_black)) light.hide_around(half.index);
    }
    mark_hidden(model, parameters, light, pixels);
}

CellCheck check_cells(const TagImageModel& model, const TagParameters::Vector& parameters, double residual_scale,
                      std::vector<TagPixel>& pixels) {
    HalfCells halves(model.pattern.cells());
    add_even_parts(model, parameters, pixels, halves,
                   [](const TagPixel& pixel, const PixelModel& at) { return pixel.light - at.light; });
    const double contrast = contrast_of(parameters);
    CellCheck check;
    int judged = 0, hidden = 0, ink_for_paper = 0, paper_for_ink = 0;
    halves.visit_means([&](std::size_t index, double mean, int pixel_count) {
        // Uneven light and ink stay below an eighth of the contrast; noise below four standard deviations of the mean.
        const double most = std::max(0.125 * contrast, 4 * residual_scale / std::sqrt(pixel_count));
        ++judged;
        ink_for_paper += mean < -0.7 * contrast;
        paper_for_ink += mean > 0.7 * contrast;
        if (std::abs(mean) <= most) return;
        ++hidden;
        halves.hide_around(index);
    });
    if (judged > 0) {
        check.hidden_share = static_cast<double>(hidden) / judged;
        check.ink_for_paper_share = static_cast<double>(ink_for_paper) / judged;
        check.paper_for_ink_share = static_cast<double>(paper_for_ink) / judged;
    }
    check.changed = mark_hidden(model, parameters, halves, pixels);
    return check;
}

}  // namespace matchlight
