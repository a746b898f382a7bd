// The scene file: what the user says of footage, tags, light, objects, effects and output.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/transforms.h"
#include "core/warnings.h"
#include "lighting/probe.h"
#include "scene/classic_shading.h"
#include "scene/effects.h"
#include "scene/lamp.h"
#include "scene/surface_detail.h"
#include "scene/virtual_camera.h"

namespace matchlight {

/// Whether the clip may correct the calibrated lens: where the evidence is clear, never, or in any case.
enum class LensRefinement { automatic, off, on };

struct FootageSettings {
    std::filesystem::path video;   // a video, or an image sequence "frames/%04d.jpg"
    std::filesystem::path camera;  // empty: `track` finds the lens with the path
    std::filesystem::path solve;   // "<scene>.solve.json" beside the scene unless given
    std::optional<std::filesystem::path> response;
    bool solve_response = false;  // response = "solve": `track` finds it
    std::optional<double> fps;    // for image sequences
    LensRefinement refine_lens = LensRefinement::automatic;
    double readout_s = 0;                     // rolling shutter: from the first row to the last
    bool solve_readout = false;               // `track` finds it
    std::optional<std::string> color_matrix;  // "bt601", "bt709", "bt2020": overrides the file's tag
    std::optional<std::string> color_range;   // "limited", "full"
    std::filesystem::path ocio_config;        // empty: $OCIO, where ocio_space is given
    std::string ocio_space;                   // of the footage; empty: response and the file's tags count
    std::filesystem::path matte;              // what is real and in front, a picture a frame; empty: nothing
    std::filesystem::path depth;              // of what the footage shows; empty: not known
    std::optional<double> depth_scale;        // metres a unit

    bool operator==(const FootageSettings&) const = default;
};

struct RigTag {
    int id = 0;
    double size_m = 0;
    std::optional<RigidTransform> world_from_tag;  // absent: to be solved

    bool operator==(const RigTag& other) const {
        const bool same_place = world_from_tag && other.world_from_tag
                                    ? world_from_tag->matrix() == other.world_from_tag->matrix()
                                    : world_from_tag.has_value() == other.world_from_tag.has_value();
        return id == other.id && size_m == other.size_m && same_place;
    }
};

struct TagSettings {
    std::string family = "tag36h11";
    std::vector<RigTag> rig;
    double white_albedo = 0.8;
    double black_albedo = 0.04;

    bool operator==(const TagSettings&) const = default;
};

struct ProbeSettings {
    std::filesystem::path path;
    std::optional<ProbeMapping> mapping;
    ProbePlacement placement;
    std::optional<Eigen::Vector3d> place_m;  // where it was taken, in the world

    bool operator==(const ProbeSettings&) const = default;
};

enum class ReflectionForm { cube, sphere_map };

struct MaterialOverride {
    std::optional<std::array<double, 3>> base_color;  // scene-linear
    std::filesystem::path texture;                    // of the base colour, which multiplies it
    std::optional<double> metallic, roughness;
    std::optional<std::array<double, 3>> emissive;  // radiance, probe units
    std::optional<std::array<double, 3>> diffuse;   // Od of the classic model
    std::optional<std::array<double, 3>> specular;  // Ks of the classic model
    SurfaceDetail detail;
    ClassicShading shading;

    bool operator==(const MaterialOverride&) const = default;
};

/// How an object stands at a frame.
struct ObjectKey {
    std::int64_t frame = 0;
    Eigen::Vector3d translate_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotate_deg = Eigen::Vector3d::Zero();
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();

    bool operator==(const ObjectKey&) const = default;
};

/// A steady turn about an axis through the object's origin, on top of how it stands.
struct SpinSettings {
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // in the axes that translate is in; any length but 0
    double turns_per_second = 0;                      // counter-clockwise seen from the axis' tip

    bool operator==(const SpinSettings&) const = default;
};

/// How a model's own animation is played on the clip's clock.
struct AnimationSettings {
    std::string name;  // or its number; empty: the first; "none": at rest
    double speed = 1;
    double start_s = 0;  // of the animation, when the clip begins
    bool loop = true;    // false: held at its ends

    bool operator==(const AnimationSettings&) const = default;
};

/// What an object is blurred by in place of the lens' own focus (Kosloff & Barsky 2007, "An Algorithm for Rendering
/// Generalized Depth of Field Effects Based on Simulated Heat Diffusion").
struct FocusOverride {
    std::optional<double> distance_m;  // as if the lens were focused there; absent: sharp everywhere

    bool operator==(const FocusOverride&) const = default;
};

/// Which axis of a file points up.
enum class SphereAxes { z, y };

/// Darkness behind the silhouettes of spheres.
struct SphereHalo {
    double strength = 0;     // 0..1 of the light, at the silhouette; 0: none
    double width_deg = 0.3;  // of the view
    double depth_m = 0.1;    // how far behind it is as dark as that

    bool operator==(const SphereHalo&) const = default;
};

/// How the columns of a file become spheres.
struct SphereSettings {
    std::optional<double> radius;  // of all, in the file's units
    std::string radius_column;
    double radius_scale = 1;
    std::string color_column;   // or "element"
    std::size_t color_map = 0;  // index into color_map_names()
    std::optional<std::array<double, 2>> color_range;
    double opacity = 1;
    std::string opacity_column;
    SphereAxes up = SphereAxes::z;
    std::int64_t frame = 0;  // of a trajectory
    SphereHalo halo;

    bool operator==(const SphereSettings&) const = default;
};

struct ObjectSettings {
    // One of three:
    std::filesystem::path model;
    std::string shape;              // a word that make_shape() knows
    std::filesystem::path spheres;  // what load_sphere_set() reads
    SphereSettings sphere;
    std::string name;  // for layers and messages; the file's stem unless given
    Eigen::Vector3d translate_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d rotate_deg = Eigen::Vector3d::Zero();
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
    std::vector<ObjectKey> keys;  // ascending; instead of the three above
    std::optional<SpinSettings> spin;
    AnimationSettings animation;
    std::optional<int> parent_tag;  // coordinates are that tag's instead of the world's
    ReflectionForm reflection = ReflectionForm::cube;
    bool casts_shadow = true;
    double lights = 1;     // of the model's own analytic lights: probe units a candela or a lux; 0: none
    bool holdout = false;  // it stands for a real thing: never drawn, it hides what is behind it
    std::optional<FocusOverride> focus;
    MaterialOverride material;

    bool operator==(const ObjectSettings&) const = default;
};

struct SurfaceSettings {
    bool present = true;  // [surface] enabled = false turns shadow catching off
    double z_m = 0;
    bool shadow = true;
    double reflection = 0;  // of light that falls on it straight on, mirrored; 0: it mirrors no objects
    double reflection_roughness = 0.1;

    bool operator==(const SurfaceSettings&) const = default;
};

enum class QualityLevel { draft, preview, final_, reference };

/// How spheres that let light through are put together. Lists and both ways of peeling are exact, to the tolerance, and
/// alike; the others keep no order.
enum class TransparencyMethod { lists, peeling, dual_peeling, weighted_sum, weighted_blended, moments };

/// What is near in what objects mirror: nothing but where the probe saw it, the real surface as the clip shows it, the
/// other objects by rays, too.
enum class ReflectionLevel { environment, plane, rays };

struct OutputSettings {
    std::string codec = "h264";  // h264, h265, ffv1, prores4444
    std::optional<int> crf;
    std::optional<std::string> pixel_format;  // the footage's own unless given
    std::string preset = "medium";            // of x264 and x265: faster or smaller
    bool audio = true;

    bool operator==(const OutputSettings&) const = default;
};

struct Scene {
    std::filesystem::path path;
    FootageSettings footage;               // without a camera
    std::optional<CameraSettings> camera;  // of a scene without footage
    BackgroundSettings background;
    TagSettings tags;
    std::optional<ProbeSettings> probe;
    std::vector<LampSettings> lamps;
    std::vector<ObjectSettings> objects;
    SurfaceSettings surface;
    EffectSettings effects;
    QualityLevel quality = QualityLevel::final_;
    std::optional<ReflectionLevel> reflections;  // in place of the level's
    std::optional<bool> bounce;                  // likewise: whether light bounces between objects
    std::optional<int> sphere_edges;             // places along a layer pixel's side, in place of the level's
    std::optional<double> sphere_detail_px;      // radius below which spheres are drawn fewer, in place of the level's
    std::optional<int> occlusion_divisions;      // of an octahedron, in place of the level's directions of light
    TransparencyMethod transparency = TransparencyMethod::lists;
    double transparency_tolerance = 1;  // codes of 255, of spheres that let light through
    std::optional<double> budget_ms;    // for a frame: chooses levels within it
    OutputSettings output;
    std::string effective_toml;  // every setting with its value, defaults included: recorded in outputs
};

/// Whether there is no light but that of analytic lights: no probe, and lamps that are the footage's own, or no
/// footage.
bool lit_by_lamps_alone(const Scene& scene);

/// The settings of a scene file as Markdown tables, from the table that also checks them: `render --help-scene` and the
/// README print it.
std::string scene_schema_text();

/// Reads a scene file; paths are made relative to its folder. An unknown key is an error with line and nearest known
/// key. Throws InputError.
Scene load_scene(const std::filesystem::path& path, Warnings& warnings);

}  // namespace matchlight
