// Integrates the sheen of cloth over the hemisphere.
#include "render/sheen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace matchlight {

double sheen_brdf(double n_dot_l, double n_dot_v, double n_dot_h, double roughness) {
    // As common/material_layers.glsl: below these the power is 0 or 1 in floats.
    const double inverse = 1 / std::max(roughness * roughness, 1e-3);
    const double sine2 = std::max(1 - n_dot_h * n_dot_h, 1e-4);
    const double distribution = (2 + inverse) * std::pow(sine2, inverse / 2) / (2 * std::numbers::pi);
    return distribution / (4 * (n_dot_l + n_dot_v - n_dot_l * n_dot_v));
}

double sheen_albedo(double n_dot_v, double roughness, int steps) {
    const double eye = std::max(n_dot_v, 1e-4);
    const double eye_sine = std::sqrt(1 - eye * eye);
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        // Even in the square of the sine, as the cosine weighs directions.
        const double sine2 = (i + 0.5) / steps;
        const double cosine = std::sqrt(1 - sine2);
        for (int j = 0; j < 2 * steps; ++j) {
            const double azimuth = std::numbers::pi * (j + 0.5) / (2 * steps);  // the other half is its mirror image
            const double x = std::sqrt(sine2) * std::cos(azimuth) + eye_sine;
            const double y = std::sqrt(sine2) * std::sin(azimuth);
            const double z = cosine + eye;
            sum += sheen_brdf(cosine, eye, z / std::sqrt(x * x + y * y + z * z), roughness);
        }
    }
    return std::min(sum / (2.0 * steps * steps) * std::numbers::pi, 1.0);
}

ImageF sheen_albedo_table(int size, int steps) {
    ImageF table(size, size, 1);
    parallel_for(size, [&](int row) {
        for (int column = 0; column < size; ++column) {
            const double last = size - 1;
            table.at(column, row, 0) = static_cast<float>(sheen_albedo(column / last, row / last, steps));
        }
    });
    return table;
}

}  // namespace matchlight
