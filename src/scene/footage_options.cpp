// Names of matrices and ranges were checked when the scene was read.
#include "scene/footage_options.h"

namespace matchlight {

FootageOptions footage_options(const FootageSettings& footage, bool strict) {
    FootageOptions options;
    options.sequence_fps = footage.fps;
    options.strict = strict;
    if (footage.color_matrix == "bt601") options.matrix = ColorMatrix::bt601;
    if (footage.color_matrix == "bt709") options.matrix = ColorMatrix::bt709;
    if (footage.color_matrix == "bt2020") options.matrix = ColorMatrix::bt2020;
    if (footage.color_range == "limited") options.range = ColorRange::limited;
    if (footage.color_range == "full") options.range = ColorRange::full;
    return options;
}

}  // namespace matchlight
