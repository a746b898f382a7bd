// The back's rotation is searched from coarse to fine over smoothed logarithms of light; its gain is a median.
#include "lighting/fisheye_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "lighting/halved_image.h"

namespace matchlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;

Matrix3d turned_upright(const FisheyePicture& picture, const Matrix3d& upright_from_pair) {
    // A picture that is upright after a clockwise turn shows everything turned the other way (y is down).
    return Eigen::AngleAxisd(-picture.upright_deg * degree, Vector3d::UnitZ()).toRotationMatrix() * upright_from_pair;
}

Matrix3d rotation_of(const Vector3d& vector) {
    const double angle = vector.norm();
    return angle > 0 ? Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix() : Matrix3d::Identity();
}

double focal_of(const FisheyePicture& picture) {
    return std::sqrt(picture.lens.focal_px.x() * picture.lens.focal_px.y());
}

/// Mean logarithm of the three channels within the round picture, times how much of a pixel lies in it, and that share:
/// two channels that can be averaged. Of logarithms a gain of each channel is one constant, whatever the colours.
ImageF log_light(const FisheyePicture& picture) {
    const ImageF& light = picture.light;
    double sum = 0;
    for (const float sample : light.samples()) sum += sample;
    // What is darker than a thousandth of the mean is as good as black: its logarithm is that of noise.
    const double floor = std::max(1e-30, 1e-3 * sum / static_cast<double>(light.samples().size()));
    const double rim = picture.lens.radius_of(picture.lens.most_angle);
    ImageF result(light.width(), light.height(), 2);
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            const Vector2d from_centre = (Vector2d(x, y) - picture.lens.centre_px).cwiseQuotient(picture.lens.focal_px);
            if (from_centre.norm() > rim - 1 / focal_of(picture)) continue;
            double logarithm = 0;
            for (int c = 0; c < 3; ++c) {
                logarithm += std::log2(std::max<double>(light.at(x, y, c), floor)) / 3;
            }
            result.at(x, y, 0) = static_cast<float>(logarithm);
            result.at(x, y, 1) = 1;
        }
    }
    return result;
}

/// The smoothed log light of a picture, looked up by direction.
class LogPyramid {
public:
    explicit LogPyramid(const FisheyePicture& picture) : picture_(picture), levels_{log_light(picture)} {
        constexpr int smallest = 16;
        while (std::min(levels_.back().width(), levels_.back().height()) > smallest) {
            const ImageF& last = levels_.back();
            levels_.push_back(halved(last, (last.width() + 1) / 2, (last.height() + 1) / 2));
        }
    }

    /// The level whose pixels are about so many radians wide.
    int level_of(double radians) const {
        const int level = static_cast<int>(std::lround(std::log2(std::max(1.0, radians * focal_of(picture_)))));
        return std::clamp(level, 0, static_cast<int>(levels_.size()) - 1);
    }

    /// NaN outside the round picture.
    double at(int level, const Vector3d& direction) const {
        const std::optional<Vector2d> px = picture_.lens.pixel_from_direction(direction);
        if (!px) return std::numeric_limits<double>::quiet_NaN();
        const ImageF& image = levels_[static_cast<std::size_t>(level)];
        const double scale = std::ldexp(1.0, -level);
        // Pixel centres at whole numbers on every level.
        const Vector2d at = ((px->array() + 0.5) * scale - 0.5).matrix();
        const double left = std::floor(at.x()), top = std::floor(at.y()), u = at.x() - left, v = at.y() - top;
        double sum = 0, weight = 0;
        for (int i = 0; i < 4; ++i) {
            const int x = static_cast<int>(left) + i % 2, y = static_cast<int>(top) + i / 2;
            if (!image.bounds().contains(x, y)) continue;
            const double tap = (i % 2 == 1 ? u : 1 - u) * (i / 2 == 1 ? v : 1 - v);
            sum += tap * image.at(x, y, 0);
            weight += tap * image.at(x, y, 1);
        }
        // Less than half a pixel's worth of picture is its rim.
        return weight > 0.5 ? sum / weight : std::numeric_limits<double>::quiet_NaN();
    }

private:
    const FisheyePicture& picture_;
    std::vector<ImageF> levels_;
};

/// Directions of the ring that both pictures see, in the pair's axes.
std::vector<Vector3d> ring_directions(const FisheyePicture& front, const FisheyePicture& back) {
    const double low = std::numbers::pi - back.lens.most_angle, high = front.lens.most_angle;
    // Ten thousand points tell a turn to a hundredth of a degree, and are quick.
    constexpr int around = 720, across = 14;
    std::vector<Vector3d> directions;
    for (int i = 0; i < around; ++i) {
        const double azimuth = 2 * std::numbers::pi * i / around;
        for (int j = 0; j < across; ++j) {
            const double angle = low + (high - low) * (j + 0.5) / across;
            directions.emplace_back(std::sin(angle) * std::cos(azimuth), std::cos(angle),
                                    std::sin(angle) * std::sin(azimuth));
        }
    }
    return directions;
}

double median_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

class TurnSearch {
public:
    TurnSearch(const FisheyePicture& front, const FisheyePicture& back)
        : front_light_(front),
          back_light_(back),
          front_from_pair_(front_from_pair(front)),
          back_from_pair_(back_from_pair(back)),
          ring_(ring_directions(front, back)) {}

    /// Mean |log2| of back over front at the smoothing of `radians`, apart from a common gain; infinite where they
    /// share too little.
    double difference(const Vector3d& turn, double radians) const {
        const int front_level = front_light_.level_of(radians), back_level = back_light_.level_of(radians);
        const Matrix3d back_from_turned = back_from_pair_ * rotation_of(turn);
        std::vector<double> steps;
        for (const Vector3d& direction : ring_) {
            const double step = back_light_.at(back_level, back_from_turned * direction) -
                                front_light_.at(front_level, front_from_pair_ * direction);
            if (std::isfinite(step)) steps.push_back(step);
        }
        if (4 * steps.size() < ring_.size()) return std::numeric_limits<double>::infinity();
        const double middle = median_of(steps);
        double sum = 0;
        for (const double step : steps) sum += std::abs(step - middle);
        return sum / static_cast<double>(steps.size());
    }

    /// Steps along the three axes, halved where none helps (Hooke & Jeeves 1961); what is compared is as smooth as the
    /// step is long.
    Vector3d best(double most_turn, double finest) const {
        Vector3d turn = Vector3d::Zero();
        for (double step = 2 * degree; step > finest; step /= 2) {
            double least = difference(turn, step);
            for (bool better = true; better;) {
                better = false;
                for (int axis = 0; axis < 3; ++axis) {
                    for (const double way : {-step, step}) {
                        Vector3d tried = turn;
                        tried[axis] += way;
                        if (tried.norm() > most_turn) continue;
                        const double difference_there = difference(tried, step);
                        if (difference_there >= least) continue;
                        least = difference_there;
                        turn = tried;
                        better = true;
                    }
                }
            }
        }
        return turn;
    }

private:
    LogPyramid front_light_, back_light_;
    Matrix3d front_from_pair_, back_from_pair_;
    std::vector<Vector3d> ring_;
};

/// What the back's channels must be multiplied by: medians over the ring.
Vector3d gain_of(const FisheyePicture& front, const FisheyePicture& back, const Matrix3d& back_from_turned) {
    const SphereView front_view = view_of(front, front_from_pair(front), 1);
    const SphereView back_view = view_of(back, back_from_turned, 1);
    std::array<std::vector<double>, 3> ratios;
    for (const Vector3d& direction : ring_directions(front, back)) {
        const ViewPoint a = front_view.look(front_view.view_from_world * direction);
        const ViewPoint b = back_view.look(back_view.view_from_world * direction);
        if (a.weight <= 0 || b.weight <= 0) continue;
        const Vector3d front_light = light_at(front_view, a.px), back_light = light_at(back_view, b.px);
        for (int c = 0; c < 3; ++c) {
            if (front_light[c] > 0 && back_light[c] > 0) {
                ratios[static_cast<std::size_t>(c)].push_back(std::log(front_light[c] / back_light[c]));
            }
        }
    }
    Vector3d gain = Vector3d::Ones();
    constexpr std::size_t fewest = 100;
    for (int c = 0; c < 3; ++c) {
        std::vector<double>& channel = ratios[static_cast<std::size_t>(c)];
        if (channel.size() >= fewest) gain[c] = std::exp(median_of(channel));
    }
    return gain;
}

}  // namespace

Matrix3d front_from_pair(const FisheyePicture& front) {
    Matrix3d axes;  // rows: the picture's right, down and forward
    axes << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    return turned_upright(front, axes);
}

Matrix3d back_from_pair(const FisheyePicture& back) {
    Matrix3d axes;
    axes << -1, 0, 0, 0, 0, -1, 0, -1, 0;
    return turned_upright(back, axes);
}

PairMatch match_pair(const FisheyePicture& front, const FisheyePicture& back, const MatchOptions& options) {
    PairMatch match;
    match.overlap_deg = (front.lens.most_angle + back.lens.most_angle - std::numbers::pi) / degree;
    constexpr double narrowest_deg = 1;  // a narrower ring is the pictures' rims, which tell nothing
    if (match.overlap_deg < narrowest_deg) return match;
    const TurnSearch search(front, back);
    // The two are compared at a smoothing that both turns can be judged by.
    constexpr double judged_at = 0.5 * degree;
    match.difference_before_ev = match.difference_ev = search.difference(Vector3d::Zero(), judged_at);
    if (options.turn) {
        // Thousands of pixels tell a turn far better than one does.
        const double part_of_px = 0.03 / std::min(focal_of(front), focal_of(back));
        const Vector3d turn = search.best(options.most_turn_deg * degree, part_of_px);
        const double difference = search.difference(turn, judged_at);
        // A ring without detail agrees as well at any turn.
        constexpr double clearly_less = 0.98;
        if (difference < clearly_less * match.difference_before_ev) {
            match.turn_rad = turn;
            match.difference_ev = difference;
            match.turned = true;
        }
    }
    if (options.gain) {
        match.back_gain = gain_of(front, back, back_from_pair(back) * rotation_of(match.turn_rad));
    }
    return match;
}

SphereView view_of(const FisheyePicture& picture, const Matrix3d& view_from_world, double blend) {
    SphereView view;
    view.light = &picture.light;
    view.clipped = picture.clipped.empty() ? nullptr : &picture.clipped;
    view.view_from_world = view_from_world;
    view.px_per_radian = picture.lens.focal_px.maxCoeff() * finest_scale(picture.lens);
    // The rim's own pixel is partly frame.
    const double rim = picture.lens.most_angle - 1 / focal_of(picture);
    const double right = picture.light.width() - 1, bottom = picture.light.height() - 1;
    view.look = [&lens = picture.lens, rim, blend, right, bottom](const Vector3d& direction) {
        const double angle = std::acos(std::clamp(direction.z(), -1.0, 1.0));
        if (angle > rim) return ViewPoint{};
        const std::optional<Vector2d> px = lens.pixel_from_direction(direction);
        if (!px || px->x() < 0 || px->y() < 0 || px->x() > right || px->y() > bottom) return ViewPoint{};
        constexpr double least = 1e-6;  // what one picture alone sees at its rim is seen all the same
        return ViewPoint{*px, std::clamp((rim - angle) / blend, least, 1.0)};
    };
    return view;
}

StitchedSphere stitched_pair(const FisheyePicture& front, const FisheyePicture* back, const PairMatch& match,
                             const Matrix3d& world_from_pair, int height) {
    const Matrix3d pair_from_world = world_from_pair.transpose();
    // Over the whole ring: halfway both count the same.
    const double blend = std::max(match.overlap_deg, 0.5) * degree;
    std::vector<SphereView> views = {view_of(front, front_from_pair(front) * pair_from_world, blend)};
    if (back != nullptr) {
        views.push_back(view_of(*back, back_from_pair(*back) * rotation_of(match.turn_rad) * pair_from_world, blend));
        views.back().gain = match.back_gain;
    }
    return stitched_sphere(views, height);
}

int latlong_height_for(const FisheyePicture& picture) {
    return std::max(2, static_cast<int>(std::lround(std::numbers::pi * focal_of(picture))));
}

}  // namespace matchlight
