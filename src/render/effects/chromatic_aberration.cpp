// One pass over the layer, which finds where each channel's light came from.
#include "render/effects/chromatic_aberration.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

namespace {

Eigen::Vector2d centre_of(const LateralColor& color) {
    return {(color.frame_width - 1) / 2.0, (color.frame_height - 1) / 2.0};
}

double corner_px(const LateralColor& color) {
    return std::hypot(color.frame_width, color.frame_height) / 2;
}

/// As in the shader.
double set_in(double displacement_px) {
    const double t = std::clamp(std::abs(displacement_px) / least_aberration_px - 1, 0.0, 1.0);
    return displacement_px * t * t * (3 - 2 * t);
}

}  // namespace

double LateralColor::displacement_px(const Eigen::Vector2d& pixel) const {
    const double radius = (pixel - centre_of(*this)).norm() / corner_px(*this);
    return std::abs(set_in(std::max(std::abs(red_px), std::abs(blue_px)) * radius));
}

bool LateralColor::is_none(const Region& region) const {
    if (region.empty()) return true;
    // The corner farthest from the middle.
    const Eigen::Vector2d centre = centre_of(*this);
    const Eigen::Vector2d low(region.x, region.y);
    const Eigen::Vector2d high(region.x + region.width - 1, region.y + region.height - 1);
    const Eigen::Vector2d reach = (low - centre).cwiseAbs().cwiseMax((high - centre).cwiseAbs());
    return displacement_px(centre + reach) == 0;
}

ChromaticAberrationKnobs chromatic_aberration_knobs(QualityLevel level) {
    return {.cubic = level == QualityLevel::final_ || level == QualityLevel::reference};
}

PlateLayer add_chromatic_aberration(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                                    const LateralColor& color, const ChromaticAberrationKnobs& knobs) {
    if (!layer.light) return layer;
    PlateLayer displaced = layer;
    const GraphTexture light = layer.light;
    const ShaderDefines defines{{"CUBIC", knobs.cubic ? "1" : "0"}};
    const std::vector<GraphTexture> written =
        graph.add_pass({.name = "chromatic aberration",
                        .reads = {{light}},
                        .writes = {GL_RGBA32F, GL_RGBA32F},
                        .region = graph.shape(light).region,
                        .draw = [&shaders, light, color, defines](PassRun& run) {
                            Program& program =
                                shaders.full_screen("effects/chromatic_aberration/displace.frag", defines);
                            program.use();
                            run.bind(program, "layer", 0, light);
                            const Eigen::Vector2d centre = centre_of(color);
                            program.set("centre_px", Eigen::Vector2f(centre.cast<float>()));
                            program.set("corner_px", corner_px(color));
                            program.set("red_px", color.red_px);
                            program.set("blue_px", color.blue_px);
                            program.set("least_px", least_aberration_px);
                            run.draw(program);
                        }});
    displaced.light = written[0];
    displaced.coverage = written[1];
    return displaced;
}

}  // namespace matchlight
