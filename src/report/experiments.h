// The effects that a report measures on a scene's frame: what each compares and against which reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/experiment.h"
#include "report/scene_stage.h"

namespace matchlight {

struct ExperimentOptions {
    bool quick = false;    // fewer candidates, cheaper references
    bool by_name = false;  // asked for by name: with its defaults where the scene does without
};

// Each is absent where the scene does not have what it is about.

/// The shadow on the real surface: directions of light, texels of its maps.
std::optional<Experiment> contact_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Shadows of objects on objects: directions of light, texels of its depth maps.
std::optional<Experiment> object_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Edges and shading of the virtual layer: pixels and samples a plate pixel.
std::optional<Experiment> antialiasing_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// What a mirror shows of the probe: cube map and sphere map by size.
std::optional<Experiment> reflection_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// What objects mirror of the surface, of each other and of themselves: levels, rays.
std::optional<Experiment> near_reflection_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Light that bounces between objects and to the surface: rays.
std::optional<Experiment> bounce_light_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// The same against double precision, in a small scene of its own: a lamp mirrored by an object, by the real surface,
/// and shining on it: rays.
std::optional<Experiment> mirrored_lamp_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> table_reflection_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> lamp_on_table_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// The shadow of a virtual box on a real one: directions.
std::optional<Experiment> holdout_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Analytic lights, classic shading and depth cueing against double precision, in small scenes of their own.
std::optional<Experiment> lamp_shadow_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> classic_shading_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> depth_cue_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// What a glossy surface shows of it: lookups of the rough levels.
std::optional<Experiment> glossy_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// Ways to show a height map: steps.
std::optional<Experiment> relief_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Patterns towards the horizon: filtered, or samples a pixel.
std::optional<Experiment> pattern_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// What moves while the shutter is open: gathered from one picture, or drawn at several times.
std::optional<Experiment> motion_blur_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// Bloom as a mixture of Gaussians, and as the study had it.
std::optional<Experiment> bloom_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> classic_bloom_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// Diffraction by the aperture, and the lenticular halo where there is one.
std::optional<Experiment> diffraction_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// Streak glare, and as the study had it.
std::optional<Experiment> streaks_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> classic_streaks_experiment(const SceneStage& stage, const ExperimentOptions& options);

/// Depth of field: every level, `gather` at every quality, and points of the lens by their number.
std::optional<Experiment> depth_of_field_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// The shadow on the real surface out of focus.
std::optional<Experiment> surface_defocus_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Noise on what is virtual.
std::optional<Experiment> grain_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// Red and blue displaced: against the scene drawn by a lens for each colour.
std::optional<Experiment> chromatic_aberration_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// The Gaussian of codec and resampling.
std::optional<Experiment> softness_experiment(const SceneStage& stage, const ExperimentOptions& options);
/// The virtual layer in other colours, and blurred by repeated boxes, by level of `sensor` (whole frames).
std::optional<Experiment> color_transform_experiment(const SceneStage& stage, const ExperimentOptions& options);
std::optional<Experiment> repeated_blur_experiment(const SceneStage& stage, const ExperimentOptions& options);

struct NamedExperiment {
    std::string name;  // as --effects takes it
    std::optional<Experiment> (*make)(const SceneStage&, const ExperimentOptions&);
};
const std::vector<NamedExperiment>& all_experiments();

}  // namespace matchlight
