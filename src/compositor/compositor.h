// One frame in, one image out: the same for render, preview and report.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "compositor/budget.h"
#include "compositor/overscan.h"
#include "compositor/quality.h"
#include "core/image.h"
#include "core/warnings.h"
#include "gl/context.h"
#include "gl/shader_library.h"
#include "media/plate.h"
#include "render/gathered_surface.h"
#include "render/graph.h"
#include "render/surface.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// How the light of a frame's layers goes with that of the probe and with code values.
struct LayerLight {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // plate-linear light of unit probe light: 2^ev · white balance
    std::array<double, 2> vignette{};                // on top of the gain: 1 + v0 r² + v1 r⁴, r = 1 at the corner
    double plate_gain = 1;                           // of the footage's own light: exposed anew
    double white_light = 0;  // plate-linear light that the tone curve shows as white; 0: there is no curve
};

/// The parts of a frame for EXR output, each covering `region` of the plate (with overscan: and beyond); light is
/// plate-linear (the response's inverse of the code values), depth in metres along the camera's axis (0 = nothing
/// there), normals in world axes.
///
///     beauty = plate · shadow · (1 − coverage) + reflection + virtual + spill + grain
struct FrameLayers {
    Region region;
    ImageF beauty;        // RGB
    ImageF alpha;         // 1 channel
    ImageF depth;         // 1 channel
    ImageF normal;        // 3 channels
    ImageF shadow;        // RGB ratio
    ImageF object_id;     // 1 channel; 0 = nothing, 1 = the scene's first object
    ImageF reflection;    // RGB that the real surface mirrors of objects less what they cover there; empty: none
    ImageF virtual_rgba;  // the virtual layer alone: premultiplied plate-linear light and alpha
    ImageF background;    // RGB, in place of the plate in scenes without footage; else empty
    ImageF plate;         // RGB light of footage or background as it was composited: exposed anew where that is asked
    ImageF coverage;      // RGB where the lens parts the channels; empty: alpha in all of them
    ImageF spill;         // RGB that the camera's effects add or take away; empty: none
    ImageF grain;         // RGB noise; empty: none
    ImageF clipped;  // 1 channel, under a shadow: 1 = known only from below, ½ = by its neighbours' colour; empty: 0
    LayerLight light;
    // With CompositorOptions::exchange; else empty.
    ImageF motion;  // 4 channels, pixels to the right and up: to the next frame, to the previous one
    ImageF parts;   // 16 channels: part (an index into Compositor::parts(), from 1; 0 = none), coverage, eight times
};

/// The plate as it came, and what is new in it.
struct CompositedFrame {
    PlateFrame plate;
    Region reach;    // where virtual things can be seen or cast shadow; empty when nowhere
    ImageF code;     // RGB code values over `reach`, the plate's own where nothing was touched
    Image8 touched;  // 1 channel over `reach`: 255 where the pixel changed hands
    std::optional<FrameLayers> layers;
    std::int64_t clipped_under_shadow = 0;  // clipped plate pixels under a shadow that no other frame knows better

    /// The plate with the touched pixels written into its samples: for encoders. Where chroma is subsampled a touched
    /// pixel changes its whole block's chroma.
    PlateFrame composited_plate() const;
    /// Rounded R'G'B' of the whole frame: the decoded plate, with the touched pixels and no others replaced.
    Image8 rgb8() const;
    Image16 rgb16() const;
};

struct CompositorOptions {
    QualityLevel quality = QualityLevel::final_;
    std::optional<Quality> settings = {};    // instead of what `quality` means
    std::optional<FrameBudget> budget = {};  // chooses the levels within `settings` or `quality`
    // What the clip shows of the real surface (compositor/surface_picture.h); null: nothing.
    std::shared_ptr<const GatheredSurface> gathered_surface = {};
    bool layers = false;     // also return FrameLayers
    bool exchange = false;   // and in them motion vectors and parts
    Overscan overscan = {};  // layers go on beyond the frame; needs `layers`
    bool leave_out = true;   // false: draw what could be left out, too; the result is the same, bit for bit
    bool timed = false;      // time every pass, for reports(); waits for the GPU at each
};

/// A part of an object, by the names that other programs are told.
struct NamedPart {
    std::string object;    // unlike any other object's
    std::string material;  // the same for all parts of that material
};

class Compositor {
public:
    /// Loads probe and models, and makes what no frame changes. `context` must be current and outlive the compositor.
    /// Throws InputError.
    Compositor(GlContext& context, const Scene& scene, const Solve& solve, const CompositorOptions& options,
               Warnings& warnings);
    ~Compositor();
    Compositor(const Compositor&) = delete;
    Compositor& operator=(const Compositor&) = delete;

    /// A pure function of frame, solve and scene: frames may come in any order. A frame without a pose is returned as
    /// it came.
    CompositedFrame composite(PlateFrame plate);

    /// Other effects from the next frame on, at the cost of none of what is loaded: for the preview's switches.
    void set_effects(const EffectSettings& effects);
    /// Another scene from the next frame on, at the cost of what it changes: its frames are those of a compositor made
    /// of it, bit for bit. False where there is nothing to keep (see compositor/scene_change.h), where the options'
    /// gathered surface is of another one, or where a budget chose the levels: then, as after an InputError, this
    /// compositor is of no use any more.
    bool set_scene(const Scene& scene);
    /// While true, set_scene() makes coarse shadows and reflections, and leaves shadows between objects and the
    /// gathered surface as they were; once false again, the next frame is exact. False as set_scene() says it.
    bool set_dragging(bool dragging);
    /// Where the camera of a frame stands from now on, instead of where the solve or the scene has it.
    void set_pose(std::int64_t frame, const RigidTransform& camera_from_world);
    /// As RenderGraph::watch(), from the next frame on, and watched().
    void watch(const std::string& pass);
    const std::optional<WatchedTexture>& watched() const;
    /// As CompositorOptions::timed, from the next frame on.
    void set_timed(bool timed);
    /// Makes programs anew whose shader files changed; the next frame is drawn with them, and with new maps of what the
    /// clip shares. Where one does not compile, the last good one stays.
    ShaderReload reload_shaders();

    /// What exposure control meters of the frame, linear light before any tone curve: see
    /// render/effects/exposure_meter.h. Effects are left out.
    ImageF meter_map(const PlateFrame& plate);

    /// What became of each pass of the last frame.
    std::vector<PassReport> reports() const;

    /// The virtual layer alone over the whole frame, for output with alpha: code values of its light, premultiplied by
    /// alpha, 4 floats a pixel. Needs the frame's layers.
    ImageF virtual_layer_code(const CompositedFrame& frame) const;

    /// What the budget chose, for every frame of the clip; nullopt without a budget.
    const std::optional<LevelChoice>& level_choice() const;

    /// What mattes can be asked for, by the numbers that FrameLayers::parts has.
    std::vector<NamedPart> parts() const;

    /// The objects on the GPU, for the report: it holds what is drawn of them against references.
    SurfaceRenderer& surfaces();

    /// The plate's linear light over the whole frame (for EXR output), through the response in force.
    ImageF plate_linear(const PlateFrame& plate) const;
    /// The response in force: the solve's, or what the footage says of itself.
    const Response& response_of(const PlateFrame& plate) const;
    /// How far layers go beyond the frame.
    const Overscan& overscan() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace matchlight
