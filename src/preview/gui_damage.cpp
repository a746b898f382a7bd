// Controls are drawn in the same order in every frame: between the corners that both frames begin and end with lies
// what is new.
#include "preview/gui_damage.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

namespace {

bool is_same(const ImDrawVert& a, const ImDrawVert& b) {
    return a.pos.x == b.pos.x && a.pos.y == b.pos.y && a.uv.x == b.uv.x && a.uv.y == b.uv.y && a.col == b.col;
}

bool is_same(const ImVec4& a, const ImVec4& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w;
}

/// Textures that are drawn may be filled anew from frame to frame.
bool is_same_part(const ImDrawCmd& a, const ImDrawCmd& b) {
    return a.TextureId == nullptr && b.TextureId == nullptr && a.VtxOffset == b.VtxOffset &&
           is_same(a.ClipRect, b.ClipRect);
}

/// Whole pixels about it, and one more for edges that are smoothed.
Region pixels_about(const ImVec4& box) {
    const int left = static_cast<int>(std::floor(box.x)) - 1, top = static_cast<int>(std::floor(box.y)) - 1;
    const int right = static_cast<int>(std::ceil(box.z)) + 1, bottom = static_cast<int>(std::ceil(box.w)) + 1;
    return {left, top, right - left, bottom - top};
}

}  // namespace

std::vector<Region> apart(std::vector<Region> regions) {
    std::erase_if(regions, [](const Region& region) { return region.empty(); });
    for (std::size_t i = 0; i < regions.size();) {
        const auto other = std::find_if(regions.begin() + static_cast<std::ptrdiff_t>(i) + 1, regions.end(),
                                        [&](const Region& one) { return !one.intersected(regions[i]).empty(); });
        if (other == regions.end()) {
            ++i;
            continue;
        }
        regions[i] = regions[i].united(*other);
        regions.erase(other);
        i = 0;  // it may overlap an earlier one now
    }
    return regions;
}

GuiDamage::Drawn GuiDamage::copy_of(const ImDrawList& list) {
    return {.corners = {list.VtxBuffer.begin(), list.VtxBuffer.end()},
            .indices = {list.IdxBuffer.begin(), list.IdxBuffer.end()},
            .parts = {list.CmdBuffer.begin(), list.CmdBuffer.end()}};
}

Region GuiDamage::reached(const Drawn& drawn, std::size_t first, std::size_t end) {
    Region all;
    for (const ImDrawCmd& part : drawn.parts) {
        const auto index = [&](std::size_t i) { return drawn.indices[part.IdxOffset + i] + part.VtxOffset; };
        for (std::size_t i = 0; i + 2 < part.ElemCount; i += 3) {
            bool is_within = false;
            ImVec4 box = part.ClipRect;
            ImVec4 triangle{box.z, box.w, box.x, box.y};
            for (std::size_t k = i; k < i + 3; ++k) {
                const std::size_t corner = index(k);
                is_within = is_within || (corner >= first && corner < end);
                const ImVec2& at = drawn.corners[corner].pos;
                triangle = {std::min(triangle.x, at.x), std::min(triangle.y, at.y), std::max(triangle.z, at.x),
                            std::max(triangle.w, at.y)};
            }
            if (!is_within) continue;
            box = {std::max(box.x, triangle.x), std::max(box.y, triangle.y), std::min(box.z, triangle.z),
                   std::min(box.w, triangle.w)};
            if (box.x <= box.z && box.y <= box.w) all = all.united(pixels_about(box));
        }
    }
    return all;
}

Region GuiDamage::changed(const Drawn& before, const Drawn& now) {
    const bool same_parts = std::ranges::equal(before.parts, now.parts, is_same_part);
    const bool same_count = before.corners.size() == now.corners.size();
    std::size_t first = 0, last = 0;  // corners that both begin, and both end with
    if (same_parts && (!same_count || before.indices == now.indices)) {
        const std::size_t both = std::min(before.corners.size(), now.corners.size());
        while (first < both && is_same(before.corners[first], now.corners[first])) ++first;
        if (same_count && first == both) return {};
        while (last < both - first &&
               is_same(before.corners[before.corners.size() - 1 - last], now.corners[now.corners.size() - 1 - last])) {
            ++last;
        }
    }
    return reached(before, first, before.corners.size() - last).united(reached(now, first, now.corners.size() - last));
}

std::vector<Region> GuiDamage::since_last(const ImDrawData& data, const Region& window) {
    std::vector<Drawn> now;
    for (int i = 0; i < data.CmdListsCount; ++i) now.push_back(copy_of(*data.CmdLists[i]));
    const std::size_t lists = std::max(now.size(), before_.size());
    now.resize(lists);
    before_.resize(lists);
    std::vector<Region> regions;
    for (std::size_t i = 0; i < lists; ++i) regions.push_back(changed(before_[i], now[i]).intersected(window));
    before_ = std::move(now);
    return apart(std::move(regions));
}

}  // namespace matchlight
