// Chooses each part's channels, window and metadata.
#include "compositor/exr_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compositor/cryptomatte.h"
#include "core/version.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

/// The units of parts, as `matchlight:unit` has them.
constexpr const char* light_unit = "camera-linear light, 1 = code 1 of the response";

std::string three_numbers(const Eigen::Vector3d& values) {
    return fmt::format("{:.9g} {:.9g} {:.9g}", values.x(), values.y(), values.z());
}

ImageMetadata metadata_of(const CompositedFrame& frame, const ExrOrigin& origin) {
    ImageMetadata metadata{{"software", origin.provenance},
                           {"frame", std::to_string(frame.plate.index())},
                           {"matchlight:version", version},
                           {"matchlight:scene", origin.scene.filename().string()},
                           {"matchlight:frame", std::to_string(origin.number)},
                           {"matchlight:time_s", fmt::format("{:.9g}", frame.plate.time_s())},
                           {"matchlight:primaries", "Rec.709, D65"}};
    if (frame.layers) {
        const LayerLight& light = frame.layers->light;
        metadata["matchlight:gain_from_probe"] = three_numbers(light.gain);
        // White balance is relative to green, as the solve has it.
        metadata["matchlight:exposure_ev"] = fmt::format("{:.9g}", std::log2(light.gain.y()));
        metadata["matchlight:white_balance"] = three_numbers(light.gain / light.gain.y());
        metadata["matchlight:vignette"] = fmt::format("{:.9g} {:.9g}", light.vignette[0], light.vignette[1]);
        metadata["matchlight:plate_gain"] = fmt::format("{:.9g}", light.plate_gain);
        metadata["matchlight:tone_white"] = fmt::format("{:.9g}", light.white_light);
    }
    return metadata;
}

/// The parts of one file, and the images that some of them are made into.
class ExrParts {
public:
    /// What is given whole lies over `picture`, the rest over `window`.
    ExrParts(const Region& picture, const Region& window) : picture_(picture), window_(window) {}

    void add_light(const char* name, const ImageF& image, bool covers_picture) {
        ExrPart& part = add(name, {"R", "G", "B"}, image, covers_picture);
        part.metadata = {{"matchlight:light", "camera-linear"},
                         {"matchlight:unit", light_unit},
                         {"matchlight:probe_light", "this light / (gain_from_probe * vignette)"}};
        part.rec709 = true;
    }
    ExrPart& add_data(const char* name, std::vector<std::string> channels, const ImageF& image, const char* unit) {
        ExrPart& part = add(name, std::move(channels), image, false);
        part.metadata = {{"matchlight:unit", unit}};
        return part;
    }
    std::vector<ExrPart>& parts() { return parts_; }

private:
    ExrPart& add(const char* name, std::vector<std::string> channels, const ImageF& image, bool covers_picture) {
        return parts_.emplace_back(ExrPart{.name = name,
                                           .channels = std::move(channels),
                                           .image = &image,
                                           .half = true,
                                           .data_window = covers_picture ? picture_ : window_,
                                           .metadata = {}});
    }

    Region picture_, window_;
    std::vector<ExrPart> parts_;
};

/// A layer's values put over those of the whole frame.
void put(ImageF& frame, const ImageF& layer, const Region& region) {
    for (int y = 0; y < region.height; ++y)
        std::copy_n(layer.pixel(0, y), layer.channels() * region.width, frame.pixel(region.x, region.y + y));
}

ImageF in_all_channels(const ImageF& alpha) {
    ImageF rgb(alpha.width(), alpha.height(), 3);
    for (int y = 0; y < rgb.height(); ++y) {
        for (int x = 0; x < rgb.width(); ++x) std::fill_n(rgb.pixel(x, y), 3, alpha.at(x, y));
    }
    return rgb;
}

/// Layers of a frame that has none: a pixel of nothing, as a part cannot be empty.
FrameLayers no_layers() {
    FrameLayers none;
    none.region = {0, 0, 1, 1};
    none.alpha = none.depth = none.object_id = ImageF(1, 1, 1);
    none.normal = ImageF(1, 1, 3);
    none.virtual_rgba = ImageF(1, 1, 4);
    return none;
}

std::array<Cryptomatte, 2> cryptomattes_of(const FrameLayers& layers, const std::vector<NamedPart>& parts) {
    std::vector<std::string> objects, materials;
    for (const NamedPart& part : parts) {
        objects.push_back(part.object);
        materials.push_back(part.material);
    }
    return {make_cryptomatte("CryptoObject", objects, layers.parts, layers.alpha),
            make_cryptomatte("CryptoMaterial", materials, layers.parts, layers.alpha)};
}

}  // namespace

void write_exr_layers(const std::filesystem::path& path, const CompositedFrame& frame, const Compositor& compositor,
                      const ExrOrigin& origin) {
    const PlateFormat& format = frame.plate.format();
    static const FrameLayers none = no_layers();
    const FrameLayers& layers = frame.layers ? *frame.layers : none;
    const Region picture = compositor.overscan().window(format.width, format.height);
    ImageF plate(picture.width, picture.height, 3);
    if (layers.background.empty())
        put(plate, compositor.plate_linear(frame.plate), {-picture.x, -picture.y, format.width, format.height});
    // A ratio is 1 where there is no shadow, while EXR takes 0 outside a part's window: so it covers the whole picture.
    ImageF shadow(picture.width, picture.height, 3, 1.0F);
    ImageF beauty;
    if (frame.layers) {
        const Region window = layers.region.moved(-picture.x, -picture.y);
        put(plate, layers.plate, window);
        put(shadow, layers.shadow, window);
        beauty = plate;
        put(beauty, layers.beauty, window);
    } else {
        beauty = plate;
    }
    const ImageF coverage = layers.coverage.empty() ? in_all_channels(layers.alpha) : layers.coverage;
    const ImageF nothing(layers.region.width, layers.region.height, 3);

    ExrParts file(picture, layers.region);
    file.add_light("beauty", beauty, true);
    // Once a file: a table is long.
    file.parts().front().metadata["matchlight:response"] = compositor.response_of(frame.plate).to_json().dump();
    const Eigen::Matrix3d& footage = from_rec709(format.primaries);
    file.parts().front().metadata["matchlight:footage_primaries"] = format.primaries.name();
    file.parts().front().metadata["matchlight:footage_from_rec709"] =
        three_numbers(footage.row(0)) + " " + three_numbers(footage.row(1)) + " " + three_numbers(footage.row(2));
    file.parts().front().metadata["matchlight:formula"] =
        "beauty = plate * shadow * (1 - coverage) + reflection + virtual + spill + grain";
    file.add_light("plate", plate, true);
    file.add_data("shadow", {"R", "G", "B"}, shadow, "ratio of the surface's light that is left").data_window = picture;
    file.add_data("alpha", {"A"}, layers.alpha, "coverage");
    file.add_light("virtual", layers.virtual_rgba, false);
    file.parts().back().channels = {"R", "G", "B", "A"};
    file.add_data("coverage", {"R", "G", "B"}, coverage, "coverage of each channel");
    file.add_light("reflection", layers.reflection.empty() ? nothing : layers.reflection, false);
    file.add_light("spill", layers.spill.empty() ? nothing : layers.spill, false);
    file.add_light("grain", layers.grain.empty() ? nothing : layers.grain, false);
    const ImageF unclipped(layers.region.width, layers.region.height, 1);
    file.add_data("clipped", {"Y"}, layers.clipped.empty() ? unclipped : layers.clipped,
                  "1 where the plate under a shadow is clipped, and known only from below; 0.5 where it has its "
                  "neighbours' colour");
    file.add_data("depth", {"Z"}, layers.depth, "metres along the camera's axis, 0 = nothing").half = false;
    file.add_data("normal", {"X", "Y", "Z"}, layers.normal, "unit vector in world axes, z up");
    const ImageF still(layers.region.width, layers.region.height, 4);
    file.add_data("motion", {"forward.u", "forward.v", "backward.u", "backward.v"},
                  layers.motion.empty() ? still : layers.motion,
                  "pixels to the right and up, from here to where it is in the next and in the previous frame")
        .half = false;
    file.add_data("object_id", {"id"}, layers.object_id, "number of the scene's object, 0 = nothing").half = false;
    // Programs look for the names of mattes in one part or another, so all of them have them.
    ImageMetadata metadata = metadata_of(frame, origin);
    const std::array<Cryptomatte, 2> mattes = cryptomattes_of(layers, compositor.parts());
    for (const Cryptomatte& matte : mattes) {
        file.add_data(matte.layer.c_str(), matte.channels, matte.ranks, "Cryptomatte: id, coverage").half = false;
        metadata.insert(matte.metadata.begin(), matte.metadata.end());
    }
    write_exr(path, format.width, format.height, file.parts(), metadata);
}

}  // namespace matchlight
