// A new key is written with all keys of its object; a key that is there keeps all but what has changed.
#include "preview/object_keys.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/object_motion.h"

namespace matchlight {

using Eigen::Vector3d;

namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// Degrees about x, then y, then z (z-y'-x''), those of the many that are nearest to `expected_deg` by full turns.
Vector3d degrees_near(const Eigen::Matrix3d& rotation, const Vector3d& expected_deg) {
    Vector3d angles_deg;
    const double sine_y = std::clamp(-rotation(2, 0), -1.0, 1.0);
    constexpr double upright = 1 - 1e-12;  // x and z turn about the same axis there: all of it is z's
    if (std::abs(sine_y) > upright) {
        angles_deg = {0, std::asin(sine_y) * degrees, std::atan2(-rotation(0, 1), rotation(1, 1)) * degrees};
    } else {
        angles_deg = {std::atan2(rotation(2, 1), rotation(2, 2)) * degrees, std::asin(sine_y) * degrees,
                      std::atan2(rotation(1, 0), rotation(0, 0)) * degrees};
    }
    for (int i = 0; i < 3; ++i) angles_deg[i] += 360 * std::round((expected_deg[i] - angles_deg[i]) / 360);
    return angles_deg;
}

/// What would be there if degrees went evenly from key to key.
Vector3d even_degrees(const std::vector<ObjectKey>& keys, std::int64_t frame) {
    const auto after = std::ranges::find_if(keys, [&](const ObjectKey& key) { return key.frame > frame; });
    if (after == keys.begin()) return keys.front().rotate_deg;
    if (after == keys.end()) return keys.back().rotate_deg;
    const ObjectKey& before = *(after - 1);
    const double share = static_cast<double>(frame - before.frame) / static_cast<double>(after->frame - before.frame);
    return before.rotate_deg + share * (after->rotate_deg - before.rotate_deg);
}

std::string list_of(const Vector3d& xyz) {
    return scene_value_text(std::vector<double>(xyz.begin(), xyz.end()));
}

/// An equal scale is one number, and no scale none.
std::string scale_entry(const Vector3d& scale) {
    if (scale == Vector3d::Ones()) return "";
    const bool equal = scale.x() == scale.y() && scale.y() == scale.z();
    return ", scale = " + (equal ? scene_value_text(scale.x()) : list_of(scale));
}

std::string text_of(const std::vector<ObjectKey>& keys) {
    std::vector<std::string> entries;
    for (const ObjectKey& key : keys) {
        std::string entry = fmt::format("frame = {}, translate = {}", key.frame, list_of(key.translate_m));
        if (!key.rotate_deg.isZero(0)) entry += ", rotate_deg = " + list_of(key.rotate_deg);
        entries.push_back("{" + entry + scale_entry(key.scale) + "}");
    }
    return fmt::format("[{}]", fmt::join(entries, ", "));
}

Vector3d rounded(const Vector3d& values, double steps) {
    return (values * steps).array().round() / steps;
}

}  // namespace

Placing placing_at(const ObjectSettings& object, std::int64_t frame) {
    if (object.keys.empty()) return {object.translate_m, object.rotate_deg, object.scale};
    const auto own = std::ranges::find(object.keys, frame, &ObjectKey::frame);
    if (own != object.keys.end()) return {own->translate_m, own->rotate_deg, own->scale};
    ObjectSettings still = object;
    still.spin.reset();
    const Eigen::Affine3d placed = object_placement(still, {static_cast<double>(frame), 0});
    const Vector3d scale = placed.linear().colwise().norm();
    const Eigen::Matrix3d rotation = placed.linear() * scale.cwiseInverse().asDiagonal();
    // As a hand writes them: hundredths of a millimetre and of a degree, millionths of a scale.
    return {rounded(placed.translation(), 1e5), rounded(degrees_near(rotation, even_degrees(object.keys, frame)), 100),
            rounded(scale, 1e6)};
}

void set_placing(SceneText& text, const std::string& object_key, const ObjectSettings& object, std::int64_t frame,
                 Grip grip, const Placing& placing) {
    const auto own = std::ranges::find(object.keys, frame, &ObjectKey::frame);
    if (!object.keys.empty() && own == object.keys.end()) {
        std::vector<ObjectKey> keys = object.keys;
        const auto after = std::ranges::find_if(keys, [&](const ObjectKey& key) { return key.frame > frame; });
        keys.insert(after, {frame, placing.translate_m, placing.rotate_deg, placing.scale});
        return text.set(object_key + ".keys", TomlText(text_of(keys)));
    }
    const std::string key =
        object.keys.empty() ? object_key : fmt::format("{}.keys[{}]", object_key, own - object.keys.begin());
    const auto list = [](const Vector3d& xyz) { return std::vector<double>(xyz.begin(), xyz.end()); };
    const Vector3d& scale = placing.scale;
    switch (grip) {
        case Grip::turn:
            return text.set(key + ".rotate_deg", list(placing.rotate_deg));
        case Grip::size:
            if (scale.x() == scale.y() && scale.y() == scale.z()) return text.set(key + ".scale", scale.x());
            return text.set(key + ".scale", list(scale));
        default:
            return text.set(key + ".translate", list(placing.translate_m));
    }
}

}  // namespace matchlight
