// Levenberg-Marquardt on the nine parameters of two crossing blurred edges.
#include "calibration/saddle.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Parameters = Eigen::Matrix<double, 9, 1>;
using Normal = Eigen::Matrix<double, 9, 9>;

// Order of the parameters.
enum Parameter { centre_x, centre_y, angle_1, angle_2, log_blur, level, gain, slope_x, slope_y };

/// Narrower windows hold too few pixels for nine parameters; wider ones only add the lens's bending of the edges.
constexpr double least_radius_px = 2.5, most_radius_px = 12;

struct Sample {
    Vector2d px;  // from the guess
    double light;
};

std::vector<Sample> gather(const ImageF& light, const SaddleGuess& guess, double radius_m) {
    const Eigen::Matrix2d board_from_px = guess.px_from_board.inverse();
    const double reach_px = (guess.px_from_board.cwiseAbs() * Vector2d::Constant(radius_m)).maxCoeff();
    std::vector<Sample> samples;
    if (!guess.px.allFinite() || !(reach_px < 4 * most_radius_px)) return samples;
    const int left = static_cast<int>(std::ceil(guess.px.x() - reach_px));
    const int right = static_cast<int>(std::floor(guess.px.x() + reach_px));
    const int top = static_cast<int>(std::ceil(guess.px.y() - reach_px));
    const int bottom = static_cast<int>(std::floor(guess.px.y() + reach_px));
    if (left < 0 || top < 0 || right >= light.width() || bottom >= light.height()) return samples;
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) {
            const Vector2d offset = Vector2d(x, y) - guess.px;
            if ((board_from_px * offset).cwiseAbs().maxCoeff() > radius_m) continue;
            samples.push_back({offset, light.at(x, y)});
        }
    }
    return samples;
}

/// The light that the parameters predict, and its derivatives.
double predict(const Parameters& p, const Vector2d& px, Parameters& derivative) {
    const double blur = std::exp(p[log_blur]);
    const Vector2d from_centre = px - Vector2d(p[centre_x], p[centre_y]);
    const auto edge = [&](double angle, double& value, double& slope, Vector2d& normal, double& along) {
        normal = {std::cos(angle), std::sin(angle)};
        const double t = normal.dot(from_centre) / blur;
        along = -normal.y() * from_centre.x() + normal.x() * from_centre.y();
        value = std::erf(t / std::numbers::sqrt2);
        slope = std::sqrt(2 / std::numbers::pi) * std::exp(-t * t / 2) / blur;  // by the distance
        return t;
    };
    double e1 = 0, e2 = 0, s1 = 0, s2 = 0, along1 = 0, along2 = 0;
    Vector2d n1, n2;
    const double t1 = edge(p[angle_1], e1, s1, n1, along1);
    const double t2 = edge(p[angle_2], e2, s2, n2, along2);
    const Vector2d by_place = p[gain] * (s1 * e2 * n1 + e1 * s2 * n2);
    derivative[centre_x] = -by_place.x() - p[slope_x];
    derivative[centre_y] = -by_place.y() - p[slope_y];
    derivative[angle_1] = p[gain] * s1 * along1 * e2;
    derivative[angle_2] = p[gain] * s2 * along2 * e1;
    derivative[log_blur] = -p[gain] * blur * (s1 * t1 * e2 + e1 * s2 * t2);
    derivative[level] = 1;
    derivative[gain] = e1 * e2;
    derivative[slope_x] = from_centre.x();
    derivative[slope_y] = from_centre.y();
    return p[level] + p[slope_x] * from_centre.x() + p[slope_y] * from_centre.y() + p[gain] * e1 * e2;
}

double sum_of_squares(const Parameters& p, const std::vector<Sample>& samples) {
    double sum = 0;
    Parameters unused;
    for (const Sample& sample : samples) {
        const double residual = sample.light - predict(p, sample.px, unused);
        sum += residual * residual;
    }
    return sum;
}

void normal_equations(const Parameters& p, const std::vector<Sample>& samples, Normal& normal, Parameters& right) {
    normal.setZero();
    right.setZero();
    Parameters derivative;
    for (const Sample& sample : samples) {
        const double residual = sample.light - predict(p, sample.px, derivative);
        normal.noalias() += derivative * derivative.transpose();
        right.noalias() += derivative * residual;
    }
}

/// Level and gain enter linearly: from the guessed geometry they are known at once.
void start_light(Parameters& p, const std::vector<Sample>& samples) {
    p[level] = 0;
    p[gain] = 1;
    double sum_e = 0, sum_ee = 0, sum_l = 0, sum_el = 0;
    Parameters derivative;
    for (const Sample& sample : samples) {
        predict(p, sample.px, derivative);
        const double e = derivative[gain];
        sum_e += e;
        sum_ee += e * e;
        sum_l += sample.light;
        sum_el += e * sample.light;
    }
    const double n = static_cast<double>(samples.size());
    const double determinant = n * sum_ee - sum_e * sum_e;
    p[gain] = determinant > 0 ? (n * sum_el - sum_e * sum_l) / determinant : 0;
    p[level] = (sum_l - p[gain] * sum_e) / n;
}

double angle_of_normal(const Vector2d& direction) {
    return std::atan2(direction.x(), -direction.y());
}

}  // namespace

std::optional<Saddle> fit_saddle(const ImageF& light, const SaddleGuess& guess) {
    const double scale_px = std::sqrt(std::abs(guess.px_from_board.determinant()));
    if (!(scale_px > 0)) return std::nullopt;
    const double radius_px = std::clamp(guess.radius_m * scale_px, least_radius_px, most_radius_px);
    const std::vector<Sample> samples = gather(light, guess, radius_px / scale_px);
    constexpr std::size_t least_samples = 16;
    if (samples.size() < least_samples) return std::nullopt;

    Parameters p = Parameters::Zero();
    p[angle_1] = angle_of_normal(guess.px_from_board.col(0));
    p[angle_2] = angle_of_normal(guess.px_from_board.col(1));
    start_light(p, samples);
    if (p[gain] == 0) return std::nullopt;

    double cost = sum_of_squares(p, samples);
    double damping = 1e-3;
    constexpr int most_steps = 40;
    constexpr double converged_px = 1e-5;
    Normal normal;
    Parameters right;
    for (int i = 0; i < most_steps; ++i) {
        normal_equations(p, samples, normal, right);
        Normal damped = normal;
        damped.diagonal() *= 1 + damping;
        damped.diagonal().array() += 1e-12;
        const Parameters step = damped.ldlt().solve(right);
        Parameters next = p + step;
        next[log_blur] = std::clamp(next[log_blur], std::log(0.2), std::log(most_radius_px));
        const double next_cost = step.allFinite() ? sum_of_squares(next, samples) : cost;
        if (next_cost < cost) {
            p = next;
            cost = next_cost;
            damping = std::max(1e-9, damping / 10);
            if (step.head<2>().norm() < converged_px) break;
        } else {
            damping *= 10;
            if (damping > 1e6) break;
        }
    }

    const Vector2d shift(p[centre_x], p[centre_y]);
    // A crossing elsewhere is another corner; edges that fell together are no crossing.
    if (shift.norm() > std::max(0.5 * radius_px, 1.5) || std::abs(std::sin(p[angle_1] - p[angle_2])) < 0.1) {
        return std::nullopt;
    }
    const double n = static_cast<double>(samples.size());
    Saddle saddle;
    saddle.px = guess.px + shift;
    saddle.contrast = 2 * std::abs(p[gain]);
    saddle.blur_px = std::exp(p[log_blur]);
    saddle.residual = std::sqrt(cost / n) / std::max(saddle.contrast, 1e-12);
    normal_equations(p, samples, normal, right);
    normal.diagonal().array() += 1e-12;
    const Normal inverse = normal.ldlt().solve(Normal::Identity());
    saddle.sigma_px = std::sqrt(std::max(0.0, cost / std::max(1.0, n - 9) * (inverse(0, 0) + inverse(1, 1)) / 2));
    // A fifth of the contrast unexplained is another pattern, a pixel of doubt no measurement.
    if (!(saddle.sigma_px < 1) || saddle.residual > 0.2) return std::nullopt;
    return saddle;
}

}  // namespace matchlight
