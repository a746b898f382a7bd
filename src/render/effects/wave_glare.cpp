// Chooses scale and sizes, and puts convolutions into the graph.
#include "render/effects/wave_glare.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <stdexcept>

#include <fmt/format.h>

#include "render/effects/bright_pass.h"
#include "render/effects/kernel.h"

namespace matchlight {
namespace {

/// Places along one axis that keep light from coming round from the other end to where it is wanted: `length` texels
/// that hold all light and all that is wanted past one end of it, and as many more as light travels.
int places(int length, int reach) {
    return length + std::min(reach, length - 1);
}

int choose_scale(const WaveGlareOptions& options, double reach_px) {
    const int side = std::max(options.frame_width, options.frame_height);
    const auto fits = [&](int scale) {
        return places((side + scale - 1) / scale, kernel_radius(reach_px, scale)) <= options.knobs.most_side;
    };
    int scale = options.knobs.least_scale;
    // The firefly-safe bright pass takes 1, 2 and multiples of 4.
    while (!fits(scale)) scale = scale < 4 ? 2 * scale : scale + 4;
    return scale;
}

}  // namespace

void WaveGlareKnobs::check() const {
    const auto refuse = [](const char* name, double value) {
        throw std::invalid_argument(fmt::format("glare: {} must not be {}", name, value));
    };
    const auto is_power_of_two = [](int value) { return std::has_single_bit(static_cast<unsigned>(value)); };
    if (least_scale < 1 || (least_scale > 2 && least_scale % 4 != 0)) refuse("least_scale", least_scale);
    if (most_side < 16 || most_side > Fft2d::most_side) refuse("most_side", most_side);
    if (diffraction.aperture_side < 16 || diffraction.aperture_side > 8192 ||
        !is_power_of_two(diffraction.aperture_side)) {
        refuse("diffraction.aperture_side", diffraction.aperture_side);
    }
    if (diffraction.wavelengths < 4 || diffraction.wavelengths > 1024) {
        refuse("diffraction.wavelengths", diffraction.wavelengths);
    }
    if (!(diffraction.samples >= 0.1 && diffraction.samples <= 16)) refuse("diffraction.samples", diffraction.samples);
    if (halo.wavelengths < 4 || halo.wavelengths > 1024) refuse("halo.wavelengths", halo.wavelengths);
    if (!(halo.samples >= 0.1 && halo.samples <= 1000)) refuse("halo.samples", halo.samples);
}

WaveGlareKnobs wave_glare_knobs(QualityLevel quality) {
    switch (quality) {
        case QualityLevel::draft:
            return {.most_side = 256, .diffraction = {.aperture_side = 512, .wavelengths = 16}};
        case QualityLevel::preview:
            return {.most_side = 512, .diffraction = {.aperture_side = 512, .wavelengths = 16}};
        case QualityLevel::reference:
            return {.most_side = 2048,
                    .full_float = true,
                    .diffraction = {.aperture_side = 2048, .wavelengths = 128, .samples = 2},
                    .halo = {.wavelengths = 128}};
        case QualityLevel::final_:
            break;
    }
    return {};
}

WaveGlare::Plan::Plan(ShaderLibrary& shaders, int width, int height)
    : size{width, height},
      fft(shaders, width, height, true),
      kernel_fft(shaders, width, height),
      scratch(width, height) {}

WaveGlare::WaveGlare(ShaderLibrary& shaders, const GlareSettings& settings, const WaveGlareOptions& options)
    : shaders_(&shaders), settings_(settings), options_(options) {
    settings.check();
    options.knobs.check();
    const bool diffraction = settings.level == GlareLevel::diffraction && settings.strength > 0;
    const bool halo = settings.halo > 0;
    const double diffraction_px = diffraction ? diffraction_reach_px(settings, options.frame_height) : 0;
    const double halo_px = halo ? halo_reach_px(options.focal_px) : 0;
    scale_ = choose_scale(options, std::max(diffraction_px, halo_px));
    // Light that is carried further leaves the frame.
    const int most_radius = std::max(options.frame_width, options.frame_height) / scale_;
    const KernelGrid grid{.scale = scale_, .most_radius = most_radius};
    Image<double> kernel;
    if (diffraction) {
        add_kernel(kernel, make_diffraction_kernel(settings.aperture, diffraction_px, grid, options.knobs.diffraction),
                   settings.strength);
    }
    if (halo) add_kernel(kernel, make_halo_kernel(options.focal_px, grid, options.knobs.halo), settings.halo);
    kernel_ = std::make_shared<const Image<double>>(std::move(kernel));
}

std::string WaveGlare::kernel_pass(const Plan& plan) const {
    return fmt::format("{}/kernel {}x{}", options_.name, plan.size[0], plan.size[1]);
}

std::shared_ptr<WaveGlare::Plan> WaveGlare::plan(RenderGraph& graph, int width, int height) {
    const std::array<int, 2> size{width, height};
    const auto found = std::find_if(plans_.begin(), plans_.end(), [&](const auto& plan) { return plan->size == size; });
    if (found != plans_.end()) {
        plans_.splice(plans_.begin(), plans_, found);
        return plans_.front();
    }
    // Objects that move need two sizes an axis in turn, seldom more.
    constexpr std::size_t most_plans = 4;
    if (plans_.size() == most_plans) plans_.pop_back();
    plans_.push_front(std::make_shared<Plan>(*shaders_, width, height));
    graph.forget_kept(kernel_pass(*plans_.front()));
    return plans_.front();
}

void WaveGlare::transform_kernel(const Image<double>& kernel, Plan& plan) {
    const int reach = kernel.width() / 2;
    const auto [width, height] = plan.size;
    // The middle goes to (0, 0), what lies left of it or above to the far ends.
    ImageF wrapped(width, height, 3);
    const int across = std::min(reach, (width - 1) / 2);
    const int down = std::min(reach, (height - 1) / 2);
    for (int j = -down; j <= down; ++j) {
        for (int i = -across; i <= across; ++i) {
            const double* from = kernel.pixel(reach + i, reach + j);
            float* to = wrapped.pixel((i + width) % width, (j + height) % height);
            for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(from[c]);
        }
    }
    Texture2D texture({.format = GL_RGBA32F, .width = width, .height = height});
    texture.upload(wrapped);
    RgbSpectrum spectrum(width, height);
    plan.kernel_fft.forward({.texture = &texture, .texels = texture.bounds()}, spectrum);
    plan.kernel_spectrum = std::move(spectrum.re);
}

BrightPassSettings wave_glare_light(const GlareSettings& settings, BrightShare share, double object_strength) {
    return {.threshold = settings.threshold,
            .knee = settings.knee,
            .firefly_safe = true,
            .share = share,
            .object_strength = object_strength};
}

GraphTexture add_wave_glare(RenderGraph& graph, const WaveGlareSource& source, GpuCondition& bright, WaveGlare& glare) {
    GraphTexture bright_light;
    if (!glare.empty() && source.light.after) {
        bright_light = add_bright_pass(graph, *glare.shaders_, source.light,
                                       wave_glare_light(glare.settings_, source.share, source.object_strength),
                                       glare.scale(), bright);
    }
    return add_wave_glare(graph, bright_light, bright, glare);
}

GraphTexture add_wave_glare(RenderGraph& graph, GraphTexture bright_light, const GpuCondition& bright,
                            WaveGlare& glare) {
    const std::string& name = glare.options_.name;
    if (glare.empty()) {
        graph.leave_out(name, "its strength is 0");
        return {};
    }
    if (!bright_light) {
        graph.leave_out(name, "nothing virtual is seen");
        return {};
    }
    assert(graph.shape(bright_light).scale == glare.scale());
    const Region light = graph.shape(bright_light).region;
    const Region wanted = graph.reached({bright_light, glare.reach()}, glare.scale());
    const int left = light.x - wanted.x;
    const int top = light.y - wanted.y;
    const int right = wanted.width - light.width - left;
    const int bottom = wanted.height - light.height - top;
    const int width = Fft2d::side_for(places(light.width + std::max(left, right), glare.reach()));
    const int height = Fft2d::side_for(places(light.height + std::max(top, bottom), glare.reach()));
    assert(width > 0 && height > 0);  // by the choice of the scale
    const auto plan = glare.plan(graph, width, height);

    const GraphTexture kernel = graph.import(&plan->kernel_spectrum, {.format = GL_NONE, .region = {}, .scale = 1});
    GraphPass transform{.name = glare.kernel_pass(*plan), .provides = {kernel}, .once = true};
    transform.draw = [kernel_image = glare.kernel_, plan](PassRun&) {
        WaveGlare::transform_kernel(*kernel_image, *plan);
    };
    graph.add_pass(std::move(transform));

    Fft2d::Convolution convolution{.source = {.texels = {0, 0, light.width, light.height}, .x = left, .y = top},
                                   .width = wanted.width,
                                   .height = wanted.height};
    GraphPass pass{.name = fmt::format("{}/convolution {}x{}", name, width, height)};
    pass.reads = {{bright_light, glare.reach()}, {kernel}};
    pass.writes = {glare.options_.knobs.full_float ? GLenum{GL_RGBA32F} : GLenum{GL_RGBA16F}};
    pass.scale = glare.scale();
    pass.region = wanted;
    pass.needs = &bright;
    pass.bytes = plan->fft.bytes(convolution);
    pass.draw = [&bright, plan, bright_light, convolution](PassRun& run) {
        bright.bind_for_shaders();
        Fft2d::Convolution now = convolution;
        now.source.texture = &run.texture(bright_light);
        now.kernel = &plan->kernel_spectrum;
        now.picture = &run.written();
        plan->fft.convolve(now, plan->scratch);
    };
    return graph.add_pass(std::move(pass)).front();
}

}  // namespace matchlight
