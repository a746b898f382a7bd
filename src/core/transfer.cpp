// Transfer functions from their standards' own constants.
#include "core/transfer.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

double srgb_code_from_linear(double linear) {
    const double x = std::abs(linear);
    const double code = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    return std::copysign(code, linear);
}

double linear_from_srgb_code(double code) {
    const double x = std::abs(code);
    const double linear = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
    return std::copysign(linear, code);
}

namespace {
constexpr double pq_m1 = 2610.0 / 16384, pq_m2 = 2523.0 / 4096 * 128;
constexpr double pq_c1 = 3424.0 / 4096, pq_c2 = 2413.0 / 4096 * 32, pq_c3 = 2392.0 / 4096 * 32;
constexpr double hlg_a = 0.17883277, hlg_b = 1 - 4 * hlg_a;
const double hlg_c = 0.5 - hlg_a * std::log(4 * hlg_a);
}  // namespace

double pq_code_from_linear(double linear) {
    const double y = std::pow(std::max(linear, 0.0), pq_m1);
    return std::pow((pq_c1 + pq_c2 * y) / (1 + pq_c3 * y), pq_m2);
}

double linear_from_pq_code(double code) {
    const double x = std::pow(std::clamp(code, 0.0, 1.0), 1 / pq_m2);
    return std::pow(std::max(x - pq_c1, 0.0) / (pq_c2 - pq_c3 * x), 1 / pq_m1);
}

double hlg_code_from_linear(double linear) {
    const double x = std::max(linear, 0.0);
    return x <= 1.0 / 12 ? std::sqrt(3 * x) : hlg_a * std::log(12 * x - hlg_b) + hlg_c;
}

double linear_from_hlg_code(double code) {
    const double x = std::max(code, 0.0);
    return x <= 0.5 ? x * x / 3 : (std::exp((x - hlg_c) / hlg_a) + hlg_b) / 12;
}

}  // namespace matchlight
