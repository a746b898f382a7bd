// Glare that is convolved by Fourier transforms: diffraction by the aperture, the lenticular halo, or both at the cost
// of one.
#pragma once

#include <array>
#include <list>
#include <memory>
#include <string>

#include "gl/condition.h"
#include "render/effects/bright_light.h"
#include "render/effects/diffraction.h"
#include "render/effects/halo.h"
#include "render/fft.h"
#include "render/frame_light.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct WaveGlareKnobs {
    int least_scale = 1;      // frame pixels along a side of a texel, at least: 1, 2 or a multiple of 4
    int most_side = 1024;     // of a transform, 16 to 2048: larger frames get a larger scale
    bool full_float = false;  // textures of 32 bits a channel instead of 16 for what is added
    DiffractionQuality diffraction = {};
    HaloQuality halo = {};

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};

WaveGlareKnobs wave_glare_knobs(QualityLevel quality);

struct WaveGlareOptions {
    std::string name = "glare";  // of its passes; two in one graph differ in it
    int frame_width = 0;
    int frame_height = 0;
    double focal_px = 0;  // sets the size of the halo
    WaveGlareKnobs knobs = {};
};

/// Whose light makes glare: with a glare of its own, dazzling reflection takes `objects` and the scene's glare the
/// `rest`.
struct WaveGlareSource {
    FrameLight light;
    BrightShare share = BrightShare::all;
    double object_strength = 1;
};

/// The light that makes glare: fireflies held back.
BrightPassSettings wave_glare_light(const GlareSettings& settings, BrightShare share = BrightShare::all,
                                    double object_strength = 1);

/// The kernel of a scene's glare: made once, on the CPU, and transformed once for each size of transform that frames
/// ask for.
class WaveGlare {
public:
    /// Diffraction where the settings' level is `diffraction`, times their strength; the halo times theirs. Throws
    /// InputError where the aperture's image is bad.
    WaveGlare(ShaderLibrary& shaders, const GlareSettings& settings, const WaveGlareOptions& options);

    /// Neither has any strength.
    bool empty() const { return kernel_->empty(); }
    /// What the bright pass must have: 1, 2 or a multiple of 4.
    int scale() const { return scale_; }
    /// Texels that light is carried.
    int reach() const { return kernel_->width() / 2; }

private:
    friend GraphTexture add_wave_glare(RenderGraph& graph, const WaveGlareSource& source, GpuCondition& bright,
                                       WaveGlare& glare);
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
    static void transform_kernel(const Image<double>& kernel, Plan& plan);
    std::string kernel_pass(const Plan& plan) const;

    ShaderLibrary* shaders_;
    GlareSettings settings_;
    WaveGlareOptions options_;
    int scale_ = 1;
    std::shared_ptr<const Image<double>> kernel_;  // passes that are still to be drawn share it
    std::list<std::shared_ptr<Plan>> plans_;       // latest first
};

/// Plate-linear light to add to the picture, signed and times its strength: its sum is that of the bright light times
/// the strength, but for what leaves the frame. Valid where `bright` is met; empty where nothing virtual is seen or the
/// strength is 0.
GraphTexture add_wave_glare(RenderGraph& graph, const WaveGlareSource& source, GpuCondition& bright, WaveGlare& glare);

/// The same for `bright_light`, D of a bright pass at the glare's scale, which sets `bright`.
GraphTexture add_wave_glare(RenderGraph& graph, GraphTexture bright_light, const GpuCondition& bright,
                            WaveGlare& glare);

}  // namespace matchlight
