// Moves the principal point, and keeps what is measured in frames as it was.
#include "compositor/overscan.h"

#include <charconv>
#include <cmath>

namespace matchlight {

Overscan OverscanRequest::of(int frame_width, int frame_height) const {
    const auto side = [&](int length) { return pixels + static_cast<int>(std::ceil(share * length)); };
    return {side(frame_width), side(frame_height)};
}

std::optional<OverscanRequest> parse_overscan(const std::string& text) {
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc() || !(number >= 0)) return std::nullopt;
    const std::string unit(rest, end);
    constexpr double most_percent = 100, most_pixels = 4096;
    if (unit == "%" && number <= most_percent) return OverscanRequest{.share = number / 100};
    if ((unit.empty() || unit == "px") && number <= most_pixels && number == std::floor(number))
        return OverscanRequest{.pixels = static_cast<int>(number)};
    return std::nullopt;
}

Solve with_overscan(const Solve& solve, const Overscan& overscan) {
    Solve wider = solve;
    wider.camera.width += 2 * overscan.x;
    wider.camera.height += 2 * overscan.y;
    wider.camera.cx += overscan.x;
    wider.camera.cy += overscan.y;
    return wider;
}

Camera without_overscan(const Camera& camera, const Overscan& overscan) {
    Camera frame = camera;
    frame.width -= 2 * overscan.x;
    frame.height -= 2 * overscan.y;
    frame.cx -= overscan.x;
    frame.cy -= overscan.y;
    return frame;
}

double corner_ratio(const Camera& frame, const Overscan& overscan) {
    return std::hypot(frame.width + 2 * overscan.x, frame.height + 2 * overscan.y) /
           std::hypot(frame.width, frame.height);
}

EffectSettings with_overscan(const EffectSettings& effects, const Camera& frame, const Overscan& overscan) {
    if (!overscan.any()) return effects;
    EffectSettings wider = effects;
    const double taller = static_cast<double>(frame.height + 2 * overscan.y) / frame.height;
    const auto keep_size = [&](GlareSettings& glare) {
        glare.size /= taller;
        // Light is lost from step to step, and steps count in heights.
        glare.attenuation = std::pow(glare.attenuation, taller);
    };
    if (wider.bloom) wider.bloom->radius /= taller;
    if (wider.glare) keep_size(*wider.glare);
    if (wider.dazzle && wider.dazzle->glare) keep_size(*wider.dazzle->glare);
    if (wider.chromatic_aberration) {
        // Displacements are those of the corner.
        const double farther = corner_ratio(frame, overscan);
        for (std::optional<double>* displaced_px :
             {&wider.chromatic_aberration->red_px, &wider.chromatic_aberration->blue_px}) {
            if (*displaced_px) **displaced_px *= farther;
        }
    }
    return wider;
}

}  // namespace matchlight
