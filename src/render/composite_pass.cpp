// Uploads the region's code values and draws one triangle a run.
#include "render/composite_pass.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "gl/framebuffer.h"

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

void put(ImageF& image, const Region& part, const ImageF& packed) {
    for (int y = 0; y < part.height; ++y) {
        std::copy_n(packed.pixel(0, y), part.width * image.channels(), image.pixel(part.x, part.y + y));
    }
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

/// Draws only where the runs are.
void draw_runs(const PassRun& run, Program& program, const Region& region, const std::vector<Region>& runs) {
    glEnable(GL_SCISSOR_TEST);
    for (const Region& one : runs) {
        const Region part = one.moved(-region.x, -region.y);
        glScissor(part.x, part.y, part.width, part.height);
        run.draw(program);
    }
    glDisable(GL_SCISSOR_TEST);
}

GLenum upload_format(int channels) {
    return channels == 1 ? GL_R32F : channels == 3 ? GL_RGB32F : GL_RGBA32F;
}

}  // namespace

ImageF read_runs(const Texture2D& texture, const Region& region, const std::vector<Region>& runs, int channels) {
    const Framebuffer source({texture});
    ImageF image(region.width, region.height, channels);
    for (const Region& run : runs) {
        const Region part = run.moved(-region.x, -region.y);
        put(image, part, source.read<float>(part, channels));
    }
    return image;
}

CompositePass::CompositePass(ShaderLibrary& shaders, const ImageF& lens_nodes, int lens_spacing, const ImageF& response,
                             const Primaries& primaries)
    : shaders_(shaders),
      lens_nodes_({.format = GL_RG32F, .width = lens_nodes.width(), .height = lens_nodes.height()}),
      response_({.format = GL_R32F, .width = response.width(), .height = 6}),
      response_table_(response),
      lens_spacing_(lens_spacing),
      primaries_(primaries),
      empty_({.format = GL_RGBA32F, .width = 2, .height = 2}),
      empty_id_({.format = GL_R32UI, .width = 2, .height = 2}) {
    lens_nodes_.upload(lens_nodes);
    response_.upload(with_starting_points(response));
}

double CompositePass::linear_from_code(float code, int channel) const {
    const std::span<const float> light = response_table_.row(channel);
    const double at = std::clamp(static_cast<double>(code), 0.0, 1.0) * (response_table_.width() - 1);
    const auto below = std::min(static_cast<std::size_t>(at), light.size() - 2);
    return std::lerp(static_cast<double>(light[below]), static_cast<double>(light[below + 1]),
                     at - static_cast<double>(below));
}

double CompositePass::least_visible_light(int bit_depth) const {
    const int last = response_table_.width() - 1;
    const int half_step = std::max(1, last / (2 * ((1 << bit_depth) - 1)));
    double least = 1e9;
    for (int channel = 0; channel < 3; ++channel) {
        const std::span<const float> light = response_table_.row(channel);
        for (int i = half_step; i <= last; ++i) {
            least = std::min(least, static_cast<double>(light[i]) - static_cast<double>(light[i - half_step]));
        }
    }
    // A change of one channel by this changes none of the footage's channels by more.
    return least / from_rec709(primaries_).cwiseAbs().rowwise().sum().maxCoeff();
}

double CompositePass::brightest_light() const {
    double most = 0;
    for (int channel = 0; channel < 3; ++channel) most = std::max<double>(most, response_table_.row(channel).back());
    // Light that is brightest in one of the footage's channels alone.
    return most * rec709_from(primaries_).cwiseMax(0).rowwise().sum().maxCoeff();
}

void CompositePass::set_response(Program& program) const {
    program.bind_texture("response_linear", 2, response_);
    program.set("rec709_from_footage", Eigen::Matrix3f(rec709_from(primaries_).cast<float>()));
    program.set("footage_from_rec709", Eigen::Matrix3f(from_rec709(primaries_).cast<float>()));
}

GraphTexture CompositePass::add_upload(RenderGraph& graph, const Upload& upload) {
    double pixels = 0;
    for (const Region& run : upload.runs) pixels += static_cast<double>(run.width) * run.height;
    const ImageF& picture = upload.picture;
    const Region covered = upload.covered, region = upload.region;
    return graph.add_pass({.name = upload.name,
                           .writes = {upload_format(picture.channels())},
                           .region = region,
                           .raster = false,
                           .bytes = pixels * picture.channels() * static_cast<double>(sizeof(float)),
                           .draw = [&picture, covered, region, runs = upload.runs](PassRun& run) {
                               for (const Region& one : runs) {
                                   const ImageF rows = rows_of(picture, one.moved(-covered.x, -covered.y));
                                   run.upload(one.moved(-region.x, -region.y), rows.samples());
                               }
                           }})[0];
}

ShaderDefines CompositePass::layer_defines(const CompositeInput& input) {
    if (input.layer == nullptr || input.layer->whole_density == 0) return {};
    return {{"LAYER_DENSITY", std::to_string(input.layer->whole_density)}};
}

void CompositePass::set_layer(Program& program, const CompositeInput& input) const {
    static const VirtualLayer nothing;
    const VirtualLayer& layer = input.layer != nullptr ? *input.layer : nothing;
    const SurfacePicture& picture = layer.picture;
    program.set("layer_present", picture.color != nullptr);
    program.set("layer_size", Eigen::Vector2i(picture.width, picture.height));
    program.set("layer_intrinsics",
                Eigen::Vector4f(Eigen::Vector4d(layer.fx, layer.fy, layer.cx, layer.cy).cast<float>()));
    program.set("layer_first_pixel", layer.first_pixel);
    const auto bind_or = [&](const char* sampler, GLuint unit, const Texture2D* texture, const Texture2D& otherwise) {
        program.bind_texture(sampler, unit, texture != nullptr ? *texture : otherwise);
    };
    set_lens(program, 1);
    bind_or("layer", 3, picture.color, empty_);
    const auto share_of = [](const SurfacePicture& of) { return of.focus_share ? of.focus_share : of.depth_share; };
    bind_or("layer_depth_share", 9, share_of(picture), empty_);
    program.set("near_m", near_plane_m);
    program.set("hidden_present", layer.hidden.color != nullptr);
    bind_or("hidden_layer", 12, layer.hidden.color, empty_);
    bind_or("hidden_depth_share", 13, share_of(layer.hidden), empty_);
    if (!input.layers) return;
    bind_or("layer_normal", 6, picture.normal, empty_);
    bind_or("layer_depth_m", 7, picture.depth_m, empty_);
    bind_or("layer_object_id", 8, picture.object_id, empty_id_);
}

void CompositePass::set_lens(Program& program, GLuint unit) const {
    program.bind_texture("lens_nodes", unit, lens_nodes_);
    program.set("lens_spacing", static_cast<float>(lens_spacing_));
}

void CompositePass::set_surface(Program& program, const CompositeInput& input) const {
    set_lens(program, 1);
    program.set("shadow_present", input.shadow != nullptr);
    if (input.shadow != nullptr) {
        input.shadow->bind(program, 4);
        program.set("surface_z_m", input.shadow->surface_z_m);
    } else {
        program.bind_texture("shadow_fine", 4, empty_);
        program.bind_texture("shadow_far", 5, empty_);
    }
    const RigidTransform world_from_camera = input.optics.camera_from_world.inverse();
    program.set("world_from_camera", Eigen::Matrix3f(world_from_camera.linear().cast<float>()));
    program.set("eye_world_m", Eigen::Vector3f(world_from_camera.translation().cast<float>()));
    program.set("least_visible_loss", input.least_visible_loss);
}

void CompositePass::set_input(Program& program, const CompositeInput& input) const {
    set_response(program);
    set_layer(program, input);
    set_surface(program, input);

    const FrameOptics& optics = input.optics;
    program.set("gain", Eigen::Vector3f(optics.gain.cast<float>()));
    program.set("vignette", Eigen::Vector2f(Eigen::Vector2d(optics.vignette[0], optics.vignette[1]).cast<float>()));
    const Eigen::Vector2d centre((optics.frame_width - 1) / 2.0, (optics.frame_height - 1) / 2.0);
    const double corner_px = std::hypot(optics.frame_width, optics.frame_height) / 2 / optics.corner_ratio;
    program.set("vignette_frame",
                Eigen::Vector3f(Eigen::Vector3d(centre.x(), centre.y(), 1 / corner_px).cast<float>()));
    program.set("plate_gain", optics.plate_gain);
    program.set("white_light", optics.white_light);
}

ResolvedLayer CompositePass::add_resolved_layer(RenderGraph& graph, const CompositeInput& input, const Region& region) {
    const std::vector<GraphTexture> written =
        graph.add_pass({.name = "resolve",
                        .reads = {{input.layer_drawn}},
                        .writes = {GL_RGBA32F, GL_R32F},
                        .region = region,
                        .draw = [this, input](PassRun& run) {
                            Program& program = shaders_.full_screen("composite/resolve.frag", layer_defines(input));
                            program.use();
                            set_layer(program, input);
                            run.draw(program);
                        }});
    return {written[0], written[1]};
}

GraphTexture CompositePass::add_shadow_ratio(RenderGraph& graph, const CompositeInput& input, const Region& region) {
    return graph.add_pass(
        {.name = "shadow", .writes = {GL_RGBA32F}, .region = region, .draw = [this, input](PassRun& run) {
             Program& program = shaders_.full_screen(
                 "composite/shadow_ratio.frag", input.shadow != nullptr ? input.shadow->defines() : ShaderDefines{});
             program.use();
             set_surface(program, input);
             run.draw(program);
         }})[0];
}

CompositePicture CompositePass::add(RenderGraph& graph, const CompositeInput& input) {
    const GraphTexture plate =
        input.background
            ? input.background
            : add_upload(graph, {"plate/upload", *input.plate_code, input.region, input.region, input.runs});
    GraphTexture matte;
    if (input.matte != nullptr) {
        const Region frame{0, 0, input.optics.frame_width, input.optics.frame_height};
        matte = add_upload(graph, {"matte/upload", *input.matte, frame, input.region, input.runs});
    }
    const PlateLayer& blurred = input.blurred;
    GraphPass pass{.name = "composite",
                   .reads = {{plate},
                             {matte},
                             {input.inverse_depth},
                             {blurred.holdouts},
                             {input.layer_drawn},
                             {blurred.light},
                             {blurred.shadow},
                             {blurred.coverage}},
                   .writes = {GL_RGBA32F},
                   .region = input.region};
    GraphTexture unclipped;
    if (input.unclipped != nullptr) {
        unclipped = add_upload(graph, {"plate/unclipped", *input.unclipped, input.region, input.region, input.runs});
        pass.reads.push_back({unclipped});
    }
    ShaderDefines defines = layer_defines(input);
    if (unclipped) defines["UNCLIPPED"] = "1";
    if (input.shadow != nullptr) defines.merge(input.shadow->defines());
    if (blurred.light) defines["BLURRED_LAYER"] = "1";
    if (blurred.shadow) defines["BLURRED_SHADOW"] = "1";
    if (blurred.coverage) defines["CHANNEL_COVERAGE"] = "1";
    if (matte) defines["MATTE"] = "1";
    if (blurred.holdouts) defines["HOLDOUTS"] = "1";
    if (input.inverse_depth && input.shadow != nullptr) defines["REAL_DEPTH"] = "1";
    if (input.background) defines["NO_FOOTAGE"] = "1";
    if (input.reflection) {
        defines["REFLECTION"] = "1";
        const SurfaceReflection& reflection = input.reflection;
        for (const GraphTexture part : {reflection.objects, reflection.covered, reflection.shown})
            pass.reads.push_back({part});
    }
    if (input.grain) {
        defines["GRAIN"] = "1";
        pass.reads.push_back({input.grain->noise});
    }
    if (input.light) {
        pass.writes.push_back(GL_RGBA32F);
        defines["WRITE_LIGHT"] = "1";
    }
    if (input.layers) {
        pass.writes.insert(pass.writes.end(), 4, GL_RGBA32F);
        defines["WRITE_LAYERS"] = "1";
    }
    if (input.layers && input.reflection) {
        defines["REFLECTION_LAYER"] = std::to_string(pass.writes.size());
        pass.writes.push_back(GL_RGBA32F);
    }
    if (input.light && input.grain) {
        defines["PLATE_SHARE"] = std::to_string(pass.writes.size());
        pass.writes.push_back(GL_RGBA32F);
    }
    pass.draw = [this, input, plate, matte, unclipped, defines](PassRun& run) {
        if (input.light) {
            // Effects look at the whole region; between the runs nothing was added or taken away.
            for (const int target : {0, 1}) run.target().clear_color(target, 0, 0, 0, 0);
        }
        Program& program = shaders_.full_screen("composite/composite.frag", defines);
        program.use();
        run.bind(program, "plate_code", 0, plate);
        set_input(program, input);
        run.bind(program, "blurred_layer", 10, input.blurred.light);
        run.bind(program, "blurred_shadow", 11, input.blurred.shadow);
        run.bind(program, "channel_coverage", 13, input.blurred.coverage);
        if (unclipped) {
            run.bind(program, "unclipped_light", 16, unclipped);
            program.set("clipped_code", input.clipped_code);
        }
        run.bind(program, "matte", 14, matte);
        run.bind(program, "holdouts", 15, input.blurred.holdouts);
        run.bind(program, "real_inverse_depth", 17, input.inverse_depth);
        if (input.reflection) {
            run.bind(program, "mirrored_objects", 18, input.reflection.objects);
            run.bind(program, "mirrored_covered", 19, input.reflection.covered);
            run.bind(program, "mirrored_shown", 20, input.reflection.shown);
        }
        if (input.grain && !input.light) set_grain(run, program, 12, *input.grain);
        draw_runs(run, program, input.region, input.runs);
    };
    const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
    CompositePicture picture;
    picture.plate = plate;
    (input.light ? picture.light.after : picture.code) = written[0];
    if (input.light) picture.light.before = written[1];
    if (input.light && input.grain) picture.plate_share = written.back();
    if (input.layers) {
        picture.shadow = written[2];
        picture.virtual_rgba = written[3];
        picture.geometry = written[4];
        picture.object_id = written[5];
        if (input.reflection) picture.reflection = written[6];
    }
    return picture;
}

ResponsePicture CompositePass::add_response(RenderGraph& graph, const ResponseInput& input) {
    const bool around = !input.light.after;
    const GraphTexture plate =
        input.plate
            ? input.plate
            : add_upload(graph, {"plate/upload around", *input.plate_code, input.region, input.region, input.runs});
    GraphPass pass{.name = around ? "response around" : "response",
                   .reads = {{plate}, {input.light.after}, {input.light.before}, {input.spill}, {input.plate_share}},
                   .writes = {GL_RGBA32F},
                   .region = input.region};
    ShaderDefines defines;
    if (around) defines["PLATE_ALONE"] = "1";
    if (input.grain) {
        defines["GRAIN"] = "1";
        pass.reads.push_back({input.grain->noise});
    }
    if (input.layers) {
        pass.writes.insert(pass.writes.end(), 2, GL_RGBA32F);
        defines["WRITE_LAYERS"] = "1";
    }
    pass.draw = [this, input, plate, defines](PassRun& run) {
        Program& program = shaders_.full_screen("composite/response.frag", defines);
        program.use();
        run.bind(program, "plate_code", 0, plate);
        run.bind(program, "light_after", 1, input.light.after);
        set_response(program);
        run.bind(program, "light_before", 3, input.light.before);
        run.bind(program, "spill", 4, input.spill);
        if (input.grain) {
            run.bind(program, "plate_share", 5, input.plate_share);
            program.set("plate_share_present", static_cast<bool>(input.plate_share));
            set_grain(run, program, 6, *input.grain);
        }
        program.set("spill_present", static_cast<bool>(input.spill));
        program.set("least_visible_code", input.least_visible_code);
        program.set("least_visible_light", input.least_visible_light);
        program.set("white_light", input.white_light);
        draw_runs(run, program, input.region, input.runs);
    };
    const std::vector<GraphTexture> written = graph.add_pass(std::move(pass));
    if (!input.layers) return {.code = written[0], .linear = {}, .spill = {}};
    return {.code = written[0], .linear = written[1], .spill = written[2]};
}

}  // namespace matchlight
