// Settings of the camera's effects, as the scene file gives them: defaults, ranges and units.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "scene/color_transform.h"

namespace matchlight {

// Light is plate-linear: 1 is the brightest code of the footage. Strengths scale what an effect adds (the study's
// equation 9: picture + strength · effect). Each check() throws std::invalid_argument naming what is out of range.

enum class BloomLevel { classic, pyramid, reference };

/// Light above a threshold, spread around where it is.
struct BloomSettings {
    BloomLevel level = BloomLevel::pyramid;
    double threshold = 1.0;  // light below it does not spill
    double knee = 0.5;       // share of the threshold over which spilling sets in; 0: at once
    double strength = 0.2;
    double radius = 0.08;      // the widest Gaussian's standard deviation, in frame heights
    bool firefly_safe = true;  // a very bright pixel that stands alone is held back; not at the level `classic`

    void check() const;
    bool operator==(const BloomSettings&) const = default;
};

enum class GlareLevel { classic, streaks, diffraction, reference };

/// The opening of the lens, which shapes diffraction (and, later, out-of-focus discs).
struct ApertureSettings {
    int blades = 6;  // 0: round
    double rotation_deg = 0;
    double roundness = 0;  // 0: straight blades; 1: a circle
    int eyelashes = 0;
    int dust = 0;                      // specks
    int seed = 1;                      // of eyelashes and dust
    std::filesystem::path image = {};  // instead of blades: white lets light through
    // Where both are known, diffraction has its true size: GlareSettings::size is left alone.
    std::optional<double> f_number = {};
    std::optional<double> pixel_pitch_um = {};  // of a pixel of the footage on the sensor

    void check() const;
    bool operator==(const ApertureSettings&) const = default;
};

/// Light above a threshold, drawn out into streaks.
struct GlareSettings {
    GlareLevel level = GlareLevel::streaks;
    double threshold = 2.0;
    double knee = 0.25;
    double strength = 0.2;
    int directions = 4;
    double angle_deg = 45;           // of the first streak, counter-clockwise from the picture's right
    double attenuation = 0.92;       // a: of light from step to step, each 1/128 of the frame's height
    int passes = 3;                  // a streak is 4^passes steps long
    double size = 0.25;              // how far diffraction reaches, in frame heights
    double halo = 0;                 // strength of the lenticular halo
    ApertureSettings aperture = {};  // of `diffraction`

    void check() const;
    bool operator==(const GlareSettings&) const = default;
};

/// Bright reflections on virtual objects, apart from other light.
struct DazzleSettings {
    double strength = 1;                      // of what objects send to bloom and glare
    std::optional<GlareSettings> glare = {};  // a shape of their own

    void check() const;
    bool operator==(const DazzleSettings&) const = default;
};

enum class ExposureMode { matched, simulated };

/// Time constants of adaptation, in seconds.
struct AdaptationTimes {
    double to_light_s = 0;
    double to_dark_s = 0;
};
/// Exposure controls of cameras close faster than they open; half a second and two are what phones and camcorders do.
inline constexpr AdaptationTimes camera_adaptation{0.5, 2.0};
/// Of the retina's quick part: cones 0.1 s, rods 0.4 s (Durand & Dorsey 2000, "Interactive tone mapping"). The slow
/// one, bleached pigment that takes minutes to come back, is not simulated.
inline constexpr AdaptationTimes eye_adaptation{0.1, 0.4};

/// Matched: the footage's own exposure. Simulated: a meter and its adaptation over time, for scenes without footage, or
/// when asked for: then the whole picture is exposed anew, footage and all, as objects that alone changed would no
/// longer belong in it.
struct ExposureSettings {
    ExposureMode mode = ExposureMode::matched;
    double key = 0.18;            // the log average's place in the picture, 0.18 to 0.72 (Reinhard 2002)
    std::optional<double> white;  // light that becomes white; the brightest metered unless given
    double darkest_share = 0.05;  // of metered pixels left out at either end of the histogram
    double brightest_share = 0.02;
    double to_light_s = camera_adaptation.to_light_s;
    double to_dark_s = camera_adaptation.to_dark_s;
    double compensation_ev = 0;

    void check() const;
    bool operator==(const ExposureSettings&) const = default;
};

/// How simulated exposure control exposes a frame: scene-linear light · 2^ev, of which light of `white` and above is
/// shown as white.
struct FrameExposure {
    double ev = 0;
    double white = 1;
};

/// How what is out of focus is blurred. `lens_samples` draws the scene from many points of the lens; the others work on
/// one picture of it.
enum class DepthOfFieldLevel { gather, two_pass, one_pass, layers, mipmap, diffusion, lens_samples };

/// What the lens is focused on, where neither the solve nor a distance says.
enum class FocusTarget { distance, middle, point, object };

/// The lens' opening as out-of-focus discs show it.
struct BokehSettings {
    int blades = 0;  // 0: round
    double rotation_deg = 0;
    double roundness = 0;  // 0: straight blades; 1: a circle

    void check() const;
    bool operator==(const BokehSettings&) const = default;
};

/// A thin lens: what is not at the focus distance becomes a disc of the circle of confusion.
// What a mirror shows is as far as its virtual image; or it is painted on the mirror. `lens_samples` sees the first.
enum class ReflectionFocus { virtual_image, surface };

struct DepthOfFieldSettings {
    DepthOfFieldLevel level = DepthOfFieldLevel::gather;
    // Instead of what the solve, or the scene's camera, says.
    std::optional<double> focus_distance_m = {};
    std::optional<double> coc_scale_px_m = {};  // circle in px = scale · |1/focus − 1/z|
    FocusTarget focus_on = FocusTarget::distance;
    std::array<double, 3> focus_point_m = {};  // world
    std::string focus_object = {};             // its name
    int lens_samples = 64;                     // of that level
    BokehSettings bokeh = {};
    ReflectionFocus reflections = ReflectionFocus::virtual_image;

    void check() const;
    bool operator==(const DepthOfFieldSettings&) const = default;
};
/// Circles of confusion narrower than this, in plate pixels, are none.
inline constexpr double least_coc_px = 0.25;

/// How what moves while the shutter is open is smeared. `gather` blurs one picture along the way of each pixel; the
/// others draw the scene at many times.
enum class MotionBlurLevel { gather, sub_frames, reference };

/// The shutter is open around the middle of a frame's exposure, for which the solve's poses hold.
struct MotionBlurSettings {
    MotionBlurLevel level = MotionBlurLevel::gather;
    std::optional<double> shutter = {};  // share of a frame's time; instead of what the solve says
    int sub_frames = 8;                  // of that level

    void check() const;
    bool operator==(const MotionBlurSettings&) const = default;
};
/// Ways shorter than this, in plate pixels, are none.
inline constexpr double least_motion_px = 0.25;
/// Of scenes without footage: half the frame's time, the rotary shutter of film cameras.
inline constexpr double usual_shutter = 0.5;

/// The camera's noise on what is virtual: variance = read² + shot · light, plate-linear. The solve's unless given.
struct GrainSettings {
    std::optional<double> read = {}, shot = {};
    std::optional<double> correlation_px = {};  // standard deviation of the Gaussian that smooths the noise; 0: none
    double strength = 1;                        // times the noise that is added
    int seed = 1;

    void check() const;
    bool operator==(const GrainSettings&) const = default;
};

/// The lens' fall-off: gain = 1 + v1 r² + v2 r⁴, r = 1 in the corners. The solve's unless given.
struct VignetteSettings {
    std::optional<double> v1 = {}, v2 = {};

    void check() const;
    bool operator==(const VignetteSettings&) const = default;
};

/// Red and blue displaced along the radius, away from the middle, in plate pixels at the frame's corners.
struct ChromaticAberrationSettings {
    std::optional<double> red_px = {}, blue_px = {};

    void check() const;
    bool operator==(const ChromaticAberrationSettings&) const = default;
};

/// What codec and resampling blurred in the footage, as a Gaussian.
struct SoftnessSettings {
    std::optional<double> sigma_px = {};  // the solve's unless given

    void check() const;
    bool operator==(const SoftnessSettings&) const = default;
};

/// What is virtual fades to a colour with its distance from the camera (the depth cueing of PHIGS and of OpenGL's
/// linear fog).
struct DepthCueSettings {
    double near_m = 1, far_m = 10;            // along the camera's z: from where it fades, and to where
    std::array<double, 3> color = {0, 0, 0};  // scene-linear, probe units
    double strength = 1;                      // share of the colour at the far distance

    void check() const;
    bool operator==(const DepthCueSettings&) const = default;
};

struct EffectSettings {
    std::optional<BloomSettings> bloom;
    std::optional<GlareSettings> glare;
    std::optional<DazzleSettings> dazzle;
    std::optional<ExposureSettings> exposure;
    std::optional<DepthOfFieldSettings> depth_of_field;
    std::optional<MotionBlurSettings> motion_blur;
    std::optional<GrainSettings> grain;
    std::optional<ChromaticAberrationSettings> chromatic_aberration;
    std::optional<SoftnessSettings> softness;
    std::optional<DepthCueSettings> depth_cue;
    std::optional<ColorTransformSettings> color_transform;
    std::optional<RepeatedBlurSettings> repeated_blur;
    std::optional<VignetteSettings> vignette = VignetteSettings{};  // nullopt: off

    bool operator==(const EffectSettings&) const = default;
};

}  // namespace matchlight
