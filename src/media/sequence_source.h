// A numbered image sequence as footage.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "media/frame_source.h"

namespace matchlight {

class SequenceSource : public FrameSource {
public:
    SequenceSource(const std::filesystem::path& pattern, const FootageOptions& options);

    const FootageInfo& info() const override { return info_; }
    std::optional<PlateFrame> next() override;
    void seek(std::int64_t frame) override { next_ = frame; }

private:
    std::shared_ptr<AVFrame> read(std::int64_t frame) const;

    FootageInfo info_;
    FootageOptions options_;
    int bit_depth_ = 8;
    std::int64_t next_ = 0;
};

}  // namespace matchlight
