// Front to back over the parts that the cards' edges cut a pixel into.
#include "report/thin_lens_reference.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "render/effects/bokeh.h"

namespace matchlight {

namespace {

/// From one edge of a pixel to the other, with the cards' edges between them in order.
std::vector<double> cuts_of(double pixel, const std::vector<std::array<double, 2>>& edges_px) {
    std::vector<double> cuts{pixel - 0.5, pixel + 0.5};
    for (const auto& ends : edges_px) {
        for (const double edge : ends) {
            if (edge > pixel - 0.5 && edge < pixel + 0.5) cuts.push_back(edge);
        }
    }
    std::ranges::sort(cuts);
    return cuts;
}

bool holds(const std::array<double, 2>& ends, double at) {
    return ends[0] < at && at < ends[1];
}

/// Cards as one point of the lens sees them, the nearest first.
struct SeenCards {
    std::vector<std::array<double, 2>> columns_px, rows_px;
    std::vector<Eigen::Vector4d> light;

    Eigen::Vector4d over_part(double x, double y) const {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (std::size_t i = 0; i < light.size(); ++i) {
            if (holds(columns_px[i], x) && holds(rows_px[i], y)) sum += (1 - sum[3]) * light[i];
        }
        return sum;
    }
    Eigen::Vector4d over_pixel(const std::vector<double>& columns, const std::vector<double>& rows) const {
        Eigen::Vector4d sum = Eigen::Vector4d::Zero();
        for (std::size_t row = 1; row < rows.size(); ++row) {
            for (std::size_t column = 1; column < columns.size(); ++column) {
                const double area = (columns[column] - columns[column - 1]) * (rows[row] - rows[row - 1]);
                sum += area * over_part((columns[column] + columns[column - 1]) / 2, (rows[row] + rows[row - 1]) / 2);
            }
        }
        return sum;
    }
};

std::vector<Eigen::Vector2d> opening_points(const BokehSettings& bokeh, int steps) {
    std::vector<Eigen::Vector2d> points;
    for (int y = 0; y < steps; ++y) {
        for (int x = 0; x < steps; ++x) {
            const Eigen::Vector2d point((2 * x + 1.0) / steps - 1, (2 * y + 1.0) / steps - 1);
            if (bokeh_distance(bokeh, point) <= 1) points.push_back(point);
        }
    }
    return points;
}

}  // namespace

ImageD thin_lens_light(const ThinLensView& view) {
    assert(view.lens_steps > 0);
    std::vector<LensCard> cards = view.cards;
    std::ranges::stable_sort(cards, {}, &LensCard::depth_m);
    std::vector<SeenCards> seen;
    for (const Eigen::Vector2d& point : opening_points(view.bokeh, view.lens_steps)) {
        SeenCards& from_point = seen.emplace_back();
        for (const LensCard& card : cards) {
            const Eigen::Vector2d shift = signed_coc_px(view.focus, card.depth_m) / 2 * point;
            from_point.columns_px.push_back({card.left_px + shift.x(), card.right_px + shift.x()});
            from_point.rows_px.push_back({card.top_px + shift.y(), card.bottom_px + shift.y()});
            from_point.light.push_back(card.light);
        }
    }
    ImageD picture(view.width, view.height, 4);
    parallel_for(view.height, [&](int y) {
        std::vector<Eigen::Vector4d> sums(static_cast<std::size_t>(view.width), Eigen::Vector4d::Zero());
        for (const SeenCards& from_point : seen) {
            const std::vector<double> rows = cuts_of(y, from_point.rows_px);
            for (int x = 0; x < view.width; ++x) {
                sums[static_cast<std::size_t>(x)] += from_point.over_pixel(cuts_of(x, from_point.columns_px), rows);
            }
        }
        for (int x = 0; x < view.width; ++x) {
            const Eigen::Vector4d mean = sums[static_cast<std::size_t>(x)] / static_cast<double>(seen.size());
            std::copy_n(mean.data(), 4, picture.pixel(x, y));
        }
    });
    return picture;
}

SpreadPixel spread_pixel(double coc_px) {
    const int reach_px = static_cast<int>(std::ceil(coc_px / 2)) + 1;
    const int size = 2 * reach_px + 1;
    const ImageD light = thin_lens_light({.width = size,
                                          .height = size,
                                          .focus = {.coc_scale_px_m = coc_px},
                                          .bokeh = {},
                                          .cards = {{.left_px = reach_px - 0.5,
                                                     .top_px = reach_px - 0.5,
                                                     .right_px = reach_px + 0.5,
                                                     .bottom_px = reach_px + 0.5,
                                                     .depth_m = 1}},
                                          .lens_steps = 256});
    return {1 - light.at(reach_px, reach_px), light.at(reach_px + 1, reach_px)};
}

double disc_share_before(double edge) {
    const double cosine = std::clamp(2 * edge, -1.0, 1.0);
    return 1 - (std::acos(cosine) - cosine * std::sqrt(1 - cosine * cosine)) / std::numbers::pi;
}

}  // namespace matchlight
