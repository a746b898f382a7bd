// Stiff and extreme cases: what comes out of each part there, against a bound that it must keep.
//
// `matchlight report --stability` runs them all and prints the table; tests/gpu/stability_test.cpp runs the same.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "gl/condition.h"
#include "gl/shader_library.h"
#include "render/frame_light.h"
#include "report/report.h"

namespace matchlight {

struct StabilityOutcome {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::optional<double> energy_kept = {};  // out over in, where light is spread
    std::optional<double> most = {};         // upper end of the bound, where it follows from the case's own picture
    std::vector<Knob> beside = {};           // what else came out: shown, not judged
};

/// Both ends belong to it; NaN lies in none.
struct Bound {
    double least = 0, most = 0;
    bool holds(double value) const { return value >= least && value <= most; }
};

struct StabilityCase {
    std::string effect;  // the part of the program
    std::string name;
    std::string measure;  // what the value is: "largest error"
    Bound bound;
    std::optional<Bound> energy;  // bound of energy_kept
    std::function<StabilityOutcome()> run;
};

/// Transfer curves, lens, depth, poses, sampled light, metrics, budgets: on the CPU.
std::vector<StabilityCase> number_cases();
/// Light probes through every mapping and file: on the CPU.
std::vector<StabilityCase> probe_cases();
/// Environment maps, shadows, bright light and its effects, whole frames: a context must be current where they run.
std::vector<StabilityCase> light_cases();
std::vector<StabilityCase> frame_cases();
/// Diffraction and halo: likewise.
std::vector<StabilityCase> wave_glare_cases();
/// The post-process methods of depth of field, and what each is known for: likewise.
std::vector<StabilityCase> defocus_cases();
/// Motion blur gathered from one picture: likewise.
std::vector<StabilityCase> motion_blur_cases();
/// Depth of field by every method: likewise.
std::vector<StabilityCase> depth_of_field_cases();
/// The pose of a tag over sizes, tilts, blurs and noise, against other libraries': on the CPU.
std::vector<StabilityCase> tag_pose_cases(bool quick);
/// Bracketed photographs, their merge and the response they tell: on the CPU.
std::vector<StabilityCase> exposure_cases();
/// Probes from photographs of a mirror ball: on the CPU.
std::vector<StabilityCase> ball_cases(bool quick);
/// The picture of the real surface from the clip: on the CPU.
std::vector<StabilityCase> surface_picture_cases();
/// Sphere sets on the GPU against rays in double precision: a context must be current where they run.
std::vector<StabilityCase> sphere_cases();
/// Rays between objects, bounced light, mirroring tables and holdouts: a context must be current where they run.
std::vector<StabilityCase> near_light_cases();
/// Relief and patterns on surfaces: likewise.
std::vector<StabilityCase> surface_detail_cases();
/// Analytic lights: likewise.
std::vector<StabilityCase> lamp_cases();
/// All of them; `quick` leaves out most of the slow ones.
std::vector<StabilityCase> stability_cases(bool quick = false);

/// A camera effect on its own, for spill_cases().
using AddSpill = std::function<GraphTexture(RenderGraph& graph, ShaderLibrary& shaders, const FrameLight& light,
                                            GpuCondition& bright)>;
struct SpillCaseBounds {
    std::optional<Bound> energy;  // of light up to 65504 in the middle of a frame that holds what it spreads to
    double most_gain = 1.002;     // of evenly lit frames: half floats round twice
    bool huge_frames = false;     // also 8192×4320
};
/// What every effect that spreads light must bear: one pixel of any value, and frames of any size.
std::vector<StabilityCase> spill_cases(const std::string& effect, const SpillCaseBounds& bounds, const AddSpill& add);

/// Runs it: a value or energy outside of its bound, or an exception, does not pass.
StabilityRow stability_row(const StabilityCase& tried);

}  // namespace matchlight
