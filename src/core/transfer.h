// Standard transfer functions between code values and linear light, and luminance of Rec.709 primaries.
#pragma once

namespace matchlight {

/// IEC 61966-2-1 (sRGB). Values below 0 are mirrored, above 1 continued, so that the pair inverts everywhere.
double srgb_code_from_linear(double linear);
double linear_from_srgb_code(double code);

/// SMPTE ST 2084 (PQ); linear 1.0 = 10,000 cd/m².
double pq_code_from_linear(double linear);
double linear_from_pq_code(double code);

/// ITU-R BT.2100 HLG opto-electrical transfer function and its inverse; linear in [0, 1] is scene light.
double hlg_code_from_linear(double linear);
double linear_from_hlg_code(double code);

/// Relative luminance of linear Rec.709 (ITU-R BT.709).
inline double luminance_rec709(double r, double g, double b) {
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

}  // namespace matchlight
