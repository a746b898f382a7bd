// How far two effects' light differ: in the picture they are added to, and in linear light.
#pragma once

#include <algorithm>
#include <cmath>

#include "effect_frame.h"
#include "report/flip.h"
#include "report/image_error.h"

namespace matchlight::test {

struct ShownError {
    double flip = 0;          // mean over the frame, as sRGB pictures
    double relative_rms = 0;  // of the effect's light alone
};

inline Image8 shown(const LightOnCpu& light, const ImageD& effect) {
    Image8 picture(effect.width(), effect.height(), 3);
    for (int y = 0; y < effect.height(); ++y) {
        for (int x = 0; x < effect.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double value = std::clamp(light.after.at(x, y, c) + effect.at(x, y, c), 0.0, 1.0);
                const double code = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
                picture.at(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * code));
            }
        }
    }
    return picture;
}

inline ShownError shown_error(const LightOnCpu& light, const ImageD& expected, const ImageD& found) {
    ShownError error;
    error.flip = *masked_mean(flip_error_map(shown(light, expected), shown(light, found)));
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < expected.samples().size(); ++i) {
        difference += std::pow(found.samples()[i] - expected.samples()[i], 2);
        size += std::pow(expected.samples()[i], 2);
    }
    error.relative_rms = size > 0 ? std::sqrt(difference / size) : difference;
    return error;
}

}  // namespace matchlight::test
