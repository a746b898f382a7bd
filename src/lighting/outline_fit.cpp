// Fits the outline of a ball, robustly, to the edges across it in a picture.
#include "lighting/outline_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

namespace matchlight {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
/// Edges nearer than this to the outline lie on it while it is still being found.
constexpr double consensus_px = 0.75;

}  // namespace

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

OutlineFit::OutlineFit(const cv::Mat& light, const Camera& camera, const BallOutline& start)
    : light_(light), camera_(camera), outline_(start) {
    const double around = two_pi * start.radius_px(camera);
    profiles_ = static_cast<int>(std::clamp(around / 2, 48.0, 720.0));
}

bool OutlineFit::settle() {
    gather(std::max(4.0, 0.1 * outline_.radius_px(camera_)));
    if (!move_to_consensus()) return false;
    gather(4);
    return step();
}

bool OutlineFit::refine() {
    for (int round = 0; round < 8; ++round) {
        gather(4);
        if (!step()) return false;
    }
    return true;
}

float OutlineFit::sample(const Eigen::Vector2d& at, int channel) const {
    const double x = std::clamp(at.x(), 0.0, light_.cols - 1.001), y = std::clamp(at.y(), 0.0, light_.rows - 1.001);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
    const auto fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
    const auto get = [&](int px, int py) { return light_.ptr<float>(py)[3 * px + channel]; };
    return (get(x0, y0) * (1 - fx) + get(x0 + 1, y0) * fx) * (1 - fy) +
           (get(x0, y0 + 1) * (1 - fx) + get(x0 + 1, y0 + 1) * fx) * fy;
}

void OutlineFit::gather(double reach_px) {
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
    for (const OutlineEdge& edge : edges_) strengths.push_back(edge.strength);
    const auto tenth = strengths.begin() + static_cast<std::ptrdiff_t>(strengths.size() * 9 / 10);
    std::nth_element(strengths.begin(), tenth, strengths.end());
    const double least = *tenth / 5;
    std::erase_if(edges_, [least](const OutlineEdge& edge) { return edge.strength < least; });
}

Eigen::Vector2d OutlineFit::normal_at(const Eigen::Matrix3d& frame, double turn) const {
    constexpr double small = 1e-4;
    const Eigen::Vector2d along = outline_pixel(camera_, frame, outline_.half_angle, turn + small) -
                                  outline_pixel(camera_, frame, outline_.half_angle, turn - small);
    Eigen::Vector2d normal(along.y(), -along.x());
    normal.normalize();
    const Eigen::Vector2d wider = outline_pixel(camera_, frame, outline_.half_angle * (1 + small), turn) -
                                  outline_pixel(camera_, frame, outline_.half_angle, turn);
    return normal.dot(wider) < 0 ? Eigen::Vector2d(-normal) : normal;
}

Eigen::Vector3d OutlineFit::derivative(const Eigen::Matrix3d& frame, double turn, const Eigen::Vector2d& normal) const {
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

void OutlineFit::move(const Eigen::Vector3d& by) {
    const Eigen::Matrix3d frame = frame_about(outline_.axis);
    outline_.axis = (outline_.axis + by[0] * frame.col(0) + by[1] * frame.col(1)).normalized();
    outline_.half_angle = std::clamp(outline_.half_angle + by[2], 1e-6, 1.5);
}

std::vector<Eigen::Vector3d> OutlineFit::derivatives() const {
    const Eigen::Matrix3d frame = frame_about(outline_.axis);
    std::vector<Eigen::Vector3d> result;
    for (int i = 0; i < profiles_; ++i) {
        const double turn = two_pi * i / profiles_;
        result.push_back(derivative(frame, turn, normal_at(frame, turn)));
    }
    return result;
}

bool OutlineFit::move_to_consensus() {
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

std::pair<int, double> OutlineFit::vote(const std::vector<Eigen::Vector2d>& normals, const Eigen::Vector2d& shift,
                                        double bin_px, int bins) const {
    std::vector<int> count(static_cast<std::size_t>(bins), 0), last(static_cast<std::size_t>(bins), -1);
    for (const OutlineEdge& edge : edges_) {
        const double radius = edge.offset_px - normals[static_cast<std::size_t>(edge.profile)].dot(shift);
        const int bin = static_cast<int>(std::floor(radius / bin_px)) + bins / 2;
        if (bin < 0 || bin >= bins) continue;
        const auto at = static_cast<std::size_t>(bin);
        if (last[at] == edge.profile) continue;
        last[at] = edge.profile;
        ++count[at];
    }
    const auto best = std::ranges::max_element(count) - count.begin();
    const auto from_middle = best - bins / 2;
    return {count[static_cast<std::size_t>(best)], (static_cast<double>(from_middle) + 0.5) * bin_px};
}

bool OutlineFit::step() {
    std::vector<const OutlineEdge*> nearest(static_cast<std::size_t>(profiles_), nullptr);
    for (const OutlineEdge& edge : edges_) {
        const OutlineEdge*& kept = nearest[static_cast<std::size_t>(edge.profile)];
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

double OutlineFit::significance(int on_it) const {
    constexpr std::array<double, 4> beside_px = {-3.25, -2.25, 2.25, 3.25};
    double met = 0;
    for (const double offset : beside_px) {
        int last = -1;
        for (const OutlineEdge& edge : edges_) {
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

}  // namespace matchlight
