// One pass over the layer; each part of it is compiled only where the settings have it.
#include "render/effects/color_transform.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "media/image_io.h"

namespace matchlight {

namespace {

/// A table of fewer nodes, evenly taken.
std::vector<float> thinned(const ColorTable& table, int size) {
    std::vector<float> rgb;
    const int step = (table.size - 1) / (size - 1);
    for (int blue = 0; blue < size; ++blue) {
        for (int green = 0; green < size; ++green) {
            for (int red = 0; red < size; ++red) {
                const float* node = table.at(red * step, green * step, blue * step);
                rgb.insert(rgb.end(), node, node + 3);
            }
        }
    }
    return rgb;
}

Eigen::Matrix3f matrix_of(const ColorTransformSettings& settings) {
    Eigen::Matrix3f matrix;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            matrix(row, column) =
                static_cast<float>(settings.matrix[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)]);
        }
    }
    return matrix;
}

Eigen::Vector3f vector_of(const std::array<double, 3>& color) {
    return Eigen::Vector3d(color[0], color[1], color[2]).cast<float>();
}

/// As the model counts it.
double hue_of(const ColorTransformSettings& settings) {
    if (settings.model == ColorModel::yiq) return std::remainder(settings.hue_deg, 360) * std::numbers::pi / 180;
    constexpr double degrees_of_a_sixth = 60;
    return (std::fmod(settings.hue_deg, 360) + 360) / degrees_of_a_sixth;
}

}  // namespace

ColorTransformFiles ColorTransformFiles::read(const ColorTransformSettings& settings) {
    ColorTransformFiles files;
    if (!settings.table.empty()) files.table = read_color_table(settings.table);
    if (!settings.mask.empty()) {
        const Image8 picture = read_rgb8(settings.mask);
        files.mask = ImageF(picture.width(), picture.height(), 1);
        for (int y = 0; y < picture.height(); ++y) {
            for (int x = 0; x < picture.width(); ++x) {
                const std::uint8_t* pixel = picture.pixel(x, y);
                files.mask.at(x, y) = static_cast<float>(pixel[0] + pixel[1] + pixel[2]) / (3 * 255);
            }
        }
    }
    return files;
}

ColorTransformKnobs color_transform_knobs(QualityLevel level) {
    switch (level) {
        case QualityLevel::draft:
            return {.table_size = 17};
        case QualityLevel::preview:
            return {.table_size = 33};
        case QualityLevel::final_:
        case QualityLevel::reference:
            break;
    }
    return {};
}

ColorTransform::ColorTransform(const ColorTransformSettings& settings, const ColorTransformFiles& files,
                               const ColorTransformKnobs& knobs)
    : settings_(settings) {
    const int model = settings.changes_model() ? 1 + static_cast<int>(settings.model) : 0;
    defines_ = {{"MODEL", std::to_string(model)},
                {"GREY", std::to_string(static_cast<int>(settings.grey))},
                {"TABLE", files.table ? "1" : "0"},
                {"MASK", files.mask.empty() ? "0" : "1"}};
    if (files.table) {
        table_size_ = knobs.table_size;
        table_ = Texture2D({.format = GL_RGB32F, .width = table_size_, .height = table_size_ * table_size_});
        table_.upload(table_.bounds(), std::span<const float>(thinned(*files.table, table_size_)));
    }
    if (!files.mask.empty()) {
        mask_ = Texture2D({.format = GL_R32F, .width = files.mask.width(), .height = files.mask.height()});
        mask_.upload(files.mask);
        mask_.set_filter(Filter::linear);
    }
}

PlateLayer ColorTransform::add(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                               const ColorTransformFrame& frame) const {
    if (!layer.light) return layer;
    const GraphTexture light = layer.light;
    const auto draw = [this, &shaders, light, frame](PassRun& run) {
        Program& program = shaders.full_screen("effects/color_transform/apply.frag", defines_);
        program.use();
        run.bind(program, "layer", 0, light);
        program.set("gain", Eigen::Vector3f(frame.gain.cast<float>()));
        program.set("weights", matrix_of(settings_));
        if (settings_.changes_model()) {
            program.set("model",
                        Eigen::Vector3d(hue_of(settings_), settings_.saturation, settings_.value).cast<float>().eval());
        }
        program.set("contrast", settings_.contrast);
        program.set("brightness", settings_.brightness);
        if (table_) {
            table_.bind(1);
            program.set("table", 1);
            program.set("table_size", table_size_);
        }
        if (settings_.grey != GreyKind::none) program.set("tint", vector_of(settings_.tint));
        const std::array<double, 3>& faded_to = settings_.fade_color;
        program.set("fade",
                    Eigen::Vector4d(faded_to[0], faded_to[1], faded_to[2], settings_.fade).cast<float>().eval());
        if (mask_) {
            mask_.bind(2);
            program.set("mask", 2);
            const Region& at = frame.mask_frame;
            program.set("mask_frame", Eigen::Vector4i(at.x, at.y, at.width, at.height).cast<float>().eval());
        }
        run.draw(program);
    };
    PlateLayer transformed = layer;
    transformed.light = graph.add_pass({.name = "color transform",
                                        .reads = {{light}},
                                        .writes = {GL_RGBA32F},
                                        .region = graph.shape(light).region,
                                        .draw = draw})[0];
    return transformed;
}

}  // namespace matchlight
