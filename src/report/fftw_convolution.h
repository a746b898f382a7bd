// Linear convolution in double precision by FFTW (Frigo & Johnson 2005, "The Design and Implementation of FFTW3").
#pragma once

#include "core/image.h"

namespace matchlight {

/// Each channel of `picture` with the same channel of `kernel`, whose sides are odd and whose middle is the origin. The
/// result has the picture's size; outside of it the picture is 0.
Image<double> convolve_fftw(const Image<double>& picture, const Image<double>& kernel);

}  // namespace matchlight
