// Where a hierarchy of boxes is cut: by the surface area heuristic over bins of centroids.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include <Eigen/Geometry>

namespace matchlight {

/// Half of a box's surface; 0 where it is empty.
inline float half_area(const Eigen::AlignedBox3f& box) {
    if (box.isEmpty()) return 0;
    const Eigen::Vector3f size = box.sizes();
    return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

/// Orders the part and says how many go to its first half (Wald 2007, "On fast Construction of SAH-based Bounding
/// Volume Hierarchies"). `box_of` and `centroid_of` tell of an item; at least two items. Deterministic.
template <class Item, class BoxOf, class CentroidOf>
std::size_t split_by_area(std::span<Item> part, const BoxOf& box_of, const CentroidOf& centroid_of) {
    constexpr int bins = 16;
    Eigen::AlignedBox3f centroids;
    for (const Item& item : part) centroids.extend(centroid_of(item));
    int axis = 0;
    const float extent = centroids.sizes().maxCoeff(&axis);
    const float low = centroids.min()[axis];
    // What lies all in one place cannot be told apart.
    if (!(extent > 0)) return part.size() / 2;
    const auto bin_of = [&](const Item& item) {
        const float share = (centroid_of(item)[axis] - low) / extent;
        return std::clamp(static_cast<int>(share * bins), 0, bins - 1);
    };
    std::array<Eigen::AlignedBox3f, bins> boxes;
    std::array<std::size_t, bins> counts{};
    for (const Item& item : part) {
        const auto bin = static_cast<std::size_t>(bin_of(item));
        boxes.at(bin).extend(box_of(item));
        ++counts.at(bin);
    }
    std::array<float, bins> cost_above{};  // of all bins from this one on
    Eigen::AlignedBox3f box;
    std::size_t count = 0;
    for (std::size_t bin = bins; bin-- > 1;) {
        box.extend(boxes.at(bin));
        count += counts.at(bin);
        cost_above.at(bin) = half_area(box) * static_cast<float>(count);
    }
    box.setEmpty();
    count = 0;
    float least = std::numeric_limits<float>::infinity();
    int first_above = bins / 2;
    for (std::size_t bin = 1; bin < bins; ++bin) {
        box.extend(boxes.at(bin - 1));
        count += counts.at(bin - 1);
        if (count == 0 || count == part.size()) continue;
        const float cost = half_area(box) * static_cast<float>(count) + cost_above.at(bin);
        if (cost < least) {
            least = cost;
            first_above = static_cast<int>(bin);
        }
    }
    const auto middle =
        std::stable_partition(part.begin(), part.end(), [&](const Item& item) { return bin_of(item) < first_above; });
    const auto left = static_cast<std::size_t>(middle - part.begin());
    return left == 0 || left == part.size() ? part.size() / 2 : left;
}

}  // namespace matchlight
