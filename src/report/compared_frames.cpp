// Pictures through image_io, videos through FrameSource.
#include "report/compared_frames.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/lowercase.h"
#include "media/frame_source.h"
#include "media/image_io.h"
#include "report/srgb_picture.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

bool is_linear_picture(const fs::path& path) {
    const std::string extension = lowercase_extension(path);
    return extension == ".exr" || extension == ".hdr";
}

ComparedFrame read_frame(const fs::path& path, std::int64_t number, bool is_mask, Warnings& warnings) {
    ComparedFrame frame;
    frame.number = number;
    frame.file = path;
    if (is_mask) {
        frame.rgb = read_mask(path);
    } else if (is_linear_picture(path)) {
        frame.linear = read_linear_rgb(path, warnings);
        frame.rgb = srgb_picture(*frame.linear);
    } else {
        frame.rgb = read_rgb8(path);
    }
    return frame;
}

/// One picture, or the files of a pattern.
class PictureFrames : public ComparedFrames {
public:
    PictureFrames(std::vector<std::pair<std::int64_t, fs::path>> files, bool is_mask, Warnings& warnings)
        : files_(std::move(files)), is_mask_(is_mask), warnings_(warnings) {}

    std::optional<ComparedFrame> next() override {
        if (at_ == files_.size()) return std::nullopt;
        const auto& [number, file] = files_[at_++];
        return read_frame(file, number, is_mask_, warnings_);
    }

private:
    std::vector<std::pair<std::int64_t, fs::path>> files_;
    std::size_t at_ = 0;
    bool is_mask_;
    Warnings& warnings_;
};

class VideoFrames : public ComparedFrames {
public:
    VideoFrames(const fs::path& path, const ComparedFramesOptions& options, Warnings& warnings)
        : path_(path), last_(options.last) {
        FootageOptions footage;
        footage.strict = options.strict;
        source_ = FrameSource::open(path, footage, warnings);
        if (options.first > 0) source_->seek(options.first);
    }

    std::optional<ComparedFrame> next() override {
        std::optional<PlateFrame> plate = source_->next();
        if (!plate || (last_ && plate->index() > *last_)) return std::nullopt;
        const PlateFormat& format = plate->format();
        ComparedFrame frame;
        frame.number = plate->index();
        frame.file = path_;
        frame.rgb = plate->rgb8({0, 0, format.width, format.height});
        return frame;
    }

private:
    fs::path path_;
    std::optional<std::int64_t> last_;
    std::unique_ptr<FrameSource> source_;
};

}  // namespace

bool is_single_picture(const fs::path& path) {
    constexpr std::array extensions{".png", ".jpg", ".jpeg", ".tif",  ".tiff", ".bmp",
                                    ".ppm", ".pgm", ".tga",  ".webp", ".exr",  ".hdr"};
    const std::string extension = lowercase_extension(path);
    return !is_pattern(path) && std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

std::unique_ptr<ComparedFrames> ComparedFrames::open(const fs::path& path, const ComparedFramesOptions& options,
                                                     Warnings& warnings) {
    std::vector<std::pair<std::int64_t, fs::path>> files;
    if (is_pattern(path)) {
        for (const std::int64_t number : numbers_of_pattern(path)) files.emplace_back(number, numbered(path, number));
        if (files.empty()) throw InputError(path, "no file has a name of this pattern");
        for (auto& [number, file] : files) number -= options.first_number;
    } else if (is_single_picture(path)) {
        files.emplace_back(0, path);
    } else if (options.is_mask) {
        throw InputError(path, "is no picture", "give a mask as PNG, or a sequence of them");
    } else {
        return std::make_unique<VideoFrames>(path, options, warnings);
    }
    std::erase_if(files, [&](const auto& file) {
        return file.first < options.first || (options.last && file.first > *options.last);
    });
    return std::make_unique<PictureFrames>(std::move(files), options.is_mask, warnings);
}

}  // namespace matchlight
