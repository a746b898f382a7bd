// The double-precision references of what is done to colours, and of repeated boxes.
#pragma once

#include <array>

#include "core/image.h"
#include "media/color_table.h"
#include "report/bright_reference.h"
#include "scene/color_transform.h"

namespace matchlight {

using Color = std::array<double, 3>;

/// Hue in degrees (0 for grey), saturation, value, by Smith's hexcone.
Color reference_hsv_from_rgb(const Color& rgb);
Color reference_rgb_from_hsv(const Color& hsv);
Color reference_yiq_from_rgb(const Color& rgb);
/// Solved anew from the forward matrix.
Color reference_rgb_from_yiq(const Color& yiq);

/// Codes to codes, without the mask; `table` is that of the settings or null.
Color reference_color_transform(const Color& code, const ColorTransformSettings& settings, const ColorTable* table);

/// Premultiplied light and coverage (4 channels) to the same, where gain · light is picture-linear.
void reference_transform_layer(ImageD& layer, const Color& gain, const ColorTransformSettings& settings,
                               const ColorTable* table);

/// Boxes over the whole of an image, at its edges as the image ends there.
ImageD reference_repeated_blur(const ImageD& image, const RepeatedBlurSettings& settings);

}  // namespace matchlight
