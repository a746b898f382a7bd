// Uploads the region's code values, draws one triangle, reads the region back.
#include "render/composite_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace matchlight {

namespace {

/// The samples of a part of an image, packed.
ImageF rows_of(const ImageF& image, const Region& part) {
    ImageF packed(part.width, part.height, image.channels());
    for (int y = 0; y < part.height; ++y) {
        std::copy_n(image.pixel(part.x, part.y + y), part.width * image.channels(), packed.pixel(0, y));
    }
    return packed;
}

/// Below the three rows of light at each code, three rows that say for evenly spaced roots of light (as a share of the
/// last entry) in which interval of the row it lies: where code_from_linear of common/response.glsl starts.
ImageF with_starting_points(const ImageF& response) {
    const int last = response.width() - 1;
    ImageF table(response.width(), 6, 1);
    for (int channel = 0; channel < 3; ++channel) {
        const std::span<const float> light = response.row(channel);
        std::ranges::copy(light, table.row(channel).begin());
        for (int i = 0; i <= last; ++i) {
            const double root = static_cast<double>(i) / last;
            const auto above = std::ranges::upper_bound(light, static_cast<float>(root * root * light.back()));
            const auto interval = std::distance(light.begin(), above) - 1;
            table.at(i, channel + 3) = static_cast<float>(std::clamp<std::ptrdiff_t>(interval, 0, last - 1));
        }
    }
    return table;
}

void put(ImageF& image, const Region& part, const ImageF& packed) {
    for (int y = 0; y < part.height; ++y) {
        std::copy_n(packed.pixel(0, y), part.width * image.channels(), image.pixel(part.x, part.y + y));
    }
}

}  // namespace

CompositePass::CompositePass(ShaderLibrary& shaders, const ImageF& lens_nodes, int lens_spacing, const ImageF& response)
    : shaders_(shaders),
      lens_nodes_({.format = GL_RG32F, .width = lens_nodes.width(), .height = lens_nodes.height()}),
      response_({.format = GL_R32F, .width = response.width(), .height = 6}),
      lens_spacing_(lens_spacing),
      empty_({.format = GL_RGBA32F, .width = 2, .height = 2}),
      empty_id_({.format = GL_R32UI, .width = 2, .height = 2}) {
    lens_nodes_.upload(lens_nodes);
    response_.upload(with_starting_points(response));
}

void CompositePass::hold(const Region& region, bool layers) {
    const std::array<Texture2D*, 5> layer_targets{&linear_, &shadow_, &virtual_, &geometry_, &object_};
    if (region.width > width_ || region.height > height_) {
        width_ = std::max(width_, region.width);
        height_ = std::max(height_, region.height);
        plate_ = Texture2D({.format = GL_RGB32F, .width = width_, .height = height_});
        code_ = Texture2D({.format = GL_RGBA32F, .width = width_, .height = height_});
        for (Texture2D* target : layer_targets) *target = Texture2D();
    }
    if (!layers || linear_) return;
    for (Texture2D* target : layer_targets) {
        *target = Texture2D({.format = GL_RGBA32F, .width = width_, .height = height_});
    }
}

CompositeOutput CompositePass::draw(const CompositeInput& input) {
    const Region& region = input.region;
    const Region origin{0, 0, region.width, region.height};
    hold(region, input.layers);
    for (const Region& run : input.runs) {
        const Region part = run.moved(-region.x, -region.y);
        const ImageF rows = rows_of(*input.plate_code, part);
        plate_.upload(part, rows.samples());
    }
    const Framebuffer target =
        input.layers ? Framebuffer({code_, linear_, shadow_, virtual_, geometry_, object_}) : Framebuffer({code_});
    target.bind(origin);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);

    Program& program = shaders_.full_screen("composite/composite.frag",
                                            input.layers ? ShaderDefines{{"WRITE_LAYERS", "1"}} : ShaderDefines{});
    program.use();
    program.bind_texture("plate_code", 0, plate_);
    program.set("region_origin", Eigen::Vector2i(region.x, region.y));
    program.bind_texture("lens_nodes", 1, lens_nodes_);
    program.set("lens_spacing", static_cast<float>(lens_spacing_));
    program.bind_texture("response_linear", 2, response_);

    const VirtualLayer& layer = input.layer;
    const SurfacePicture& picture = layer.picture;
    program.set("layer_present", picture.color != nullptr);
    program.set("layer_size", Eigen::Vector2i(picture.width, picture.height));
    program.set("layer_intrinsics",
                Eigen::Vector4f(Eigen::Vector4d(layer.fx, layer.fy, layer.cx, layer.cy).cast<float>()));
    const auto bind_or = [&](const char* sampler, GLuint unit, const Texture2D* texture, const Texture2D& otherwise) {
        program.bind_texture(sampler, unit, texture != nullptr ? *texture : otherwise);
    };
    bind_or("layer", 3, picture.color, empty_);
    if (input.layers) {
        bind_or("layer_normal", 6, picture.normal, empty_);
        bind_or("layer_depth_m", 7, picture.depth_m, empty_);
        bind_or("layer_object_id", 8, picture.object_id, empty_id_);
    }

    program.set("shadow_present", input.shadow != nullptr);
    if (input.shadow != nullptr) {
        input.shadow->bind(program, 4);
        program.set("surface_z_m", input.shadow->surface_z_m);
    } else {
        program.bind_texture("shadow_fine", 4, empty_);
        program.bind_texture("shadow_far", 5, empty_);
    }

    const FrameOptics& optics = input.optics;
    const RigidTransform world_from_camera = optics.camera_from_world.inverse();
    program.set("world_from_camera", Eigen::Matrix3f(world_from_camera.linear().cast<float>()));
    program.set("eye_world_m", Eigen::Vector3f(world_from_camera.translation().cast<float>()));
    program.set("gain", Eigen::Vector3f(optics.gain.cast<float>()));
    program.set("vignette", Eigen::Vector2f(Eigen::Vector2d(optics.vignette[0], optics.vignette[1]).cast<float>()));
    const Eigen::Vector2d centre((optics.frame_width - 1) / 2.0, (optics.frame_height - 1) / 2.0);
    const double corner_px = std::hypot(optics.frame_width, optics.frame_height) / 2;
    program.set("vignette_frame",
                Eigen::Vector3f(Eigen::Vector3d(centre.x(), centre.y(), 1 / corner_px).cast<float>()));
    program.set("least_visible_loss", input.least_visible_loss);

    CompositeOutput output;
    output.code = ImageF(region.width, region.height, 4);
    glEnable(GL_SCISSOR_TEST);
    for (const Region& run : input.runs) {
        const Region part = run.moved(-region.x, -region.y);
        glScissor(part.x, part.y, part.width, part.height);
        triangle_.draw();
    }
    glDisable(GL_SCISSOR_TEST);
    for (const Region& run : input.runs) {
        const Region part = run.moved(-region.x, -region.y);
        put(output.code, part, target.read<float>(part, 4));
    }
    if (input.layers) {
        output.linear = target.read<float>(origin, 4, 1);
        output.shadow = target.read<float>(origin, 3, 2);
        output.virtual_rgba = target.read<float>(origin, 4, 3);
        output.geometry = target.read<float>(origin, 4, 4);
        output.object_id = target.read<float>(origin, 1, 5);
    }
    return output;
}

}  // namespace matchlight
