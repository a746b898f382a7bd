// Reads the layers of a frame back, and makes those that follow from the others.
#include <algorithm>

#include "compositor/exchange.h"
#include "compositor/frame_passes.h"
#include "core/parallel.h"

namespace matchlight {

namespace {

ImageF channels_of(const ImageF& image, int first, int count) {
    ImageF part(image.width(), image.height(), count);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < count; ++c) part.at(x, y, c) = image.at(x, y, first + c);
        }
    }
    return part;
}

void put_channels(ImageF& image, int first, const ImageF& part) {
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x)
            std::copy_n(part.pixel(x, y), part.channels(), image.pixel(x, y) + first);
    }
}

/// Takes away what is behind something real.
void hide_behind(const ImageF& matte, const Region& region, ImageF& coverage) {
    for (int y = 0; y < region.height; ++y) {
        for (int x = 0; x < region.width; ++x) {
            for (int c = 0; c < coverage.channels(); ++c)
                coverage.at(x, y, c) *= 1 - matte.at(region.x + x, region.y + y);
        }
    }
}

/// What is left of the picture when all else that it is made of is taken away.
ImageF noise_of(const FrameLayers& layers) {
    ImageF noise = layers.beauty;
    parallel_for(noise.height(), [&](int y) {
        for (int x = 0; x < noise.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const float coverage = layers.coverage.empty() ? layers.alpha.at(x, y) : layers.coverage.at(x, y, c);
                const float spill = layers.spill.empty() ? 0 : layers.spill.at(x, y, c);
                const float mirrored = layers.reflection.empty() ? 0 : layers.reflection.at(x, y, c);
                noise.at(x, y, c) -= layers.plate.at(x, y, c) * layers.shadow.at(x, y, c) * (1 - coverage) + mirrored +
                                     layers.virtual_rgba.at(x, y, c) + spill;
            }
        }
    });
    return noise;
}

}  // namespace

void FramePasses::read_layers(CompositedFrame& result, const CompositePicture& picture, const ResponsePicture& shown,
                              const CompositeInput& input) const {
    const RenderGraph& graph = resources_.graph;
    const Region& region = result.reach;
    const auto read = [&](GraphTexture texture, int channels) {
        return read_runs(graph.texture(texture), region, {region}, channels);
    };
    const ImageF linear = read(shown.linear, 4), geometry = read(picture.geometry, 4);
    FrameLayers layers{.region = region,
                       .beauty = channels_of(linear, 0, 3),
                       .alpha = channels_of(linear, 3, 1),
                       .depth = channels_of(geometry, 3, 1),
                       .normal = channels_of(geometry, 0, 3),
                       .shadow = read(picture.shadow, 3),
                       .object_id = read(picture.object_id, 1),
                       .reflection = picture.reflection ? read(picture.reflection, 3) : ImageF(),
                       .virtual_rgba = read(picture.virtual_rgba, 4),
                       .background = background_ ? read(background_, 3) : ImageF(),
                       .plate = read(picture.light.before, 3),
                       .coverage = {},
                       .spill = resources_.effects.any() ? read(shown.spill, 3) : ImageF(),
                       .grain = {},
                       .clipped = clipped_plate_.bound,
                       .light = {.gain = plan_.optics.gain,
                                 .vignette = plan_.optics.vignette,
                                 .plate_gain = plan_.optics.plate_gain,
                                 .white_light = plan_.optics.white_light},
                       .motion = {},
                       .parts = {}};
    if (const GraphTexture coverage = input.blurred.coverage) {
        // Only where objects are; elsewhere it is none.
        const Region covered = graph.shape(coverage).region.intersected(region);
        layers.coverage = ImageF(region.width, region.height, 3);
        const Region& held = graph.shape(coverage).region;
        const ImageF part = read_runs(graph.texture(coverage), held, {covered}, 3);
        for (int y = 0; y < covered.height; ++y) {
            std::copy_n(part.pixel(covered.x - held.x, covered.y - held.y + y), 3 * covered.width,
                        layers.coverage.pixel(covered.x - region.x, covered.y - region.y + y));
        }
        if (!plan_.matte.empty()) hide_behind(plan_.matte, region, layers.coverage);
    }
    if (input.grain) layers.grain = noise_of(layers);
    if (exchange_) {
        layers.motion = motion_px(read(exchange_->motion, 4), region, resources_.camera, resources_.lens_map);
        layers.parts = ImageF(region.width, region.height, 16);
        for (int i = 0; i < 4; ++i) put_channels(layers.parts, 4 * i, read(exchange_->parts[i], 4));
    }
    result.layers = std::move(layers);
}

}  // namespace matchlight
