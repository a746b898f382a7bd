// Ranges of the effects' settings.
#include "scene/effects.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "scene/check_range.h"

namespace matchlight {
void DepthCueSettings::check() const {
    check_range("depth_cue near", near_m, 0, 1e6);
    check_range("depth_cue far", far_m, 0, 1e6);
    check_range("depth_cue strength", strength, 0, 1);
    if (!(far_m > near_m))
        throw std::invalid_argument(fmt::format("depth_cue far is {}, not beyond near, {}", far_m, near_m));
}

void BloomSettings::check() const {
    check_range("bloom threshold", threshold, 0, 1e6);
    check_range("bloom knee", knee, 0, 1);
    check_range("bloom strength", strength, 0, 100);
    check_range("bloom radius", radius, 0.001, 1);
}

void ApertureSettings::check() const {
    check_range("aperture blades", blades, 0, 32);
    if (blades == 1 || blades == 2) {
        throw std::invalid_argument(fmt::format("aperture blades is {}, not 0 (round) or from 3 to 32", blades));
    }
    check_range("aperture rotation_deg", rotation_deg, -36000, 36000);
    check_range("aperture roundness", roundness, 0, 1);
    check_range("aperture eyelashes", eyelashes, 0, 1000);
    check_range("aperture dust", dust, 0, 10000);
    check_range("aperture seed", seed, 0, 1e9);
    if (f_number) check_range("aperture f_number", *f_number, 0.1, 1000);
    if (pixel_pitch_um) check_range("aperture pixel_pitch_um", *pixel_pitch_um, 0.01, 10000);
}

void GlareSettings::check() const {
    check_range("glare threshold", threshold, 0, 1e6);
    check_range("glare knee", knee, 0, 1);
    check_range("glare strength", strength, 0, 100);
    check_range("glare directions", directions, 1, 64);
    check_range("glare angle_deg", angle_deg, -36000, 36000);
    check_range("glare attenuation", attenuation, 0, 0.999);
    check_range("glare passes", passes, 1, 5);
    check_range("glare size", size, 0.001, 1);
    check_range("glare halo", halo, 0, 100);
    aperture.check();
}

void DazzleSettings::check() const {
    check_range("dazzle strength", strength, 0, 1000);
    if (glare) glare->check();
}

void ExposureSettings::check() const {
    check_range("exposure key", key, 0.01, 1);
    if (white) check_range("exposure white", *white, 1e-300, 1e9);
    check_range("exposure darkest_share", darkest_share, 0, 0.49);
    check_range("exposure brightest_share", brightest_share, 0, 0.49);
    check_range("exposure to_light_s", to_light_s, 0, 1e6);
    check_range("exposure to_dark_s", to_dark_s, 0, 1e6);
    check_range("exposure compensation_ev", compensation_ev, -32, 32);
}

void BokehSettings::check() const {
    ApertureSettings{.blades = blades, .rotation_deg = rotation_deg, .roundness = roundness}.check();
}

void DepthOfFieldSettings::check() const {
    if (focus_distance_m) check_range("depth_of_field focus_distance_m", *focus_distance_m, 1e-3, 1e9);
    if (coc_scale_px_m) check_range("depth_of_field coc_scale_px_m", *coc_scale_px_m, 0, 1e9);
    check_range("depth_of_field lens_samples", lens_samples, 1, 65536);
    bokeh.check();
}

void MotionBlurSettings::check() const {
    if (shutter) check_range("motion_blur shutter", *shutter, 0, 1);
    check_range("motion_blur sub_frames", sub_frames, 1, 65536);
}

void GrainSettings::check() const {
    if (read) check_range("grain read", *read, 0, 1);
    if (shot) check_range("grain shot", *shot, 0, 1);
    if (correlation_px) check_range("grain correlation_px", *correlation_px, 0, 4);
    check_range("grain strength", strength, 0, 100);
    check_range("grain seed", seed, 0, 1e9);
}

void ChromaticAberrationSettings::check() const {
    if (red_px) check_range("chromatic_aberration red_px", *red_px, -100, 100);
    if (blue_px) check_range("chromatic_aberration blue_px", *blue_px, -100, 100);
}

void SoftnessSettings::check() const {
    if (sigma_px) check_range("softness sigma_px", *sigma_px, 0, 16);
}

void VignetteSettings::check() const {
    if (v1) check_range("vignette v1", *v1, -1, 10);
    if (v2) check_range("vignette v2", *v2, -1, 10);
    // 1 + v1 t + v2 t², t = r² from 0 to 1: least at an end, or where its slope is 0.
    const double a = v1.value_or(0), b = v2.value_or(0);
    const double turn = b > 0 ? std::clamp(-a / (2 * b), 0.0, 1.0) : 1;
    if (1 + a * turn + b * turn * turn < 0) {
        throw std::invalid_argument(
            fmt::format("vignette 1 {:+g} r² {:+g} r⁴ turns light negative at r = {:.3g}", a, b, std::sqrt(turn)));
    }
}

}  // namespace matchlight
