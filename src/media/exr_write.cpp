// Multi-part EXR through OpenEXR, encoded in memory and then written by checked calls.
#include <algorithm>
#include <cstring>
#include <exception>
#include <string_view>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "media/exr_file.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

class MemoryStream : public Imf::OStream {
public:
    MemoryStream() : Imf::OStream("memory") {}
    void write(const char bytes[], int count) override {
        const std::size_t end = position_ + static_cast<std::size_t>(count);
        if (end > bytes_.size()) bytes_.resize(end);
        std::memcpy(bytes_.data() + position_, bytes, static_cast<std::size_t>(count));
        position_ = end;
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override { position_ = position; }
    std::string_view bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::size_t position_ = 0;
};

Imf::Header header_of(const ExrPart& part, const Imath::Box2i& display, const ImageMetadata& metadata) {
    const Imath::V2i origin(part.data_window.x, part.data_window.y);
    const Imath::Box2i data(origin, origin + Imath::V2i(part.image->width() - 1, part.image->height() - 1));
    Imf::Header header(display, data);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.setName(part.name);
    header.setType(Imf::SCANLINEIMAGE);
    for (const std::string& channel : part.channels)
        header.channels().insert(channel, Imf::Channel(part.half ? Imf::HALF : Imf::FLOAT));
    for (const ImageMetadata* entries : {&metadata, &part.metadata}) {
        for (const auto& [key, value] : *entries) header.insert(key, Imf::StringAttribute(value));
    }
    if (part.rec709) Imf::addChromaticities(header, Imf::Chromaticities());
    return header;
}

void write_part(Imf::MultiPartOutputFile& file, int index, const ExrPart& part) {
    const std::span<const float> samples = part.image->samples();
    const std::size_t channels = part.channels.size();
    // Narrowed here: OpenEXR does not convert, and a value beyond half range must become the largest half, not
    // infinity.
    constexpr float limit = HALF_MAX;
    std::vector<half> narrowed;
    if (part.half) {
        narrowed.resize(samples.size());
        std::transform(samples.begin(), samples.end(), narrowed.begin(),
                       [limit](float v) { return half(std::clamp(v, -limit, limit)); });
    }
    const std::size_t sample_bytes = part.half ? sizeof(half) : sizeof(float);
    const char* base =
        part.half ? reinterpret_cast<const char*>(narrowed.data()) : reinterpret_cast<const char*>(samples.data());
    const Imath::V2i origin(part.data_window.x, part.data_window.y);
    Imf::FrameBuffer slices;
    for (std::size_t c = 0; c < channels; ++c) {
        slices.insert(part.channels[c],
                      Imf::Slice::Make(part.half ? Imf::HALF : Imf::FLOAT, base + c * sample_bytes, origin,
                                       part.image->width(), part.image->height(), channels * sample_bytes,
                                       channels * sample_bytes * part.image->width()));
    }
    Imf::OutputPart output(file, index);
    output.setFrameBuffer(slices);
    output.writePixels(part.image->height());
}

}  // namespace

void write_exr(const std::filesystem::path& path, int display_width, int display_height,
               const std::vector<ExrPart>& parts, const ImageMetadata& metadata) {
    assert(!parts.empty() && display_width > 0 && display_height > 0);
    use_exr_threads();
    const Imath::Box2i display({0, 0}, {display_width - 1, display_height - 1});
    std::vector<Imf::Header> headers;
    for (const ExrPart& part : parts) {
        assert(part.image != nullptr && !part.image->empty());
        assert(static_cast<int>(part.channels.size()) == part.image->channels());
        assert(part.data_window.empty() ||
               (part.data_window.width == part.image->width() && part.data_window.height == part.image->height()));
        headers.push_back(header_of(part, display, metadata));
    }
    MemoryStream memory;
    try {
        Imf::MultiPartOutputFile file(memory, headers.data(), static_cast<int>(headers.size()));
        for (std::size_t i = 0; i < parts.size(); ++i) write_part(file, static_cast<int>(i), parts[i]);
    } catch (const std::exception& error) {
        throw InputError(path, fmt::format("cannot be encoded as EXR: {}", error.what()));
    }
    write_text_file(path, memory.bytes());
}

}  // namespace matchlight
