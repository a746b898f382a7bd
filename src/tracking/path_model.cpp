// Kalman filters over camera poses, the noise level chosen frame by frame.
#include "tracking/path_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace matchlight {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Exp(ε)·T: a perturbation on the camera's side is the adjoint of one on the world's.
Matrix6 camera_side_from_world_side(const RigidTransform& camera_from_world) {
    const Eigen::Matrix3d rotation = camera_from_world.linear();
    const Eigen::Vector3d t = camera_from_world.translation();
    Matrix6 adjoint = Matrix6::Zero();
    adjoint.topLeftCorner<3, 3>() = rotation;
    adjoint.bottomRightCorner<3, 3>() = rotation;
    adjoint.bottomLeftCorner<3, 3>() = cross_matrix(t) * rotation;
    return adjoint;
}

/// One frame on the reference path: measured poses, and straight lines between them where there is none.
struct Knot {
    double elapsed_s = 0;  // since the knot before
    RigidTransform reference = RigidTransform::Identity();
    Matrix6 adjoint = Matrix6::Identity();    // camera side from world side
    Matrix6 transport = Matrix6::Identity();  // of perturbations at the knot before
    Vector6 motion = Vector6::Zero();         // since the knot before, on the camera's side
    bool measured = false;
    Matrix6 covariance = Matrix6::Identity();  // of the measurement, on the camera's side
};

struct NoiseLevel {
    double turn = 0,
           shift = 0;  // power spectral density of the highest derivative, rad² and m², a second to some power
};

/// How a level departs from the clip's own: powers of ten of the spectral density; the last is a cut.
constexpr std::array<double, 5> level_decades{-4, -2, 0, 2, 4};
constexpr std::size_t cut = level_decades.size(), level_count = level_decades.size() + 1;
/// Levels last for seconds: a change is an event of one frame in fifty.
constexpr double change_cost = 4;

/// State: pose perturbation at the knot, velocity, and with three orders acceleration.
template <int orders>
class PathFilter {
public:
    static constexpr int size = 6 * orders;
    using State = Eigen::Matrix<double, size, 1>;
    using Spread = Eigen::Matrix<double, size, size>;

    struct Belief {
        State mean = State::Zero();
        Spread covariance = Spread::Zero();
    };
    struct Step {
        Belief predicted, updated;
        double cost = 0;  // −log probability of the measurement
    };

    explicit PathFilter(const std::vector<Knot>& knots) : knots_(knots) {}

    static Belief unknown() {
        // Anything a camera can do: metres, turns, and speeds of tens of both.
        Belief belief;
        belief.covariance.diagonal().template head<6>().setConstant(1);
        for (int order = 1; order < orders; ++order) {
            belief.covariance.diagonal().template segment<6>(6 * order).setConstant(std::pow(100.0, order));
        }
        return belief;
    }

    Step first() const {
        Step step;
        step.predicted = unknown();
        update(knots_.front(), step);
        step.cost = 0;
        return step;
    }

    Spread transition(const Knot& knot) const {
        Spread matrix = Spread::Identity();
        matrix.template topLeftCorner<6, 6>() = knot.transport;
        double factor = 1;
        for (int order = 1; order < orders; ++order) {
            factor *= knot.elapsed_s / order;
            for (int row = 0; row + order < orders; ++row) {
                matrix.template block<6, 6>(6 * row, 6 * (row + order)).diagonal().setConstant(factor);
            }
        }
        return matrix;
    }

    Step next(std::size_t k, const Belief& before, const NoiseLevel& noise, std::size_t level) const {
        const Knot& knot = knots_[k];
        Step step;
        const Spread f = transition(knot);
        step.predicted.mean = f * before.mean;
        step.predicted.mean.template head<6>() -= knot.motion;
        step.predicted.covariance = f * before.covariance * f.transpose();
        add_noise(knot.elapsed_s, noise, level, step.predicted.covariance);
        update(knot, step);
        return step;
    }

    /// −log probability of all measurements at one level.
    double cost(const NoiseLevel& noise) const {
        Step step = first();
        double sum = 0;
        for (std::size_t k = 1; k < knots_.size(); ++k) {
            step = next(k, step.updated, noise, 2);
            sum += step.cost;
        }
        return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
    }

    /// The best level of every frame.
    std::vector<std::size_t> levels(const NoiseLevel& noise, double& cost) const {
        struct Survivor {
            Step step;
            double cost = 0;
        };
        std::array<Survivor, level_count> survivors, extended;
        for (Survivor& survivor : survivors) survivor.step = first();
        std::vector<std::array<std::size_t, level_count>> origins(knots_.size());
        for (std::size_t k = 1; k < knots_.size(); ++k) {
            const std::size_t leader = leader_of(survivors);
            for (std::size_t level = 0; level < level_count; ++level) {
                Survivor& best = extended[level];
                best.cost = std::numeric_limits<double>::infinity();
                // A change pays the same wherever it comes from: from the leader, then.
                for (const std::size_t from : {level, leader}) {
                    Survivor candidate{next(k, survivors[from].step.updated, noise, level), 0};
                    candidate.cost = survivors[from].cost + candidate.step.cost + (from == level ? 0 : change_cost);
                    if (!(candidate.cost < best.cost)) continue;
                    best = candidate;
                    origins[k][level] = from;
                }
            }
            std::swap(survivors, extended);
        }
        std::size_t level = leader_of(survivors);
        cost = survivors[level].cost;
        std::vector<std::size_t> result(knots_.size());
        for (std::size_t k = knots_.size(); k-- > 0;) {
            result[k] = level;
            level = origins[k][level];
        }
        return result;
    }

    /// Every state from all measurements.
    std::vector<Belief> smooth(const NoiseLevel& noise, double& cost) const {
        const std::vector<std::size_t> chosen = levels(noise, cost);
        std::vector<Step> path{first()};
        for (std::size_t k = 1; k < knots_.size(); ++k) path.push_back(next(k, path.back().updated, noise, chosen[k]));
        std::vector<Belief> beliefs(knots_.size());
        beliefs.back() = path.back().updated;
        for (std::size_t k = knots_.size() - 1; k-- > 0;) {
            const Belief& filtered = path[k].updated;
            const Belief& predicted = path[k + 1].predicted;
            const Spread gain =
                predicted.covariance.ldlt().solve(transition(knots_[k + 1]) * filtered.covariance).transpose();
            beliefs[k].mean = filtered.mean + gain * (beliefs[k + 1].mean - predicted.mean);
            const Spread spread =
                filtered.covariance + gain * (beliefs[k + 1].covariance - predicted.covariance) * gain.transpose();
            beliefs[k].covariance = 0.5 * (spread + spread.transpose());
        }
        return beliefs;
    }

private:
    template <class Survivors>
    static std::size_t leader_of(const Survivors& survivors) {
        const auto best = std::ranges::min_element(survivors, {}, [](const auto& survivor) { return survivor.cost; });
        return static_cast<std::size_t>(best - survivors.begin());
    }

    static void add_noise(double elapsed_s, const NoiseLevel& noise, std::size_t level, Spread& covariance) {
        if (level == cut) {
            covariance += unknown().covariance;
            return;
        }
        const double factor = std::pow(10.0, level_decades[level]);
        // White noise integrated: ∫ s^(p+q) / (p! q!) ds, p and q the orders below the highest.
        constexpr std::array<double, 3> factorial{1, 1, 2};
        for (int a = 0; a < orders; ++a) {
            for (int b = 0; b < orders; ++b) {
                const int p = orders - 1 - a, q = orders - 1 - b;
                const double integral =
                    std::pow(elapsed_s, p + q + 1) /
                    ((p + q + 1) * factorial[static_cast<std::size_t>(p)] * factorial[static_cast<std::size_t>(q)]);
                auto block = covariance.template block<6, 6>(6 * a, 6 * b).diagonal();
                block.template head<3>().array() += factor * noise.turn * integral;
                block.template tail<3>().array() += factor * noise.shift * integral;
            }
        }
    }

    static void update(const Knot& knot, Step& step) {
        step.updated = step.predicted;
        if (!knot.measured) return;
        const Belief& predicted = step.predicted;
        const Matrix6 expected = predicted.covariance.template topLeftCorner<6, 6>() + knot.covariance;
        const Eigen::LLT<Matrix6> factor(expected);
        const Vector6 innovation = -predicted.mean.template head<6>();
        const Eigen::Matrix<double, size, 6> gain =
            factor.solve(predicted.covariance.template topRows<6>()).transpose();
        step.updated.mean += gain * innovation;
        // Joseph's form: stays positive where velocities were unknown.
        Spread left = Spread::Identity();
        left.template leftCols<6>() -= gain;
        step.updated.covariance =
            left * predicted.covariance * left.transpose() + gain * knot.covariance * gain.transpose();
        step.cost = factor.info() == Eigen::Success ? 0.5 * innovation.dot(factor.solve(innovation)) +
                                                          factor.matrixLLT().diagonal().array().log().sum()
                                                    : std::numeric_limits<double>::infinity();
    }

    const std::vector<Knot>& knots_;
};

std::vector<Knot> knots_between(const std::vector<PathMeasurement>& measurements, std::size_t first, std::size_t last) {
    std::vector<Knot> knots(last - first + 1);
    std::size_t before = first;
    for (std::size_t f = first; f <= last; ++f) {
        Knot& knot = knots[f - first];
        const PathMeasurement& measurement = measurements[f];
        knot.measured = measurement.camera_from_world.has_value();
        if (knot.measured) {
            knot.reference = *measurement.camera_from_world;
            before = f;
        } else {
            std::size_t after = f;
            while (!measurements[after].camera_from_world) ++after;
            const RigidTransform& start = *measurements[before].camera_from_world;
            const double share = (measurement.time_s - measurements[before].time_s) /
                                 std::max(measurements[after].time_s - measurements[before].time_s, 1e-9);
            knot.reference =
                perturbed(start, share * perturbation_between(start, *measurements[after].camera_from_world));
        }
        knot.adjoint = camera_side_from_world_side(knot.reference);
        knot.covariance = knot.adjoint * measurement.covariance * knot.adjoint.transpose();
        if (f == first) continue;
        const Knot& previous = knots[f - first - 1];
        knot.elapsed_s = std::max(measurement.time_s - measurements[f - 1].time_s, 1e-6);
        const RigidTransform step = knot.reference * previous.reference.inverse();
        const Eigen::AngleAxisd turn(step.linear());
        knot.motion << turn.angle() * turn.axis(), step.translation();
        knot.transport = camera_side_from_world_side(step);
    }
    return knots;
}

struct NoiseChoice {
    NoiseLevel noise;
    double cost = std::numeric_limits<double>::infinity();
};

/// Most probable noise by a search in ever finer factors over turn and shift.
template <int orders>
NoiseChoice most_probable_noise(const std::vector<Knot>& knots) {
    const PathFilter<orders> filter(knots);
    NoiseChoice best;
    // From a tripod's creep to a fall: decades of the density, jerk higher than acceleration by the square of a rate.
    const double lowest = orders == 3 ? -6 : -8, highest = orders == 3 ? 6 : 4;
    for (double decade = lowest; decade <= highest; decade += 2) {
        const NoiseLevel noise{std::pow(10, decade), std::pow(10, decade)};
        const double cost = filter.cost(noise);
        if (cost < best.cost) best = {noise, cost};
    }
    for (double factor = 10; factor > 1.5; factor = std::sqrt(factor)) {
        for (bool better = true; better;) {
            better = false;
            for (const auto& [turn, shift] :
                 {std::pair{factor, 1.0}, {1 / factor, 1.0}, {1.0, factor}, {1.0, 1 / factor}}) {
                const NoiseLevel noise{best.noise.turn * turn, best.noise.shift * shift};
                // Far below any motion nothing changes any more.
                if (noise.turn < 1e-12 || noise.shift < 1e-12) continue;
                const double cost = filter.cost(noise);
                if (cost < best.cost - 1e-6) {
                    best = {noise, cost};
                    better = true;
                }
            }
        }
    }
    return best;
}

/// The longest stretch the noise is estimated from, in frames: ten seconds tell how a camera is held.
constexpr std::size_t longest_stretch = 250;

template <int orders>
void fill(const std::vector<Knot>& knots, const NoiseLevel& noise, std::size_t first, SmoothPath& path, double& cost) {
    const auto beliefs = PathFilter<orders>(knots).smooth(noise, cost);
    for (std::size_t k = 0; k < knots.size(); ++k) {
        const Matrix6 world_side = knots[k].adjoint.inverse();
        SmoothPath::Pose& pose = path.poses[first + k].emplace();
        pose.camera_from_world = perturbed(knots[k].reference, world_side * beliefs[k].mean.template head<6>());
        const Matrix6 covariance =
            world_side * beliefs[k].covariance.template topLeftCorner<6, 6>() * world_side.transpose();
        pose.covariance = 0.5 * (covariance + covariance.transpose());
    }
}

}  // namespace

SmoothPath smooth_path(const std::vector<PathMeasurement>& measurements) {
    SmoothPath path;
    path.poses.resize(measurements.size());
    std::vector<std::size_t> measured;
    for (std::size_t f = 0; f < measurements.size(); ++f) {
        if (measurements[f].camera_from_world) measured.push_back(f);
    }
    for (const std::size_t f : measured) {
        path.poses[f] = SmoothPath::Pose{*measurements[f].camera_from_world, measurements[f].covariance};
    }
    constexpr std::size_t fewest = 4;  // three explain any velocity and acceleration
    if (measured.size() < fewest) return path;
    const std::size_t first = measured.front();
    const std::vector<Knot> knots = knots_between(measurements, first, measured.back());
    const std::size_t begin = knots.size() > longest_stretch ? (knots.size() - longest_stretch) / 2 : 0;
    const std::vector<Knot> stretch(
        knots.begin() + static_cast<std::ptrdiff_t>(begin),
        knots.begin() + static_cast<std::ptrdiff_t>(std::min(knots.size(), begin + longest_stretch)));
    const NoiseChoice acceleration = most_probable_noise<2>(stretch), jerk = most_probable_noise<3>(stretch);
    double cost_a = 0, cost_j = 0;
    SmoothPath other = path;
    fill<2>(knots, acceleration.noise, first, path, cost_a);
    fill<3>(knots, jerk.noise, first, other, cost_j);
    return cost_j < cost_a ? other : path;
}

}  // namespace matchlight
