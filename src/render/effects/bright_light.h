// Which light is bright enough to spill: the curve that the bright pass and the references share.
#pragma once

namespace matchlight {

/// Whose light is taken: everybody's; what virtual objects send; or all but that.
enum class BrightShare { all, objects, rest };

/// What a colour's brightness is: its largest channel, so that a saturated lamp counts in full, or its luminance.
enum class BrightMeasure { largest_channel, luminance };

struct BrightPassSettings {
    double threshold = 1;
    double knee = 0.5;          // share of the threshold, 0..1
    bool firefly_safe = false;  // see firefly_limit_plate_linear
    BrightShare share = BrightShare::all;
    double object_strength = 1;  // of what objects send
    BrightMeasure measure = BrightMeasure::largest_channel;
    bool full_float = false;  // 32 bits a channel instead of 16
};

/// A pixel alone in its block of 4×4 counts for no more than about this much light; a block that is bright throughout
/// keeps all of it. The block's pixels are weighted by 1/(1 + brightness/limit), as Karis 2013, "Tone Mapping" (in
/// Graphic Rants), does with a limit of 1: ours lies far above what a lamp's reflection sends, so that only a sun
/// in a single pixel loses energy.
inline constexpr double firefly_limit_plate_linear = 1000;
inline constexpr int firefly_block_px = 4;

/// The share of a colour that spills, by its brightness m: 0 below the threshold's knee, (m − t)/m above it, and a
/// parabola between that meets both with their slopes (after Takahashi 2015, KinoBloom). Continuous and monotone.
inline double bright_share(double m, double threshold, double knee) {
    const double half_width = knee * threshold;
    if (m <= threshold - half_width || m <= 0) return 0;
    if (m >= threshold + half_width) return (m - threshold) / m;
    const double over = m - threshold + half_width;
    return over * over / (4 * half_width) / m;
}

}  // namespace matchlight
