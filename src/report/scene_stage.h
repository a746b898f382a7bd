// One frame of a scene with all that measuring needs: solve, plate, light, and compositors of any quality.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "calibration/response.h"
#include "compositor/compositor.h"
#include "core/warnings.h"
#include "gl/context.h"
#include "gl/shader_library.h"
#include "lighting/probe.h"
#include "report/run_time.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

struct SceneStage {
    /// Without `frame` the first that has a pose. Throws InputError: no solve, no such frame, a frame without a pose.
    SceneStage(GlContext& gl_context, const Scene& the_scene, std::optional<std::int64_t> frame,
               Warnings& the_warnings);

    GlContext& context;
    Warnings& warnings;
    Scene scene;
    Solve solve;
    std::optional<PlateFrame> plate;  // always there
    Probe probe;                      // placed
    Response response;                // the plate's
    std::shared_ptr<const GatheredSurface> gathered_surface;
    mutable ShaderLibrary shaders;

    /// Rays would take most of the time of every measurement, and change nothing of what it compares: reflections are
    /// at most those of the level preview, and no light bounces.
    std::unique_ptr<Compositor> compositor(const Quality& quality, bool layers) const;
    std::unique_ptr<Compositor> compositor(const Scene& changed, const Quality& quality, bool layers) const;
    /// With rays as the quality says.
    std::unique_ptr<Compositor> compositor_with_rays(const Quality& quality, bool layers) const;
    const SolvedFrame& solved() const;

    /// 8-bit code values of plate-linear light, as the footage's camera would give them.
    Image8 code_of(const ImageF& light) const;
};

/// The part of an image that a region names.
ImageF cropped(const ImageF& image, const Region& region);

/// Plate-linear light over a region: the frame's, which has layers, and the plate's own where it has none.
ImageF beauty_over(const Compositor& compositor, const CompositedFrame& frame, const Region& region);

}  // namespace matchlight
