// Flat sheets, one ray after the other.
#include "report/tag_view_reference.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixfmt.h>
}

#include "core/parallel.h"
#include "media/av_pointers.h"
#include "media/plate_format.h"

namespace matchlight {

namespace {

/// Offsets, each within ±½: from the pixel's centre (px), on a square that becomes the lens, and from mid-exposure (of
/// the exposure).
struct RaySample {
    Eigen::Vector2d pixel, lens;
    double time = 0;
};

/// From the square [−½, ½]² to the unit disc, equal areas to equal areas and −p to −p (Shirley & Chiu 1997, A Low
/// Distortion Map Between Disk and Square).
Eigen::Vector2d disc_from_square(const Eigen::Vector2d& p) {
    const double x = 2 * p.x(), y = 2 * p.y();
    if (x == 0 && y == 0) return Eigen::Vector2d::Zero();
    const bool wide = std::abs(x) > std::abs(y);
    const double radius = wide ? x : y;
    const double angle = wide ? std::numbers::pi / 4 * y / x : std::numbers::pi / 2 - std::numbers::pi / 4 * x / y;
    return radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
}

/// What a pixel is the mean over beside its own area.
struct Blur {
    bool lens = false, motion = false;
    int dimensions() const { return 2 + (lens ? 2 : 0) + (motion ? 1 : 0); }
};

/// The worst-case error of a Korobov lattice for smooth periodic functions, P₂ (Sloan & Joe 1994, Lattice Methods for
/// Multiple Integration, ch. 4), up to a constant.
double lattice_error(int count, std::int64_t factor, int dimensions) {
    double sum = 0;
    for (std::int64_t k = 0; k < count; ++k) {
        double product = 1;
        std::int64_t residue = k;
        for (int d = 0; d < dimensions; ++d) {
            const double x = static_cast<double>(residue) / count;
            product *= 1 + 2 * std::numbers::pi * std::numbers::pi * (x * x - x + 1.0 / 6);
            residue = residue * factor % count;
        }
        sum += product;
    }
    return sum;
}

/// A rank-1 lattice of an odd number of points: on each axis the midpoints of equal strata, and symmetric about 0:
/// the last is the first but one with its signs changed, and so on.
std::vector<RaySample> ray_samples(int count, const Blur& blur) {
    assert(count > 0 && count % 2 == 1);
    std::int64_t best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::int64_t factor = 2; factor <= count / 2; ++factor) {
        constexpr int most_tried = 200;  // near enough to the best of all
        if (factor > most_tried) break;
        const double error = lattice_error(count, factor, blur.dimensions());
        if (error < least) least = error, best = factor;
    }
    std::vector<RaySample> samples;
    for (std::int64_t k = 0; k < count; ++k) {
        std::int64_t residue = k;
        const auto next = [&] {
            const double x = static_cast<double>(residue > count / 2 ? residue - count : residue) / count;
            residue = residue * best % count;
            return x;
        };
        RaySample& sample = samples.emplace_back();
        sample.pixel = {next(), next()};
        if (blur.lens) sample.lens = {next(), next()};
        if (blur.motion) sample.time = next();
    }
    return samples;
}

/// Within ±½ by whole steps.
Eigen::Vector2d wrapped(const Eigen::Vector2d& at) {
    return at - at.array().round().matrix();
}

/// Evenly spread over ±½, another for every pixel and number (the finaliser of MurmurHash3, Appleby 2011).
double scattered(int x, int y, std::uint64_t number) {
    std::uint64_t bits = (static_cast<std::uint64_t>(x) << 34) ^ (static_cast<std::uint64_t>(y) << 4) ^ number;
    bits = (bits ^ (bits >> 33)) * 0xff51afd7ed558ccdULL;
    bits = (bits ^ (bits >> 33)) * 0xc4ceb9fe1a85ec53ULL;
    bits ^= bits >> 33;
    return static_cast<double>(bits >> 11) * 0x1p-53 - 0.5;
}

struct GridPoint {
    double a = 0, b = 0, z = 0;  // cells (or metres) along the sheet; distance along the optical axis
};

/// What a ray may hit: a tag or a card.
class Sheet {
public:
    explicit Sheet(const TagSheet& tag)
        : world_from_sheet_(tag.world_from_tag), pattern_(&tag.pattern), paper_(tag.paper), ink_(tag.ink) {
        const double across = tag.pattern.border_end - tag.pattern.border_begin;
        cell_m_ = tag.size_m / across;
        low_ = {-tag.margin_cells, -tag.margin_cells};
        high_ = {tag.pattern.cells + tag.margin_cells, tag.pattern.cells + tag.margin_cells};
        middle_ = {tag.pattern.cells / 2.0, tag.pattern.cells / 2.0};
    }
    explicit Sheet(const HidingCard& card)
        : world_from_sheet_(card.world_from_card),
          paper_(card.light),
          low_(-card.width_m / 2, -card.height_m / 2),
          high_(card.width_m / 2, card.height_m / 2) {}

    const RigidTransform& world_from_sheet() const { return world_from_sheet_; }

    std::array<Eigen::Vector3d, 4> corners_m() const {
        std::array<Eigen::Vector3d, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) {
            const double a = i % 2 == 0 ? low_.x() : high_.x(), b = i < 2 ? low_.y() : high_.y();
            corners[i] = {(a - middle_.x()) * cell_m_, (middle_.y() - b) * cell_m_, 0};
        }
        return corners;
    }

    /// Where the ray from `origin` along `direction` (camera frame, direction.z = 1) meets the sheet's plane; nullopt
    /// for a tag seen from behind or a plane behind the camera.
    std::optional<GridPoint> hit(const RigidTransform& sheet_from_camera, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& direction) const {
        const Eigen::Vector3d from = sheet_from_camera * origin;
        const Eigen::Vector3d along = sheet_from_camera.linear() * direction;
        if (pattern_ && !(along.z() < 0)) return std::nullopt;
        const double z = -from.z() / along.z();
        if (!(z > 0) || !std::isfinite(z)) return std::nullopt;
        return GridPoint{middle_.x() + (from.x() + z * along.x()) / cell_m_,
                         middle_.y() - (from.y() + z * along.y()) / cell_m_, z};
    }

    bool holds(const GridPoint& at) const {
        return at.a >= low_.x() && at.b >= low_.y() && at.a < high_.x() && at.b < high_.y();
    }
    bool misses(const GridPoint& at, double da, double db) const {
        return at.a + da < low_.x() || at.b + db < low_.y() || at.a - da > high_.x() || at.b - db > high_.y();
    }

    /// Light of a point that the sheet holds.
    double light(const GridPoint& at) const {
        return is_ink(static_cast<int>(std::floor(at.a)), static_cast<int>(std::floor(at.b))) ? ink_ : paper_;
    }

    /// Whether the sheet is of one light everywhere within ±da, ±db of the point, and reaches that far.
    bool even_around(const GridPoint& at, double da, double db) const {
        if (at.a - da < low_.x() || at.b - db < low_.y() || at.a + da >= high_.x() || at.b + db >= high_.y()) {
            return false;
        }
        if (!pattern_) return true;
        const int left = static_cast<int>(std::floor(at.a - da)), right = static_cast<int>(std::floor(at.a + da));
        const int top = static_cast<int>(std::floor(at.b - db)), bottom = static_cast<int>(std::floor(at.b + db));
        const bool first = is_ink(left, top);
        for (int y = top; y <= bottom; ++y) {
            for (int x = left; x <= right; ++x) {
                if (is_ink(x, y) != first) return false;
            }
        }
        return true;
    }

private:
    bool is_ink(int x, int y) const {
        return pattern_ && x >= 0 && y >= 0 && x < pattern_->cells && y < pattern_->cells &&
               pattern_->at(x, y) == TagPattern::black;
    }

    RigidTransform world_from_sheet_;
    const TagPattern* pattern_ = nullptr;  // of a tag
    double paper_ = 0, ink_ = 0;
    double cell_m_ = 1;
    Eigen::Vector2d low_, high_, middle_ = Eigen::Vector2d::Zero();
};

/// sheet_from_camera of every sheet at some times.
using SheetPoses = std::vector<std::vector<RigidTransform>>;

class Caster {
public:
    explicit Caster(const TagView& view)
        : view_(view),
          blur_{view.aperture_m > 0, view.exposure_s > 0},
          samples_(ray_samples(sharp() ? view.rays : (view.rays / 2) | 1, blur_)) {
        for (const TagSheet& tag : view.tags) sheets_.emplace_back(tag);
        for (const HidingCard& card : view.cards) sheets_.emplace_back(card);
        for (const Sheet& sheet : sheets_) reach_.push_back(reach_of(sheet));
        if (view.readout_s == 0) all_rows_ = exposed_at(0);
    }

    ImageF light() const {
        ImageF light(view_.camera.width, view_.camera.height, 1, static_cast<float>(view_.ground));
        parallel_for(light.height(), [&](int y) { cast_row(light, y); });
        return light;
    }

private:
    bool sharp() const { return !blur_.lens && !blur_.motion; }

    /// The poses that a row is exposed with: in the middle of it, at its ends, and at every ray's time.
    struct Exposed {
        SheetPoses ends;  // of each sheet: middle, begin, end
        SheetPoses rays;  // of each sheet: as samples_; one where nothing moves during the exposure
    };

    Exposed exposed_at(double row_time_s) const {
        const auto poses_at = [&](const std::vector<double>& times_s) {
            SheetPoses poses(sheets_.size());
            for (const double time_s : times_s) {
                const RigidTransform world_from_camera = view_.camera_from_world(row_time_s + time_s).inverse();
                for (std::size_t s = 0; s < sheets_.size(); ++s) {
                    poses[s].push_back(sheets_[s].world_from_sheet().inverse() * world_from_camera);
                }
            }
            return poses;
        };
        if (view_.exposure_s == 0) return {poses_at({0}), poses_at({0})};
        std::vector<double> times_s;
        for (const RaySample& sample : samples_) times_s.push_back(view_.exposure_s * sample.time);
        return {poses_at({0, -view_.exposure_s / 2, view_.exposure_s / 2}), poses_at(times_s)};
    }

    /// Pixels that a sheet may reach at any time; the whole frame when it comes behind the camera.
    Region reach_of(const Sheet& sheet) const {
        const Region frame{0, 0, view_.camera.width, view_.camera.height};
        const double span_s = view_.exposure_s + view_.readout_s;
        constexpr int looks = 9;
        Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
        double blur_px = 0;
        for (int i = 0; i < looks; ++i) {
            const RigidTransform camera_from_world = view_.camera_from_world(span_s * (i / (looks - 1.0) - 0.5));
            for (const Eigen::Vector3d& corner : sheet.corners_m()) {
                const Eigen::Vector3d at = camera_from_world * (sheet.world_from_sheet() * corner);
                if (!(at.z() > 1e-3)) return frame;
                const Eigen::Vector2d px = view_.camera.pixel_from_camera(at);
                low = low.cwiseMin(px), high = high.cwiseMax(px);
                blur_px = std::max(
                    blur_px, view_.camera.fx * view_.aperture_m * std::abs(1 / view_.focus_distance_m - 1 / at.z()));
            }
        }
        // Edges that the lens bows, and motion that turns between the looks.
        const Eigen::Vector2d margin = 0.15 * (high - low) + Eigen::Vector2d::Constant(3 + blur_px);
        low = (low - margin).cwiseMax(-1).cwiseMin(1e8), high = (high + margin).cwiseMin(1e8).cwiseMax(-1);
        const int left = static_cast<int>(low.x()), top = static_cast<int>(low.y());
        return Region{left, top, static_cast<int>(high.x()) + 1 - left, static_cast<int>(high.y()) + 1 - top}
            .intersected(frame);
    }

    void cast_row(ImageF& light, int y) const {
        const bool touched = std::ranges::any_of(
            reach_, [&](const Region& region) { return y >= region.y && y < region.y + region.height; });
        if (!touched) return;
        const Exposed own = view_.readout_s == 0 ? Exposed{} : exposed_at(row_time_s(view_, y));
        const Exposed& exposed = view_.readout_s == 0 ? all_rows_ : own;
        std::vector<std::size_t> near;
        for (int x = 0; x < light.width(); ++x) {
            near.clear();
            for (std::size_t s = 0; s < sheets_.size(); ++s) {
                if (reach_[s].contains(x, y)) near.push_back(s);
            }
            if (!near.empty()) light.at(x, y) = static_cast<float>(pixel(x, y, exposed, near));
        }
    }

    /// The ray through a point of the lens (camera frame, m) that focuses on the normalised image point.
    void ray(const Eigen::Vector2d& normalized, const Eigen::Vector2d& lens_m, Eigen::Vector3d& origin,
             Eigen::Vector3d& direction) const {
        origin << lens_m, 0;
        direction << normalized - lens_m / view_.focus_distance_m, 1;
    }

    /// Light where the nearest sheet of those near is hit.
    double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const SheetPoses& poses,
                std::size_t pose, const std::vector<std::size_t>& near) const {
        double nearest = std::numeric_limits<double>::infinity(), light = view_.ground;
        for (const std::size_t s : near) {
            const auto hit = sheets_[s].hit(poses[s][pose], origin, direction);
            if (!hit || hit->z >= nearest || !sheets_[s].holds(*hit)) continue;
            nearest = hit->z;
            light = sheets_[s].light(*hit);
        }
        return light;
    }

    double pixel(int x, int y, const Exposed& exposed, const std::vector<std::size_t>& near) const {
        const Camera& camera = view_.camera;
        const Eigen::Vector2d centre = camera.normalized_from_pixel(Eigen::Vector2d(x, y));
        if (!centre.allFinite()) return view_.ground;
        // Over one pixel the lens is linear to 1e-7 px.
        const Eigen::Vector2d right(0.5 / camera.fx, 0), down(0, 0.5 / camera.fy);
        Eigen::Matrix2d pixels_by_step;
        pixels_by_step << camera.pixel_from_normalized(centre + right) - camera.pixel_from_normalized(centre - right),
            camera.pixel_from_normalized(centre + down) - camera.pixel_from_normalized(centre - down);
        Eigen::Matrix2d jacobian = pixels_by_step.inverse();
        jacobian.row(0) /= camera.fx, jacobian.row(1) /= camera.fy;
        if (even(centre, jacobian, exposed, near)) {
            Eigen::Vector3d origin, direction;
            ray(centre, Eigen::Vector2d::Zero(), origin, direction);
            return cast(origin, direction, exposed.ends, 0, near);
        }
        const auto cast_sample = [&](const Eigen::Vector2d& on_pixel, const Eigen::Vector2d& on_lens,
                                     std::size_t time) {
            Eigen::Vector3d origin, direction;
            ray(centre + jacobian * on_pixel, view_.aperture_m / 2 * on_lens, origin, direction);
            return cast(origin, direction, exposed.rays, view_.exposure_s == 0 ? 0 : time, near);
        };
        double sum = 0;
        if (sharp()) {
            for (const RaySample& sample : samples_) sum += cast_sample(sample.pixel, Eigen::Vector2d::Zero(), 0);
            return sum / static_cast<double>(samples_.size());
        }
        // Steps of light in five dimensions are no smooth function: what the lattice misses is scattered from pixel to
        // pixel by a shift (Cranley & Patterson 1976), and every ray has its mirror image.
        const Eigen::Vector2d pixel_shift(scattered(x, y, 0), scattered(x, y, 1));
        const Eigen::Vector2d lens_shift =
            blur_.lens ? Eigen::Vector2d(scattered(x, y, 2), scattered(x, y, 3)) : Eigen::Vector2d(0, 0);
        for (std::size_t k = 0; k < samples_.size(); ++k) {
            const Eigen::Vector2d on_pixel = wrapped(samples_[k].pixel + pixel_shift);
            const Eigen::Vector2d on_lens = disc_from_square(wrapped(samples_[k].lens + lens_shift));
            sum += cast_sample(on_pixel, on_lens, k) +
                   cast_sample(-on_pixel, -on_lens, (samples_.size() - k) % samples_.size());
        }
        return sum / static_cast<double>(2 * samples_.size());
    }

    /// Whether every ray of the pixel meets the same light: every sheet is either even over what the rays can reach of
    /// it or out of their reach.
    bool even(const Eigen::Vector2d& centre, const Eigen::Matrix2d& jacobian, const Exposed& exposed,
              const std::vector<std::size_t>& near) const {
        for (const std::size_t s : near) {
            Eigen::Vector3d origin, direction;
            ray(centre, Eigen::Vector2d::Zero(), origin, direction);
            const auto middle = sheets_[s].hit(exposed.ends[s][0], origin, direction);
            if (!middle) return false;
            // Corners of the pixel at the ends of the exposure, and of the square around the lens.
            double da = 0, db = 0, lens_a = 0, lens_b = 0;
            for (int i = 0; i < 4; ++i) {
                const Eigen::Vector2d corner(i % 2 == 0 ? -0.5 : 0.5, i < 2 ? -0.5 : 0.5);
                ray(centre + jacobian * corner, Eigen::Vector2d::Zero(), origin, direction);
                for (const RigidTransform& pose : exposed.ends[s]) {
                    const auto hit = sheets_[s].hit(pose, origin, direction);
                    if (!hit) return false;
                    da = std::max(da, std::abs(hit->a - middle->a));
                    db = std::max(db, std::abs(hit->b - middle->b));
                }
                if (view_.aperture_m == 0) continue;
                ray(centre, view_.aperture_m * corner, origin, direction);
                const auto hit = sheets_[s].hit(exposed.ends[s][0], origin, direction);
                if (!hit) return false;
                lens_a = std::max(lens_a, std::abs(hit->a - middle->a));
                lens_b = std::max(lens_b, std::abs(hit->b - middle->b));
            }
            // A tenth more for motion that turns and perspective across the blur.
            da = 1.1 * (da + lens_a), db = 1.1 * (db + lens_b);
            if (!sheets_[s].misses(*middle, da, db) && !sheets_[s].even_around(*middle, da, db)) return false;
        }
        return true;
    }

    const TagView& view_;
    Blur blur_;
    std::vector<RaySample> samples_;
    std::vector<Sheet> sheets_;
    std::vector<Region> reach_;
    Exposed all_rows_;
};

}  // namespace

ImageF reference_light(const TagView& view) {
    return Caster(view).light();
}

double row_time_s(const TagView& view, double row_px) {
    if (view.readout_s == 0) return 0;
    const double last = view.camera.height - 1;
    return view.readout_s * (row_px / last - 0.5);
}

Eigen::Matrix<double, 2, 4> reference_corners_px(const TagView& view, const TagSheet& tag) {
    const Eigen::Matrix<double, 3, 4> corners_m = tag_corners_m(tag.size_m);
    Eigen::Matrix<double, 2, 4> corners;
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector3d world = tag.world_from_tag * Eigen::Vector3d(corners_m.col(i));
        // The row decides the time, and the time the row; rows move far slower than the shutter does.
        double time_s = 0;
        constexpr int rounds = 20;
        for (int round = 0; round < rounds; ++round) {
            corners.col(i) = view.camera.pixel_from_camera(view.camera_from_world(time_s) * world);
            time_s = row_time_s(view, corners(1, i));
        }
    }
    return corners;
}

namespace {

/// r² of a pixel, 1 at the corners of the frame.
double corner_radius2(int x, int y, int width, int height) {
    const double cx = (width - 1) / 2.0, cy = (height - 1) / 2.0;
    return ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (cx * cx + cy * cy);
}

}  // namespace

Image8 recorded_picture(const ImageF& light, const Recording& recording) {
    Image8 picture(light.width(), light.height(), 3);
    parallel_for(light.height(), [&](int y) {
        std::seed_seq seeds{recording.seed, static_cast<unsigned>(y)};
        std::mt19937_64 random(seeds);
        std::normal_distribution<double> normal;
        for (int x = 0; x < light.width(); ++x) {
            const double r2 = corner_radius2(x, y, light.width(), light.height());
            const double gain =
                std::exp2(recording.exposure_ev) * (1 + recording.vignette[0] * r2 + recording.vignette[1] * r2 * r2);
            for (int channel = 0; channel < 3; ++channel) {
                const double signal =
                    light.at(x, y) * gain * recording.white_balance[static_cast<std::size_t>(channel)];
                const double spread = std::sqrt(recording.read_noise * recording.read_noise +
                                                recording.shot_noise * std::max(signal, 0.0));
                double code = recording.response.code_from_linear(signal + spread * normal(random), channel);
                code = 255 * code + recording.code_noise * normal(random);
                picture.at(x, y, channel) = static_cast<std::uint8_t>(std::lround(std::clamp(code, 0.0, 255.0)));
            }
        }
    });
    return picture;
}

PlateFrame recorded_frame(const Image8& picture, std::int64_t index, double time_s) {
    std::shared_ptr<AVFrame> samples = allocated_frame(picture.width(), picture.height(), AV_PIX_FMT_RGB24);
    for (int y = 0; y < picture.height(); ++y) {
        std::ranges::copy(picture.row(y), samples->data[0] + static_cast<std::ptrdiff_t>(y) * samples->linesize[0]);
    }
    PlateFormat format = plate_format_of(*samples, 0, {}, "recorded");
    return {std::move(samples), std::move(format), index, time_s};
}

}  // namespace matchlight
