// The place of a mirror ball to a fraction of a millimetre: what it reflects of a plane is compared with the plane
// itself.
#include "lighting/ball_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "core/median.h"
#include "core/parallel.h"

namespace matchlight {
namespace {

/// The ball's edge, blurred, and its outline's error lie within this many radii.
constexpr double clear_of_ball = 1.06;
/// Nearer to the rim a pixel holds too much of the plane.
constexpr double least_cosine = 0.25;

/// The photographs a little blurred, as the ball's minification blurs what it reflects.
std::vector<ImageF> blurred(const std::vector<BallView>& views, double sigma_px) {
    std::vector<ImageF> result;
    for (const BallView& view : views) {
        ImageF copy = view.radiance;
        cv::Mat pixels(copy.height(), copy.width(), CV_32FC3, copy.samples().data());
        cv::GaussianBlur(pixels, pixels, {}, sigma_px);
        result.push_back(std::move(copy));
    }
    return result;
}

/// A point of the plane with its green light, in logarithms to base 2.
struct PlanePoint {
    Eigen::Vector3d place_m;
    double log_direct = 0;
};

class BallFitter {
public:
    BallFitter(const std::vector<BallView>& views, const RigPlane& plane, const MirrorBall& start)
        : views_(views), sharp_(blurred(views, 1)), radius_m_(start.radius_m) {
        // What lies within six radii of the foot is large enough in the ball to tell its place.
        constexpr int half = 24;
        const double step_m = 6.0 * radius_m_ / half;
        const Eigen::Vector3d foot = start.centre_m - plane.height_m(start.centre_m) * plane.normal;
        Eigen::Vector3d across = plane.normal.cross(Eigen::Vector3d::UnitY());
        if (across.norm() < 0.1) across = plane.normal.cross(Eigen::Vector3d::UnitX());
        across.normalize();
        const Eigen::Vector3d along = plane.normal.cross(across);
        // Where the ball is not sure no plane is taken for seen.
        MirrorBall wide = start;
        wide.radius_m *= 1.1;
        for (int j = -half; j <= half; ++j) {
            for (int i = -half; i <= half; ++i) {
                const Eigen::Vector3d place = foot + step_m * (i * across + j * along);
                Eigen::Vector3d sum = Eigen::Vector3d::Zero();
                int seen = 0;
                for (std::size_t v = 0; v < views.size(); ++v) {
                    const auto pixel = direct_pixel(views[v], wide, place, clear_of_ball);
                    if (!pixel) continue;
                    sum += sample_rgb(sharp_[v], *pixel);
                    ++seen;
                }
                if (seen == 0 || sum.minCoeff() <= 0) continue;
                points_.push_back({place, std::log2(sum.y() / seen)});
            }
        }
    }

    /// Of every point that a view shows in the ball too: log2 of the reflected light over the direct, green.
    std::vector<double> log_ratios(const MirrorBall& ball) const {
        std::vector<std::vector<double>> found(views_.size());
        parallel_for(static_cast<int>(views_.size()), [&](int v) {
            const BallView& view = views_[static_cast<std::size_t>(v)];
            const Eigen::Vector3d eye = view.eye_m();
            for (const PlanePoint& point : points_) {
                const auto hit = hit_reflecting_place(ball, eye, point.place_m);
                if (!hit || hit->cosine < least_cosine) continue;
                const Eigen::Vector3d light = sample_rgb(sharp_[static_cast<std::size_t>(v)], view.pixel(hit->point_m));
                if (light.minCoeff() <= 0) continue;
                found[static_cast<std::size_t>(v)].push_back(std::log2(light.y()) - point.log_direct);
            }
        });
        std::vector<double> all;
        for (const auto& one : found) all.insert(all.end(), one.begin(), one.end());
        return all;
    }

    /// Robust mean square of the green ratio about its median; what is not seen counts as the worst.
    double cost(const Eigen::Vector3d& centre_m) const {
        const std::vector<double> ratios = log_ratios({centre_m, radius_m_});
        if (ratios.empty()) return std::numeric_limits<double>::infinity();
        const double middle = upper_median(ratios);
        // Half a stop: more than a shadow's or a gloss's difference, less than ink against paper.
        constexpr double reach = 0.5;
        double sum = 0;
        for (const double ratio : ratios) {
            const double part = (ratio - middle) * (ratio - middle) / (reach * reach);
            sum += part / (1 + part);
        }
        const double most = static_cast<double>(views_.size() * points_.size());
        return (sum + 0.5 * (most - static_cast<double>(ratios.size()))) / most;
    }

    /// Downhill in x, y and z with steps that halve (Hooke & Jeeves 1961, "Direct Search"), because tag edges make the
    /// cost rough.
    Eigen::Vector3d descend(const Eigen::Vector3d& start_m) const {
        Eigen::Vector3d best = start_m;
        double least = cost(best);
        for (double step_m = 0.08 * radius_m_; step_m > 5e-4 * radius_m_; step_m /= 2) {
            for (bool moved = true; moved;) {
                moved = false;
                for (int k = 0; k < 6; ++k) {
                    Eigen::Vector3d next = best;
                    next[k / 2] += k % 2 == 0 ? step_m : -step_m;
                    const double value = cost(next);
                    if (value < least) least = value, best = next, moved = true;
                }
            }
        }
        return best;
    }

private:
    const std::vector<BallView>& views_;
    std::vector<ImageF> sharp_;
    double radius_m_;
    std::vector<PlanePoint> points_;
};

/// Head on, by the white cells of the tags: paper sends much the same light everywhere, wood and ink shine.
std::optional<Eigen::Vector3d> measured_reflectance(const std::vector<BallView>& views, const BallRig& rig,
                                                    const MirrorBall& ball) {
    std::array<std::vector<double>, 3> shares;
    for (const PlacedSheet& sheet : rig.sheets) {
        for (int i = 0; i < sheet.printed.cells * sheet.printed.cells; ++i) {
            const int x = i % sheet.printed.cells, y = i / sheet.printed.cells;
            if (sheet.printed.at(x, y) != TagPattern::white) continue;
            const Eigen::Vector3d place_m = sheet.world_from_tag * sheet.sheet_from_grid({x + 0.5, y + 0.5});
            const auto direct = direct_radiance(views, ball, place_m);
            if (!direct || direct->minCoeff() <= 0) continue;
            for (const BallView& view : views) {
                const Eigen::Vector3d eye = view.eye_m();
                const auto hit = hit_reflecting_place(ball, eye, place_m);
                // Beyond 60° what grazing incidence adds is no longer small.
                if (!hit || hit->cosine < 0.5) continue;
                // A pixel has to lie well within the cell, as the ball sees it.
                const Eigen::Vector3d way = place_m - hit->point_m;
                const double pixel_sr = reflected_solid_angle_ratio(ball, (hit->point_m - eye).norm(), hit->cosine) /
                                        (view.camera.fx * view.camera.fy);
                const double cell_sr = sheet.cell_m() * sheet.cell_m() *
                                       std::abs(way.normalized().dot(sheet.world_from_tag.linear().col(2))) /
                                       way.squaredNorm();
                if (9 * pixel_sr > cell_sr) continue;
                const Eigen::Vector3d ratio =
                    sample_rgb(view.radiance, view.pixel(hit->point_m)).cwiseQuotient(*direct);
                const double grazing = fresnel_reflectance(0, hit->cosine);
                for (int c = 0; c < 3; ++c)
                    shares[static_cast<std::size_t>(c)].push_back((ratio[c] - grazing) / (1 - grazing));
            }
        }
    }
    // Fewer than these and one shadow's edge decides.
    if (shares[0].size() < 8) return std::nullopt;
    Eigen::Vector3d result;
    for (std::size_t c = 0; c < 3; ++c) {
        result[static_cast<Eigen::Index>(c)] = std::clamp(upper_median_in_place(shares[c]), 0.02, 1.0);
    }
    return result;
}

}  // namespace

std::optional<Eigen::Vector3d> RigPlane::meets(const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction) const {
    const double towards = -normal.dot(direction);
    const double height = height_m(from_m);
    if (towards <= 0 || height <= 0) return std::nullopt;
    return from_m + height / towards * direction;
}

std::optional<RigPlane> plane_of_rig(const BallRig& rig) {
    if (rig.sheets.empty()) return std::nullopt;
    RigPlane plane;
    plane.normal.setZero();
    double extent_m = 0;
    for (const PlacedSheet& sheet : rig.sheets) {
        plane.normal += sheet.world_from_tag.linear().col(2);
        plane.point_m += sheet.world_from_tag.translation() / static_cast<double>(rig.sheets.size());
    }
    plane.normal.normalize();
    for (const PlacedSheet& sheet : rig.sheets) {
        extent_m = std::max(extent_m, sheet.size_m + (sheet.world_from_tag.translation() - plane.point_m).norm());
    }
    for (const PlacedSheet& sheet : rig.sheets) {
        if (std::abs(plane.height_m(sheet.world_from_tag.translation())) > extent_m / 50) return std::nullopt;
        constexpr double cosine_of_3_deg = 0.99863;
        if (sheet.world_from_tag.linear().col(2).dot(plane.normal) < cosine_of_3_deg) return std::nullopt;
    }
    return plane;
}

std::optional<Eigen::Vector3d> direct_radiance(const std::vector<BallView>& views, const MirrorBall& ball,
                                               const Eigen::Vector3d& place_m) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int seen = 0;
    for (const BallView& view : views) {
        const auto pixel = direct_pixel(view, ball, place_m, clear_of_ball);
        if (!pixel) continue;
        sum += sample_rgb(view.radiance, *pixel);
        ++seen;
    }
    if (seen == 0) return std::nullopt;
    return sum / seen;
}

MirrorBall ball_from_outlines(const std::vector<BallView>& views, double radius_m) {
    // A rim that is hard to see makes an outline some per cent too small and moves it half as much: that is far along
    // the line of sight and little across it.
    constexpr double radius_error = 0.03, shift_error = 0.015;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const BallView& view : views) {
        const Eigen::Vector3d eye = view.eye_m();
        const Eigen::Vector3d centre = view.camera_from_world->inverse() * view.outline.centre_camera_m(radius_m);
        const double distance_m = (centre - eye).norm();
        const Eigen::Vector3d sight = (centre - eye) / distance_m;
        const Eigen::Matrix3d along = sight * sight.transpose();
        const double along_m = radius_error * distance_m, across_m = shift_error * radius_m;
        const Eigen::Matrix3d weight =
            along / (along_m * along_m) + (Eigen::Matrix3d::Identity() - along) / (across_m * across_m);
        information += weight;
        sum += weight * centre;
    }
    return {information.ldlt().solve(sum), radius_m};
}

std::optional<BallFit> fit_ball_to_rig(const std::vector<BallView>& views, const BallRig& rig, const RigPlane& plane,
                                       const MirrorBall& start) {
    const BallFitter fitter(views, plane, start);
    if (fitter.log_ratios(start).size() < 60) return std::nullopt;
    BallFit fit;
    fit.ball = {fitter.descend(start.centre_m), start.radius_m};
    // Most balls lie on the table: where that explains the reflections better, the outlines were wrong.
    const Eigen::Vector3d lying = start.centre_m + (start.radius_m - plane.height_m(start.centre_m)) * plane.normal;
    const Eigen::Vector3d from_lying = fitter.descend(lying);
    if (fitter.cost(from_lying) < fitter.cost(fit.ball.centre_m)) fit.ball.centre_m = from_lying;
    const std::vector<double> ratios = fitter.log_ratios(fit.ball);
    fit.points = ratios.size();
    if (fit.points < 60) return std::nullopt;
    fit.reflectance = measured_reflectance(views, rig, fit.ball);
    std::vector<double> off;
    const double middle = upper_median(ratios);
    for (const double ratio : ratios) off.push_back(std::abs(ratio - middle));
    fit.residual = upper_median(off);
    for (const BallView& view : views) {
        const Eigen::Vector3d by_outline =
            view.camera_from_world->inverse() * view.outline.centre_camera_m(start.radius_m);
        const double distance_m = (view.eye_m() - fit.ball.centre_m).norm();
        // Along the line of sight an error shows in the radius.
        const Eigen::Vector3d off_m = by_outline - fit.ball.centre_m;
        const Eigen::Vector3d sight = (fit.ball.centre_m - view.eye_m()).normalized();
        const double along_m = off_m.dot(sight);
        const double across_px = view.camera.fx * (off_m - along_m * sight).norm() / distance_m;
        const double radius_px = view.camera.fx * start.radius_m / distance_m * std::abs(along_m) / distance_m;
        fit.outline_off_px = std::max(fit.outline_off_px, std::hypot(across_px, radius_px));
    }
    return fit;
}

}  // namespace matchlight
