// Levenberg–Marquardt over the pixels of one tag.
#include "tracking/tag_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace matchlight {

namespace {

// Parameters: the eight free entries of grid_from_local, log blur (px) along a and b, light of paper and of ink as
// planes over the local coordinates.
constexpr int parameter_count = 16;
constexpr int blur_at = 8, paper_at = 10, ink_at = 13;
using Parameters = Eigen::Matrix<double, parameter_count, 1>;
using Normal = Eigen::Matrix<double, parameter_count, parameter_count>;

/// A pixel in local coordinates: normalised ones moved to the tag's centre and scaled to its half side, so that the
/// normal equations are well conditioned.
struct TagPixel {
    double x = 0, y = 0;
    double light = 0;
};

struct LocalFrame {
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // normalised
    double scale = 1;                                  // normalised length of one local unit
    double unit_px = 1;                                // pixels of one local unit

    Eigen::Vector2d from_normalized(const Eigen::Vector2d& point) const { return (point - centre) / scale; }
    Eigen::Matrix3d local_from_normalized() const {
        Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
        matrix.topLeftCorner<2, 2>() /= scale;
        matrix.topRightCorner<2, 1>() = -centre / scale;
        return matrix;
    }
};

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

Eigen::Matrix3d homography_of(const Parameters& p) {
    Eigen::Matrix3d homography;
    homography << p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7], 1;
    return homography;
}

/// Model light at one pixel and its derivatives by all parameters. False where the pixel lies behind the tag's
/// horizon.
struct PixelModel {
    double light = 0;
    double paper = 0;  // share
    Parameters gradient;
};

struct TagModel {
    const BlurredPattern& pattern;
    LocalFrame local;

    /// Where on the grid, and how many cells a pixel spans there.
    struct Place {
        double a = 0, b = 0, w = 1;
        double cells_per_px_a = 0, cells_per_px_b = 0;
    };

    Place place(const Parameters& p, double x, double y) const {
        Place place;
        place.w = p[6] * x + p[7] * y + 1;
        place.a = (p[0] * x + p[1] * y + p[2]) / place.w;
        place.b = (p[3] * x + p[4] * y + p[5]) / place.w;
        const double scale = 1 / (place.w * local.unit_px);
        place.cells_per_px_a = std::hypot(p[0] - place.a * p[6], p[1] - place.a * p[7]) * std::abs(scale);
        place.cells_per_px_b = std::hypot(p[3] - place.b * p[6], p[4] - place.b * p[7]) * std::abs(scale);
        return place;
    }

    bool evaluate(const Parameters& p, const TagPixel& pixel, PixelModel& model) const {
        const double x = pixel.x, y = pixel.y;
        const Place at = place(p, x, y);
        // Far outside the grid the homography may swing through infinity.
        if (!(at.w > 0.05) || !(std::abs(at.a) < 100) || !(std::abs(at.b) < 100)) return false;
        const double blur_a = std::exp(p[blur_at]) * at.cells_per_px_a;
        const double blur_b = std::exp(p[blur_at + 1]) * at.cells_per_px_b;
        const PatternSample sample = pattern.at(at.a, at.b, {at.cells_per_px_a, blur_a}, {at.cells_per_px_b, blur_b});
        const double paper_light = p[paper_at] + p[paper_at + 1] * x + p[paper_at + 2] * y;
        const double ink_light = p[ink_at] + p[ink_at + 1] * x + p[ink_at + 2] * y;
        const double contrast = paper_light - ink_light;
        model.paper = sample.paper;
        model.light = ink_light + contrast * sample.paper;
        const double by_a = contrast * sample.by_a / at.w;
        const double by_b = contrast * sample.by_b / at.w;
        const double by_w = -(by_a * at.a + by_b * at.b);
        model.gradient << by_a * x, by_a * y, by_a, by_b * x, by_b * y, by_b, by_w * x, by_w * y,
            contrast * sample.by_blur_a * blur_a, contrast * sample.by_blur_b * blur_b, sample.paper, sample.paper * x,
            sample.paper * y, 1 - sample.paper, (1 - sample.paper) * x, (1 - sample.paper) * y;
        return true;
    }
};

/// Paper and ink that fit best for given geometry, flat over the tag, and what remains.
struct FlatLight {
    double paper = 0, ink = 0, squares = 0;
};

FlatLight fit_flat_light(const TagModel& model, const Parameters& p, const std::vector<TagPixel>& pixels,
                         std::size_t stride) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    double total = 0;
    PixelModel at;
    for (std::size_t i = 0; i < pixels.size(); i += stride) {
        if (!model.evaluate(p, pixels[i], at)) continue;
        const Eigen::Vector2d shares(at.paper, 1 - at.paper);
        normal += shares * shares.transpose();
        right += shares * pixels[i].light;
        total += pixels[i].light * pixels[i].light;
    }
    normal.diagonal().array() += 1e-9;
    const Eigen::Vector2d light = normal.ldlt().solve(right);
    return {light[0], light[1], total - light.dot(right)};
}

/// Pixels on tag cells whose neighbourhood is known: all of them near edges, every sixteenth elsewhere.
std::vector<TagPixel> gather_pixels(const ImageF& light, const LensGrid& lens, const TagModel& model,
                                    const Parameters& start, double band_px) {
    Region box = region_of_grid(homography_of(start) * model.local.local_from_normalized(), model.pattern.cells(),
                                lens.camera());
    box = box.grown(2).intersected(light.bounds());
    std::vector<TagPixel> pixels;
    for (int y = box.y; y < box.y + box.height; ++y) {
        for (int x = box.x; x < box.x + box.width; ++x) {
            const Eigen::Vector2d local = model.local.from_normalized(lens.normalized_from_pixel(x, y));
            if (!local.allFinite()) continue;
            const TagModel::Place at = model.place(start, local.x(), local.y());
            if (!(at.w > 0.05) || !model.pattern.is_known(at.a, at.b)) continue;
            const double px_per_cell = 1 / std::max(at.cells_per_px_a, at.cells_per_px_b);
            const bool near_edge = model.pattern.distance_to_edge(at.a, at.b) * px_per_cell < band_px;
            if (!near_edge && (x & 3 || y & 3)) continue;
            pixels.push_back({local.x(), local.y(), light.at(x, y)});
        }
    }
    // A tag that fills a 4K frame has more edge pixels than its corners need.
    constexpr std::size_t most_pixels = 4000;
    if (pixels.size() > most_pixels) {
        const double step = static_cast<double>(pixels.size()) / most_pixels;
        for (std::size_t i = 0; i < most_pixels; ++i) pixels[i] = pixels[static_cast<std::size_t>(double(i) * step)];
        pixels.resize(most_pixels);
    }
    return pixels;
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Tukey's biweight: occluders, glints and hard shadows are many scales away and count nothing.
double biweight(double residual, double cut) {
    const double t = residual / cut;
    return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

struct FitState {
    Parameters parameters = Parameters::Zero();
    Normal normal = Normal::Zero();
    Parameters right = Parameters::Zero();
    double cost = 0;            // Σ of the biweight's ρ
    double residual_scale = 0;  // robust standard deviation
    double weight_sum = 0;
    double correlation = 0;
};

class TagFit {
public:
    TagFit(const TagModel& model, const std::vector<TagPixel>& pixels, double clipped_light)
        : model_(model), pixels_(pixels), clipped_(clipped_light), residuals_(pixels.size()) {}

    /// Residuals at `p`; `cut` is where the biweight ends.
    FitState linearized(const Parameters& p, double cut) {
        FitState state;
        state.parameters = p;
        PixelModel at;
        double sum = 0, squares = 0, unexplained = 0;
        for (std::size_t i = 0; i < pixels_.size(); ++i) {
            residuals_[i] = cut;
            if (!model_.evaluate(p, pixels_[i], at)) {
                state.cost += cut * cut / 6;
                continue;
            }
            // A clipped pixel says no more than that its light is at least that.
            const bool clipped = at.light >= clipped_ && pixels_[i].light >= clipped_;
            const double observed = std::min(pixels_[i].light, clipped_);
            const double residual = clipped ? 0 : observed - at.light;
            residuals_[i] = std::abs(residual);
            const double weight = biweight(residual, cut);
            const double t = std::min(1.0, residual * residual / (cut * cut));
            state.cost += cut * cut / 6 * (1 - (1 - t) * (1 - t) * (1 - t));
            sum += observed, squares += observed * observed, unexplained += residual * residual;
            if (weight == 0 || clipped) continue;
            state.normal.selfadjointView<Eigen::Lower>().rankUpdate(at.gradient, weight);
            state.right += weight * residual * at.gradient;
            state.weight_sum += weight;
        }
        const auto count = static_cast<double>(pixels_.size());
        const double variance = squares - sum * sum / count;
        state.correlation = variance > 0 ? std::sqrt(std::max(0.0, 1 - unexplained / variance)) : 0;
        state.residual_scale = 1.4826 * median_of(residuals_);
        state.normal.triangularView<Eigen::StrictlyUpper>() = state.normal.transpose();
        return state;
    }

    /// One step towards residuals orthogonal to the derivatives of a tag blurred by `log_blur` instead. The blur itself
    /// is held.
    Parameters instrumented_step(const Parameters& p, const Eigen::Vector2d& log_blur, double cut) const {
        Normal system = Normal::Zero();
        Parameters right = Parameters::Zero();
        Parameters wider = p;
        wider.segment<2>(blur_at) = log_blur;
        PixelModel at, instrument;
        for (const TagPixel& pixel : pixels_) {
            if (!model_.evaluate(p, pixel, at) || !model_.evaluate(wider, pixel, instrument)) continue;
            if (at.light >= clipped_ || pixel.light >= clipped_) continue;
            const double residual = pixel.light - at.light;
            const double weight = biweight(residual, cut);
            if (weight == 0) continue;
            system += weight * instrument.gradient * at.gradient.transpose();
            right += weight * residual * instrument.gradient;
        }
        for (int i = blur_at; i < blur_at + 2; ++i) {
            system.row(i).setZero();
            system.col(i).setZero();
            system(i, i) = 1;
            right[i] = 0;
        }
        return system.partialPivLu().solve(right);
    }

private:
    const TagModel& model_;
    const std::vector<TagPixel>& pixels_;
    double clipped_;
    std::vector<double> residuals_;
};

double contrast_of(const Parameters& p) {
    return p[paper_at] - p[ink_at];
}

bool is_sane(const Parameters& p, double largest_blur_px) {
    return p.allFinite() && p[blur_at] > std::log(0.01) && p[blur_at + 1] > std::log(0.01) &&
           p[blur_at] < std::log(largest_blur_px) && p[blur_at + 1] < std::log(largest_blur_px);
}

/// Keeps the blur where it can be told from a sharp edge: below a tenth of a pixel the box of the pixel hides it.
void hold_blur(Parameters& p) {
    for (int axis = 0; axis < 2; ++axis) p[blur_at + axis] = std::max(p[blur_at + axis], std::log(0.05));
}

/// Least squares with a symmetric blur finds the steepest place of an edge; an exposure that accelerates or a lens with
/// coma has its mean elsewhere, and the mean is where the tag was. So the residual is made orthogonal not to the
/// model's own derivative but to that of a wider edge, which weighs the whole transition alike (an estimating equation
/// with instruments; Godambe 1960). The wider edge is only the weight: the residual stays that of the fitted blur.
FitState centred_on_mean(TagFit& fit, FitState state, double cut, double widest_px) {
    constexpr double least_wider_px = 1.2;  // covers the steps of a short exposure's blur
    Parameters instrument_blur = state.parameters;
    for (int axis = 0; axis < 2; ++axis) {
        const double blur = std::exp(state.parameters[blur_at + axis]);
        instrument_blur[blur_at + axis] =
            std::log(std::max(blur, std::min(std::hypot(blur, 1.5 * blur + least_wider_px), widest_px)));
    }
    for (int iteration = 0; iteration < 3; ++iteration) {
        const Parameters step = fit.instrumented_step(state.parameters, instrument_blur.segment<2>(blur_at), cut);
        if (!step.allFinite()) break;
        state.parameters += step;
    }
    return state;
}

std::optional<FitState> minimise(TagFit& fit, const TagModel& model, Parameters p, double cell_px) {
    const double largest_blur_px = 2 * cell_px;
    // The residual of a good fit is noise and what the blur's shape misses; the cut never falls below the latter.
    const auto cut_for = [](const FitState& state) {
        return std::max(6 * state.residual_scale, 0.6 * std::abs(contrast_of(state.parameters)));
    };
    double cut = std::abs(contrast_of(p));
    FitState state = fit.linearized(p, cut);
    double damping = 1e-3;
    for (int iteration = 0; iteration < 20; ++iteration) {
        const double tighter = cut_for(state);
        if (tighter < 0.95 * cut) {  // costs compare only under one cut
            cut = tighter;
            state = fit.linearized(state.parameters, cut);
        }
        bool lowered = false;
        double moved_px = 0;
        for (int attempt = 0; attempt < 5 && !lowered; ++attempt) {
            Normal damped = state.normal;
            damped.diagonal().array() += damping * state.normal.diagonal().array() + 1e-12 * state.weight_sum;
            Parameters next = state.parameters + damped.ldlt().solve(state.right);
            hold_blur(next);
            if (is_sane(next, largest_blur_px)) {
                const FitState candidate = fit.linearized(next, cut);
                if (candidate.cost < state.cost) {
                    const Parameters step = next - state.parameters;
                    const TagModel::Place centre = model.place(next, 0, 0);
                    moved_px = step.head<8>().cwiseAbs().maxCoeff() / std::max(centre.cells_per_px_a, 1e-9);
                    state = candidate;
                    lowered = true;
                    damping = std::max(damping * 0.1, 1e-9);
                    break;
                }
            }
            damping = std::max(damping * 10, 1e-6);
        }
        if (!lowered || (moved_px < 2e-3 && iteration > 1)) break;
    }
    if (!(contrast_of(state.parameters) > 0)) return std::nullopt;
    return centred_on_mean(fit, state, cut_for(state), 0.35 * cell_px);
}

/// Corners (normalised) and their covariance from the fitted homography: G(x(g); g) stays at the grid's corner, so
/// dx = −(∂G/∂x)⁻¹ (∂G/∂g) dg.
void take_corners(const FitState& state, const TagModel& model, const TagPattern& tag, TagObservation& observation) {
    const Eigen::Matrix3d local_from_grid = homography_of(state.parameters).inverse();
    Eigen::Matrix<double, 8, parameter_count> corner_by_parameter = Eigen::Matrix<double, 8, parameter_count>::Zero();
    const auto corners = grid_corners(tag);
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d& grid = corners[static_cast<std::size_t>(i)];
        const Eigen::Vector2d local = (local_from_grid * grid.homogeneous()).hnormalized();
        const Parameters& p = state.parameters;
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
    Normal regular = state.normal;
    regular.diagonal().array() += 1e-12 * state.normal.diagonal().maxCoeff();
    const Normal covariance = regular.ldlt().solve(Normal::Identity()) * variance;
    observation.covariance = corner_by_parameter * covariance * corner_by_parameter.transpose();
}

double mean_side(const TagCorners& corners) {
    double sum = 0;
    for (int i = 0; i < 4; ++i) sum += (corners.col(i) - corners.col((i + 1) % 4)).norm();
    return sum / 4;
}

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

std::optional<TagImageFit> fit_tag(const ImageF& light, double clipped_light, const LensGrid& lens,
                                   const TagPattern& tag, const TagDetection& detection) {
    const Camera& camera = lens.camera();
    TagImageFit result;
    TagObservation& observation = result.observation;
    observation.id = detection.id;
    observation.decision_margin = detection.decision_margin;
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d& px = detection.corners_px[static_cast<std::size_t>(i)];
        observation.corners_px.col(i) = px;
        observation.corners_normalized.col(i) = camera.normalized_from_pixel(px);
    }
    if (!observation.corners_normalized.allFinite()) return std::nullopt;

    const double focal_px = std::sqrt(camera.fx * camera.fy);
    const BlurredPattern pattern(tag);
    TagModel model{pattern, {}};
    model.local.centre = observation.corners_normalized.rowwise().mean();
    model.local.scale = mean_side(observation.corners_normalized) / 2;
    model.local.unit_px = model.local.scale * focal_px;
    observation.side_px = 2 * model.local.unit_px;

    std::array<Eigen::Vector2d, 4> local_corners;
    for (int i = 0; i < 4; ++i) {
        local_corners[static_cast<std::size_t>(i)] = model.local.from_normalized(observation.corners_normalized.col(i));
    }
    const Eigen::Matrix3d start_homography = homography_from_corners(local_corners, grid_corners(tag));
    Parameters start = Parameters::Zero();
    start.head<8>() << start_homography(0, 0), start_homography(0, 1), start_homography(0, 2), start_homography(1, 0),
        start_homography(1, 1), start_homography(1, 2), start_homography(2, 0), start_homography(2, 1);
    const TagModel::Place centre = model.place(start, 0, 0);
    result.cell_px = {1 / centre.cells_per_px_a, 1 / centre.cells_per_px_b};
    const double cell_px = std::sqrt(result.cell_px[0] * result.cell_px[1]);

    // How blurred it is decides which pixels tell where the edges are.
    std::vector<TagPixel> pixels = gather_pixels(light, lens, model, start, cell_px);
    if (pixels.size() < 4 * parameter_count) return std::nullopt;
    const std::size_t stride = std::max<std::size_t>(1, pixels.size() / 800);
    FlatLight best;
    double best_blur = 0;
    for (const double blur : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
        if (best_blur > 0 && blur > cell_px) break;
        start[blur_at] = start[blur_at + 1] = std::log(blur);
        const FlatLight flat = fit_flat_light(model, start, pixels, stride);
        if (best_blur > 0 && flat.squares >= best.squares) continue;
        best = flat;
        best_blur = blur;
    }
    start[blur_at] = start[blur_at + 1] = std::log(best_blur);
    start[paper_at] = best.paper;
    start[ink_at] = best.ink;
    if (!(best.paper > best.ink)) return std::nullopt;
    pixels = gather_pixels(light, lens, model, start, 4 + 4 * best_blur);

    TagFit fit(model, pixels, clipped_light);
    const std::optional<FitState> state = minimise(fit, model, start, cell_px);
    constexpr double least_correlation = 0.7;  // a decoy that decodes by chance has other ink in many cells
    if (!state || state->correlation < least_correlation) return std::nullopt;
    observation.correlation = state->correlation;
    observation.contrast = contrast_of(state->parameters);
    observation.blur_px = {std::exp(state->parameters[blur_at]), std::exp(state->parameters[blur_at + 1])};

    TagObservation refined = observation;
    take_corners(*state, model, tag, refined);
    const double moved_px =
        (refined.corners_normalized - observation.corners_normalized).colwise().norm().maxCoeff() * focal_px;
    // The library's corners are within a pixel or two where the tag is sharp, within the blur where it is not.
    const double believable_px = std::max({2.0, 0.5 * cell_px, 2 * best_blur});
    if (refined.corners_normalized.allFinite() && refined.covariance.allFinite() && moved_px < believable_px) {
        observation = refined;
        observation.refined = true;
        for (int i = 0; i < 4; ++i) {
            observation.corners_px.col(i) = camera.pixel_from_normalized(observation.corners_normalized.col(i));
        }
        result.grid_from_normalized = homography_of(state->parameters);
    } else {
        constexpr double library_corner_sigma_px = 0.5;
        observation.covariance = TagCovariance::Identity() * std::pow(library_corner_sigma_px / focal_px, 2);
        result.grid_from_normalized = start_homography;
    }
    result.grid_from_normalized = result.grid_from_normalized * model.local.local_from_normalized();
    return result;
}

}  // namespace matchlight
