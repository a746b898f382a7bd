// Smooth curves through keys: what a camera and an object do between the frames at which the scene places them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace matchlight {

/// Where a frame lies: `t` from 0 at key `from` to 1 at the next, `step` frames later. Before the first key and after
/// the last one that key holds: t and step are 0.
struct KeySpan {
    std::size_t from = 0;
    double t = 0;
    double step = 0;
};

/// `keys` ascend by their member `frame`, and there is at least one.
template <class Key>
KeySpan span_of(const std::vector<Key>& keys, double frame) {
    const auto frame_of = [&](std::size_t i) { return static_cast<double>(keys[i].frame); };
    if (frame <= frame_of(0)) return {};
    if (frame >= frame_of(keys.size() - 1)) return {.from = keys.size() - 1};
    const auto above = std::upper_bound(keys.begin(), keys.end(), frame, [](double value, const Key& key) {
        return value < static_cast<double>(key.frame);
    });
    KeySpan span{.from = static_cast<std::size_t>(above - keys.begin()) - 1};
    span.step = frame_of(span.from + 1) - frame_of(span.from);
    span.t = (frame - frame_of(span.from)) / span.step;
    return span;
}

/// How fast a key is passed: the slope of the parabola through it and its neighbours (Catmull & Rom 1974, "A class of
/// local interpolating splines", for uneven steps); of the line to the only neighbour at either end. `slope(i)` is the
/// change a frame from key i to the next.
template <class Key, class Slope>
auto tangent_at(const std::vector<Key>& keys, std::size_t i, const Slope& slope) -> decltype(slope(i)) {
    if (i == 0) return slope(0);
    if (i + 1 == keys.size()) return slope(i - 1);
    const auto before = static_cast<double>(keys[i].frame - keys[i - 1].frame);
    const auto after = static_cast<double>(keys[i + 1].frame - keys[i].frame);
    return (after * slope(i - 1) + before * slope(i)) / (before + after);
}

/// The cubic Hermite curve through the keys' values, vectors that `value_of` takes from a key.
template <class Key, class ValueOf>
auto between_keys(const std::vector<Key>& keys, double frame, const ValueOf& value_of) -> decltype(value_of(keys[0])) {
    using Value = decltype(value_of(keys[0]));
    const KeySpan span = span_of(keys, frame);
    const std::size_t i = span.from;
    if (span.step == 0) return value_of(keys[i]);
    const auto slope = [&](std::size_t from) -> Value {
        const auto step = static_cast<double>(keys[from + 1].frame - keys[from].frame);
        return (value_of(keys[from + 1]) - value_of(keys[from])) / step;
    };
    const double t = span.t, t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * value_of(keys[i]) + (t3 - 2 * t2 + t) * span.step * tangent_at(keys, i, slope) +
           (3 * t2 - 2 * t3) * value_of(keys[i + 1]) + (t3 - t2) * span.step * tangent_at(keys, i + 1, slope);
}

}  // namespace matchlight
