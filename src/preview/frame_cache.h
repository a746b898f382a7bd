// Decoded frames at hand: stepping back costs nothing while they last, and decodes a run at once after that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "media/frame_source.h"

namespace matchlight {

class FrameCache {
public:
    /// What is kept takes about `budget_bytes`, and is at least a few frames.
    explicit FrameCache(std::unique_ptr<FrameSource> source, std::size_t budget_bytes = std::size_t{384} << 20);

    const FootageInfo& info() const { return source_->info(); }

    /// The frame, or where it cannot be decoded the next one that can; nullopt where there is none. Throws InputError.
    std::optional<PlateFrame> at_or_after(std::int64_t frame);
    /// The last one before `frame` that can be decoded.
    std::optional<PlateFrame> before(std::int64_t frame);

    std::size_t capacity() const { return capacity_; }

private:
    struct Held {
        PlateFrame frame;
        std::int64_t last_use = 0;
    };
    void keep(const PlateFrame& frame);
    std::optional<PlateFrame> held(std::int64_t frame);

    std::unique_ptr<FrameSource> source_;
    std::size_t capacity_;       // frames
    std::int64_t position_ = 0;  // of the source's next frame
    std::int64_t uses_ = 0;
    std::map<std::int64_t, Held> held_;
    std::set<std::int64_t> undecodable_;
    std::optional<std::int64_t> end_;  // where the source was found to end
};

}  // namespace matchlight
