// Glare by Fourier transforms, run in a graph on light that a test gives.
#pragma once

#include <cmath>
#include <optional>

#include "core/transfer.h"
#include "gl_fixture.h"
#include "render/effects/wave_glare.h"
#include "report/flip.h"

namespace matchlight {

/// What a run of the graph gave.
struct WaveResult {
    ImageF light;  // over `region`
    Region region;
    std::vector<PassReport> reports;
};

class WaveTest : public GlTest {
protected:
    /// The glare of `bright_light` (texels of the glare's scale), which lies at (x, y) of the frame's texels.
    WaveResult run(WaveGlare& glare, const ImageF& bright_light, int frame_width, int frame_height, int x = 0,
                   int y = 0, bool met = true) {
        const Texture2D texture = upload(bright_light);
        graph_.begin_frame(frame_width, frame_height);
        const GraphTexture source =
            graph_.import(&texture, {.format = GL_RGBA16F,
                                     .region = {x, y, bright_light.width(), bright_light.height()},
                                     .scale = glare.scale()});
        bright_.set(met);
        const GraphTexture added = add_wave_glare(graph_, source, bright_, glare);
        graph_.output(added);
        graph_.run();
        WaveResult result;
        result.reports = graph_.reports();
        if (!added) return result;
        result.region = graph_.shape(added).region;
        result.light = graph_.texture(added).read<float>({0, 0, result.region.width, result.region.height}, 3);
        return result;
    }

    static Texture2D upload(const ImageF& light) {
        Texture2D texture({.format = GL_RGBA16F, .width = light.width(), .height = light.height()});
        texture.upload(light);
        return texture;
    }
    /// What half floats keep of it.
    static ImageF rounded_to_half(const ImageF& light) {
        const Texture2D texture = upload(light);
        return texture.read<float>(texture.bounds(), 3);
    }

    ShaderLibrary shaders_;
    RenderGraph graph_;
    GpuCondition bright_{"no light above the threshold"};
};

inline Image<double> to_double(const ImageF& image) {
    Image<double> result(image.width(), image.height(), image.channels());
    std::copy(image.samples().begin(), image.samples().end(), result.samples().begin());
    return result;
}

template <class Sample>
double sum_of(const Image<Sample>& image, int channel) {
    double sum = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) sum += image.at(x, y, channel);
    }
    return sum;
}

inline double relative_rms(const Image<double>& truth, const Image<double>& test) {
    double error = 0, total = 0;
    for (std::size_t i = 0; i < truth.samples().size(); ++i) {
        error += std::pow(test.samples()[i] - truth.samples()[i], 2);
        total += std::pow(truth.samples()[i], 2);
    }
    return std::sqrt(error / total);
}

/// Lamps, sparks and one-pixel suns on a frame: D of the bright pass.
inline Image<double> night_lights(int width, int height) {
    Image<double> light(width, height, 3);
    const auto lamp = [&](double x, double y, double radius, const Eigen::Vector3d& color) {
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                if (std::hypot(u - std::floor(x * width), v - std::floor(y * height)) > radius * height) continue;
                for (int c = 0; c < 3; ++c) light.at(u, v, c) += color[c];
            }
        }
    };
    lamp(0.30, 0.40, 0.012, {300, 280, 250});
    lamp(0.70, 0.30, 0.004, {3000, 2800, 2500});
    lamp(0.60, 0.70, 0.05, {8, 6, 4});
    lamp(0.15, 0.80, 0, {20000, 20000, 20000});
    lamp(0.52, 0.20, 0.002, {10, 40, 20});
    lamp(0.85, 0.85, 0.001, {40, 10, 10});
    lamp(0.98, 0.05, 0, {100, 100, 3000});
    return light;
}

/// The mean over blocks of scale × scale pixels, as the bright pass takes it: dark outside of the frame.
inline ImageF reduced(const Image<double>& image, int scale) {
    ImageF result((image.width() + scale - 1) / scale, (image.height() + scale - 1) / scale, 3);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                result.at(x / scale, y / scale, c) += static_cast<float>(image.at(x, y, c) / (scale * scale));
            }
        }
    }
    return result;
}

/// As the sum of effects interpolates it (shaders/effects/spill/sum.frag).
inline Image<double> enlarged(const ImageF& light, int scale, int width, int height) {
    Image<double> result(width, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / scale - 0.5, v = (y + 0.5) / scale - 0.5;
            const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
            for (int c = 0; c < 3; ++c) {
                const auto at = [&](int i, int j) {
                    return light.bounds().contains(i, j) ? static_cast<double>(light.at(i, j, c)) : 0.0;
                };
                result.at(x, y, c) = std::lerp(std::lerp(at(left, top), at(left + 1, top), u - left),
                                               std::lerp(at(left, top + 1), at(left + 1, top + 1), u - left), v - top);
            }
        }
    }
    return result;
}

/// sRGB codes of a dim room with the lights and what an effect adds.
inline Image8 picture_of(const Image<double>& light, const Image<double>& added) {
    Image8 picture(light.width(), light.height(), 3);
    for (std::size_t i = 0; i < picture.samples().size(); ++i) {
        const double linear = 0.05 + light.samples()[i] + added.samples()[i];
        picture.samples()[i] =
            static_cast<std::uint8_t>(std::lround(255 * srgb_code_from_linear(std::clamp(linear, 0.0, 1.0))));
    }
    return picture;
}

inline double mean_flip(const Image8& reference, const Image8& test) {
    const ImageF map = flip_error_map(reference, test);
    return sum_of(map, 0) / static_cast<double>(map.samples().size());
}

}  // namespace matchlight
