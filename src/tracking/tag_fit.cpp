// From rough corners to fitted ones.
#include "tracking/tag_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "tracking/tag_image_model.h"
#include "tracking/tag_minimiser.h"
#include "tracking/tag_pixels.h"

namespace matchlight {

namespace {

Eigen::Matrix3d homography_from_corners(const std::array<Eigen::Vector2d, 4>& from,
                                        const std::array<Eigen::Vector2d, 4>& to) {
    Eigen::Matrix<double, 8, 8> system;
    Eigen::Matrix<double, 8, 1> right;
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d& p = from[static_cast<std::size_t>(i)];
        const Eigen::Vector2d& q = to[static_cast<std::size_t>(i)];
        system.row(2 * i) << p.x(), p.y(), 1, 0, 0, 0, -q.x() * p.x(), -q.x() * p.y();
        system.row(2 * i + 1) << 0, 0, 0, p.x(), p.y(), 1, -q.y() * p.x(), -q.y() * p.y();
        right.segment<2>(2 * i) = q;
    }
    const Eigen::Matrix<double, 8, 1> h = system.fullPivLu().solve(right);
    Eigen::Matrix3d homography;
    homography << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], 1;
    return homography;
}

/// The detection corners on the grid, in tag_corners_m's order (the grid's b runs down the sheet).
std::array<Eigen::Vector2d, 4> grid_corners(const TagPattern& tag) {
    const double begin = tag.border_begin, end = tag.border_end;
    return {Eigen::Vector2d(begin, end), {end, end}, {end, begin}, {begin, begin}};
}

using ParameterJacobian = Eigen::Matrix<double, 8, TagParameters::count>;

/// Corners (normalised) and their covariance from the fitted homography: G(x(g); g) stays at the grid's corner, so
/// dx = −(∂G/∂x)⁻¹ (∂G/∂g) dg.
void take_corners(const TagFitState& state, const TagImageModel& model, const TagPattern& tag,
                  TagObservation& observation) {
    const Eigen::Matrix3d local_from_grid = homography_of(state.parameters).inverse();
    ParameterJacobian corner_by_parameter = ParameterJacobian::Zero();
    const auto corners = grid_corners(tag);
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d& grid = corners[static_cast<std::size_t>(i)];
        const Eigen::Vector2d local = (local_from_grid * grid.homogeneous()).hnormalized();
        const TagParameters::Vector& p = state.parameters;
        const double x = local.x(), y = local.y();
        const double w = p[6] * x + p[7] * y + 1;
        Eigen::Matrix2d by_local;
        by_local << p[0] - grid.x() * p[6], p[1] - grid.x() * p[7], p[3] - grid.y() * p[6], p[4] - grid.y() * p[7];
        by_local /= w;
        Eigen::Matrix<double, 2, 8> by_parameter;
        by_parameter << x, y, 1, 0, 0, 0, -grid.x() * x, -grid.x() * y,  //
            0, 0, 0, x, y, 1, -grid.y() * x, -grid.y() * y;
        by_parameter /= w;
        corner_by_parameter.block<2, 8>(2 * i, 0) = -by_local.inverse() * by_parameter * model.local.scale;
        observation.corners_normalized.col(i) = local * model.local.scale + model.local.centre;
    }
    // Neighbouring residuals hang together (coding blocks, the blur's shape): fewer independent ones than pixels.
    constexpr double pixels_per_independent_residual = 4;
    const double variance = state.residual_scale * state.residual_scale * pixels_per_independent_residual;
    TagParameters::Matrix regular = state.normal;
    regular.diagonal().array() += 1e-12 * state.normal.diagonal().maxCoeff();
    const TagParameters::Matrix covariance = regular.ldlt().solve(TagParameters::Matrix::Identity()) * variance;
    observation.covariance = corner_by_parameter * covariance * corner_by_parameter.transpose();
}

/// The blur in the plate from its extents across the sheet's two sets of edges: gᵢᵀ Σ gⱼ is known for the unit
/// gradients g of the grid's two coordinates (normalised coordinates and pixels have the same axes).
Eigen::Matrix2d blur_in_plate(const TagImageModel& model, const TagParameters::Vector& p) {
    const TagImageModel::Place place = model.place(p, 0, 0);
    Eigen::Matrix2d gradients;
    gradients.row(0) = Eigen::RowVector2d(p[0] - place.a * p[6], p[1] - place.a * p[7]).normalized();
    gradients.row(1) = Eigen::RowVector2d(p[3] - place.b * p[6], p[4] - place.b * p[7]).normalized();
    Eigen::Matrix2d across;
    across << std::exp(2 * p[TagParameters::blur]), p[TagParameters::covariance], p[TagParameters::covariance],
        std::exp(2 * p[TagParameters::blur + 1]);
    const Eigen::Matrix2d inverse = gradients.inverse();
    return inverse * across * inverse.transpose();
}

double mean_side(const TagCorners& corners) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += (corners.col(i) - corners.col((i + 1) % 4)).norm();
    return sum / 4;
}

void set_blur(const TagImageModel& model, double blur_px, TagParameters::Vector& parameters) {
    parameters[TagParameters::blur] = parameters[TagParameters::blur + 1] = std::log(blur_px);
    parameters[TagParameters::covariance] = 0.9 * blur_px * blur_px * model.place(parameters, 0, 0).axes_cosine;
}

/// The parameters' start: geometry from the rough corners, the blur that explains the pixels best, even light. Returns
/// the blur in pixels, or nothing where paper is no lighter than ink.
std::optional<double> start_blur_and_light(const TagImageModel& model, const std::vector<TagPixel>& pixels,
                                           double cell_px, TagParameters::Vector& start) {
    FlatLight best;
    double best_blur = 0;
    for (const double blur : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
        if (best_blur > 0 && blur > cell_px) break;
        set_blur(model, blur, start);
        const FlatLight flat = fit_flat_light(model, start, pixels);
        if (best_blur > 0 && flat.squares >= best.squares) continue;
        best = flat;
        best_blur = blur;
    }
    if (!(best.paper > best.ink)) return std::nullopt;
    set_blur(model, best_blur, start);
    start[TagParameters::paper] = best.paper;
    start[TagParameters::ink] = best.ink;
    return best_blur;
}

struct VisibleFitOptions {
    double clipped_light = 1, cell_px = 0;
    bool predicted = false;  // hidden pixels are marked already
};

/// Fits, hides what does not show the tag, and fits again; nullopt when the pixels are not that tag's.
std::optional<TagFitState> fit_visible(const TagImageModel& model, std::vector<TagPixel>& pixels,
                                       const VisibleFitOptions& options, const TagParameters::Vector& start) {
    TagMinimiser minimiser(model, pixels, options.clipped_light, options.cell_px);
    using Light = TagMinimiser::Light;
    const bool any_hidden = std::ranges::any_of(pixels, &TagPixel::hidden);
    std::optional<TagFitState> state = minimiser.minimise(start, any_hidden ? Light::even : Light::planes);
    // A hand over a part of the tag pulls the planes of light to it and hides in their slope: with even light it stands
    // out.
    constexpr double whole_tag_correlation = 0.985;
    if (state && state->correlation < whole_tag_correlation) state = minimiser.minimise(start, Light::even);
    constexpr int most_rounds = 4;
    for (int round = 0; state && round < most_rounds; ++round) {
        const CellCheck check = check_cells(model, state->parameters, state->residual_scale, pixels);
        // The library corrects two bits of a hundred cells; a decoy that decodes by chance has more of them wrong.
        // Of a tag that is known to be there, half may be hidden, and the cells that the hand's outline crosses.
        // Where it is known to be, a dark hand turns paper to ink, but not ink to paper as a slip by a cell would.
        constexpr double most_inverted = 0.06;
        const double inverted = options.predicted ? 2 * std::min(check.ink_for_paper_share, check.paper_for_ink_share)
                                                  : check.ink_for_paper_share + check.paper_for_ink_share;
        const double most_hidden = options.predicted ? 0.55 : 0.5;
        if (inverted > most_inverted || check.hidden_share > most_hidden) return std::nullopt;
        if (round > 0 && !check.changed) break;
        if (check.changed || state->correlation < whole_tag_correlation) {
            state = minimiser.minimise(state->parameters, Light::planes);
        }
    }
    constexpr double least_correlation = 0.7;  // where cells are too small to be judged one by one
    if (!state || state->correlation < least_correlation) return std::nullopt;
    return minimiser.centred_on_mean(*state);
}

constexpr double library_corner_sigma_px = 0.5;

/// A fit's start: the detection's corners and the homography through them.
struct RoughFit {
    TagImageFit result;
    LocalFrame local;
    Eigen::Matrix3d homography;  // grid from local
};

std::optional<RoughFit> rough_fit(const Camera& camera, const TagPattern& tag, const TagDetection& detection) {
    RoughFit rough;
    TagObservation& observation = rough.result.observation;
    observation.id = detection.id;
    observation.decision_margin = detection.decision_margin;
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d& px = detection.corners_px[static_cast<std::size_t>(i)];
        observation.corners_px.col(i) = px;
        observation.corners_normalized.col(i) = camera.normalized_from_pixel(px);
    }
    if (!observation.corners_normalized.allFinite()) return std::nullopt;
    const double focal_px = std::sqrt(camera.fx * camera.fy);
    observation.covariance = TagCovariance::Identity() * std::pow(library_corner_sigma_px / focal_px, 2);
    rough.local.centre = observation.corners_normalized.rowwise().mean();
    rough.local.scale = mean_side(observation.corners_normalized) / 2;
    rough.local.unit_px = rough.local.scale * focal_px;
    observation.side_px = 2 * rough.local.unit_px;

    std::array<Eigen::Vector2d, 4> local_corners;
    for (int i = 0; i < 4; ++i) {
        local_corners[static_cast<std::size_t>(i)] = rough.local.from_normalized(observation.corners_normalized.col(i));
    }
    rough.homography = homography_from_corners(local_corners, grid_corners(tag));
    if (!rough.homography.allFinite()) return std::nullopt;
    rough.result.grid_from_normalized = rough.homography * rough.local.local_from_normalized();
    const double cells = tag.border_end - tag.border_begin;
    rough.result.cell_px = {observation.side_px / cells, observation.side_px / cells};
    return rough;
}

}  // namespace

std::optional<TagImageFit> detected_corners(const LensGrid& lens, const TagPattern& tag,
                                            const TagDetection& detection) {
    std::optional<RoughFit> rough = rough_fit(lens.camera(), tag, detection);
    if (!rough) return std::nullopt;
    rough->result.observation.blur_px = {1, 1};
    return rough->result;
}

std::optional<TagImageFit> fit_tag(const FitSource& source, const TagPattern& tag, const TagDetection& detection,
                                   const TagFitOptions& options) {
    const Camera& camera = source.lens.camera();
    std::optional<RoughFit> rough = rough_fit(camera, tag, detection);
    if (!rough) return std::nullopt;
    TagImageFit& result = rough->result;
    TagObservation& observation = result.observation;
    const double focal_px = std::sqrt(camera.fx * camera.fy);
    const BlurredPattern pattern(tag);
    const TagImageModel model{pattern, rough->local};
    TagParameters::Vector start = TagParameters::Vector::Zero();
    const Eigen::Matrix3d& h = rough->homography;
    start.head<8>() << h(0, 0), h(0, 1), h(0, 2), h(1, 0), h(1, 1), h(1, 2), h(2, 0), h(2, 1);
    const TagImageModel::Place centre = model.place(start, 0, 0);
    result.cell_px = {1 / centre.cells_per_px_a, 1 / centre.cells_per_px_b};
    const double cell_px = std::sqrt(result.cell_px[0] * result.cell_px[1]);

    // How blurred it is decides which pixels tell where the edges are.
    constexpr std::size_t first_pixels = 800;
    std::vector<TagPixel> pixels = gather_pixels(source, model, start, {cell_px, first_pixels});
    constexpr std::size_t fewest_pixels = 4 * TagParameters::count;
    if (pixels.size() < fewest_pixels) return std::nullopt;
    const bool predicted = options.start_error_px > 0;
    if (predicted) {
        set_blur(model, 1 + 0.5 * std::min(options.start_error_px, 0.2 * cell_px), start);
        hide_by_vote(model, start, pixels);
    }
    const std::optional<double> blur_px = start_blur_and_light(model, pixels, cell_px, start);
    if (!blur_px) return std::nullopt;
    pixels = gather_pixels(source, model, start, {4 + 4 * *blur_px, options.most_pixels});
    if (predicted) hide_by_vote(model, start, pixels);

    const std::optional<TagFitState> state =
        fit_visible(model, pixels, {source.clipped_light, cell_px, predicted}, start);
    if (!state) return std::nullopt;
    observation.correlation = state->correlation;
    observation.contrast = contrast_of(state->parameters);
    observation.blur_px = {std::exp(state->parameters[TagParameters::blur]),
                           std::exp(state->parameters[TagParameters::blur + 1])};

    observation.blur_covariance_px2 = blur_in_plate(model, state->parameters);
    if (options.edge_blur) {
        observation.edge_blur = measure_edge_blur(model, *state, pixels, source.clipped_light, camera);
    }

    TagObservation refined = observation;
    take_corners(*state, model, tag, refined);
    const double moved_px =
        (refined.corners_normalized - observation.corners_normalized).colwise().norm().maxCoeff() * focal_px;
    // The library's corners are within a pixel or two where the tag is sharp, within the blur where it is not.
    const double believable_px = std::max({2.0, 0.5 * cell_px, 2 * *blur_px, options.start_error_px});
    if (refined.corners_normalized.allFinite() && refined.covariance.allFinite() && moved_px < believable_px) {
        observation = refined;
        observation.refined = true;
        for (int i = 0; i < 4; ++i) {
            observation.corners_px.col(i) = camera.pixel_from_normalized(observation.corners_normalized.col(i));
        }
        result.grid_from_normalized = homography_of(state->parameters) * model.local.local_from_normalized();
    }
    return result;
}

}  // namespace matchlight
