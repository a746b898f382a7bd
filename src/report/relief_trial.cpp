// Stones with joints between them, on a square of a metre, from nearby.
#include "report/relief_trial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/transforms.h"
#include "render/lamps.h"
#include "report/relief_reference.h"

namespace matchlight {

namespace {

constexpr int texels = 256;

/// Rows of rounded stones, every other one moved by half a stone.
double stone_height(double u, double v) {
    constexpr int stones = 5, rows = 8;
    const double row = v * rows;
    const double column = u * stones + (static_cast<int>(std::floor(row)) % 2 == 0 ? 0.0 : 0.5);
    const double across = 2 * std::abs(column - std::floor(column) - 0.5) * rows / stones;
    const double from_end = (static_cast<double>(rows) / stones - across) / 2;
    const double from_side = 0.5 - std::abs(row - std::floor(row) - 0.5);
    constexpr double round = 0.25;  // of a stone's height
    const auto rise = [](double distance) {
        const double t = std::clamp(distance / round, 0.0, 1.0);
        return t * t * (3 - 2 * t);
    };
    const double grain =
        0.04 * std::sin(2 * std::numbers::pi * (9 * u + 2 * v)) * std::cos(2 * std::numbers::pi * 7 * v);
    return std::clamp(0.05 + 0.88 * rise(from_end) * rise(from_side) + grain, 0.0, 1.0);
}

ImageF stone_heights() {
    ImageF heights(texels, texels, 1);
    for (int y = 0; y < texels; ++y) {
        for (int x = 0; x < texels; ++x)
            heights.at(x, y) = static_cast<float>(stone_height((x + 0.5) / texels, (y + 0.5) / texels));
    }
    return heights;
}

/// The stones bright, the joints dark, so that it is seen where the picture moves.
ModelTexture stone_colors(const ImageF& heights) {
    ModelTexture texture{.name = "stones", .rgba = Image8(texels, texels, 4, 255), .sampling = {}};
    for (int y = 0; y < texels; ++y) {
        for (int x = 0; x < texels; ++x) {
            std::uint8_t* texel = texture.rgba.pixel(x, y);
            const double height = heights.at(x, y);
            texel[0] = static_cast<std::uint8_t>(std::lround(90 + 110 * height));
            texel[1] = static_cast<std::uint8_t>(std::lround(70 + 100 * height));
            texel[2] = static_cast<std::uint8_t>(std::lround(60 + 70 * height));
        }
    }
    return texture;
}

}  // namespace

ReliefTrial::ReliefTrial(ShaderLibrary& shaders, const Probe& probe, double tilt_deg)
    : shaders_(shaders),
      environment_(shaders, probe),
      square_(make_shape("plane", "relief")),
      heights_(stone_heights()) {
    square_.textures.push_back(stone_colors(heights_));
    ModelMaterial& material = square_.materials.front();
    material.roughness = 0.6F;
    material.use(MaterialSlot::base_color) = {0, {}};
    // Seen within the square, so that no outline is.
    const double tilt = tilt_deg * std::numbers::pi / 180;
    const Eigen::Vector3d forward(0, std::cos(tilt), -std::sin(tilt));
    view_.eye_world_m = -0.5 * forward;
    PinholeView pinhole;
    pinhole.width = width;
    pinhole.height = height;
    pinhole.fx = pinhole.fy = 1.5 * width;
    pinhole.cx = (width - 1) / 2.0;
    pinhole.cy = (height - 1) / 2.0;
    view_.clip_from_world = clip_from_camera(pinhole) * camera_looking_along(view_.eye_world_m, forward).matrix();
    view_.width = width;
    view_.height = height;
    view_.samples = 1;
}

ReliefTrial::~ReliefTrial() = default;

std::shared_ptr<SurfaceRenderer> ReliefTrial::renderer(ReliefMethod method, int steps) const {
    SurfacePictures pictures{.settings = {}, .heights = {}, .layers = {}};
    pictures.settings.relief = {.height_map = "stones", .depth_m = carved_m, .method = method, .steps = steps};
    if (steps > 0) pictures.heights = heights_;
    auto made = std::make_shared<SurfaceRenderer>(shaders_);
    made->add_object({.model = &square_, .pictures = &pictures});
    return made;
}

std::shared_ptr<SurfaceRenderer> ReliefTrial::displaced() const {
    const Model model = displaced_model(square_, {.heights = heights_, .depth = carved_m});
    auto made = std::make_shared<SurfaceRenderer>(shaders_);
    made->add_object({.model = &model});
    return made;
}

void ReliefTrial::draw(SurfaceRenderer& renderer) const {
    renderer.draw(environment_, view_);
}

ImageF ReliefTrial::picture(SurfaceRenderer& renderer) const {
    const SurfacePicture drawn = renderer.draw(environment_, view_);
    return drawn.color->read<float>({0, 0, width, height}, 3);
}

ImageF ReliefTrial::picture(SurfaceRenderer& renderer, const LampSettings& lamp) const {
    Lamps lamps(std::span(&lamp, 1));
    lamps.draw_maps(
        shaders_, {renderer.shadow_caster_bounds_m(), [&](Program& program) { renderer.draw_shadow_casters(program); }},
        {.resolution = 4096}, true);
    SurfaceShading shading;
    shading.has_lamps = true;
    shading.bind = [&](Program& program) { lamps.bind(program); };
    return renderer.draw(environment_, view_, shading).color->read<float>({0, 0, width, height}, 3);
}

ImageF ReliefTrial::depth_m(SurfaceRenderer& renderer) const {
    return renderer.draw_layers(view_).depth_m->read<float>({0, 0, width, height}, 1);
}

}  // namespace matchlight
