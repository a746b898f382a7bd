// Reads flat EXR parts of any storage and compression; the library's own limits are set first.
#include "media/exr_file.h"

#include <algorithm>
#include <exception>
#include <thread>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include "core/error.h"
#include "media/input_limits.h"

namespace matchlight {

namespace {

std::int64_t width_of(const Imath::Box2i& window) {
    return std::int64_t{window.max.x} - window.min.x + 1;
}

std::int64_t height_of(const Imath::Box2i& window) {
    return std::int64_t{window.max.y} - window.min.y + 1;
}

std::unique_ptr<Imf::MultiPartInputFile> open_checked(const std::filesystem::path& path) {
    require_regular_file(path);
    use_exr_threads();
    // OpenEXR sizes its tables by the header, so the limits must be known to it before it reads one.
    Imf::Header::setMaxImageSize(max_image_side, max_image_side);
    Imf::Header::setMaxTileSize(max_image_side, max_image_side);
    try {
        return std::make_unique<Imf::MultiPartInputFile>(path.c_str());
    } catch (const std::exception& error) {
        throw InputError(path, fmt::format("is no readable EXR file ({})", error.what()), "export it again");
    }
}

}  // namespace

void use_exr_threads() {
    static const bool done = [] {
        Imf::setGlobalThreadCount(static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
        return true;
    }();
    static_cast<void>(done);
}

ExrFile::ExrFile(const std::filesystem::path& path) : path_(path), file_(open_checked(path)) {
    for (int part = 0; part < parts(); ++part) {
        const Imf::Header& header = this->header(part);
        check_image_size(path, width_of(header.dataWindow()), height_of(header.dataWindow()));
        check_image_size(path, width_of(header.displayWindow()), height_of(header.displayWindow()));
        const auto& channels = header.channels();
        std::int64_t count = 0;
        for (auto channel = channels.begin(); channel != channels.end(); ++channel) ++count;
        if (count > max_image_channels)
            throw InputError(path, fmt::format("its header claims {} channels", count),
                             fmt::format("at most {} are read", max_image_channels));
    }
}

ExrFile::~ExrFile() = default;

int ExrFile::parts() const {
    return file_->parts();
}

const Imf::Header& ExrFile::header(int part) const {
    return file_->header(part);
}

std::string ExrFile::part_name(int part) const {
    return header(part).hasName() ? header(part).name() : std::string();
}

bool ExrFile::has_channel(int part, const std::string& channel) const {
    return header(part).channels().findChannel(channel) != nullptr;
}

ImageF ExrFile::read(int part, const std::vector<std::string>& channels) const {
    const Imf::Header& header = this->header(part);
    if (header.hasType() && !Imf::isImage(header.type()))
        throw InputError(path_, "is a deep image", "flatten it first");
    for (const std::string& channel : channels) {
        const Imf::Channel* found = header.channels().findChannel(channel);
        if (found == nullptr) throw InputError(path_, fmt::format("has no channel {}", channel));
        if (found->xSampling != 1 || found->ySampling != 1)
            throw InputError(path_, fmt::format("its channel {} is subsampled", channel), "export it as plain RGB");
    }
    if (!file_->partComplete(part)) throw InputError(path_, "ends early or is damaged", "export it again");

    const Imath::Box2i window = header.dataWindow();
    const Imath::Box2i display = header.displayWindow();
    ImageF data(static_cast<int>(width_of(window)), static_cast<int>(height_of(window)),
                static_cast<int>(channels.size()));
    const std::size_t pixel_bytes = channels.size() * sizeof(float);
    Imf::FrameBuffer slices;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        slices.insert(channels[c], Imf::Slice::Make(Imf::FLOAT, data.samples().data() + c, window.min, data.width(),
                                                    data.height(), pixel_bytes, pixel_bytes * data.width()));
    }
    try {
        Imf::InputPart input(*file_, part);
        input.setFrameBuffer(slices);
        input.readPixels(window.min.y, window.max.y);
    } catch (const std::exception& error) {
        throw InputError(path_, fmt::format("its pixels are damaged or cut off ({})", error.what()), "export it again");
    }
    if (window == display) return data;

    ImageF shown(static_cast<int>(width_of(display)), static_cast<int>(height_of(display)), data.channels());
    const Region placed{window.min.x - display.min.x, window.min.y - display.min.y, data.width(), data.height()};
    const Region common = placed.intersected(shown.bounds());
    if (common.empty()) throw InputError(path_, "its data window lies outside the picture");
    for (int y = common.y; y < common.y + common.height; ++y) {
        const float* from = data.pixel(common.x - placed.x, y - placed.y);
        std::copy_n(from, static_cast<std::size_t>(common.width) * data.channels(), shown.pixel(common.x, y));
    }
    return shown;
}

}  // namespace matchlight
