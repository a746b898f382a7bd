// From the footage's pixel format to one an encoder takes: as they are, re-ordered, or converted with exact matrices.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "media/frame_sink.h"
#include "media/plate.h"

extern "C" {
#include <libavcodec/avcodec.h>
}

namespace matchlight {

/// What of a plate an encoder is given. `format` describes the stored picture without rotation.
class FrameConversion {
public:
    /// Chooses among the encoder's pixel formats. Throws InputError naming `output` when `options.pixel_format` is
    /// unknown or not among them; warns when samples cannot stay as they are although nobody asked for a change.
    FrameConversion(const PlateFormat& plate, const AVCodec& encoder, const VideoOptions& options,
                    const std::filesystem::path& output, Warnings& warnings);

    AVPixelFormat pixel_format() const { return pixel_format_; }
    /// Matrix, range and siting of what the encoder gets.
    const PlateFormat& encoded() const { return encoded_; }
    /// Samples reach the encoder with the values they have in the plate.
    bool lossless() const { return lossless_; }

    /// Shares the plate's samples where nothing changes.
    std::shared_ptr<AVFrame> operator()(const PlateFrame& plate) const;

private:
    AVPixelFormat pixel_format_ = AV_PIX_FMT_NONE;
    PlateFormat plate_, encoded_;
    bool lossless_ = true;
};

/// A frame of `format` (4:4:4 with alpha) with these R'G'B'A code values.
std::shared_ptr<AVFrame> frame_from_rgba(const ImageF& rgba_code, AVPixelFormat pixel_format,
                                         const PlateFormat& format);

}  // namespace matchlight
