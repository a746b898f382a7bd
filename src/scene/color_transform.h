// What the scene asks of colours: transforms of the codes in which virtual things are shown.
#pragma once

#include <array>
#include <filesystem>

namespace matchlight {

/// In which hue, saturation and value are changed.
enum class ColorModel { hsv, yiq };
/// How a colour becomes grey: HSV's value, the mean of the channels, or YIQ's luma.
enum class GreyKind { none, hsv, average, yiq };

/// One after the other in this order, on codes: sRGB's of picture-linear light, 0 to 1 and above for what is brighter.
struct ColorTransformSettings {
    std::array<std::array<double, 3>, 3> matrix{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // a row makes a channel
    ColorModel model = ColorModel::hsv;
    double hue_deg = 0;     // added to HSV's hue; or YIQ's chroma is turned by it
    double saturation = 1;  // times HSV's saturation, or YIQ's chroma
    double value = 1;       // times HSV's value, or YIQ's luma
    double contrast = 1;    // about the code 1/2
    double brightness = 0;  // added
    std::filesystem::path table = {};
    GreyKind grey = GreyKind::none;
    std::array<double, 3> tint{1, 1, 1};  // of the grey
    double fade = 0;
    std::array<double, 3> fade_color{};  // codes
    std::filesystem::path mask = {};     // white: transformed, black: as it was

    /// Whether every code stays as it is.
    bool is_identity() const;
    bool changes_model() const { return hue_deg != 0 || saturation != 1 || value != 1; }
    bool changes_matrix() const { return matrix != ColorTransformSettings{}.matrix; }
    void check() const;
    bool operator==(const ColorTransformSettings&) const = default;
};

/// A box along rows and one along columns, again and again: towards a Gaussian of variance passes · ((2 radius_px + 1)²
/// − 1) / 12 (central limit theorem; Wells 1986, "Efficient Synthesis of Gaussian Filters by Cascaded Uniform
/// Filters").
struct RepeatedBlurSettings {
    int passes = 3;
    int radius_px = 2;  // the box is 2 radius_px + 1 pixels wide

    double variance_px2() const { return passes * ((2.0 * radius_px + 1) * (2.0 * radius_px + 1) - 1) / 12; }
    void check() const;
    bool operator==(const RepeatedBlurSettings&) const = default;
};

}  // namespace matchlight
