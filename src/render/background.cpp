// Uploads what is shown, and draws it in one pass.
#include "render/background.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "core/lowercase.h"
#include "core/transfer.h"
#include "lighting/latlong_pyramid.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

/// Full floats: a sun may be brighter than a half float holds, and the exposure that makes it fit comes later.
Texture2D sky_texture(const Probe& probe) {
    const std::vector<ImageF> levels = latlong_pyramid(probe.latlong);
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (levels[0].width() > largest) {
        throw InputError("", fmt::format("[background]: the probe is {} pixels wide, the driver takes {}",
                                         levels[0].width(), largest));
    }
    Texture2D sky({.format = GL_RGB32F, .width = levels[0].width(), .height = levels[0].height(), .levels = 0});
    for (std::size_t level = 0; level < levels.size(); ++level) {
        sky.upload(levels[level].bounds(), levels[level].samples(), static_cast<int>(level));
    }
    sky.set_filter(Filter::trilinear);  // else fetches reach level 0 only
    return sky;
}

bool is_scene_linear(const std::filesystem::path& path) {
    const std::string ending = lowercase_extension(path);
    return ending == ".exr" || ending == ".hdr";
}

/// Scene-linear; pictures of other kinds than .exr and .hdr are taken as sRGB.
ImageF linear_image(const std::filesystem::path& path, Warnings& warnings) {
    if (is_scene_linear(path)) return read_linear_rgb(path, warnings);
    const Image16 codes = read_rgb16(path);
    ImageF linear(codes.width(), codes.height(), 3);
    constexpr double white_code = 65535;
    std::transform(codes.samples().begin(), codes.samples().end(), linear.samples().begin(),
                   [](std::uint16_t code) { return static_cast<float>(linear_from_srgb_code(code / white_code)); });
    return linear;
}

}  // namespace

Background::Background(const BackgroundSettings& settings, const Probe& probe, int width, int height,
                       Warnings& warnings) {
    if (settings.color) color_ = {(*settings.color)[0], (*settings.color)[1], (*settings.color)[2]};
    if (settings.probe) sky_ = sky_texture(probe);
    if (settings.image.empty()) return;
    const ImageF image = linear_image(settings.image, warnings);
    if (image.width() != width || image.height() != height) {
        throw InputError(settings.image,
                         fmt::format("is {}×{}, the camera {}×{}", image.width(), image.height(), width, height),
                         "make the background the camera's size");
    }
    image_ = Texture2D({.format = GL_RGB32F, .width = image.width(), .height = image.height()});
    image_.upload(image);
}

std::optional<ImageF> Background::picture() const {
    if (sky_) return std::nullopt;
    if (image_) return image_.read<float>({0, 0, image_.width(), image_.height()}, 3);
    ImageF even(1, 1, 3);
    for (int c = 0; c < 3; ++c) even.at(0, 0, c) = static_cast<float>(color_[c]);
    return even;
}

GraphTexture Background::add(RenderGraph& graph, ShaderLibrary& shaders, const BackgroundView& view) const {
    if (!view.defocus || !can_blur()) return add_part(graph, shaders, view, {0, 0, view.width, view.height}, 1);
    return add_background_defocus(
        graph, shaders,
        [&](const Region& texels, int texel_px) { return add_part(graph, shaders, view, texels, texel_px); },
        *view.defocus);
}

GraphTexture Background::add_part(RenderGraph& graph, ShaderLibrary& shaders, const BackgroundView& view,
                                  const Region& texels, int texel_px) const {
    return graph.add_pass(
        {.name = "background",
         .writes = {GL_RGBA32F},
         .scale = texel_px,
         .region = texels,
         .beyond_frame = true,
         .draw = [this, &shaders, view, texel_px](PassRun& run) {
             const Eigen::Vector3f gain = view.gain.cast<float>();
             if (!sky_ && !image_) {
                 const Eigen::Vector3f light = view.gain.cwiseProduct(color_).cast<float>();
                 run.target().clear_color(0, light.x(), light.y(), light.z(), 0);
                 return;
             }
             Program& program = shaders.full_screen(sky_ ? "background/sky.frag" : "background/image.frag");
             program.use();
             program.bind_texture("source", 0, sky_ ? sky_ : image_);
             program.set("gain", gain);
             // Each pixel as it is drawn sharp, so that blurred light is the sharp picture's; of the widest discs'
             // texels not every one.
             constexpr int most_samples = 16;
             program.set("texel_px", texel_px);
             program.set("samples", std::min(texel_px, most_samples));
             program.set("intrinsics",
                         Eigen::Vector4f(Eigen::Vector4d(view.fx, view.fy, view.cx, view.cy).cast<float>()));
             program.set("world_from_camera",
                         Eigen::Matrix3f(view.camera_from_world.linear().transpose().cast<float>()));
             run.draw(program);
         }})[0];
}

}  // namespace matchlight
