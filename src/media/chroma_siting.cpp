// Weights from the sites that ITU-T H.273 gives.
#include "media/chroma_siting.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

std::vector<ChromaAxis::Phase> ChromaAxis::phases() const {
    std::vector<Phase> result;
    for (int phase = 0; phase < step; ++phase) {
        const double place = (phase - site) / step;
        const double first = std::floor(place);
        result.push_back({static_cast<int>(first), static_cast<float>(place - first)});
    }
    return result;
}

ChromaAxis::Box ChromaAxis::box() const {
    // The box spans [site − step/2, site + step/2]; a luma sample counts as much as its unit interval overlaps it.
    const double begin = site - 0.5 * step, end = site + 0.5 * step;
    Box result;
    result.first = static_cast<int>(std::floor(begin + 0.5));
    for (int sample = result.first; sample - 0.5 < end - 1e-9; ++sample) {
        const double overlap = std::min(sample + 0.5, end) - std::max(sample - 0.5, begin);
        result.weight.push_back(static_cast<float>(overlap / step));
    }
    return result;
}

ChromaAxes chroma_axes(ChromaSiting siting, int log2_width, int log2_height) {
    const int width = 1 << log2_width, height = 1 << log2_height;
    const bool left =
        siting == ChromaSiting::left || siting == ChromaSiting::top_left || siting == ChromaSiting::bottom_left;
    const bool top = siting == ChromaSiting::top_left || siting == ChromaSiting::top;
    const bool bottom = siting == ChromaSiting::bottom_left || siting == ChromaSiting::bottom;
    ChromaAxes axes;
    axes.horizontal = {width, left ? 0.0 : 0.5 * (width - 1)};
    axes.vertical = {height, top ? 0.0 : bottom ? height - 1.0 : 0.5 * (height - 1)};
    return axes;
}

}  // namespace matchlight
