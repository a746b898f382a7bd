// Least recently used frames go first.
#include "preview/frame_cache.h"

#include <algorithm>

namespace matchlight {

namespace {

constexpr std::size_t least_frames = 4;
/// Decoded before a frame that is stepped back to, for the steps that follow.
constexpr std::int64_t run_back = 12;
/// Further on, the source looks for a key frame instead of handing out every frame.
constexpr std::int64_t near_frames = 24;

std::size_t bytes_of(const PlateFormat& format) {
    const std::size_t bytes_a_sample = format.bit_depth > 8 ? 2 : 1;
    return std::size_t{3} * bytes_a_sample * static_cast<std::size_t>(format.width) *
           static_cast<std::size_t>(format.height);
}

}  // namespace

FrameCache::FrameCache(std::unique_ptr<FrameSource> source, std::size_t budget_bytes)
    : source_(std::move(source)),
      capacity_(std::max(least_frames, budget_bytes / std::max<std::size_t>(1, bytes_of(source_->info().format)))) {}

void FrameCache::keep(const PlateFrame& frame) {
    held_.insert_or_assign(frame.index(), Held{frame, ++uses_});
    if (held_.size() <= capacity_) return;
    held_.erase(std::ranges::min_element(held_, {}, [](const auto& entry) { return entry.second.last_use; }));
}

std::optional<PlateFrame> FrameCache::held(std::int64_t frame) {
    const auto found = held_.find(frame);
    if (found == held_.end()) return std::nullopt;
    found->second.last_use = ++uses_;
    return found->second.frame;
}

std::optional<PlateFrame> FrameCache::at_or_after(std::int64_t frame) {
    frame = std::max<std::int64_t>(0, frame);
    while (undecodable_.contains(frame)) ++frame;
    if (end_ && frame >= *end_) return std::nullopt;
    if (auto known = held(frame)) return known;
    if (frame < position_) {
        const std::int64_t run = std::min(run_back, static_cast<std::int64_t>(capacity_) / 2);
        position_ = std::max<std::int64_t>(0, frame + 1 - run);
        source_->seek(position_);
    } else if (frame > position_ + near_frames) {
        position_ = frame;
        source_->seek(frame);
    }
    while (true) {
        std::optional<PlateFrame> next = source_->next();
        if (!next) {
            end_ = position_;
            return std::nullopt;
        }
        for (; position_ < next->index(); ++position_) undecodable_.insert(position_);
        position_ = next->index() + 1;
        keep(*next);
        if (next->index() >= frame) return next;
    }
}

std::optional<PlateFrame> FrameCache::before(std::int64_t frame) {
    for (std::int64_t earlier = std::min(frame, end_.value_or(frame)) - 1; earlier >= 0; --earlier) {
        if (undecodable_.contains(earlier)) continue;
        std::optional<PlateFrame> found = at_or_after(earlier);
        if (found && found->index() < frame) return found;
    }
    return std::nullopt;
}

}  // namespace matchlight
