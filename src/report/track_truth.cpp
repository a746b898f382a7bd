// Reads the truth, and compares frame by frame.
#include "report/track_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tracking/camera_pose.h"

namespace matchlight {

namespace {

using nlohmann::json;

class TruthReader {
public:
    explicit TruthReader(const std::filesystem::path& path) : path_(path) {}

    TrackTruth read() const {
        const json whole = json::parse(read_text_file(path_), nullptr, false);
        if (!whole.is_object() || !whole.contains("poses") || !whole["poses"].is_array()) {
            fail("holds no list \"poses\"");
        }
        TrackTruth truth;
        for (const json& entry : whole["poses"]) {
            if (!entry.is_object() || !entry.contains("frame") || !entry["frame"].is_number_integer()) {
                fail("has a pose without a \"frame\"");
            }
            const auto frame = entry["frame"].get<std::int64_t>();
            TrueFrame& read = truth.frames[frame];
            read.camera_from_world = pose(entry, frame);
            read.exposure_ev = number(entry, "ev");
            read.focus_distance_m = number(entry, "focus_m");
        }
        if (truth.frames.empty()) fail("holds no pose");
        if (whole.contains("white_balance")) {
            const json& balance = whole["white_balance"];
            if (!balance.is_array() || balance.size() != 3) fail("\"white_balance\" is not [r, g, b]");
            truth.white_balance.emplace();
            for (std::size_t c = 0; c < 3; ++c) {
                (*truth.white_balance)[c] = finite(balance[c], "white_balance");
                if (!((*truth.white_balance)[c] > 0)) fail("\"white_balance\" is not above 0");
            }
        }
        truth.shutter_fraction = number(whole, "shutter");
        const auto fx = number(whole, "fx"), lens_mm = number(whole, "lens_mm"), f_stop = number(whole, "fstop");
        if (fx && lens_mm && f_stop) truth.coc_scale_px_m = *fx * *lens_mm * 1e-3 / *f_stop;
        return truth;
    }

private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw InputError(path_, cause, "give the groundtruth.json of a made clip");
    }

    double finite(const json& value, const std::string& key) const {
        if (!value.is_number() || !std::isfinite(value.get<double>())) fail("\"" + key + "\" is not a finite number");
        return value.get<double>();
    }

    std::optional<double> number(const json& object, const char* key) const {
        if (!object.contains(key)) return std::nullopt;
        return finite(object[key], key);
    }

    RigidTransform pose(const json& entry, std::int64_t frame) const {
        const json rows = entry.value("cam_from_world", json());
        Eigen::Matrix4d matrix;
        bool good = rows.is_array() && rows.size() == 4;
        for (std::size_t row = 0; good && row < 4; ++row) {
            good = rows[row].is_array() && rows[row].size() == 4;
            for (std::size_t column = 0; good && column < 4; ++column) {
                good = rows[row][column].is_number();
                if (good) {
                    matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
                        rows[row][column].get<double>();
                }
            }
        }
        // Single precision is what most programs write.
        if (!good || !matrix.allFinite() || !is_rigid(matrix, 1e-4)) {
            throw InputError(path_, frame, "\"cam_from_world\" is not a rigid 4x4 matrix");
        }
        return RigidTransform(matrix);
    }

    const std::filesystem::path& path_;
};

std::optional<double> mean(const std::vector<double>& values) {
    if (values.empty()) return std::nullopt;
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of at least one value, interpolated between neighbours.
double quantile(std::vector<double> values, double share) {
    std::ranges::sort(values);
    const double at = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

/// Pixels of the volume's corners, without distortion; NaN for one behind the camera.
Eigen::Matrix2Xd projected(const ScoredVolume& volume, const RigidTransform& camera_from_world, const Camera& camera) {
    Eigen::Matrix2Xd pixels(2, static_cast<Eigen::Index>(volume.corners_m.size()));
    for (std::size_t i = 0; i < volume.corners_m.size(); ++i) {
        const Eigen::Vector3d at = camera_from_world * volume.corners_m[i];
        Eigen::Vector2d pixel = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
        if (at.z() > 1e-6) {
            pixel << camera.fx * at.x() / at.z() + camera.cx, camera.fy * at.y() / at.z() + camera.cy;
        }
        pixels.col(static_cast<Eigen::Index>(i)) = pixel;
    }
    return pixels;
}

struct FrameSums {
    std::vector<double> errors_px, slow_px, fast_px, jitter_px2, nees, ev, white_balance, focus, coc_scale, shutter;
};

void compare_optics(const SolvedFrame& solved, const TrueFrame& exact, const TrackTruth& truth, FrameSums& sums) {
    if (solved.exposure_ev && exact.exposure_ev) sums.ev.push_back(*solved.exposure_ev - *exact.exposure_ev);
    if (solved.white_balance && truth.white_balance) {
        double worst = 0;
        for (const std::size_t c : {0, 2}) {
            const double found = (*solved.white_balance)[c] / (*solved.white_balance)[1];
            worst = std::max(worst, std::abs(found / ((*truth.white_balance)[c] / (*truth.white_balance)[1]) - 1));
        }
        sums.white_balance.push_back(worst);
    }
    if (solved.focus_distance_m && exact.focus_distance_m) {
        sums.focus.push_back(std::abs(*solved.focus_distance_m / *exact.focus_distance_m - 1));
    }
    if (solved.coc_scale_px_m && truth.coc_scale_px_m) {
        sums.coc_scale.push_back(std::abs(*solved.coc_scale_px_m / *truth.coc_scale_px_m - 1));
    }
    if (solved.shutter_fraction && truth.shutter_fraction) {
        sums.shutter.push_back(std::abs(*solved.shutter_fraction - *truth.shutter_fraction));
    }
}

}  // namespace

TrackTruth load_track_truth(const std::filesystem::path& path) {
    return TruthReader(path).read();
}

ScoredVolume scored_volume(const Camera& camera, double largest_tag_m) {
    ScoredVolume volume{camera, {}};
    for (const double x : {-1, 1}) {
        for (const double y : {-1, 1}) {
            for (const double z : {0, 1}) volume.corners_m.push_back(largest_tag_m * Eigen::Vector3d(x, y, z));
        }
    }
    return volume;
}

void score(const ScoredPath& path, const TrackTruth& truth, const ScoredVolume& volume,
           const std::filesystem::path& reported, TrackPoint& point) {
    std::map<std::int64_t, const SolvedFrame*> solved;
    for (const SolvedFrame& frame : path.frames) solved[frame.frame] = &frame;

    constexpr double fast_px = 8;  // a frame: from there on motion blurs edges by pixels
    FrameSums sums;
    TrackErrors errors;
    std::optional<Eigen::Matrix2Xd> truth_before, error_before;
    std::optional<std::int64_t> frame_before;
    std::int64_t common = 0;
    for (const auto& [index, exact] : truth.frames) {
        const auto found = solved.find(index);
        if (found == solved.end()) continue;  // outside the range that was tracked
        ++common;
        const Eigen::Matrix2Xd at = projected(volume, exact.camera_from_world, volume.camera);
        const bool follows = frame_before && *frame_before + 1 == index;
        const double speed_px = follows ? (at - *truth_before).colwise().norm().mean() : 0;
        truth_before = at, frame_before = index;
        const SolvedFrame& frame = *found->second;
        std::optional<double>& error_px = point.error_px.emplace_back();
        if (!frame.camera_from_world) {
            ++errors.lost;
            error_before.reset();
            continue;
        }
        const Eigen::Matrix2Xd error = projected(volume, *frame.camera_from_world, path.camera) - at;
        const double mean_px = error.colwise().norm().mean();
        if (!std::isfinite(mean_px)) {
            ++errors.lost;
            error_before.reset();
            continue;
        }
        error_px = mean_px;
        sums.errors_px.push_back(mean_px);
        (speed_px > fast_px ? sums.fast_px : sums.slow_px).push_back(mean_px);
        if (follows && error_before) sums.jitter_px2.push_back((error - *error_before).colwise().squaredNorm().mean());
        error_before = error;
        if (frame.covariance) {
            const auto off = perturbation_between(exact.camera_from_world, *frame.camera_from_world);
            sums.nees.push_back(off.dot(frame.covariance->ldlt().solve(off)) / 6);
        }
        compare_optics(frame, exact, truth, sums);
    }
    if (common == 0) throw InputError(reported, "has no frame in common with the footage");
    if (!sums.errors_px.empty()) {
        errors.mean_px = *mean(sums.errors_px);
        errors.median_px = quantile(sums.errors_px, 0.5);
        errors.p95_px = quantile(sums.errors_px, 0.95);
        errors.max_px = std::ranges::max(sums.errors_px);
    } else {
        errors.mean_px = errors.median_px = errors.p95_px = errors.max_px = std::numeric_limits<double>::infinity();
    }
    errors.slow_mean_px = mean(sums.slow_px), errors.fast_mean_px = mean(sums.fast_px);
    if (const auto squares = mean(sums.jitter_px2)) errors.jitter_px = std::sqrt(*squares);
    if (!sums.nees.empty()) errors.nees_median = quantile(sums.nees, 0.5);
    errors.ev_mean = mean(sums.ev);
    if (errors.ev_mean) {
        double squares = 0;
        for (const double ev : sums.ev) squares += (ev - *errors.ev_mean) * (ev - *errors.ev_mean);
        errors.ev_spread = std::sqrt(squares / static_cast<double>(sums.ev.size()));
    }
    errors.white_balance = mean(sums.white_balance), errors.focus = mean(sums.focus);
    errors.coc_scale = mean(sums.coc_scale), errors.shutter = mean(sums.shutter);
    point.errors = errors;
}

}  // namespace matchlight
