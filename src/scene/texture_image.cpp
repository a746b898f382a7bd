// Decodes pictures from memory with OpenImageIO, header first.
#include "scene/texture_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "core/memory.h"
#include "scene/confined_path.h"

namespace matchlight {
namespace {

/// The largest texture that the renderer's GL takes.
constexpr int largest_side = 16384;

/// OpenImageIO chooses the format by the name's extension; the contents say it more reliably.
const char* extension_of(const std::string& bytes) {
    struct Signature {
        std::string_view start;
        const char* extension;
    };
    constexpr Signature signatures[] = {{"\x89PNG", "png"}, {"\xff\xd8\xff", "jpg"}, {"GIF8", "gif"},
                                        {"BM", "bmp"},      {"RIFF", "webp"},        {"II*", "tif"}};
    for (const Signature& signature : signatures) {
        if (std::string_view(bytes).starts_with(signature.start)) return signature.extension;
    }
    return "tga";  // has no signature
}

/// Spreads 1 (grey), 2 (grey and alpha) or 3 channels to 4.
Image8 spread_to_rgba(const Image8& image) {
    Image8 rgba(image.width(), image.height(), 4, 255);
    const int channels = image.channels();
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const std::uint8_t* from = image.pixel(x, y);
            std::uint8_t* to = rgba.pixel(x, y);
            for (int c = 0; c < 3; ++c) to[c] = channels < 3 ? from[0] : from[c];
            if (channels == 2) to[3] = from[1];
            if (channels == 4) to[3] = from[3];
        }
    }
    return rgba;
}

}  // namespace

std::optional<Image8> read_texture(const TextureSource& source, const std::filesystem::path& model,
                                   Warnings& warnings) {
    const auto left_out = [&](const std::string& why) {
        warnings.add(fmt::format("{}: texture '{}' {}, left out", model.string(), source.name, why));
        return std::nullopt;
    };
    std::string file_bytes;
    if (!source.file.empty()) {
        std::error_code failure;
        if (!std::filesystem::is_regular_file(source.file, failure)) return left_out("is missing");
        file_bytes = read_binary_file(source.file);
    }
    const std::string& bytes = source.file.empty() ? source.bytes : file_bytes;
    if (bytes.empty()) return left_out("is empty");

    OIIO::Filesystem::IOMemReader memory(bytes.data(), bytes.size());
    OIIO::Filesystem::IOProxy* proxy = &memory;
    OIIO::ImageSpec config;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    config.attribute("oiio:UnassociatedAlpha", 1);
    const std::string name = std::string("texture.") + extension_of(bytes);
    const auto input = OIIO::ImageInput::open(name, &config);
    if (!input) {
        OIIO::geterror();  // it belongs to the thread and would show up elsewhere
        return left_out("cannot be decoded");
    }
    const OIIO::ImageSpec spec = input->spec();
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1) return left_out("is no picture");
    if (spec.width > largest_side || spec.height > largest_side) {
        throw InputError(model, fmt::format("texture '{}' is {} × {} pixels; the limit is {}", source.name, spec.width,
                                            spec.height, largest_side));
    }
    const int channels = std::min(spec.nchannels, 4);
    // The decoded picture, its RGBA form and the decoder's own copy.
    const std::uint64_t needed = 3ull * 4 * static_cast<std::uint64_t>(spec.width) * spec.height;
    if (needed > available_memory_bytes()) {
        throw InputError(model, fmt::format("texture '{}' needs {} MB, more than there is", source.name, needed >> 20));
    }
    Image8 pixels(spec.width, spec.height, channels);
    if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, pixels.samples().data())) {
        input->geterror();
        return left_out("is damaged");
    }
    if (channels == 4) return pixels;
    return spread_to_rgba(pixels);
}

}  // namespace matchlight
