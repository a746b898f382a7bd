// Where a picture lies in a window of another shape.
#pragma once

#include <Eigen/Core>

namespace matchlight {

/// A size in pixels; a picture's may be stretched by its pixels' own shape.
struct PictureSize {
    double width = 0;
    double height = 0;
};

/// A picture of `width` × `height` samples whose pixels are `pixel_aspect` times as wide as high, as it is to be seen:
/// rows keep their number.
PictureSize displayed_size(int width, int height, double pixel_aspect);

/// The picture's left, top, width and height in the window: as large as its shape allows, in the middle, on whole
/// pixels, so that a picture of the window's size is copied sample by sample.
Eigen::Vector4f letterbox(const PictureSize& picture, int window_width, int window_height);

/// The size of a window for the picture: its own where the screen has room, else as large as fits, and never smaller
/// than `least`.
Eigen::Vector2i fitted_window(const PictureSize& picture, const Eigen::Vector2i& screen, const Eigen::Vector2i& least);

}  // namespace matchlight
