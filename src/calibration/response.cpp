// The response curves and their inverses, continued beyond code 0 and 1 so that every curve stays monotone.
#include "calibration/response.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/transfer.h"

namespace matchlight {
namespace {

/// Codes above this follow the tangent where a shoulder has its white at infinity: half a code of ten bits below 1.
constexpr double last_shoulder_code = 1 - 0.5 / 1023;

/// PQ ends at code 1; beyond it continues with its own slope there.
constexpr double pq_end_step = 1e-4;
double pq_end_slope() {
    return (linear_from_pq_code(1) - linear_from_pq_code(1 - pq_end_step)) / pq_end_step;
}

void check_curve(const Response::Curve& curve, const std::filesystem::path& reported) {
    const std::string cure = "give at least two samples, both strictly increasing";
    if (curve.code.size() != curve.linear.size()) {
        throw InputError(reported,
                         "the response has " + std::to_string(curve.code.size()) + " codes for " +
                             std::to_string(curve.linear.size()) + " linear values",
                         "give a pair each");
    }
    if (curve.code.size() < 2) throw InputError(reported, "the response table is too short", cure);
    for (std::size_t i = 0; i < curve.code.size(); ++i) {
        const std::string place = " at sample " + std::to_string(i);
        if (!std::isfinite(curve.code[i]) || !std::isfinite(curve.linear[i])) {
            throw InputError(reported, "the response table is not finite" + place, cure);
        }
        if (i > 0 && !(curve.code[i] > curve.code[i - 1] && curve.linear[i] > curve.linear[i - 1])) {
            throw InputError(reported, "the response table does not increase" + place, cure);
        }
    }
    if (curve.code.front() < 0 || curve.code.back() > 1) {
        throw InputError(reported, "the response table has codes outside 0..1",
                         "divide them by the largest code, or give it as \"code_max\"");
    }
}

/// Piecewise linear through (x, y), both increasing; the end pieces continue.
double interpolate(const std::vector<double>& x, const std::vector<double>& y, double at) {
    const auto inner_end = x.end() - 1;
    const auto above = std::upper_bound(x.begin() + 1, inner_end, at);
    const std::size_t i = static_cast<std::size_t>(above - x.begin());
    const double part = (at - x[i - 1]) / (x[i] - x[i - 1]);
    return y[i - 1] + part * (y[i] - y[i - 1]);
}

/// Solves c·T / (1 − exp(−c·T)) = ratio > 1 for c·T by Newton's method on a convex, increasing function.
double roll_off_exponent(double ratio) {
    double u = ratio;  // the left side is at least u, so the solution is at most this: Newton comes down from there
    for (int i = 0; i < 100; ++i) {
        const double e = std::exp(-u);
        const double value = u / (1 - e);
        const double slope = (1 - e - u * e) / ((1 - e) * (1 - e));
        const double next = std::max(u - (value - ratio) / slope, u * 1e-3);
        if (std::abs(next - u) <= 1e-15 * u) break;
        u = next;
    }
    return u;
}

}  // namespace

Response Response::srgb() {
    return {};
}

Response Response::gamma(double exponent) {
    return gamma(std::array<double, 3>{exponent, exponent, exponent});
}

Response Response::gamma(const std::array<double, 3>& exponent) {
    assert(std::all_of(exponent.begin(), exponent.end(), [](double g) { return g > 0 && std::isfinite(g); }));
    Response response;
    response.family_ = Family::gamma;
    response.gamma_ = exponent;
    return response;
}

Response Response::shoulder(const Shoulder& shoulder, const std::filesystem::path& reported) {
    if (!(shoulder.knee > 0 && shoulder.knee < 1)) {
        throw InputError(reported, "the shoulder's knee is not between 0 and 1");
    }
    if (!(shoulder.gamma >= 0 && std::isfinite(shoulder.gamma) && shoulder.white >= 0)) {
        throw InputError(reported, "the shoulder's gamma or white is not a positive number");
    }
    Response response;
    response.family_ = Family::shoulder;
    response.shoulder_ = shoulder;
    if (!std::isfinite(shoulder.white)) response.shoulder_.white = 0;

    // Slope of the base curve at the knee, from its closed forms.
    const double k = shoulder.knee;
    const double slope = shoulder.gamma > 0 ? std::pow(k, 1 / shoulder.gamma - 1) / shoulder.gamma
                         : k <= 0.0031308   ? 12.92
                                            : 1.055 / 2.4 * std::pow(k, 1 / 2.4 - 1);
    RollOff& roll_off = response.roll_off_;
    roll_off.knee_code = response.base_code_from_linear(k);
    const double left = 1 - roll_off.knee_code;
    if (response.shoulder_.white > 0) {
        const double reach = response.shoulder_.white - k;
        const double ratio = slope * reach / left;
        if (!(ratio > 1 + 1e-9)) {
            throw InputError(reported, "the shoulder's white lies before its tangent reaches code 1",
                             "give a white above " + std::to_string(k + left / slope));
        }
        const double exponent = roll_off_exponent(ratio);
        roll_off.rate = exponent / reach;
        roll_off.span = left / (1 - std::exp(-exponent));
        roll_off.tail_code = 1;
        roll_off.tail_light = reach;
    } else {
        roll_off.rate = slope / left;
        roll_off.span = left;
        roll_off.tail_code = last_shoulder_code;
        roll_off.tail_light = -std::log((1 - last_shoulder_code) / left) / roll_off.rate;
        if (!(roll_off.tail_light > 0)) throw InputError(reported, "the shoulder's knee is too close to white");
    }
    roll_off.tail_slope = roll_off.span * roll_off.rate * std::exp(-roll_off.rate * roll_off.tail_light);
    return response;
}

Response Response::table(std::array<std::vector<double>, 3> linear_at_code, const std::filesystem::path& reported) {
    std::array<Curve, 3> curves;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const std::size_t samples = linear_at_code[channel].size();
        curves[channel].linear = std::move(linear_at_code[channel]);
        for (std::size_t i = 0; i < samples; ++i) {
            curves[channel].code.push_back(static_cast<double>(i) /
                                           static_cast<double>(std::max<std::size_t>(samples - 1, 1)));
        }
    }
    return from_curves(std::move(curves), reported);
}

Response Response::from_curves(std::array<Curve, 3> curves, const std::filesystem::path& reported) {
    for (const Curve& curve : curves) check_curve(curve, reported);
    Response response;
    response.family_ = Family::table;
    response.curves_ = std::move(curves);
    return response;
}

Response Response::pq() {
    Response response;
    response.family_ = Family::pq;
    return response;
}

Response Response::hlg() {
    Response response;
    response.family_ = Family::hlg;
    return response;
}

double Response::base_linear_from_code(double code) const {
    return shoulder_.gamma > 0 ? std::copysign(std::pow(std::abs(code), shoulder_.gamma), code)
                               : linear_from_srgb_code(code);
}

double Response::base_code_from_linear(double linear) const {
    return shoulder_.gamma > 0 ? std::copysign(std::pow(std::abs(linear), 1 / shoulder_.gamma), linear)
                               : srgb_code_from_linear(linear);
}

double Response::linear_from_code(double code, int channel) const {
    assert(channel >= 0 && channel < 3);
    switch (family_) {
        case Family::srgb:
            return linear_from_srgb_code(code);
        case Family::gamma:
            return std::copysign(std::pow(std::abs(code), gamma_[channel]), code);
        case Family::shoulder: {
            const RollOff& r = roll_off_;
            if (code <= r.knee_code) return base_linear_from_code(code);
            if (code >= r.tail_code) return shoulder_.knee + r.tail_light + (code - r.tail_code) / r.tail_slope;
            return shoulder_.knee - std::log1p(-(code - r.knee_code) / r.span) / r.rate;
        }
        case Family::table:
            return interpolate(curves_[channel].code, curves_[channel].linear, code);
        case Family::pq:
            return code > 1 ? 1 + (code - 1) * pq_end_slope()
                            : std::copysign(linear_from_pq_code(std::abs(code)), code);
        case Family::hlg:
            return std::copysign(linear_from_hlg_code(std::abs(code)), code);
    }
    assert(false);
    return 0;
}

double Response::code_from_linear(double linear, int channel) const {
    assert(channel >= 0 && channel < 3);
    switch (family_) {
        case Family::srgb:
            return srgb_code_from_linear(linear);
        case Family::gamma:
            return std::copysign(std::pow(std::abs(linear), 1 / gamma_[channel]), linear);
        case Family::shoulder: {
            const RollOff& r = roll_off_;
            const double t = linear - shoulder_.knee;
            if (t <= 0) return base_code_from_linear(linear);
            if (t >= r.tail_light) return r.tail_code + (t - r.tail_light) * r.tail_slope;
            return r.knee_code - r.span * std::expm1(-r.rate * t);
        }
        case Family::table:
            return interpolate(curves_[channel].linear, curves_[channel].code, linear);
        case Family::pq:
            return linear > 1 ? 1 + (linear - 1) / pq_end_slope()
                              : std::copysign(pq_code_from_linear(std::abs(linear)), linear);
        case Family::hlg:
            return std::copysign(hlg_code_from_linear(std::abs(linear)), linear);
    }
    assert(false);
    return 0;
}

std::vector<float> Response::sampled_linear(int samples, int channel) const {
    assert(samples >= 2);
    std::vector<float> linear(static_cast<std::size_t>(samples));
    for (int i = 0; i < samples; ++i) {
        linear[static_cast<std::size_t>(i)] =
            static_cast<float>(linear_from_code(static_cast<double>(i) / (samples - 1), channel));
    }
    return linear;
}

}  // namespace matchlight
