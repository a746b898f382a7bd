// Every conversion of values goes through PlateFrame's own reading and writing: one set of matrices, no hidden
// defaults.
#include "media/frame_conversion.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "media/av_pointers.h"
#include "media/plate_format.h"
#include "media/sample_layout.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

/// The deprecated yuvj formats are their plain ones with the range tag "full".
AVPixelFormat without_j(AVPixelFormat format) {
    switch (format) {
        case AV_PIX_FMT_YUVJ420P:
            return AV_PIX_FMT_YUV420P;
        case AV_PIX_FMT_YUVJ422P:
            return AV_PIX_FMT_YUV422P;
        case AV_PIX_FMT_YUVJ444P:
            return AV_PIX_FMT_YUV444P;
        case AV_PIX_FMT_YUVJ440P:
            return AV_PIX_FMT_YUV440P;
        case AV_PIX_FMT_YUVJ411P:
            return AV_PIX_FMT_YUV411P;
        default:
            return format;
    }
}

std::vector<AVPixelFormat> formats_of(const AVCodec& encoder) {
    std::vector<AVPixelFormat> formats;
    for (const AVPixelFormat* f = encoder.pix_fmts; f != nullptr && *f != AV_PIX_FMT_NONE; ++f) {
        if (without_j(*f) == *f && SampleLayout::of(*f)) formats.push_back(*f);
    }
    return formats;
}

std::string names_of(const std::vector<AVPixelFormat>& formats) {
    std::string names;
    for (const AVPixelFormat f : formats) names += (names.empty() ? "" : ", ") + std::string(av_get_pix_fmt_name(f));
    return names;
}

bool has_even_size_rule(VideoCodec codec) {
    return codec == VideoCodec::h264 || codec == VideoCodec::h265;
}

bool fits_size(const SampleLayout& layout, const PlateFormat& plate, VideoCodec codec) {
    if (!has_even_size_rule(codec)) return true;
    return plate.width % (1 << layout.log2_chroma_width) == 0 && plate.height % (1 << layout.log2_chroma_height) == 0;
}

/// How far a format is from holding the plate's samples; the smallest wins, ties go to the encoder's own order.
struct Distance {
    int colour_lost = 0, depth_lost = 0, chroma_lost = 0, alpha_lost = 0, excess = 0;
    auto operator<=>(const Distance&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 errs here
};

Distance distance(const SampleLayout& plate, const SampleLayout& target, bool rgb_becomes_420) {
    Distance d;
    d.depth_lost = std::max(0, plate.depth() - target.depth());
    d.alpha_lost = plate.has_alpha && !target.has_alpha ? 1 : 0;
    d.excess = std::max(0, target.depth() - plate.depth()) + (target.has_alpha && !plate.has_alpha ? 1 : 0);
    if (plate.rgb && rgb_becomes_420) {
        // Delivery codecs: what players expect of a video, at the least depth that the codec has.
        d.colour_lost = target.rgb || target.colours == 1 ? 1 : 0;
        d.depth_lost = target.depth() > 8 ? 1 : 0;
        d.chroma_lost = std::abs(target.log2_chroma_width - 1) + std::abs(target.log2_chroma_height - 1);
        return d;
    }
    d.colour_lost = plate.rgb != target.rgb || (plate.colours == 3 && target.colours == 1) ? 1 : 0;
    d.chroma_lost = std::max(0, target.log2_chroma_width - plate.log2_chroma_width) +
                    std::max(0, target.log2_chroma_height - plate.log2_chroma_height);
    d.excess += std::max(0, plate.log2_chroma_width - target.log2_chroma_width) +
                std::max(0, plate.log2_chroma_height - target.log2_chroma_height) +
                (plate.colours == 1 && target.colours == 3 ? 1 : 0);
    return d;
}

AVPixelFormat requested_format(const VideoOptions& options, const std::vector<AVPixelFormat>& formats,
                               const PlateFormat& plate, const fs::path& output) {
    const AVPixelFormat wanted = without_j(av_get_pix_fmt(options.pixel_format->c_str()));
    if (std::find(formats.begin(), formats.end(), wanted) == formats.end())
        throw InputError(output, fmt::format("the codec cannot hold pixel format \"{}\"", *options.pixel_format),
                         "it has " + names_of(formats));
    if (!fits_size(*SampleLayout::of(wanted), plate, options.codec))
        throw InputError(output,
                         fmt::format("{} needs an even size, the footage is {}x{}", *options.pixel_format, plate.width,
                                     plate.height),
                         "set pixel_format = \"yuv444p\" or codec = \"ffv1\"");
    return wanted;
}

PlateFormat upright(PlateFormat format) {
    if (format.rotation_deg == 90 || format.rotation_deg == 270) {
        std::swap(format.width, format.height);
        std::swap(format.chroma_block_width, format.chroma_block_height);
    }
    format.rotation_deg = 0;
    return format;
}

void write_alpha(const AVFrame* from, AVFrame& to) {
    const SampleLayout target = *SampleLayout::of(static_cast<AVPixelFormat>(to.format));
    const int alpha = target.colours;
    const int most = target.component[static_cast<std::size_t>(alpha)].max();
    const auto source = from != nullptr ? SampleLayout::of(static_cast<AVPixelFormat>(from->format)) : std::nullopt;
    std::vector<float> row(static_cast<std::size_t>(to.width), 1.0f);
    for (int y = 0; y < to.height; ++y) {
        if (source && source->has_alpha) {
            const auto full = static_cast<float>(source->component[static_cast<std::size_t>(source->colours)].max());
            read_samples(*source, *from, {source->colours, 0, y, to.width}, 0, 1 / full, row.data());
        }
        for (int x = 0; x < to.width; ++x)
            write_sample(target, to, alpha, x, y,
                         static_cast<int>(std::lround(row[static_cast<std::size_t>(x)] * static_cast<float>(most))));
    }
}

/// Zero everywhere but in chroma, whose zero is the middle of its range.
std::shared_ptr<AVFrame> blank_frame(const PlateFormat& format, AVPixelFormat pixel_format) {
    std::shared_ptr<AVFrame> frame = allocated_frame(format.width, format.height, pixel_format);
    const SampleLayout layout = *SampleLayout::of(pixel_format);
    std::vector<std::uint16_t> row(static_cast<std::size_t>(format.width));
    const int components = layout.colours + (layout.has_alpha ? 1 : 0);
    for (int c = 0; c < components; ++c) {
        const int depth = layout.component[static_cast<std::size_t>(c)].depth;
        std::fill(row.begin(), row.end(), static_cast<std::uint16_t>(layout.is_chroma(c) ? 1 << (depth - 1) : 0));
        for (int y = 0; y < layout.height_of(c, *frame); ++y)
            write_samples(layout, *frame, {c, 0, y, layout.width_of(c, *frame)}, row.data());
    }
    return frame;
}

std::shared_ptr<AVFrame> frame_from_rgb(const ImageF& rgb_code, AVPixelFormat pixel_format, const PlateFormat& format) {
    PlateFrame target(blank_frame(format, pixel_format), format, 0, 0);
    const Image8 all(format.width, format.height, 1, 1);
    target.write_rgb_code(all.bounds(), rgb_code, all);
    return target.shared_samples();
}

}  // namespace

FrameConversion::FrameConversion(const PlateFormat& plate, const AVCodec& encoder, const VideoOptions& options,
                                 const fs::path& output, Warnings& warnings)
    : plate_(upright(plate)) {
    const std::vector<AVPixelFormat> formats = formats_of(encoder);
    assert(!formats.empty());
    const AVPixelFormat own = without_j(av_get_pix_fmt(plate.pixel_format.c_str()));
    const SampleLayout own_layout = *SampleLayout::of(own);
    const bool delivery = has_even_size_rule(options.codec);
    if (options.pixel_format) {
        pixel_format_ = requested_format(options, formats, plate_, output);
    } else {
        std::optional<Distance> least;
        for (const AVPixelFormat candidate : formats) {
            const SampleLayout layout = *SampleLayout::of(candidate);
            if (!fits_size(layout, plate_, options.codec)) continue;
            Distance d = distance(own_layout, layout, delivery);
            if (candidate == own) d = {};
            if (!least || d < *least) {
                least = d;
                pixel_format_ = candidate;
            }
        }
        if (pixel_format_ == AV_PIX_FMT_NONE) throw InputError(output, "the codec has no pixel format for this size");
    }

    const SampleLayout layout = *SampleLayout::of(pixel_format_);
    lossless_ = own_layout.same_colours(layout);
    const bool loses_alpha = own_layout.has_alpha && !layout.has_alpha;
    encoded_ = plate_;
    encoded_.pixel_format = av_get_pix_fmt_name(pixel_format_);
    encoded_.bit_depth = layout.depth();
    encoded_.has_alpha = layout.has_alpha;
    encoded_.chroma_block_width = 1 << layout.log2_chroma_width;
    encoded_.chroma_block_height = 1 << layout.log2_chroma_height;
    if (loses_alpha && !options.pixel_format)
        warnings.add(output.string() + ": the codec cannot hold the footage's alpha, which is left out; use ffv1");
    if (lossless_) return;
    if (layout.rgb) {
        encoded_.matrix = ColorMatrix::rgb;
        encoded_.range = ColorRange::full;
    } else if (own_layout.rgb) {
        encoded_.matrix = ColorMatrix::bt709;
        encoded_.range = ColorRange::limited;
        encoded_.siting = ChromaSiting::left;
    }
    const bool expected = options.pixel_format || options.codec == VideoCodec::prores4444 ||
                          (delivery && own_layout.rgb && layout.log2_chroma_width == 1);
    if (!expected)
        warnings.add(fmt::format("{}: the codec cannot hold {} of {}x{}; its samples are converted to {}",
                                 output.string(), plate.pixel_format, plate_.width, plate_.height,
                                 encoded_.pixel_format));
}

std::shared_ptr<AVFrame> FrameConversion::operator()(const PlateFrame& plate) const {
    const AVFrame& samples = *plate.samples();
    std::shared_ptr<AVFrame> frame;
    const auto own = without_j(static_cast<AVPixelFormat>(samples.format));
    if (own == pixel_format_) {
        frame = owned(av_frame_clone(&samples));
        frame->format = pixel_format_;
    } else if (lossless_) {
        frame = allocated_frame(samples.width, samples.height, pixel_format_);
        if (encoded_.has_alpha) write_alpha(&samples, *frame);
        move_samples(samples, *frame);
    } else {
        const PlateFrame stored(plate.shared_samples(), plate_, plate.index(), plate.time_s());
        frame = frame_from_rgb(stored.rgb_code({0, 0, plate_.width, plate_.height}), pixel_format_, encoded_);
        if (encoded_.has_alpha) write_alpha(&samples, *frame);
    }
    return frame;
}

std::shared_ptr<AVFrame> frame_from_rgba(const ImageF& rgba_code, AVPixelFormat pixel_format,
                                         const PlateFormat& format) {
    assert(rgba_code.channels() == 4 && rgba_code.width() == format.width && rgba_code.height() == format.height);
    ImageF rgb(format.width, format.height, 3);
    for (int y = 0; y < format.height; ++y) {
        for (int x = 0; x < format.width; ++x) std::copy_n(rgba_code.pixel(x, y), 3, rgb.pixel(x, y));
    }
    std::shared_ptr<AVFrame> frame = frame_from_rgb(rgb, pixel_format, format);
    const SampleLayout layout = *SampleLayout::of(pixel_format);
    assert(layout.has_alpha);
    const int most = layout.component[static_cast<std::size_t>(layout.colours)].max();
    for (int y = 0; y < format.height; ++y) {
        for (int x = 0; x < format.width; ++x) {
            const float alpha = rgba_code.at(x, y, 3);
            const float kept = alpha > 0 ? std::min(alpha, 1.0f) : 0.0f;  // NaN becomes 0
            write_sample(layout, *frame, layout.colours, x, y,
                         static_cast<int>(std::lround(kept * static_cast<float>(most))));
        }
    }
    return frame;
}

}  // namespace matchlight
