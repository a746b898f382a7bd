// Between luma's grid and chroma's: bilinear interpolation up, and its box filter down, about the chroma sample's site.
#pragma once

#include <vector>

#include "media/plate.h"

namespace matchlight {

/// One axis of a chroma plane: sample k lies at luma coordinate k · step + site.
struct ChromaAxis {
    int step = 1;     // luma samples a chroma sample
    double site = 0;  // 0 = on the block's first luma sample, (step − 1)/2 = in the middle

    /// Interpolation at luma sample step·k + phase: (1 − weight)·C[k + first] + weight·C[k + first + 1].
    struct Phase {
        int first = 0;
        float weight = 0;
    };
    std::vector<Phase> phases() const;

    /// The box of one block's width about the site of sample k: luma sample step·k + first + i counts weight[i].
    struct Box {
        int first = 0;
        std::vector<float> weight;  // sums to 1
    };
    Box box() const;
};

struct ChromaAxes {
    ChromaAxis horizontal, vertical;
};
ChromaAxes chroma_axes(ChromaSiting siting, int log2_width, int log2_height);

}  // namespace matchlight
