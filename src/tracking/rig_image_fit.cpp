// Levenberg–Marquardt over the pixels of all tags; the light of each tag is eliminated by its Schur complement.
#include "tracking/rig_image_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

#include "core/median.h"
#include "tracking/rig_image_search.h"

namespace matchlight {

namespace {

constexpr int shared_count = 13;  // pose, motion, log blur
constexpr int light_count = 4;    // paper, ink, and the slopes of both across the sheet
constexpr int sheet_count = shared_count + light_count;

using SharedVector = Eigen::Matrix<double, shared_count, 1>;
using SharedMatrix = Eigen::Matrix<double, shared_count, shared_count>;
using SheetVector = Eigen::Matrix<double, sheet_count, 1>;
using SheetBend = Eigen::Matrix<double, sheet_count, 6>;
using SheetMatrix = Eigen::Matrix<double, sheet_count, sheet_count>;

/// A sheet's light at a point: (ink + (paper − ink)·share)·(1 + slope · place on the sheet).
struct SheetLight {
    double paper = 0, ink = 0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
};

struct SheetPixels {
    const PlacedSheet* sheet = nullptr;
    std::vector<SheetPixel> pixels;
    double spread = 0;  // twice the standard deviation of their light: about the contrast
};

struct Unknowns {
    MovingCamera camera;
    std::vector<SheetLight> light;  // parallel to the sheets' pixels
};

struct SheetNormal {
    SheetMatrix normal = SheetMatrix::Zero();
    SheetVector right = SheetVector::Zero();
    SheetBend bend = SheetBend::Zero();    // Σ gradient · derivative by the bend
    double unexplained = 0, variance = 0;  // sums, residuals cut off
};

struct Linearized {
    std::vector<SheetNormal> sheets;
    double cost = 0, residual_scale = 0;
    double unexplained = 0, variance = 0;

    double unexplained_share() const { return variance > 0 ? unexplained / variance : 1; }
};

class RigMinimiser {
public:
    RigMinimiser(const FitSource& source, const std::vector<PlacedSheet>& sheets) : source_(source), sheets_(sheets) {}

    /// Chooses pixels for the camera; false when there are too few to tell anything.
    bool gather(const MovingCamera& camera, std::size_t most) {
        gathered_.clear();
        std::size_t total = 0;
        for (const PlacedSheet& sheet : sheets_) {
            const SheetImage image(sheet, camera, source_.lens.camera());
            if (!image.in_view()) continue;
            SheetPixels pixels{&sheet, pixels_of(image, sheet, camera, most), 0};
            constexpr std::size_t fewest = 60;  // some to each unknown of a sheet
            if (pixels.pixels.size() < fewest) continue;
            total += pixels.pixels.size();
            double sum = 0, squares = 0;
            for (const SheetPixel& pixel : pixels.pixels) sum += pixel.light, squares += pixel.light * pixel.light;
            const double count = static_cast<double>(pixels.pixels.size());
            pixels.spread = 2 * std::sqrt(std::max(0.0, squares - sum * sum / count) / count);
            gathered_.push_back(std::move(pixels));
        }
        constexpr std::size_t fewest_in_all = 150;
        return total >= fewest_in_all;
    }

    /// Flat light by least squares for the camera.
    Unknowns with_light(const MovingCamera& camera) const {
        Unknowns unknowns{camera, {}};
        for (const SheetPixels& seen : gathered_) {
            const SheetImage image(*seen.sheet, camera, source_.lens.camera());
            Eigen::Matrix2d normal = 1e-9 * Eigen::Matrix2d::Identity();
            Eigen::Vector2d right = Eigen::Vector2d::Zero();
            SheetSample sample;
            for (const SheetPixel& pixel : seen.pixels) {
                if (!image.in_view() || !image.at(pixel, sample)) continue;
                const Eigen::Vector2d shares(sample.paper, 1 - sample.paper);
                normal += shares * shares.transpose();
                right += pixel.light * shares;
            }
            const Eigen::Vector2d light = normal.ldlt().solve(right);
            unknowns.light.push_back({light[0], light[1], Eigen::Vector2d::Zero()});
        }
        return unknowns;
    }

    /// `cut_share` of the spread of a sheet's light is where a residual counts no more.
    Linearized linearized(const Unknowns& unknowns, double cut_share) {
        Linearized result;
        std::vector<double> residuals;
        for (std::size_t i = 0; i < gathered_.size(); ++i) {
            result.sheets.push_back(
                sheet_normal(gathered_[i], unknowns.camera, unknowns.light[i], cut_share, residuals));
            result.unexplained += result.sheets.back().unexplained;
            result.variance += result.sheets.back().variance;
        }
        result.cost = cost_;
        cost_ = 0;
        result.residual_scale = 1.4826 * (residuals.empty() ? 0 : upper_median_in_place(residuals));
        return result;
    }

    /// Information of the shared unknowns, light eliminated, and the right-hand side.
    static void reduce(const Linearized& at, double damping, SharedMatrix& matrix, SharedVector& right) {
        matrix.setZero();
        right.setZero();
        for (const SheetNormal& sheet : at.sheets) {
            SheetMatrix damped = sheet.normal;
            damped.diagonal() *= 1 + damping;
            damped.diagonal().array() += 1e-12 * damped.diagonal().maxCoeff();
            const auto light = damped.bottomRightCorner<light_count, light_count>();
            const Eigen::Matrix<double, light_count, shared_count> solved =
                light.ldlt().solve(damped.bottomLeftCorner<light_count, shared_count>());
            matrix += damped.topLeftCorner<shared_count, shared_count>() -
                      damped.topRightCorner<shared_count, light_count>() * solved;
            right += sheet.right.head<shared_count>() - solved.transpose() * sheet.right.tail<light_count>();
        }
    }

    Unknowns stepped(const Unknowns& from, const Linearized& at, double damping) const {
        SharedMatrix matrix;
        SharedVector right;
        reduce(at, damping, matrix, right);
        add_prior(from, at, matrix, right);
        const SharedVector step = matrix.ldlt().solve(right);
        Unknowns next = from;
        next.camera.camera_from_world = perturbed(from.camera.camera_from_world, step.head<6>());
        next.camera.motion += step.segment<6>(6);
        constexpr double least_blur_px = 0.2, most_blur_px = 12;
        next.camera.blur_px =
            std::clamp(from.camera.blur_px * std::exp(std::clamp(step[12], -1.0, 1.0)), least_blur_px, most_blur_px);
        for (std::size_t i = 0; i < next.light.size(); ++i) {
            SheetMatrix damped = at.sheets[i].normal;
            damped.diagonal() *= 1 + damping;
            damped.diagonal().array() += 1e-12 * damped.diagonal().maxCoeff();
            const Eigen::Vector4d light = damped.bottomRightCorner<light_count, light_count>().ldlt().solve(
                at.sheets[i].right.tail<light_count>() - damped.bottomLeftCorner<light_count, shared_count>() * step);
            next.light[i].paper += light[0];
            next.light[i].ink += light[1];
            next.light[i].slope += light.tail<2>();
            // Light that falls off by more than half across a sheet is an occluder's doing.
            next.light[i].slope = next.light[i].slope.cwiseMax(-0.5).cwiseMin(0.5);
        }
        return next;
    }

    Unknowns minimise(Unknowns unknowns, double first_cut_share, int most_iterations) {
        double cut_share = first_cut_share, damping = 1e-3;
        Linearized at = linearized(unknowns, cut_share);
        for (int iteration = 0; iteration < most_iterations; ++iteration) {
            // Pixels that the model does not explain, beyond what the unevenness of a motion leaves, are not the tags'.
            constexpr double last_cut_share = 0.3;
            if (cut_share > last_cut_share) {
                cut_share = std::max(last_cut_share, 0.7 * cut_share);
                at = linearized(unknowns, cut_share);
            }
            bool lowered = false;
            double moved_px = 0;
            constexpr int most_attempts = 5;
            for (int attempt = 0; attempt < most_attempts && !lowered; ++attempt) {
                const Unknowns next = stepped(unknowns, at, damping);
                const Linearized candidate = linearized(next, cut_share);
                if (candidate.cost < at.cost) {
                    moved_px = moved(unknowns.camera, next.camera);
                    unknowns = next;
                    at = candidate;
                    lowered = true;
                    damping = std::max(0.1 * damping, 1e-9);
                } else {
                    damping = std::max(10 * damping, 1e-6);
                }
            }
            constexpr double settled_px = 5e-3;
            if (!lowered || (moved_px < settled_px && iteration > 1 && cut_share <= last_cut_share)) break;
        }
        return unknowns;
    }

    RigImageFit described(const Unknowns& unknowns) {
        constexpr double cut_share = 0.3;
        const Linearized at = linearized(unknowns, cut_share);
        RigImageFit fit;
        fit.camera = unknowns.camera;
        fit.correlation = std::sqrt(std::max(0.0, 1 - at.unexplained_share()));
        // Neighbouring residuals hang together, as in a single tag's fit.
        constexpr double pixels_per_independent_residual = 4;
        SharedMatrix information;
        SharedVector right;
        reduce(at, 0, information, right);
        fit.pose_by_bend = pose_by_bend(at, information);
        information /= at.residual_scale * at.residual_scale * pixels_per_independent_residual;
        information += motion_prior(unknowns.camera);
        fit.covariance = information.ldlt().solve(SharedMatrix::Identity()).topLeftCorner<6, 6>();
        for (std::size_t i = 0; i < gathered_.size(); ++i) {
            const SheetImage image(*gathered_[i].sheet, unknowns.camera, source_.lens.camera());
            const SheetNormal& sheet = at.sheets[i];
            fit.sheets.push_back(
                {gathered_[i].sheet,
                 sheet.variance > 0 ? std::sqrt(std::max(0.0, 1 - sheet.unexplained / sheet.variance)) : 0,
                 unknowns.light[i].paper - unknowns.light[i].ink, image.streak_px(), gathered_[i].pixels.size()});
        }
        return fit;
    }

private:
    static PoseCovariance pose_by_bend(const Linearized& at, const SharedMatrix& information) {
        Eigen::Matrix<double, shared_count, 6> right = Eigen::Matrix<double, shared_count, 6>::Zero();
        for (const SheetNormal& sheet : at.sheets) {
            SheetMatrix regular = sheet.normal;
            regular.diagonal().array() += 1e-12 * regular.diagonal().maxCoeff();
            right += sheet.bend.topRows<shared_count>() -
                     regular.topRightCorner<shared_count, light_count>() *
                         regular.bottomRightCorner<light_count, light_count>().ldlt().solve(
                             sheet.bend.bottomRows<light_count>());
        }
        SharedMatrix regular = information;
        regular.diagonal().array() += 1e-9 * information.diagonal().array();
        return -regular.ldlt().solve(right).topRows<6>();
    }

    std::vector<SheetPixel> pixels_of(const SheetImage& image, const PlacedSheet& sheet, const MovingCamera& camera,
                                      std::size_t most) const {
        const Camera& lens = source_.lens.camera();
        Region box;
        const double cells = sheet.printed.cells;
        for (const auto& [a, b] : {std::pair{0.0, 0.0}, {cells, 0.0}, {cells, cells}, {0.0, cells}}) {
            const Eigen::Vector3d corner =
                camera.camera_from_world * (sheet.world_from_tag * sheet.sheet_from_grid({a, b}));
            const Eigen::Vector2d px = lens.pixel_from_camera(corner);
            constexpr double beyond_any_frame_px = 1e5;
            if (!px.allFinite() || px.cwiseAbs().maxCoeff() > beyond_any_frame_px) return {};
            box = box.united(Region{static_cast<int>(std::floor(px.x())), static_cast<int>(std::floor(px.y())), 2, 2});
        }
        box = box.intersected(source_.light.bounds().moved(source_.x, source_.y));
        const auto gather = [&](double step) {
            std::vector<SheetPixel> pixels;
            visit_pixels(box, step, [&](int x, int y) {
                SheetPixel pixel;
                pixel.normalized = source_.lens.normalized_from_pixel(x, y);
                if (!pixel.normalized.allFinite() || !image.sees_only_cells(pixel.normalized)) return;
                pixel.light = source_.light.at(x - source_.x, y - source_.y);
                image.locate(pixel);
                pixels.push_back(pixel);
            });
            return pixels;
        };
        const double sparse = std::max(1.0, static_cast<double>(box.width) * box.height / 1000);
        std::vector<SheetPixel> pixels = gather(sparse);
        const double step = std::max(1.0, static_cast<double>(pixels.size()) * sparse / static_cast<double>(most));
        if (step < sparse) pixels = gather(step);
        return pixels;
    }

    SheetNormal sheet_normal(const SheetPixels& seen, const MovingCamera& camera, const SheetLight& light,
                             double cut_share, std::vector<double>& residuals) {
        SheetNormal result;
        const SheetImage image(*seen.sheet, camera, source_.lens.camera());
        const double contrast = light.paper - light.ink;
        const double cut = cut_share * std::max(seen.spread, 1e-6);
        double sum = 0, squares = 0;
        SheetSample sample;
        Eigen::Matrix<double, sheet_count, 32> block;
        Eigen::Index filled = 0;
        const auto add_block = [&] {
            result.normal.selfadjointView<Eigen::Lower>().rankUpdate(block.leftCols(filled));
            filled = 0;
        };
        for (const SheetPixel& pixel : seen.pixels) {
            const double observed = std::min(pixel.light, source_.clipped_light);
            sum += observed, squares += observed * observed;
            if (!image.in_view() || !image.at(pixel, sample)) {
                cost_ += cut * cut / 6;
                result.unexplained += seen.spread * seen.spread;
                residuals.push_back(cut);
                continue;
            }
            const double flat = light.ink + contrast * sample.paper;
            const double fall = 1 + light.slope.dot(sample.sheet);
            const bool clipped = flat * fall >= source_.clipped_light && pixel.light >= source_.clipped_light;
            const double residual = clipped ? 0 : observed - flat * fall;
            residuals.push_back(std::abs(residual));
            const double t = std::min(1.0, residual * residual / (cut * cut));
            cost_ += cut * cut / 6 * (1 - (1 - t) * (1 - t) * (1 - t));  // Tukey's biweight
            result.unexplained += std::min(residual * residual, seen.spread * seen.spread);
            const double weight = (1 - t) * (1 - t);
            if (weight == 0 || clipped) continue;
            SheetVector gradient;
            gradient << contrast * fall * sample.by_pose, contrast * fall * sample.by_motion,
                contrast * fall * sample.by_log_blur, sample.paper * fall, (1 - sample.paper) * fall,
                flat * sample.sheet;
            block.col(filled++) = std::sqrt(weight) * gradient;
            if (filled == block.cols()) add_block();
            result.right += weight * residual * gradient;
            result.bend += gradient * (weight * contrast * fall * sample.by_bend).transpose();
        }
        add_block();
        result.normal.triangularView<Eigen::StrictlyUpper>() = result.normal.transpose();
        result.variance = squares - sum * sum / static_cast<double>(std::max<std::size_t>(1, seen.pixels.size()));
        return result;
    }

    /// A camera does not turn by more than a third of a radian, nor pass by, while the shutter is open: it keeps what
    /// the pixels do not tell from running away.
    SharedMatrix motion_prior(const MovingCamera& camera) const {
        constexpr double most_turn_rad = 0.15;
        const double distance_m = distance(camera);
        SharedMatrix prior = SharedMatrix::Zero();
        prior.diagonal().segment<3>(6).setConstant(1 / (most_turn_rad * most_turn_rad));
        prior.diagonal().segment<3>(9).setConstant(1 / std::pow(most_turn_rad * distance_m, 2));
        constexpr double log_blur_sigma = 1;
        prior(12, 12) = 1 / (log_blur_sigma * log_blur_sigma);
        return prior;
    }

    void add_prior(const Unknowns& from, const Linearized& at, SharedMatrix& matrix, SharedVector& right) const {
        const double variance = std::max(at.residual_scale * at.residual_scale, 1e-12);
        const SharedMatrix prior = variance * motion_prior(from.camera);
        matrix += prior;
        right.segment<6>(6) -= prior.diagonal().segment<6>(6).cwiseProduct(from.camera.motion);
        right[12] -= prior(12, 12) * std::log(from.camera.blur_px);
    }

    double distance(const MovingCamera& camera) const {
        double sum = 0;
        for (const SheetPixels& seen : gathered_) {
            sum += (camera.camera_from_world * seen.sheet->world_from_tag.translation()).norm();
        }
        return sum / static_cast<double>(std::max<std::size_t>(1, gathered_.size()));
    }

    /// Largest way of a sheet's middle in the picture.
    double moved(const MovingCamera& from, const MovingCamera& to) const {
        const Camera& lens = source_.lens.camera();
        double most = 0;
        for (const SheetPixels& seen : gathered_) {
            const Eigen::Vector3d centre = seen.sheet->world_from_tag.translation();
            const Eigen::Vector2d way =
                (from.camera_from_world * centre).hnormalized() - (to.camera_from_world * centre).hnormalized();
            most = std::max(most, way.norm() * lens.fx);
        }
        return most;
    }

    const FitSource& source_;
    const std::vector<PlacedSheet>& sheets_;
    std::vector<SheetPixels> gathered_;
    double cost_ = 0;
};

}  // namespace

std::optional<RigImageFit> fit_rig_image(const FitSource& source, const std::vector<PlacedSheet>& sheets,
                                         const MovingCamera& start, const RigFitOptions& options) {
    struct Refined {
        Unknowns unknowns;
        double unexplained = 1;
    };
    std::vector<Refined> refined;
    RigMinimiser minimiser(source, sheets);
    for (const RigPlace& place : search_rig(source, sheets, start, options.search_px)) {
        constexpr std::size_t rough_pixels = 300;
        if (!minimiser.gather(place.camera, rough_pixels)) continue;
        const Unknowns rough = minimiser.minimise(minimiser.with_light(place.camera), 1.0, 12);
        refined.push_back({rough, minimiser.linearized(rough, 1.0).unexplained_share()});
    }
    if (refined.empty()) return std::nullopt;
    std::ranges::stable_sort(refined, {}, &Refined::unexplained);
    const Refined& best = refined.front();

    Unknowns unknowns = best.unknowns;
    for (const double first_cut_share : {0.5, 0.3}) {
        if (!minimiser.gather(unknowns.camera, options.most_pixels_a_tag)) return std::nullopt;
        unknowns = minimiser.minimise(minimiser.with_light(unknowns.camera), first_cut_share, 15);
    }
    const RigImageFit fit = minimiser.described(unknowns);

    // Another place that explains nearly as much, and is not the same one found from another start?
    const Camera& lens = source.lens.camera();
    for (const Refined& other : refined) {
        double apart_px = 0;
        for (const FittedSheet& seen : fit.sheets) {
            const Eigen::Vector3d centre = seen.sheet->world_from_tag.translation();
            const Eigen::Vector3d here = fit.camera.camera_from_world * centre,
                                  there = other.unknowns.camera.camera_from_world * centre;
            apart_px = std::max(apart_px, (here.hnormalized() - there.hnormalized()).norm() * lens.fx);
        }
        constexpr double same_px = 3, clearly_worse = 1.5;
        if (apart_px > same_px && other.unexplained < clearly_worse * best.unexplained) return std::nullopt;
    }
    // A hand over some of the tags takes part in none; but most of what was looked at must show the rig.
    std::size_t all = 0, shown = 0;
    for (const FittedSheet& seen : fit.sheets) {
        all += seen.pixels;
        if (seen.correlation >= least_sheet_correlation && seen.contrast > 0) shown += seen.pixels;
    }
    if (!fit.covariance.allFinite() || 2 * shown < all) return std::nullopt;
    return fit;
}

}  // namespace matchlight
