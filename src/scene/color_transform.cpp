// Ranges of the colour transforms, and which of them are none.
#include "scene/color_transform.h"

#include "scene/check_range.h"

namespace matchlight {

bool ColorTransformSettings::is_identity() const {
    return !changes_matrix() && !changes_model() && contrast == 1 && brightness == 0 && table.empty() &&
           grey == GreyKind::none && fade == 0;
}

void ColorTransformSettings::check() const {
    for (const auto& row : matrix) {
        for (const double weight : row) check_range("color_transform matrix", weight, -16, 16);
    }
    check_range("color_transform hue_deg", hue_deg, -36000, 36000);
    check_range("color_transform saturation", saturation, 0, 16);
    check_range("color_transform value", value, 0, 16);
    check_range("color_transform contrast", contrast, -16, 16);
    check_range("color_transform brightness", brightness, -16, 16);
    check_range("color_transform fade", fade, 0, 1);
    for (const double channel : tint) check_range("color_transform tint", channel, 0, 16);
    for (const double channel : fade_color) check_range("color_transform fade_color", channel, 0, 16);
}

void RepeatedBlurSettings::check() const {
    check_range("repeated_blur passes", passes, 1, 32);
    check_range("repeated_blur radius_px", radius_px, 0, 32);
}

}  // namespace matchlight
