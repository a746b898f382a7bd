// Opens them as footage, checks that they go with it, finds frames in any order.
#include "media/side_footage.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/lowercase.h"
#include "media/exr_file.h"
#include "media/image_io.h"

namespace matchlight {

namespace {

namespace fs = std::filesystem;

void check_size(const SideFootage& side, const fs::path& file, int width, int height) {
    if (width == side.width && height == side.height) return;
    throw InputError(
        file,
        fmt::format("is {}×{}, its footage {} is {}×{}", width, height, side.footage.string(), side.width, side.height),
        "make it of the footage's size");
}

void check_count(const SideFootage& side, std::int64_t frames, Warnings& warnings) {
    if (frames < side.frames) {
        throw InputError(
            side.path, fmt::format("has {} frames, its footage {} has {}", frames, side.footage.string(), side.frames),
            "give one for every frame");
    }
    if (frames > side.frames) {
        warnings.add(fmt::format("{}: has {} frames, of which its footage {} needs {}", side.path.string(), frames,
                                 side.footage.string(), side.frames));
    }
}

/// Numbers that mean an amount fill the whole range of codes unless the file says otherwise.
std::unique_ptr<FrameSource> open_side(const SideFootage& side, std::optional<ColorRange> range, Warnings& warnings) {
    FootageOptions options;
    options.range = range;
    std::unique_ptr<FrameSource> source = FrameSource::open(side.path, options, warnings);
    check_size(side, side.path, source->info().format.width, source->info().format.height);
    check_count(side, source->info().frame_count, warnings);
    return source;
}

PlateFrame frame_of(FrameSource& source, std::int64_t frame, std::int64_t& next) {
    if (frame != next) source.seek(frame);
    std::optional<PlateFrame> found = source.next();
    if (!found || found->index() != frame)
        throw InputError(source.info().path, frame, "cannot be decoded", "make the file again");
    next = frame + 1;
    return std::move(*found);
}

Region whole(const SideFootage& side) {
    return {0, 0, side.width, side.height};
}

bool is_exr(const fs::path& path) {
    return lowercase_extension(path) == ".exr";
}

/// The channel that holds depth, by its name.
std::string depth_channel(const ExrFile& file, const fs::path& path) {
    for (const char* name : {"Z", "Y", "R"}) {
        if (file.has_channel(0, name)) return name;
    }
    throw InputError(path, "has no channel Z, Y or R", "write depths as Z");
}

}  // namespace

MatteSource::MatteSource(const SideFootage& side, Warnings& warnings)
    : side_(side), source_(open_side(side, std::nullopt, warnings)) {}

ImageF MatteSource::coverage(std::int64_t frame) {
    ImageF coverage = frame_of(*source_, frame, next_).gray_code(whole(side_));
    for (float& share : coverage.samples()) share = std::clamp(share, 0.0F, 1.0F);
    return coverage;
}

DepthSource::DepthSource(const SideFootage& side, Warnings& warnings) : side_(side), warnings_(warnings) {
    if (!is_exr(side.path)) {
        source_ = open_side(side, ColorRange::full, warnings);
        return;
    }
    if (!is_pattern(side.path))
        throw InputError(side.path, "is one picture, not one for every frame", "name depth_%04d.exr");
    const std::vector<std::int64_t> numbers = numbers_of_pattern(side.path);
    if (numbers.empty()) throw InputError(side.path, "no file matches this pattern");
    first_number_ = numbers.front();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::int64_t wanted = first_number_ + static_cast<std::int64_t>(i);
        if (numbers[i] == wanted) continue;
        throw InputError(numbered(side.path, wanted), static_cast<std::int64_t>(i),
                         fmt::format("the picture is missing, though {} follows", numbers[i]), "complete the sequence");
    }
    check_count(side, static_cast<std::int64_t>(numbers.size()), warnings);
}

ImageF DepthSource::exr_units(std::int64_t frame) const {
    const fs::path path = numbered(side_.path, first_number_ + frame);
    const ExrFile file(path);
    ImageF depth = file.read(0, {depth_channel(file, path)});
    check_size(side_, path, depth.width(), depth.height());
    return depth;
}

ImageF DepthSource::units(std::int64_t frame) {
    if (!source_) return exr_units(frame);
    const PlateFrame found = frame_of(*source_, frame, next_);
    ImageF depth = found.gray_code(whole(side_));
    const auto codes = static_cast<float>((1 << found.format().bit_depth) - 1);
    for (float& unit : depth.samples()) unit = std::round(unit * codes);
    return depth;
}

ImageF DepthSource::inverse_depth(std::int64_t frame) {
    constexpr double millimetre_m = 0.001;
    const double scale_m = side_.scale.value_or(source_ ? millimetre_m : 1.0);
    ImageF image = units(frame);
    bool has_not_a_number = false, has_negative = false;
    for (float& value : image.samples()) {
        const double depth_m = scale_m * value;
        has_not_a_number = has_not_a_number || std::isnan(depth_m);
        has_negative = has_negative || depth_m < 0;
        value = depth_m > 0 ? static_cast<float>(1 / depth_m) : 0.0F;
    }
    // Frame by frame: the same text again raises the warning's count.
    const auto warn = [&](bool found, const char* what) {
        if (found)
            warnings_.add(fmt::format("{}: frames with {} depths, which count as unknown", side_.path.string(), what));
    };
    warn(has_not_a_number, "not-a-number");
    warn(has_negative, "negative");
    return image;
}

}  // namespace matchlight
