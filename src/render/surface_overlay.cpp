// Textures of a relief with their smaller levels, of layers; uniforms of patterns.
#include "render/surface_overlay.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "scene/relief_map.h"

namespace matchlight {

namespace {

Wrap gl_wrap(PictureWrap wrap) {
    constexpr Wrap wraps[] = {Wrap::repeat, Wrap::clamp_to_edge, Wrap::mirrored_repeat};
    return wraps[static_cast<std::size_t>(wrap)];
}

TextureFilter filter_of(const PictureSampling& sampling) {
    TextureFilter filter;
    const PictureFilter chosen = sampling.filter.value_or(PictureFilter::mipmapped);
    filter.is_smooth_near = filter.is_smooth_far = chosen != PictureFilter::nearest;
    if (chosen != PictureFilter::mipmapped) filter.mipmaps = Mipmaps::none;
    filter.anisotropy = static_cast<float>(sampling.anisotropy.value_or(1));
    return filter;
}

Eigen::Vector3f color_of(const std::array<double, 3>& rgb) {
    return Eigen::Vector3d(rgb[0], rgb[1], rgb[2]).cast<float>();
}

/// Height, slopes, cone.
constexpr int relief_channels = 4, cone_channel = 3;

ImageF relief_texels(const ImageF& heights, PictureWrap wrap, bool with_cones) {
    const ImageF slopes = slopes_of(heights, wrap);
    const ImageF cones = with_cones ? cones_of(heights, wrap) : ImageF(heights.width(), heights.height(), 1);
    ImageF texels(heights.width(), heights.height(), relief_channels);
    for (int y = 0; y < texels.height(); ++y) {
        for (int x = 0; x < texels.width(); ++x) {
            float* texel = texels.pixel(x, y);
            texel[0] = heights.at(x, y);
            texel[1] = slopes.at(x, y, 0);
            texel[2] = slopes.at(x, y, 1);
            texel[cone_channel] = cones.at(x, y);
        }
    }
    return texels;
}

/// Means of the texels that each covers; of cones the narrowest.
ImageF next_level(const ImageF& fine) {
    ImageF coarse(std::max(fine.width() / 2, 1), std::max(fine.height() / 2, 1), relief_channels);
    const auto first_of = [](int i, int from, int to) { return static_cast<int>(std::int64_t{i} * from / to); };
    for (int y = 0; y < coarse.height(); ++y) {
        for (int x = 0; x < coarse.width(); ++x) {
            float* texel = coarse.pixel(x, y);
            float count = 0;
            for (int row = first_of(y, fine.height(), coarse.height());
                 row < first_of(y + 1, fine.height(), coarse.height()); ++row) {
                for (int column = first_of(x, fine.width(), coarse.width());
                     column < first_of(x + 1, fine.width(), coarse.width()); ++column) {
                    const float* from = fine.pixel(column, row);
                    for (int c = 0; c < cone_channel; ++c) texel[c] += from[c];
                    texel[cone_channel] =
                        count == 0 ? from[cone_channel] : std::min(texel[cone_channel], from[cone_channel]);
                    ++count;
                }
            }
            for (int c = 0; c < cone_channel; ++c) texel[c] /= count;
        }
    }
    return coarse;
}

}  // namespace

SurfaceOverlay::SurfaceOverlay(const SurfacePictures& pictures, double world_scale) : settings_(pictures.settings) {
    if (!pictures.heights.empty()) upload_relief(pictures, world_scale);
    if (!pictures.layers.empty()) upload_layers(pictures);
    if (const std::optional<PatternSettings>& pattern = settings_.pattern) {
        defines_["PATTERN"] = std::to_string(static_cast<int>(pattern->kind));
        if (pattern->space == PatternSpace::uv) defines_["PATTERN_UV"] = "1";
        if (!pattern->filtered) defines_["PATTERN_UNFILTERED"] = "1";
    }
}

void SurfaceOverlay::upload_relief(const SurfacePictures& pictures, double world_scale) {
    const ReliefSettings& relief = settings_.relief;
    defines_["RELIEF"] = std::to_string(static_cast<int>(relief.method));
    ImageF level = relief_texels(pictures.heights, pictures.relief_wrap, relief.method == ReliefMethod::cone_step);
    relief_ = Texture2D({.format = GL_RGBA32F, .width = level.width(), .height = level.height(), .levels = 0});
    const auto upload_level = [&](int number) {
        relief_.upload(level.bounds(), std::span<const float>(level.samples()), number);
    };
    upload_level(0);
    for (int number = 1; level.width() > 1 || level.height() > 1; ++number) {
        level = next_level(level);
        upload_level(number);
    }
    TextureFilter filter;
    filter.anisotropy = static_cast<float>(settings_.sampling.anisotropy.value_or(1));
    relief_.set_filter(filter);
    const Wrap wrap = gl_wrap(pictures.relief_wrap);
    relief_.set_wrap(wrap, wrap);
    if (relief.method != ReliefMethod::sphere_tracing) return;
    extent_ = (Eigen::Vector2d(pictures.u_extent, pictures.v_extent) * world_scale / relief.depth_m).cast<float>();
    const std::vector<ImageF> layers =
        distances_above(pictures.heights, pictures.relief_wrap, extent_.x(), extent_.y());
    distances_ = Texture2D({.format = GL_R32F,
                            .width = layers.front().width(),
                            .height = layers.front().height(),
                            .layers = static_cast<int>(layers.size())});
    for (std::size_t i = 0; i < layers.size(); ++i)
        distances_.upload(layers[i].bounds(), layers[i].samples(), 0, static_cast<int>(i));
    distances_.set_filter(Filter::linear);
    distances_.set_wrap(wrap, wrap);
}

void SurfaceOverlay::upload_layers(const SurfacePictures& pictures) {
    defines_["PICTURE_LAYERS"] = std::to_string(pictures.layers.size());
    const Image8& first = pictures.layers.front();
    layers_ = Texture2D({.format = GL_SRGB8_ALPHA8,
                         .width = first.width(),
                         .height = first.height(),
                         .levels = 0,
                         .layers = static_cast<int>(pictures.layers.size())});
    for (std::size_t i = 0; i < pictures.layers.size(); ++i)
        layers_.upload(first.bounds(), pictures.layers[i].samples(), 0, static_cast<int>(i));
    layers_.make_mipmaps();
    layers_.set_filter(filter_of(settings_.sampling));
    const Wrap wrap = gl_wrap(pictures.relief_wrap);
    layers_.set_wrap(wrap, wrap);
}

void SurfaceOverlay::bind(Program& program) const {
    if (relief_) {
        program.bind_texture("relief_map", first_unit, relief_);
        program.set("relief_depth_m", settings_.relief.depth_m);
        program.set("relief_steps", settings_.relief.steps);
    }
    if (distances_) {
        program.bind_texture("relief_distances", first_unit + 1, distances_);
        program.set("relief_extent", extent_);
    }
    if (layers_) {
        program.bind_texture("picture_layers", first_unit + 2, layers_);
        std::vector<Eigen::Vector3f> layers;
        for (const PictureLayer& layer : settings_.layers)
            layers.emplace_back(static_cast<float>(layer.alpha), static_cast<float>(layer.uv_scale), 0.0F);
        program.set("picture_layer_alpha_scale", std::span<const Eigen::Vector3f>(layers));
    }
    if (!settings_.pattern) return;
    const PatternSettings& pattern = *settings_.pattern;
    const Eigen::Vector3f color = color_of(pattern.color), second = color_of(pattern.second_color);
    program.set("pattern_color", color);
    program.set("pattern_second_color", second);
    program.set("pattern_middle_color",
                pattern.middle_color ? color_of(*pattern.middle_color) : Eigen::Vector3f(0.5F * (color + second)));
    program.set("pattern_frequency", pattern.frequency);
    const Eigen::Vector3d direction(pattern.direction[0], pattern.direction[1], pattern.direction[2]);
    program.set("pattern_direction", Eigen::Vector3f(direction.normalized().cast<float>()));
    program.set("pattern_share", pattern.share);
    program.set("pattern_octaves", pattern.octaves);
    program.set("pattern_turbulence", pattern.turbulence);
}

ShaderDefines geometry_defines(const ShaderDefines& defines) {
    ShaderDefines geometry;
    if (const auto relief = defines.find("RELIEF"); relief != defines.end()) geometry.insert(*relief);
    return geometry;
}

}  // namespace matchlight
