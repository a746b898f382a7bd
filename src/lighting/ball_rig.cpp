// Where the cameras of ball photographs stood, by the tags around the ball.
#include "lighting/ball_rig.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/parallel.h"
#include "tracking/camera_pose.h"
#include "tracking/rig_image_fit.h"
#include "tracking/rig_solve.h"
#include "tracking/tag_detector.h"
#include "tracking/tag_fit.h"

namespace matchlight {
namespace {

constexpr double radians = std::numbers::pi / 180;

ImageF green_of(const ImageF& radiance) {
    ImageF green(radiance.width(), radiance.height(), 1);
    for (int y = 0; y < radiance.height(); ++y) {
        for (int x = 0; x < radiance.width(); ++x) green.at(x, y) = radiance.at(x, y, 1);
    }
    return green;
}

FitSource source_of(const ImageF& light, const LensGrid& lens) {
    return {light, 0, 0, lens, std::numeric_limits<double>::infinity()};
}

FrameObservations observe(const BallView& view, std::int64_t index, const TagSettings& tags,
                          const TagDetector& detector) {
    FrameObservations result;
    result.frame = index;
    const ImageF light = green_of(view.radiance);
    const LensGrid lens(view.camera);
    std::set<int> seen;
    for (const DetectionScale scale : {DetectionScale::linear, DetectionScale::perceptual}) {
        for (const TagDetection& detection : detector.detect(detection_image(light, scale))) {
            const bool wanted =
                std::ranges::any_of(tags.rig, [&](const RigTag& tag) { return tag.id == detection.id; });
            if (!wanted || seen.contains(detection.id)) continue;
            const auto fit = fit_tag(source_of(light, lens), detector.family().pattern(detection.id), detection);
            if (!fit) continue;
            seen.insert(detection.id);
            result.tags.push_back(fit->observation);
        }
    }
    std::ranges::sort(result.tags, {}, &TagObservation::id);
    return result;
}

/// What poses of one view are tried on.
struct ViewLight {
    explicit ViewLight(const BallView& view) : light(green_of(view.radiance)), lens(view.camera) {}
    ImageF light;
    LensGrid lens;
};

/// The rig fitted to the whole picture from a pose that is right within `search_px`; kept in `view` where it correlates
/// better than what is there.
bool fit_rig(const ViewLight& from, const BallRig& rig, const RigidTransform& start, double search_px, BallView& view) {
    RigFitOptions options;
    options.search_px = search_px;
    options.most_pixels_a_tag = 4000;
    MovingCamera camera;
    camera.camera_from_world = start;
    const auto fit = fit_rig_image(source_of(from.light, from.lens), rig.sheets, camera, options);
    if (!fit || fit->correlation < least_sheet_correlation || fit->correlation <= view.rig_correlation) return false;
    view.camera_from_world = fit->camera.camera_from_world;
    view.rig_correlation = fit->correlation;
    return true;
}

/// Cells of the rig's sheets, as points with what they print: −1 ink, +1 paper.
struct PrintedPoint {
    Eigen::Vector3d world_m;
    double print = 0;
};
std::vector<std::vector<PrintedPoint>> printed_points(const BallRig& rig) {
    std::vector<std::vector<PrintedPoint>> result;
    for (const PlacedSheet& sheet : rig.sheets) {
        auto& points = result.emplace_back();
        for (int y = 0; y < sheet.printed.cells; ++y) {
            for (int x = 0; x < sheet.printed.cells; ++x) {
                const TagPattern::Ink ink = sheet.printed.at(x, y);
                if (ink == TagPattern::unknown) continue;
                points.push_back({sheet.world_from_tag * sheet.sheet_from_grid({x + 0.5, y + 0.5}),
                                  ink == TagPattern::white ? 1.0 : -1.0});
            }
        }
    }
    return result;
}

/// The camera that sees the ball where the outline says, from azimuth and elevation of its place as seen from the ball,
/// turned about the line of sight.
struct TurnAroundBall {
    double azimuth = 0, elevation = 0, roll = 0;        // radians
    double distance_factor = 1;                         // of what the outline says
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();  // of the ball: rims that are hard to see move it
};

/// Seeks the turn whose picture of the rig agrees best with the photograph.
class RigSearch {
public:
    RigSearch(const BallView& view, const BallRig& rig, const Eigen::Vector3d& ball_m, double radius_m)
        : view_(view), points_(printed_points(rig)), ball_m_(ball_m), radius_m_(radius_m) {
        double cell_m = 0;
        for (const PlacedSheet& sheet : rig.sheets) cell_m += sheet.cell_m() / static_cast<double>(rig.sheets.size());
        const double cell_px = view.camera.fx * cell_m / view.outline.centre_camera_m(radius_m).norm();
        // A cell's middle then stands for the cell; half that and the search would miss between its steps.
        const ImageF light = green_of(view.radiance);
        const cv::Mat whole(light.height(), light.width(), CV_32F, const_cast<float*>(light.samples().data()));
        cv::Mat logs;
        cv::log(cv::max(whole, 1e-6F), logs);
        cv::GaussianBlur(logs, light_, {}, std::max(0.5, 0.3 * cell_px));
    }

    RigidTransform pose_of(const TurnAroundBall& turn) const {
        const Eigen::Vector3d axis = view_.outline.axis;
        const double distance_m = turn.distance_factor * view_.outline.centre_camera_m(radius_m_).norm();
        const Eigen::Vector3d from_ball(std::cos(turn.elevation) * std::cos(turn.azimuth),
                                        std::cos(turn.elevation) * std::sin(turn.azimuth), std::sin(turn.elevation));
        const Eigen::Vector3d eye = ball_m_ + turn.shift_m + distance_m * from_ball;
        const RigidTransform upright = camera_looking_along(eye, -from_ball);
        // `upright` sees the ball in its middle; the photograph along `axis`.
        const Eigen::Quaterniond aside = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
        return RigidTransform(Eigen::AngleAxisd(turn.roll, axis) * aside) * upright;
    }

    /// Log likelihood gained over a picture without tags: of each sheet −n/2·log(1 − r²), r its correlation.
    double gain(const TurnAroundBall& turn) const {
        const RigidTransform camera_from_world = pose_of(turn);
        const Eigen::Vector3d axis = view_.outline.axis;
        // A little more than the ball: its edge is blurred into the light around it.
        const double ball_cosine = std::cos(1.05 * view_.outline.half_angle);
        double total = 0;
        for (const auto& sheet : points_) {
            double n = 0, a = 0, b = 0, aa = 0, ab = 0, bb = 0;
            for (const PrintedPoint& point : sheet) {
                const Eigen::Vector3d in_camera = camera_from_world * point.world_m;
                if (in_camera.z() <= 0) return 0;
                if (in_camera.dot(axis) > ball_cosine * in_camera.norm()) continue;
                const Eigen::Vector2d normalized = in_camera.head<2>() / in_camera.z();
                if (normalized.norm() > 3) continue;  // far outside any frame, where lens models fold
                const Eigen::Vector2d px = view_.camera.pixel_from_normalized(normalized);
                if (!view_.in_frame(px)) continue;
                const double value =
                    light_.at<float>(static_cast<int>(std::lround(px.y())), static_cast<int>(std::lround(px.x())));
                n += 1, a += point.print, b += value;
                aa += point.print * point.print, ab += point.print * value, bb += value * value;
            }
            if (n < 12) continue;
            const double covariance = ab - a * b / n, spread = (aa - a * a / n) * (bb - b * b / n);
            if (covariance <= 0 || spread <= 0) continue;
            const double share = std::min(0.999, covariance * covariance / spread);
            total -= n / 2 * std::log(1 - share);
        }
        return total;
    }

    /// Different places that agree best, best first.
    std::vector<TurnAroundBall> best_turns() const {
        // Steps move what lies a few ball radii beside the ball by less than a cell; photographs are taken upright,
        // roughly, from above the table.
        constexpr int azimuths = 180, elevations = 41, rolls = 7;
        std::vector<std::pair<double, TurnAroundBall>> all(static_cast<std::size_t>(azimuths));
        std::vector<std::vector<std::pair<double, TurnAroundBall>>> found(azimuths);
        parallel_for(azimuths, [&](int i) {
            for (int j = 0; j < elevations; ++j) {
                std::pair<double, TurnAroundBall> best{-1, {}};
                for (int k = 0; k < rolls; ++k) {
                    const int upright = k - rolls / 2;
                    const TurnAroundBall turn{2 * i * radians, (5 + 2 * j) * radians, 4 * upright * radians, 1};
                    const double value = gain(turn);
                    if (value > best.first) best = {value, turn};
                }
                found[static_cast<std::size_t>(i)].push_back(best);
            }
        });
        all.clear();
        for (const auto& row : found) all.insert(all.end(), row.begin(), row.end());
        std::ranges::stable_sort(all, std::greater<>(), [](const auto& one) { return one.first; });
        all.resize(std::min<std::size_t>(all.size(), 60));
        parallel_for(static_cast<int>(all.size()), [&](int i) { climb(all[static_cast<std::size_t>(i)]); });
        std::ranges::stable_sort(all, std::greater<>(), [](const auto& one) { return one.first; });
        std::vector<TurnAroundBall> result;
        for (const auto& [value, turn] : all) {
            const RigidTransform pose = pose_of(turn);
            const bool known = std::ranges::any_of(result, [&](const TurnAroundBall& other) {
                return (pose_of(other).linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm() <
                       0.05;
            });
            if (!known) result.push_back(turn);
            if (result.size() == 5) break;
        }
        return result;
    }

private:
    /// Uphill in each of the seven, with steps that halve.
    void climb(std::pair<double, TurnAroundBall>& place) const {
        for (double step = 1; step > 0.05; step /= 2) {
            for (bool moved = true; moved;) {
                moved = false;
                for (int k = 0; k < 14; ++k) {
                    TurnAroundBall next = place.second;
                    const double sign = k % 2 == 0 ? step : -step;
                    if (k / 2 == 0) next.azimuth += sign * radians;
                    if (k / 2 == 1) next.elevation += sign * radians;
                    if (k / 2 == 2) next.roll += sign * radians;
                    if (k / 2 == 3) next.distance_factor *= 1 + 0.02 * sign;
                    if (k / 2 >= 4) next.shift_m[k / 2 - 4] += 0.05 * sign * radius_m_;
                    // The outline tells the place; it may be off by some per cent where the rim is hard to see.
                    if (std::abs(next.distance_factor - 1) > 0.08 || next.shift_m.norm() > 0.25 * radius_m_) continue;
                    const double value = gain(next);
                    if (value > place.first * (1 + 1e-9)) place = {value, next}, moved = true;
                }
            }
        }
    }

    const BallView& view_;
    std::vector<std::vector<PrintedPoint>> points_;
    Eigen::Vector3d ball_m_;
    double radius_m_;
    cv::Mat light_;
};

std::string wanted_ids(const TagSettings& tags) {
    std::vector<int> ids;
    for (const RigTag& tag : tags.rig) ids.push_back(tag.id);
    return fmt::format("{} {}", tags.family, fmt::join(ids, ", "));
}

BallRig placed_rig(const TagSettings& tags, const RigSolution& solution, const TagFamily& family) {
    BallRig rig;
    for (const RigTag& tag : tags.rig) {
        const auto place = solution.world_from_tag.find(tag.id);
        if (place == solution.world_from_tag.end()) continue;
        const TagPattern pattern = family.pattern(tag.id);
        rig.sheets.push_back({tag.id, tag.size_m, place->second, pattern, BlurredPattern(pattern)});
    }
    return rig;
}

}  // namespace

std::optional<Print> print_at(const BallRig& rig, const Eigen::Vector3d& place_m) {
    for (std::size_t i = 0; i < rig.sheets.size(); ++i) {
        const PlacedSheet& sheet = rig.sheets[i];
        const Eigen::Vector3d in_tag = sheet.world_from_tag.inverse() * place_m;
        const Eigen::Vector2d grid = sheet.grid_from_sheet(in_tag.head<2>());
        const int x = static_cast<int>(std::floor(grid.x())), y = static_cast<int>(std::floor(grid.y()));
        if (x < 0 || y < 0 || x >= sheet.printed.cells || y >= sheet.printed.cells) continue;
        const TagPattern::Ink ink = sheet.printed.at(x, y);
        if (ink == TagPattern::unknown) continue;
        return Print{i, ink == TagPattern::white};
    }
    return std::nullopt;
}

BallRig find_rig(std::vector<BallView>& views, const TagSettings& tags, double ball_radius_m, Warnings& warnings) {
    const TagDetector detector(tags.family, {});
    std::vector<FrameObservations> frames;
    for (std::size_t i = 0; i < views.size(); ++i) {
        frames.push_back(observe(views[i], static_cast<std::int64_t>(i), tags, detector));
    }
    if (std::ranges::all_of(frames, [](const FrameObservations& frame) { return frame.tags.empty(); })) {
        throw InputError(views.front().name,
                         fmt::format("no whole tag in any view; looked for {} beside the ball", wanted_ids(tags)),
                         "show at least one tag whole in one view, or leave --rig out");
    }
    const RigSolution solution = solve_rig(tags.rig, frames);
    const BallRig rig = placed_rig(tags, solution, detector.family());
    const int lowest = std::ranges::min(tags.rig, {}, &RigTag::id).id;
    if (solution.origin && *solution.origin != lowest) {
        warnings.add(
            fmt::format("{}: the scene gives no places of its tags, and tag {}, which is its world, is not whole here: "
                        "the probe's axes are those of tag {} (track the scene first, or give the places in [tags])",
                        views.front().name.string(), lowest, *solution.origin));
    }
    Eigen::Vector3d ball_m = Eigen::Vector3d::Zero();
    int posed = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        std::vector<PlacedObservation> placed;
        for (const TagObservation& tag : frames[i].tags) {
            const auto sheet = std::ranges::find(rig.sheets, tag.id, &PlacedSheet::id);
            if (sheet != rig.sheets.end()) placed.push_back({&tag, sheet->size_m, sheet->world_from_tag});
        }
        if (placed.empty()) continue;
        // Of a single flat tag's two poses the rest of the rig tells which is right.
        const ViewLight light(views[i]);
        for (const CameraPose& pose : candidate_poses(placed)) {
            const bool better = fit_rig(light, rig, pose.camera_from_world, 4, views[i]);
            if (!better && !views[i].camera_from_world) views[i].camera_from_world = pose.camera_from_world;
        }
        ball_m += views[i].camera_from_world->inverse() * views[i].outline.centre_camera_m(ball_radius_m);
        ++posed;
    }
    if (posed == 0) {
        throw InputError(views.front().name, "the tags that are seen have no place in the rig",
                         "give their places in the scene's [tags]");
    }
    ball_m /= posed;
    for (BallView& view : views) {
        if (view.camera_from_world) continue;
        const RigSearch search(view, rig, ball_m, ball_radius_m);
        const ViewLight light(view);
        for (const TurnAroundBall& turn : search.best_turns()) fit_rig(light, rig, search.pose_of(turn), 12, view);
        if (!view.camera_from_world) {
            throw InputError(view.name,
                             fmt::format("the rig is not found: no whole tag of {}, nor parts of them around the ball",
                                         wanted_ids(tags)),
                             "show a tag whole, or leave the view out");
        }
        view.pose_from_ball = true;
        warnings.add(
            fmt::format("{}: no whole tag: the camera was found by the ball and parts of tags", view.name.string()));
    }
    return rig;
}

}  // namespace matchlight
