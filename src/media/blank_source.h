// Frames of no footage: black plates to render on, so that a scene without footage goes the way of one with it.
#pragma once

#include <memory>

#include "media/frame_source.h"

namespace matchlight {

struct BlankFootage {
    std::filesystem::path path;  // what errors and warnings name
    int width = 0, height = 0;
    std::int64_t frames = 1;
    double fps = 25;
};

/// 8-bit 4:2:0, BT.709 in limited range with the sRGB curve: what encoders and players take anywhere.
class BlankSource : public FrameSource {
public:
    /// Throws InputError (naming the path) for a size beyond the limits of images.
    explicit BlankSource(const BlankFootage& footage);

    const FootageInfo& info() const override { return info_; }
    std::optional<PlateFrame> next() override;
    void seek(std::int64_t frame) override { next_ = frame; }

private:
    FootageInfo info_;
    std::shared_ptr<AVFrame> black_;
    std::int64_t next_ = 0;
};

}  // namespace matchlight
