// Cases of glare that is convolved by Fourier transforms: diffraction and the lenticular halo.
#include <array>

#include "render/effects/bright_pass.h"
#include "render/effects/wave_glare.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

/// All light makes glare, none is held back.
GraphTexture add_glare_of_all_light(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                                    GpuCondition& bright, const GlareSettings& settings) {
    // The light of these cases reaches to the frame's last corner.
    const Region& region = graph.shape(light.after).region;
    WaveGlare glare(shaders, settings,
                    {.frame_width = region.x + region.width,
                     .frame_height = region.y + region.height,
                     .focal_px = 300,
                     .knobs = wave_glare_knobs(QualityLevel::final_)});
    const GraphTexture bright_light =
        add_bright_pass(graph, shaders, light, {.threshold = 0, .knee = 0}, glare.scale(), bright);
    return add_wave_glare(graph, bright_light, bright, glare);
}

}  // namespace

std::vector<StabilityCase> wave_glare_cases() {
    GlareSettings diffraction, halo;
    diffraction.level = GlareLevel::diffraction;
    diffraction.strength = 1;
    diffraction.aperture.eyelashes = 10;
    halo.halo = 1;
    struct Kind {
        const char* name;
        GlareSettings settings;
    };
    std::vector<StabilityCase> cases;
    for (const Kind& kind : std::array{Kind{"glare, diffraction", diffraction}, Kind{"glare, halo", halo}}) {
        const AddSpill add = [settings = kind.settings](RenderGraph& graph, ShaderLibrary& shaders,
                                                        const FrameLight& light, GpuCondition& bright) {
            return add_glare_of_all_light(graph, shaders, light, bright, settings);
        };
        // Half floats lose up to 2^-10 of each texel twice: some drivers cut instead of rounding.
        for (StabilityCase& one : spill_cases(kind.name, {.energy = Bound{0.998, 1.002}, .huge_frames = true}, add)) {
            cases.push_back(std::move(one));
        }
    }
    return cases;
}

}  // namespace matchlight
