// Finds a ball in a photograph and its outline to a fraction of a pixel.
#include "lighting/ball_outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/median.h"
#include "core/parallel.h"

namespace matchlight {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
/// Of some two hundred circles proposed in clutter the best has a significance of 7 to 8.
constexpr double least_significance = 9;
/// Edges nearer than this to the outline lie on it while it is still being found.
constexpr double consensus_px = 0.75;

/// Logarithms of light, in which an edge is as strong in the shade as in the sun.
cv::Mat log_light(const ImageF& radiance) {
    std::vector<double> values;
    for (std::size_t i = 0; i < radiance.samples().size(); i += 3 * 17) values.push_back(radiance.samples()[i + 1]);
    const double median = values.empty() ? 1 : upper_median(values);
    // A twentieth of the middle is added, so that noise in the dark makes no edges, and beyond sixteen times the middle
    // one lamp is like another.
    const float lift = static_cast<float>(std::max(median, 1e-12) / 20), most = static_cast<float>(16 * median);
    cv::Mat result(radiance.height(), radiance.width(), CV_32FC3);
    for (int y = 0; y < radiance.height(); ++y) {
        auto* row = result.ptr<float>(y);
        const auto from = radiance.row(y);
        for (std::size_t i = 0; i < from.size(); ++i) row[i] = std::log2(std::min(from[i], most) + lift);
    }
    return result;
}

/// A frame about the axis: columns u, v and axis.
Eigen::Matrix3d frame_about(const Eigen::Vector3d& axis) {
    Eigen::Matrix3d frame;
    const Eigen::Vector3d across = std::abs(axis.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    frame.col(0) = (across - across.dot(axis) * axis).normalized();
    frame.col(1) = axis.cross(frame.col(0));
    frame.col(2) = axis;
    return frame;
}

Eigen::Vector2d outline_pixel(const Camera& camera, const Eigen::Matrix3d& frame, double half_angle, double turn) {
    const Eigen::Vector3d ray = frame * Eigen::Vector3d(std::sin(half_angle) * std::cos(turn),
                                                        std::sin(half_angle) * std::sin(turn), std::cos(half_angle));
    return camera.pixel_from_camera(ray);
}

/// An edge across the outline: where along the outward normal (pixels from the outline) and how strong.
struct Edge {
    int profile = 0;
    double offset_px = 0;
    double strength = 0;
};

/// The outline of one candidate, with the edges around it.
class OutlineFit {
public:
    OutlineFit(const cv::Mat& light, const Camera& camera, const BallOutline& start)
        : light_(light), camera_(camera), outline_(start) {
        const double around = two_pi * start.radius_px(camera);
        profiles_ = static_cast<int>(std::clamp(around / 2, 48.0, 720.0));
    }

    /// From a proposal of Hough's transform, which is off by a few per cent, to where most edges lie. False when there
    /// is nothing to follow.
    bool settle() {
        gather(std::max(4.0, 0.1 * outline_.radius_px(camera_)));
        if (!move_to_consensus()) return false;
        gather(4);
        return step();
    }

    /// Onto the edges. False when they end.
    bool refine() {
        for (int round = 0; round < 8; ++round) {
            gather(4);
            if (!step()) return false;
        }
        return true;
    }

    const BallOutline& outline() const { return outline_; }

private:
    float sample(const Eigen::Vector2d& at, int channel) const {
        const double x = std::clamp(at.x(), 0.0, light_.cols - 1.001), y = std::clamp(at.y(), 0.0, light_.rows - 1.001);
        const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
        const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
        const auto get = [&](int px, int py) { return light_.ptr<float>(py)[3 * px + channel]; };
        return (get(x0, y0) * (1 - fx) + get(x0 + 1, y0) * fx) * (1 - fy) +
               (get(x0, y0 + 1) * (1 - fx) + get(x0 + 1, y0 + 1) * fx) * fy;
    }

    void gather(double reach_px) {
        constexpr double step_px = 0.25;
        const int half = static_cast<int>(std::ceil(reach_px / step_px));
        // The derivative of a Gaussian of one pixel, as far as it matters.
        constexpr int kernel_half = 10;
        const Eigen::Matrix3d frame = frame_about(outline_.axis);
        edges_.clear();
        in_frame_ = 0;
        band_px_ = reach_px;
        std::vector<double> slope;
        std::vector<std::array<float, 3>> values;
        for (int i = 0; i < profiles_; ++i) {
            const double turn = two_pi * i / profiles_;
            const Eigen::Vector2d at = outline_pixel(camera_, frame, outline_.half_angle, turn);
            const Eigen::Vector2d outward = normal_at(frame, turn);
            const auto inside = [&](const Eigen::Vector2d& p) {
                return p.x() >= 0 && p.y() >= 0 && p.x() <= light_.cols - 1 && p.y() <= light_.rows - 1;
            };
            if (!inside(at + 2 * outward) || !inside(at - 2 * outward)) continue;
            ++in_frame_;
            values.clear();
            for (int s = -half - kernel_half; s <= half + kernel_half; ++s) {
                const Eigen::Vector2d p = at + s * step_px * outward;
                values.push_back({sample(p, 0), sample(p, 1), sample(p, 2)});
            }
            slope.assign(static_cast<std::size_t>(2 * half + 1), 0);
            for (int s = 0; s <= 2 * half; ++s) {
                std::array<double, 3> sum{};
                for (int k = -kernel_half; k <= kernel_half; ++k) {
                    const double distance = k * step_px;
                    const double weight = distance * std::exp(-distance * distance / 2);
                    const auto& value = values[static_cast<std::size_t>(s + kernel_half + k)];
                    for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * value[c];
                }
                slope[static_cast<std::size_t>(s)] = std::hypot(sum[0], sum[1], sum[2]);
            }
            for (int s = 1; s < 2 * half; ++s) {
                const double before = slope[static_cast<std::size_t>(s - 1)], here = slope[static_cast<std::size_t>(s)],
                             after = slope[static_cast<std::size_t>(s + 1)];
                if (here < before || here <= after) continue;
                const double bend = before - 2 * here + after;
                const double part = bend < 0 ? 0.5 * (before - after) / bend : 0;
                edges_.push_back({i, (s - half + part) * step_px, here});
            }
        }
        // Grain makes edges too: what is weaker than a fifth of the strongest tenth is left out.
        if (edges_.empty()) return;
        std::vector<double> strengths;
        strengths.reserve(edges_.size());
        for (const Edge& edge : edges_) strengths.push_back(edge.strength);
        const auto tenth = strengths.begin() + static_cast<std::ptrdiff_t>(strengths.size() * 9 / 10);
        std::nth_element(strengths.begin(), tenth, strengths.end());
        const double least = *tenth / 5;
        std::erase_if(edges_, [least](const Edge& edge) { return edge.strength < least; });
    }

    Eigen::Vector2d normal_at(const Eigen::Matrix3d& frame, double turn) const {
        constexpr double small = 1e-4;
        const Eigen::Vector2d along = outline_pixel(camera_, frame, outline_.half_angle, turn + small) -
                                      outline_pixel(camera_, frame, outline_.half_angle, turn - small);
        Eigen::Vector2d normal(along.y(), -along.x());
        normal.normalize();
        const Eigen::Vector2d wider = outline_pixel(camera_, frame, outline_.half_angle * (1 + small), turn) -
                                      outline_pixel(camera_, frame, outline_.half_angle, turn);
        return normal.dot(wider) < 0 ? Eigen::Vector2d(-normal) : normal;
    }

    /// How far the outline moves along its normal with a turn of the axis about v and u and with the half angle.
    Eigen::Vector3d derivative(const Eigen::Matrix3d& frame, double turn, const Eigen::Vector2d& normal) const {
        constexpr double small = 1e-5;
        Eigen::Vector3d result;
        const Eigen::Vector2d here = outline_pixel(camera_, frame, outline_.half_angle, turn);
        for (int k = 0; k < 2; ++k) {
            Eigen::Matrix3d turned = frame;
            turned.col(2) = (frame.col(2) + small * frame.col(k)).normalized();
            turned.col(k) = (frame.col(k) - small * frame.col(2)).normalized();
            result[k] = normal.dot(outline_pixel(camera_, turned, outline_.half_angle, turn) - here) / small;
        }
        result[2] = normal.dot(outline_pixel(camera_, frame, outline_.half_angle + small, turn) - here) / small;
        return result;
    }

    void move(const Eigen::Vector3d& by) {
        const Eigen::Matrix3d frame = frame_about(outline_.axis);
        outline_.axis = (outline_.axis + by[0] * frame.col(0) + by[1] * frame.col(1)).normalized();
        outline_.half_angle = std::clamp(outline_.half_angle + by[2], 1e-6, 1.5);
    }

    std::vector<Eigen::Vector3d> derivatives() const {
        const Eigen::Matrix3d frame = frame_about(outline_.axis);
        std::vector<Eigen::Vector3d> result;
        for (int i = 0; i < profiles_; ++i) {
            const double turn = two_pi * i / profiles_;
            result.push_back(derivative(frame, turn, normal_at(frame, turn)));
        }
        return result;
    }

    /// Moves the outline to where most profiles have an edge: shifts are tried on a grid, and for each the offsets that
    /// remain vote for the radius. First over the whole band, then finely around the best.
    bool move_to_consensus() {
        if (edges_.size() < 12) return false;
        const Eigen::Matrix3d frame = frame_about(outline_.axis);
        std::vector<Eigen::Vector2d> normals;
        for (int i = 0; i < profiles_; ++i) normals.push_back(normal_at(frame, two_pi * i / profiles_));
        constexpr int half_steps = 6;
        Eigen::Vector2d shift = Eigen::Vector2d::Zero();
        double wider = 0;
        int most = 0;
        constexpr double finest_px = consensus_px / 2;
        for (double step = std::max(finest_px, band_px_ / half_steps);; step = std::max(finest_px, step / 4)) {
            const Eigen::Vector2d middle = shift;
            // A vote's bin is as wide as the step blurs it.
            const double bin_px = 2 * step;
            const int bins = static_cast<int>(std::ceil(4 * band_px_ / bin_px)) + 2;
            for (int j = -half_steps; j <= half_steps; ++j) {
                for (int i = -half_steps; i <= half_steps; ++i) {
                    const Eigen::Vector2d trial = middle + step * Eigen::Vector2d(i, j);
                    const auto [count, radius] = vote(normals, trial, bin_px, bins);
                    if (count > most) most = count, shift = trial, wider = radius;
                }
            }
            if (step <= finest_px) break;
            most = 0;  // narrower bins hold fewer
        }
        if (most < 12) return false;
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        const auto by = derivatives();
        for (std::size_t i = 0; i < normals.size(); ++i) {
            squares += by[i] * by[i].transpose();
            right += by[i] * (wider + normals[i].dot(shift));
        }
        move(squares.ldlt().solve(right));
        return true;
    }

    /// How many profiles have an edge within a bin of one radius, and which.
    std::pair<int, double> vote(const std::vector<Eigen::Vector2d>& normals, const Eigen::Vector2d& shift,
                                double bin_px, int bins) const {
        std::vector<int> count(static_cast<std::size_t>(bins), 0), last(static_cast<std::size_t>(bins), -1);
        for (const Edge& edge : edges_) {
            const double radius = edge.offset_px - normals[static_cast<std::size_t>(edge.profile)].dot(shift);
            const int bin = static_cast<int>(std::floor(radius / bin_px)) + bins / 2;
            if (bin < 0 || bin >= bins) continue;
            const auto at = static_cast<std::size_t>(bin);
            if (last[at] == edge.profile) continue;
            last[at] = edge.profile;
            ++count[at];
        }
        const auto best = std::ranges::max_element(count) - count.begin();
        return {count[static_cast<std::size_t>(best)], (static_cast<double>(best - bins / 2) + 0.5) * bin_px};
    }

    /// One step of least squares with Tukey's weights over the edge nearest to the outline in each profile.
    bool step() {
        std::vector<const Edge*> nearest(static_cast<std::size_t>(profiles_), nullptr);
        for (const Edge& edge : edges_) {
            const Edge*& kept = nearest[static_cast<std::size_t>(edge.profile)];
            if (kept == nullptr || std::abs(edge.offset_px) < std::abs(kept->offset_px)) kept = &edge;
        }
        const auto by = derivatives();
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Vector3d right = Eigen::Vector3d::Zero();
        constexpr double reach = 2 * consensus_px;
        double squares = 0, weights = 0;
        int on_it = 0;
        for (std::size_t i = 0; i < nearest.size(); ++i) {
            if (nearest[i] == nullptr || std::abs(nearest[i]->offset_px) >= reach) continue;
            const double share = nearest[i]->offset_px / reach;
            const double weight = (1 - share * share) * (1 - share * share);
            normal += weight * by[i] * by[i].transpose();
            right += weight * nearest[i]->offset_px * by[i];
            squares += weight * nearest[i]->offset_px * nearest[i]->offset_px;
            weights += weight;
            if (std::abs(nearest[i]->offset_px) < consensus_px) ++on_it;
        }
        if (on_it < 12) return false;
        move(normal.ldlt().solve(right));
        outline_.rms_px = std::sqrt(squares / weights);
        outline_.support = static_cast<double>(on_it) / profiles_;
        outline_.significance = significance(on_it);
        outline_.share_in_frame = static_cast<double>(in_frame_) / profiles_;
        outline_.sigma_px = outline_.rms_px / std::sqrt(weights);
        return true;
    }

    /// By how many standard deviations more profiles have an edge on the outline than beside it: what large and small
    /// circles, quiet and noisy pictures can be compared by.
    double significance(int on_it) const {
        constexpr std::array<double, 4> beside_px = {-3.25, -2.25, 2.25, 3.25};
        double met = 0;
        for (const double offset : beside_px) {
            int last = -1;
            for (const Edge& edge : edges_) {
                if (edge.profile == last || std::abs(edge.offset_px - offset) > consensus_px) continue;
                last = edge.profile;
                met += 1;
            }
        }
        const double beside = met / static_cast<double>(beside_px.size()) / profiles_;
        // Edges that keep their distance from each other leave gaps beside one of them: no less than the whole band's
        // density at random.
        const double density = static_cast<double>(edges_.size()) / (std::max(in_frame_, 1) * 2 * band_px_);
        const double chance = std::clamp(std::max(beside, 1 - std::exp(-density * 2 * consensus_px)), 0.02, 0.98);
        return (on_it - chance * profiles_) / std::sqrt(chance * (1 - chance) * profiles_);
    }

    const cv::Mat& light_;
    const Camera& camera_;
    BallOutline outline_;
    int profiles_ = 0;
    int in_frame_ = 0;
    double band_px_ = 1;
    std::vector<Edge> edges_;
};

BallOutline outline_from_circle(const Camera& camera, const OutlineCircle& circle) {
    // The mean of the rays opposite each other on the rim; exact enough to start from.
    BallOutline outline;
    const auto ray = [&](double x, double y) {
        return Eigen::Vector3d(camera.normalized_from_pixel({x, y}).homogeneous().normalized());
    };
    const Eigen::Vector2d c = circle.centre_px;
    const Eigen::Vector3d left = ray(c.x() - circle.radius_px, c.y()), right = ray(c.x() + circle.radius_px, c.y());
    outline.axis = (left + right).normalized();
    outline.half_angle = std::atan2(left.cross(right).norm(), left.dot(right)) / 2;
    return outline;
}

/// What is round within the ball is a reflection: of a horizon, of another ball.
bool encloses(const BallOutline& outer, const BallOutline& inner) {
    const double between = std::acos(std::clamp(outer.axis.dot(inner.axis), -1.0, 1.0));
    return outer.half_angle > 1.02 * inner.half_angle && between + inner.half_angle < 1.1 * outer.half_angle;
}

std::vector<OutlineCircle> proposed_circles(const cv::Mat& light) {
    cv::Mat grey, small;
    cv::transform(light, grey, cv::Matx13f(1.F / 3, 1.F / 3, 1.F / 3));
    // Ball photographs are made to show the ball: 640 pixels are enough to propose it.
    const double scale = std::min(1.0, 640.0 / std::max(light.cols, light.rows));
    cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
    const double side = std::min(small.cols, small.rows);
    std::vector<OutlineCircle> result;
    // As it is, and with the shadows, where noise makes edges too, held back.
    for (const bool shadows : {true, false}) {
        cv::Mat eight;
        if (!shadows) {
            const double middle = std::exp2(cv::mean(small)[0]);
            small.forEach<float>([middle](float& value, const int*) {
                value = static_cast<float>(std::log2(std::exp2(static_cast<double>(value)) + 2 * middle));
            });
        }
        double least = 0, most = 0;
        cv::minMaxLoc(small, &least, &most);
        // Ten stops about the middle hold every outline; a lamp beyond must not squeeze them.
        const double middle = cv::mean(small)[0];
        least = std::max(least, middle - 5), most = std::min(most, middle + 5);
        const double gain = 255 / std::max(most - least, 1e-6);
        small.convertTo(eight, CV_8U, gain, -least * gain);
        cv::GaussianBlur(eight, eight, {}, 1);
        // A range of radii at a time: the transform keeps one circle a centre, and the ball's own reflections have
        // others.
        for (double radius = std::min(8.0, side / 4); radius < 0.55 * side; radius *= 1.6) {
            std::vector<cv::Vec3f> circles;
            cv::HoughCircles(eight, circles, cv::HOUGH_GRADIENT, 1.5, std::max(4.0, radius / 2), 60, 12,
                             static_cast<int>(radius), static_cast<int>(std::ceil(radius * 1.7)));
            for (std::size_t i = 0; i < std::min<std::size_t>(circles.size(), 16); ++i) {
                // A pixel of the small picture stands for 1/scale of the large one's; centres at whole numbers.
                result.push_back({{(circles[i][0] + 0.5) / scale - 0.5, (circles[i][1] + 0.5) / scale - 0.5},
                                  circles[i][2] / scale});
            }
        }
    }
    return result;
}

}  // namespace

Eigen::Vector2d BallOutline::pixel_at(const Camera& camera, double turn) const {
    return outline_pixel(camera, frame_about(axis), half_angle, turn);
}

double BallOutline::radius_px(const Camera& camera) const {
    const Eigen::Vector2d middle = camera.pixel_from_camera(axis);
    double sum = 0;
    constexpr int turns = 32;
    for (int i = 0; i < turns; ++i) sum += (pixel_at(camera, two_pi * i / turns) - middle).norm();
    return sum / turns;
}

BallOutline find_ball(const ImageF& radiance, const Camera& camera, const std::optional<OutlineCircle>& given,
                      const std::filesystem::path& reported) {
    const cv::Mat light = log_light(radiance);
    const std::vector<OutlineCircle> circles = given ? std::vector<OutlineCircle>{*given} : proposed_circles(light);
    // Most proposals are clutter: only the better ones are worth refining.
    std::vector<std::optional<BallOutline>> settled(circles.size());
    parallel_for(static_cast<int>(circles.size()), [&](int i) {
        const BallOutline start = outline_from_circle(camera, circles[static_cast<std::size_t>(i)]);
        if (!(start.half_angle > 0)) return;
        OutlineFit fit(light, camera, start);
        if (fit.settle()) settled[static_cast<std::size_t>(i)] = fit.outline();
    });
    std::vector<BallOutline> outlines;
    for (const auto& outline : settled) {
        if (outline) outlines.push_back(*outline);
    }
    std::ranges::stable_sort(outlines, std::greater<>(), &BallOutline::significance);
    constexpr std::size_t refined = 24;
    outlines.resize(std::min(outlines.size(), refined));
    // A reflected horizon close inside the rim may draw the proposal to itself: the neighbourhood is looked at too.
    parallel_for(static_cast<int>(outlines.size()), [&](int i) {
        BallOutline& outline = outlines[static_cast<std::size_t>(i)];
        for (const double factor : {0.94, 1.03, 1.06, 1.1}) {
            BallOutline start = outline;
            start.half_angle *= factor;
            OutlineFit fit(light, camera, start);
            if (fit.settle() && fit.outline().significance > outline.significance) outline = fit.outline();
        }
    });
    std::erase_if(outlines, [&](BallOutline& outline) {
        OutlineFit fit(light, camera, outline);
        if (!fit.refine()) return true;
        outline = fit.outline();
        return false;
    });
    std::ranges::stable_sort(outlines, std::greater<>(), &BallOutline::significance);
    std::optional<BallOutline> best;
    for (const BallOutline& outline : outlines) {
        if (!best || (outline.significance > 0.75 * best->significance && encloses(outline, *best))) best = outline;
    }
    if (!best || best->significance < least_significance) {
        throw InputError(
            reported,
            fmt::format("no ball: looked for a circle that more edges lie on than chance explains; the best "
                        "of {} has {:.1f} standard deviations more, not {:.0f}",
                        circles.size(), best ? best->significance : 0, least_significance),
            "give its circle by hand: --circle X,Y,RADIUS in pixels");
    }
    if (best->share_in_frame < 0.98) {
        throw InputError(
            reported,
            fmt::format("the frame cuts the ball: {:.0f} % of its outline lie inside", 100 * best->share_in_frame),
            "photograph the whole ball");
    }
    return *best;
}

}  // namespace matchlight
