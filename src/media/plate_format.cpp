// Tags of ITU-T H.273 as FFmpeg names them.
#include "media/plate_format.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "media/sample_layout.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

namespace matchlight {

namespace {

namespace fs = std::filesystem;

/// yuvj* and grey formats have full range by their own definition.
bool is_full_range_format(AVPixelFormat format, const SampleLayout& layout) {
    switch (format) {
        case AV_PIX_FMT_YUVJ420P:
        case AV_PIX_FMT_YUVJ422P:
        case AV_PIX_FMT_YUVJ444P:
        case AV_PIX_FMT_YUVJ440P:
        case AV_PIX_FMT_YUVJ411P:
            return true;
        default:
            return layout.rgb || layout.colours == 1;
    }
}

void choose_matrix(const AVFrame& frame, const SampleLayout& layout, const FootageOptions& options,
                   const fs::path& path, PlateFormat& format) {
    if (layout.rgb) {
        format.matrix = ColorMatrix::rgb;
        return;
    }
    if (options.matrix && *options.matrix != ColorMatrix::rgb) {
        format.matrix = *options.matrix;
        return;
    }
    switch (frame.colorspace) {
        case AVCOL_SPC_BT709:
            format.matrix = ColorMatrix::bt709;
            return;
        case AVCOL_SPC_BT470BG:
        case AVCOL_SPC_SMPTE170M:
            format.matrix = ColorMatrix::bt601;
            return;
        case AVCOL_SPC_BT2020_NCL:
            format.matrix = ColorMatrix::bt2020;
            return;
        case AVCOL_SPC_UNSPECIFIED:
        case AVCOL_SPC_RESERVED:
        // Grey has no matrix to be tagged with, and RGB on Y'CbCr samples is a known slip of encoders.
        case AVCOL_SPC_RGB:
            break;
        default: {
            const char* name = av_color_space_name(frame.colorspace);
            throw InputError(path,
                             std::string("its colour matrix ") + (name != nullptr ? name : "?") + " is not supported",
                             "convert it, or set color_matrix under [footage]");
        }
    }
    // As players and FFmpeg's own scaler do: BT.709 from 1280 wide or over 576 high, else BT.601.
    format.matrix_guessed = layout.colours == 3;
    format.matrix = frame.width >= 1280 || frame.height > 576 ? ColorMatrix::bt709 : ColorMatrix::bt601;
}

ChromaSiting siting_of(const AVFrame& frame, bool full_range) {
    switch (frame.chroma_location) {
        case AVCHROMA_LOC_LEFT:
            return ChromaSiting::left;
        case AVCHROMA_LOC_CENTER:
            return ChromaSiting::center;
        case AVCHROMA_LOC_TOPLEFT:
            return ChromaSiting::top_left;
        case AVCHROMA_LOC_TOP:
            return ChromaSiting::top;
        case AVCHROMA_LOC_BOTTOMLEFT:
            return ChromaSiting::bottom_left;
        case AVCHROMA_LOC_BOTTOM:
            return ChromaSiting::bottom;
        default:
            break;
    }
    // JPEG's samples (full range) lie in the middle of their block, those of MPEG-2, H.264 and H.265 at its left.
    return full_range ? ChromaSiting::center : ChromaSiting::left;
}

}  // namespace

PlateFormat plate_format_of(const AVFrame& frame, int rotation_deg, const FootageOptions& options,
                            const fs::path& path) {
    const auto pixel_format = static_cast<AVPixelFormat>(frame.format);
    const auto layout = SampleLayout::of(pixel_format);
    const char* name = av_get_pix_fmt_name(pixel_format);
    PlateFormat format;
    format.pixel_format = name != nullptr ? name : "unknown";
    if (!layout)
        throw InputError(path, "its pixel format " + format.pixel_format + " is not supported",
                         "convert it to yuv420p or rgb24");
    const bool turned = rotation_deg == 90 || rotation_deg == 270;
    format.width = turned ? frame.height : frame.width;
    format.height = turned ? frame.width : frame.height;
    format.rotation_deg = rotation_deg;
    format.bit_depth = layout->depth();
    format.has_alpha = layout->has_alpha;
    choose_matrix(frame, *layout, options, path, format);

    if (is_full_range_format(pixel_format, *layout) && frame.color_range != AVCOL_RANGE_MPEG) {
        format.range = ColorRange::full;
    } else if (frame.color_range == AVCOL_RANGE_UNSPECIFIED) {
        format.range = ColorRange::limited;
        format.range_guessed = true;
    } else {
        format.range = frame.color_range == AVCOL_RANGE_JPEG ? ColorRange::full : ColorRange::limited;
    }
    if (options.range) format.range = *options.range;
    if (layout->rgb) format.range = ColorRange::full;  // encoders tag R'G'B' either way and always mean full range

    if (frame.color_trc == AVCOL_TRC_SMPTE2084) format.transfer = Transfer::pq;
    if (frame.color_trc == AVCOL_TRC_ARIB_STD_B67) format.transfer = Transfer::hlg;
    if (frame.color_primaries == AVCOL_PRI_BT2020) format.primaries = Primaries::rec2020;
    if (frame.color_primaries == AVCOL_PRI_SMPTE432) format.primaries = Primaries::p3;
    if (options.primaries) {
        format.transfer = Transfer::camera;
        format.primaries = *options.primaries;
    }
    if (layout->is_chroma(1)) {
        format.siting = siting_of(frame, format.range == ColorRange::full);
        format.chroma_block_width = 1 << layout->log2_chroma_width;
        format.chroma_block_height = 1 << layout->log2_chroma_height;
        if (turned) std::swap(format.chroma_block_width, format.chroma_block_height);
    }
    return format;
}

int matrix_tag(ColorMatrix matrix) {
    switch (matrix) {
        case ColorMatrix::rgb:
            return AVCOL_SPC_RGB;
        case ColorMatrix::bt601:
            return AVCOL_SPC_SMPTE170M;
        case ColorMatrix::bt709:
            return AVCOL_SPC_BT709;
        case ColorMatrix::bt2020:
            return AVCOL_SPC_BT2020_NCL;
    }
    return AVCOL_SPC_UNSPECIFIED;
}

AVChromaLocation siting_tag(const PlateFormat& format) {
    if (format.chroma_block_width == 1 && format.chroma_block_height == 1) return AVCHROMA_LOC_UNSPECIFIED;
    switch (format.siting) {
        case ChromaSiting::left:
            return AVCHROMA_LOC_LEFT;
        case ChromaSiting::center:
            return AVCHROMA_LOC_CENTER;
        case ChromaSiting::top_left:
            return AVCHROMA_LOC_TOPLEFT;
        case ChromaSiting::top:
            return AVCHROMA_LOC_TOP;
        case ChromaSiting::bottom_left:
            return AVCHROMA_LOC_BOTTOMLEFT;
        case ChromaSiting::bottom:
            return AVCHROMA_LOC_BOTTOM;
    }
    return AVCHROMA_LOC_UNSPECIFIED;
}

}  // namespace matchlight
