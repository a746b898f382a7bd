// Solvers of free response curves.
#include "calibration/response_curve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/median.h"

namespace matchlight {
namespace {

/// Where a code lies between nodes.
struct Place {
    std::size_t node;
    double part;
};

Place place_of(float code) {
    const double at = std::clamp(static_cast<double>(code), 0.0, 1.0) * (curve_nodes - 1);
    const auto node = std::min(static_cast<std::size_t>(at), static_cast<std::size_t>(curve_nodes - 2));
    return {node, at - static_cast<double>(node)};
}

double value_at(const LogCurve& curve, float code) {
    const Place place = place_of(code);
    return curve[place.node] + place.part * (curve[place.node + 1] - curve[place.node]);
}

/// Debevec & Malik's weight of a code, of 1 in the middle.
double hat(float code, float full) {
    const double at = static_cast<double>(code) / full;
    return std::clamp(2 * std::min(at, 1 - at), 0.0, 1.0);
}

struct Observation {
    float code;
    double log_exposure, weight;
};

/// The usable codes of a place.
std::vector<Observation> observations_of(const ResponseSamples& samples, std::size_t place, int channel) {
    std::vector<Observation> observations;
    for (std::size_t j = 0; j < samples.photographs(); ++j) {
        if (!samples.usable(place, j, channel)) continue;
        const float code = samples.code(place, j, channel);
        observations.push_back({code, samples.log_exposure(j), hat(code, samples.full_code())});
    }
    return observations;
}

/// Weighted root mean square of what a place's photographs contradict one another by; negative where fewer than two
/// are usable.
double contradiction(const std::vector<Observation>& observations, const LogCurve& curve) {
    double weight = 0, sum = 0, squares = 0;
    for (const Observation& seen : observations) {
        const double radiance = value_at(curve, seen.code) - seen.log_exposure;
        weight += seen.weight;
        sum += seen.weight * radiance;
        squares += seen.weight * radiance * radiance;
    }
    if (observations.size() < 2 || !(weight > 0)) return -1;
    const double mean = sum / weight;
    return std::sqrt(std::max(0.0, squares / weight - mean * mean));
}

/// Sum over nodes of (change of slope)²/Δu, u the logarithm of the code: the integral of the squared second derivative
/// against u. A fiftieth of the codes is added, below which cameras' curves are straight.
Eigen::MatrixXd roughness() {
    const auto u = [](int node) { return std::log(static_cast<double>(node) / (curve_nodes - 1) + 0.02); };
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(curve_nodes, curve_nodes);
    for (int k = 1; k + 1 < curve_nodes; ++k) {
        const double before = u(k) - u(k - 1), after = u(k + 1) - u(k), both = 0.5 * (before + after);
        const Eigen::Vector3d difference(1 / before, -1 / before - 1 / after, 1 / after);
        sum.block<3, 3>(k - 1, k - 1) += difference * difference.transpose() / both;
    }
    return sum;
}

/// The nearest curve that never falls (pool adjacent violators; Barlow et al., Statistical Inference under Order
/// Restrictions, 1972), then with a least rise, so that it has an inverse.
LogCurve made_monotone(const Eigen::VectorXd& curve) {
    struct Pool {
        double sum;
        int count;
        double mean() const { return sum / count; }
    };
    std::vector<Pool> pools;
    for (const double value : curve) {
        pools.push_back({value, 1});
        while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
            const Pool last = pools.back();
            pools.pop_back();
            pools.back().sum += last.sum;
            pools.back().count += last.count;
        }
    }
    constexpr double least_rise = 1e-5;  // of light from code to code: a thousandth of what any camera's curve has
    LogCurve rising;
    for (const Pool& pool : pools) {
        for (int i = 0; i < pool.count; ++i)
            rising.push_back(rising.empty() ? pool.mean() : std::max(pool.mean(), rising.back() + least_rise));
    }
    return rising;
}

/// Adds a place to the least squares of the paper, its radiance eliminated.
void add_place(const std::vector<Observation>& observations, double place_weight, CurveEquations& equations) {
    double weight = 0, exposure = 0;
    struct Term {
        Eigen::Index node;
        double value;
    };
    std::vector<Term> sums;
    for (const Observation& seen : observations) {
        const double w = place_weight * seen.weight;
        const Place place = place_of(seen.code);
        const auto node = static_cast<Eigen::Index>(place.node);
        const Eigen::Vector2d basis(1 - place.part, place.part);
        equations.matrix.block<2, 2>(node, node) += w * basis * basis.transpose();
        equations.right.segment<2>(node) += w * seen.log_exposure * basis;
        sums.push_back({node, w * basis[0]});
        sums.push_back({node + 1, w * basis[1]});
        weight += w;
        exposure += w * seen.log_exposure;
    }
    if (!(weight > 0)) return;
    for (const Term& a : sums) {
        for (const Term& b : sums) equations.matrix(a.node, b.node) -= a.value * b.value / weight;
        equations.right[a.node] -= a.value * exposure / weight;
    }
}

CurveEquations no_equations() {
    return {Eigen::MatrixXd::Zero(curve_nodes, curve_nodes), Eigen::VectorXd::Zero(curve_nodes)};
}

bool counts(const ResponseSamples& samples, std::size_t place, double weight, Places places) {
    return weight > 0 && (places == Places::all || !samples.held_out(place));
}

/// For deciding which places count, and as a start: bends over a quarter of the logarithm of the code.
constexpr double middling_smoothness = 1;

std::vector<double> weights_by(const ResponseSamples& samples, int channel, const LogCurve& curve) {
    std::vector<double> contradictions(samples.places()), known;
    for (std::size_t place = 0; place < samples.places(); ++place) {
        contradictions[place] = contradiction(observations_of(samples, place, channel), curve);
        if (contradictions[place] >= 0) known.push_back(contradictions[place]);
    }
    // Tukey's biweight ends at 4.685 deviations; the median of a half-normal distribution lies at 0.6745. Half a
    // percent of light is what rounding alone contradicts.
    const double reach = known.empty() ? 1 : 4.685 * std::max(upper_median(known) / 0.6745, 0.005);
    std::vector<double> weights;
    for (const double value : contradictions) {
        const double t = value / reach;
        weights.push_back(value < 0 || t >= 1 ? 0 : (1 - t * t) * (1 - t * t));
    }
    return weights;
}

/// The codes and exposures of one place, for Robertson's rounds.
struct Seen {
    std::size_t node;
    double exposure, weight;
};

}  // namespace

LogCurve smooth_curve(const CurveEquations& equations, double smoothness) {
    static const Eigen::MatrixXd rough = roughness();
    Eigen::MatrixXd all = equations.matrix + smoothness * std::max(equations.matrix.diagonal().mean(), 1e-12) * rough;
    // Curves differ by a constant: the middle code's light is 1. Weak, for those that have a scale already.
    constexpr Eigen::Index middle = curve_nodes / 2;
    all(middle, middle) += 1e-6 * all.diagonal().mean();
    return made_monotone(all.ldlt().solve(equations.right));
}

std::vector<double> place_weights(const ResponseSamples& samples, int channel) {
    // In the first round everything counts: there is no curve yet to judge by. A few settle it.
    std::vector<double> weights(samples.places(), 1);
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
        const CurveEquations equations = debevec_equations(samples, channel, weights, Places::all);
        weights = weights_by(samples, channel, smooth_curve(equations, middling_smoothness));
    }
    return weights;
}

CurveEquations debevec_equations(const ResponseSamples& samples, int channel, const std::vector<double>& weights,
                                 Places places) {
    CurveEquations equations = no_equations();
    for (std::size_t place = 0; place < samples.places(); ++place) {
        if (counts(samples, place, weights[place], places))
            add_place(observations_of(samples, place, channel), weights[place], equations);
    }
    return equations;
}

CurveEquations robertson_equations(const ResponseSamples& samples, int channel, const std::vector<double>& weights,
                                   Places places) {
    std::vector<std::vector<Seen>> seen_places;
    for (std::size_t place = 0; place < samples.places(); ++place) {
        if (!counts(samples, place, weights[place], places)) continue;
        std::vector<Seen> seen;
        for (const Observation& observation : observations_of(samples, place, channel)) {
            const double at = 2 * observation.code / samples.full_code() - 1;
            seen.push_back({static_cast<std::size_t>(std::lround(observation.code * (curve_nodes - 1))),
                            std::exp(observation.log_exposure - samples.log_exposure(0)), std::exp(-4 * at * at)});
        }
        seen_places.push_back(std::move(seen));
    }
    std::vector<double> light, seen_often(curve_nodes, 0);
    for (const double value : smooth_curve(debevec_equations(samples, channel, weights, places), middling_smoothness))
        light.push_back(std::exp(value));
    constexpr int most_rounds = 200;
    for (int round = 0; round < most_rounds; ++round) {
        std::vector<double> sums(curve_nodes, 0);
        std::fill(seen_often.begin(), seen_often.end(), 0);
        for (const std::vector<Seen>& place : seen_places) {
            double above = 0, below = 0;
            for (const Seen& seen : place) {
                above += seen.weight * seen.exposure * light[seen.node];
                below += seen.weight * seen.exposure * seen.exposure;
            }
            for (const Seen& seen : place) {
                sums[seen.node] += seen.exposure * above / below;
                seen_often[seen.node] += 1;
            }
        }
        // Curves differ by a factor: the middle code, or the next that was seen, keeps its light.
        double scale = 1;
        for (std::size_t k = curve_nodes / 2; k < curve_nodes; ++k) {
            if (seen_often[k] == 0) continue;
            scale = light[k] * seen_often[k] / sums[k];
            break;
        }
        double change = 0;
        for (std::size_t k = 0; k < curve_nodes; ++k) {
            if (seen_often[k] == 0) continue;
            const double next = scale * sums[k] / seen_often[k];
            change = std::max(change, std::abs(next - light[k]) / light[k]);
            light[k] = next;
        }
        if (change < 1e-5) break;
    }
    CurveEquations equations = no_equations();
    for (std::size_t k = 0; k < curve_nodes; ++k) {
        const auto node = static_cast<Eigen::Index>(k);
        const double weight = seen_often[k] * hat(static_cast<float>(k) / (curve_nodes - 1), samples.full_code());
        equations.matrix(node, node) = weight;
        equations.right[node] = weight * std::log(light[k]);
    }
    return equations;
}

}  // namespace matchlight
