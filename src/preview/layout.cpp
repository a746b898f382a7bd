// Bars keep their height; the panel its width; the picture has the rest.
#include "preview/layout.h"

#include <algorithm>
#include <cmath>

namespace matchlight {

namespace {

// At scale 1: a row of buttons; a line of text; a row of buttons, and curves above it.
constexpr float bar_px = 40, status_px = 26, timeline_px = 124;

struct Lengths {
    int bar, status, timeline, panel;
};

Lengths lengths_of(const LayoutSettings& settings) {
    const auto scaled = [&](float length) { return static_cast<int>(std::lround(length * settings.scale)); };
    return {scaled(bar_px), scaled(status_px), scaled(timeline_px), scaled(settings.panel_width)};
}

}  // namespace

Layout lay_out(const Eigen::Vector2i& window_px, const LayoutSettings& settings) {
    const int width = window_px.x(), height = window_px.y();
    if (!settings.panels)
        return {.bar = {}, .picture = {0, 0, width, height}, .panel = {}, .timeline = {}, .status = {}};
    Lengths lengths = lengths_of(settings);
    lengths.panel = std::min(lengths.panel, width - width / 3);
    lengths.timeline = std::clamp(height - height / 3 - lengths.bar - lengths.status, 0, lengths.timeline);
    const int left = width - lengths.panel;
    const int middle = std::max(1, height - lengths.bar - lengths.timeline - lengths.status);
    return {.bar = {0, 0, width, lengths.bar},
            .picture = {0, lengths.bar, left, middle},
            .panel = {left, lengths.bar, lengths.panel, height - lengths.bar},
            .timeline = {0, lengths.bar + middle, left, lengths.timeline},
            .status = {0, height - lengths.status, left, lengths.status}};
}

Eigen::Vector2i window_around(const Eigen::Vector2i& picture_px, const LayoutSettings& settings) {
    if (!settings.panels) return picture_px;
    const Lengths lengths = lengths_of(settings);
    return {picture_px.x() + lengths.panel, picture_px.y() + lengths.bar + lengths.status + lengths.timeline};
}

}  // namespace matchlight
