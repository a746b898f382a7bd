// A kernel of frame pixels, convolved by FFTW.
#include "report/diffraction_reference.h"

#include <algorithm>

#include "report/fftw_convolution.h"

namespace matchlight {

Image<double> reference_diffraction(const Image<double>& bright_light, const GlareSettings& settings,
                                    const DiffractionQuality& quality) {
    const KernelGrid grid{.scale = 1, .most_radius = std::max(bright_light.width(), bright_light.height())};
    const Image<double> kernel = make_diffraction_kernel(
        settings.aperture, diffraction_reach_px(settings, bright_light.height()), grid, quality);
    Image<double> light = convolve_fftw(bright_light, kernel);
    for (double& sample : light.samples()) sample *= settings.strength;
    return light;
}

}  // namespace matchlight
