// Puts touched pixels into the plate: into its own samples for encoders, into rounded R'G'B' for pictures.
#include <algorithm>
#include <cmath>
#include <limits>

#include "compositor/compositor.h"
#include "core/parallel.h"

namespace matchlight {

namespace {

template <class Sample>
void replace_touched(Image<Sample>& picture, const CompositedFrame& frame) {
    constexpr float full_scale = std::numeric_limits<Sample>::max();
    const Region& reach = frame.reach;
    parallel_for(reach.height, [&](int y) {
        for (int x = 0; x < reach.width; ++x) {
            if (frame.touched.at(x, y) == 0) continue;
            const float* code = frame.code.pixel(x, y);
            Sample* out = picture.pixel(reach.x + x, reach.y + y);
            for (int c = 0; c < 3; ++c) {
                out[c] = static_cast<Sample>(std::lround(std::clamp(code[c], 0.0f, 1.0f) * full_scale));
            }
        }
    });
}

}  // namespace

PlateFrame CompositedFrame::composited_plate() const {
    PlateFrame written = plate;
    if (!reach.empty()) written.write_rgb_code(reach, code, touched);
    return written;
}

Image8 CompositedFrame::rgb8() const {
    Image8 picture = plate.rgb8({0, 0, plate.format().width, plate.format().height});
    replace_touched(picture, *this);
    return picture;
}

Image16 CompositedFrame::rgb16() const {
    Image16 picture = plate.rgb16({0, 0, plate.format().width, plate.format().height});
    replace_touched(picture, *this);
    return picture;
}

}  // namespace matchlight
