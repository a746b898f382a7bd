// One decoded frame of the footage, in the codec's own samples, and the way in and out of them through R'G'B'.
//
// The plate is the truth: samples that nothing touches reach the encoder as they were decoded. Coordinates here are
// those of the displayed picture: rotation in the file is honoured by mapping coordinates, never by resampling.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "core/image.h"
#include "core/primaries.h"

struct AVFrame;

namespace matchlight {

enum class ColorMatrix { rgb, bt601, bt709, bt2020 };
enum class ColorRange { limited, full };
/// A file's transfer tag counts only when it says PQ or HLG; `camera` means: use the scene's response.
enum class Transfer { camera, pq, hlg };
/// Where a chroma sample lies in its block of luma samples (ITU-T H.273, 8.7), in the stored orientation.
enum class ChromaSiting { left, center, top_left, top, bottom_left, bottom };

struct PlateFormat {
    int width = 0, height = 0;  // displayed, after rotation
    ColorMatrix matrix = ColorMatrix::bt709;
    ColorRange range = ColorRange::limited;
    Transfer transfer = Transfer::camera;
    Primaries primaries = Primaries::rec709;  // what the file does not say is taken as Rec.709's
    bool matrix_guessed = false;              // the file does not say; taken from the picture's size, as players do
    bool range_guessed = false;
    ChromaSiting siting = ChromaSiting::left;
    int rotation_deg = 0;  // 0, 90, 180, 270: clockwise turn from stored to displayed
    int bit_depth = 8;
    int chroma_block_width = 1;  // displayed pixels that share a chroma sample, horizontally
    int chroma_block_height = 1;
    bool has_alpha = false;
    std::string pixel_format;  // FFmpeg's name
};

class PlateFrame {
public:
    PlateFrame(std::shared_ptr<AVFrame> samples, PlateFormat format, std::int64_t index, double time_s);

    const PlateFormat& format() const { return format_; }
    std::int64_t index() const { return index_; }  // counted from 0 in presentation order
    double time_s() const { return time_s_; }      // presentation time from the start of the clip
    const AVFrame* samples() const { return samples_.get(); }
    std::shared_ptr<AVFrame> shared_samples() const { return samples_; }

    /// R'G'B' code values (0..1 of full scale; may lie slightly outside for out-of-gamut Y'CbCr) of a region, 3 floats
    /// a pixel. Chroma is interpolated (bilinear, honouring its siting).
    ImageF rgb_code(const Region& region) const;

    /// The decoded plate as 8- or 16-bit R'G'B': what PNG output shows where nothing was touched. Everywhere equal to
    /// rgb_code clipped to 0..1, times 255 or 65535 in float, rounded half to even.
    Image8 rgb8(const Region& region) const;
    Image16 rgb16(const Region& region) const;

    /// Luma-like single channel for detection: G' or Y', code values 0..1.
    ImageF gray_code(const Region& region) const;

    /// Puts new code values into the samples of `region` where `touched` (1 channel, non-zero = touched) says so. Luma
    /// changes only at touched pixels, chroma only in blocks that hold one: there it is filtered at its site from
    /// touched pixels' new and untouched pixels' old values. Values that are written back as they were read leave every
    /// sample as it was. Alpha stays. The samples are copied first: other holders of them see no change.
    void write_rgb_code(const Region& region, const ImageF& rgb_code, const Image8& touched);

private:
    std::shared_ptr<AVFrame> samples_;
    PlateFormat format_;
    std::int64_t index_ = 0;
    double time_s_ = 0;
};

}  // namespace matchlight
