#include "report/srgb_picture.h"

#include <algorithm>
#include <cmath>

#include "core/transfer.h"

namespace matchlight {

Image8 srgb_picture(const ImageF& light) {
    Image8 picture(light.width(), light.height(), 3);
    for (std::size_t i = 0; i < light.samples().size(); ++i) {
        const double code = srgb_code_from_linear(static_cast<double>(light.samples()[i]));
        picture.samples()[i] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(code, 0.0, 1.0)));
    }
    return picture;
}

}  // namespace matchlight
