// Each step as its source writes it.
#include "report/color_transform_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/parallel.h"
#include "core/transfer.h"

namespace matchlight {

namespace {

Eigen::Matrix3d yiq_matrix() {
    Eigen::Matrix3d matrix;
    matrix << 0.299, 0.587, 0.114, 0.595716, -0.274453, -0.321263, 0.211456, -0.522591, 0.311135;
    return matrix;
}

Color product(const Eigen::Matrix3d& matrix, const Color& color) {
    const Eigen::Vector3d made = matrix * Eigen::Vector3d(color[0], color[1], color[2]);
    return {made[0], made[1], made[2]};
}

Color changed_in_hsv(const Color& code, const ColorTransformSettings& settings) {
    Color hsv = reference_hsv_from_rgb({std::max(code[0], 0.0), std::max(code[1], 0.0), std::max(code[2], 0.0)});
    hsv[0] = std::fmod(std::fmod(hsv[0] + settings.hue_deg, 360) + 360, 360);
    hsv[1] = std::min(hsv[1] * settings.saturation, 1.0);
    hsv[2] *= settings.value;
    return reference_rgb_from_hsv(hsv);
}

Color changed_in_yiq(const Color& code, const ColorTransformSettings& settings) {
    const Color yiq = reference_yiq_from_rgb(code);
    const double angle = settings.hue_deg * std::numbers::pi / 180;
    return reference_rgb_from_yiq({yiq[0] * settings.value,
                                   settings.saturation * (std::cos(angle) * yiq[1] - std::sin(angle) * yiq[2]),
                                   settings.saturation * (std::sin(angle) * yiq[1] + std::cos(angle) * yiq[2])});
}

double grey_of(const Color& code, GreyKind kind) {
    if (kind == GreyKind::hsv) return std::ranges::max(code);
    if (kind == GreyKind::average) return (code[0] + code[1] + code[2]) / 3;
    return reference_yiq_from_rgb(code)[0];
}

/// Along rows, into columns of the result: twice is both axes.
ImageD transposed_box(const ImageD& image, int radius) {
    ImageD blurred(image.height(), image.width(), image.channels());
    parallel_for(image.height(), [&](int y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int i = -radius; i <= radius; ++i) {
                const double* from = image.pixel(std::clamp(x + i, 0, image.width() - 1), y);
                for (int c = 0; c < image.channels(); ++c) blurred.at(y, x, c) += from[c] / (2 * radius + 1);
            }
        }
    });
    return blurred;
}

}  // namespace

Color reference_hsv_from_rgb(const Color& rgb) {
    const double value = std::ranges::max(rgb), range = value - std::ranges::min(rgb);
    if (range <= 0) return {0, 0, value};
    double sixths = 0;
    if (rgb[0] == value) {
        sixths = (rgb[1] - rgb[2]) / range;
    } else if (rgb[1] == value) {
        sixths = 2 + (rgb[2] - rgb[0]) / range;
    } else {
        sixths = 4 + (rgb[0] - rgb[1]) / range;
    }
    return {60 * (sixths < 0 ? sixths + 6 : sixths), range / value, value};
}

Color reference_rgb_from_hsv(const Color& hsv) {
    const double sixths = hsv[0] / 60;
    const int sector = static_cast<int>(std::floor(sixths)) % 6;
    const double within = sixths - std::floor(sixths);
    const double low = hsv[2] * (1 - hsv[1]), falling = hsv[2] * (1 - hsv[1] * within);
    const double rising = hsv[2] * (1 - hsv[1] * (1 - within));
    switch (sector) {
        case 0:
            return {hsv[2], rising, low};
        case 1:
            return {falling, hsv[2], low};
        case 2:
            return {low, hsv[2], rising};
        case 3:
            return {low, falling, hsv[2]};
        case 4:
            return {rising, low, hsv[2]};
        default:
            return {hsv[2], low, falling};
    }
}

Color reference_yiq_from_rgb(const Color& rgb) {
    return product(yiq_matrix(), rgb);
}

Color reference_rgb_from_yiq(const Color& yiq) {
    return product(yiq_matrix().inverse(), yiq);
}

Color reference_color_transform(const Color& code, const ColorTransformSettings& settings, const ColorTable* table) {
    Color made{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t c = 0; c < 3; ++c) made[row] += settings.matrix[row][c] * code[c];
    }
    if (settings.changes_model())
        made = settings.model == ColorModel::hsv ? changed_in_hsv(made, settings) : changed_in_yiq(made, settings);
    for (double& channel : made) channel = (channel - 0.5) * settings.contrast + 0.5 + settings.brightness;
    if (table != nullptr) {
        const Color looked_up = (*table)(made);
        for (std::size_t c = 0; c < 3; ++c) made[c] = looked_up[c] + made[c] - std::clamp(made[c], 0.0, 1.0);
    }
    if (settings.grey != GreyKind::none) {
        const double grey = grey_of(made, settings.grey);
        for (std::size_t c = 0; c < 3; ++c) made[c] = settings.tint[c] * grey;
    }
    for (std::size_t c = 0; c < 3; ++c)
        made[c] = std::max(made[c] + settings.fade * (settings.fade_color[c] - made[c]), 0.0);
    return made;
}

void reference_transform_layer(ImageD& layer, const Color& gain, const ColorTransformSettings& settings,
                               const ColorTable* table) {
    parallel_for(layer.height(), [&](int y) {
        for (int x = 0; x < layer.width(); ++x) {
            double* pixel = layer.pixel(x, y);
            if (pixel[3] <= 0) continue;
            Color code{};
            for (std::size_t c = 0; c < 3; ++c)
                code[c] = srgb_code_from_linear(std::max(pixel[c] / pixel[3] * gain[c], 0.0));
            code = reference_color_transform(code, settings, table);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = pixel[3] * linear_from_srgb_code(code[c]) / gain[c];
        }
    });
}

ImageD reference_repeated_blur(const ImageD& image, const RepeatedBlurSettings& settings) {
    ImageD blurred = image;
    for (int pass = 0; pass < settings.passes; ++pass)
        blurred = transposed_box(transposed_box(blurred, settings.radius_px), settings.radius_px);
    return blurred;
}

}  // namespace matchlight
