// Glare that is convolved by Fourier transforms: diffraction by the aperture, the lenticular halo, or both at the cost
// of one.
#pragma once

#include <array>
#include <list>
#include <memory>
#include <string>

#include "gl/condition.h"
#include "render/effects/diffraction.h"
#include "render/effects/halo.h"
#include "render/fft.h"
#include "render/graph.h"

namespace matchlight {

struct WaveGlareOptions {
    std::string name = "glare";  // of its passes; two in one graph differ in it
    int frame_width = 0;
    int frame_height = 0;
    double focal_px = 0;     // sets the size of the halo
    int least_scale = 1;     // frame pixels along a side of a texel, at least
    int most_side = 1024;    // of a transform, up to 2048: larger frames get a larger scale
    bool half_float = true;  // precision of the result
    DiffractionQuality diffraction = {};
    HaloQuality halo = {};
};

/// The kernel of a scene's glare: made once, on the CPU, and transformed once for each size of transform that frames
/// ask for.
class WaveGlare {
public:
    /// Diffraction where the settings' level is `diffraction`, times their strength; the halo times theirs. Throws
    /// InputError where the aperture's image is bad.
    WaveGlare(ShaderLibrary& shaders, const GlareSettings& settings, const WaveGlareOptions& options);

    /// Neither has any strength.
    bool empty() const { return kernel_.empty(); }
    /// What the bright pass must have: 1, 2 or a multiple of 4.
    int scale() const { return scale_; }
    /// Texels that light is carried.
    int reach() const { return kernel_.width() / 2; }

private:
    friend GraphTexture add_wave_glare(RenderGraph& graph, GraphTexture bright_light, const GpuCondition& bright,
                                       WaveGlare& glare);
    /// Transforms of one size.
    struct Plan {
        Plan(ShaderLibrary& shaders, int width, int height);
        std::array<int, 2> size;
        Fft2d fft, kernel_fft;  // the second whether or not anything is bright
        RgbSpectrum scratch;
        Texture2D kernel_spectrum;  // its real part, which is all of it
    };
    std::shared_ptr<Plan> plan(RenderGraph& graph, int width, int height);
    void transform_kernel(Plan& plan) const;
    std::string kernel_pass(const Plan& plan) const;

    ShaderLibrary* shaders_;
    WaveGlareOptions options_;
    int scale_ = 1;
    Image<double> kernel_;
    std::list<std::shared_ptr<Plan>> plans_;  // latest first
};

/// Adds the glare of `bright_light` (D of the bright pass at the glare's scale, signed): plate-linear RGB light to add,
/// valid where `bright` is met. Empty where there is nothing to add.
GraphTexture add_wave_glare(RenderGraph& graph, GraphTexture bright_light, const GpuCondition& bright,
                            WaveGlare& glare);

}  // namespace matchlight
