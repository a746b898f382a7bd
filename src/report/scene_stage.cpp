// Loads scene, solve, plate and probe for measuring.
#include "report/scene_stage.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compositor/exposure_meter.h"
#include "compositor/surface_picture.h"
#include "core/error.h"
#include "core/parallel.h"
#include "media/frame_source.h"
#include "scene/footage_options.h"
#include "tracking/plate_light.h"
#include "tracking/scene_solve.h"

namespace matchlight {
namespace {

std::int64_t frame_to_measure(const Solve& solve, std::optional<std::int64_t> wanted) {
    if (wanted) {
        const SolvedFrame* solved = solve.find(*wanted);
        if (solved != nullptr && solved->camera_from_world) return *wanted;
        throw InputError(solve.footage_file, *wanted, "has no pose: nothing virtual is seen in it",
                         "name another frame");
    }
    for (const SolvedFrame& solved : solve.frames) {
        if (solved.camera_from_world) return solved.frame;
    }
    throw InputError(solve.footage_file, "no frame of the solve has a pose", "track the footage again");
}

PlateFrame plate_of(const Scene& scene, std::int64_t frame, Warnings& warnings) {
    const std::unique_ptr<FrameSource> source = open_frames(scene, false, warnings);
    if (frame > 0) source->seek(frame);
    std::optional<PlateFrame> plate = source->next();
    if (!plate || plate->index() != frame) throw InputError(source->info().path, frame, "cannot be decoded");
    return std::move(*plate);
}

Probe probe_of(const Scene& scene, Warnings& warnings) {
    if (scene.probe)
        return placed(load_probe(scene.probe->path, scene.probe->mapping, warnings), scene.probe->placement);
    throw InputError(scene.path, "has no light probe: there is no light whose effects could be measured",
                     "give [light] a probe");
}

}  // namespace

SceneStage::SceneStage(GlContext& gl_context, const Scene& the_scene, std::optional<std::int64_t> frame,
                       Warnings& the_warnings)
    : context(gl_context),
      warnings(the_warnings),
      scene(the_scene),
      solve(solve_of_scene(scene, warnings)),
      plate(plate_of(scene, frame_to_measure(solve, frame), warnings)),
      probe(probe_of(scene, warnings)),
      response(effective_response(solve.response, plate->format().transfer)) {
    meter_clip(solve, scene, context, {.quiet = true}, warnings);
    gathered_surface = surface_picture_of_clip(scene, solve, {.quiet = true}, warnings);
}

std::unique_ptr<Compositor> SceneStage::compositor(const Quality& quality, bool layers) const {
    return compositor(scene, quality, layers);
}

std::unique_ptr<Compositor> SceneStage::compositor(const Scene& changed, const Quality& quality, bool layers) const {
    return std::make_unique<Compositor>(
        context, changed, solve,
        CompositorOptions{.settings = without_rays(quality), .gathered_surface = gathered_surface, .layers = layers},
        warnings);
}

std::unique_ptr<Compositor> SceneStage::compositor_with_rays(const Quality& quality, bool layers) const {
    return std::make_unique<Compositor>(
        context, scene, solve,
        CompositorOptions{.settings = quality, .gathered_surface = gathered_surface, .layers = layers}, warnings);
}

const SolvedFrame& SceneStage::solved() const {
    return *solve.find(plate->index());
}

Image8 SceneStage::code_of(const ImageF& light) const {
    Image8 code(light.width(), light.height(), 3);
    parallel_for(light.height(), [&](int y) {
        for (int x = 0; x < light.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double value = std::clamp(response.code_from_linear(light.at(x, y, c), c), 0.0, 1.0);
                code.at(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * value));
            }
        }
    });
    return code;
}

ImageF cropped(const ImageF& image, const Region& region) {
    ImageF part(region.width, region.height, image.channels());
    for (int y = 0; y < region.height; ++y) {
        std::copy_n(image.pixel(region.x, region.y + y), part.row(y).size(), part.pixel(0, y));
    }
    return part;
}

ImageF beauty_over(const Compositor& compositor, const CompositedFrame& frame, const Region& region) {
    ImageF picture = cropped(compositor.plate_linear(frame.plate), region);
    if (!frame.layers) return picture;
    const Region& drawn = frame.layers->region;
    const Region both = region.intersected(drawn);
    for (int y = both.y; y < both.y + both.height; ++y) {
        std::copy_n(frame.layers->beauty.pixel(both.x - drawn.x, y - drawn.y), 3 * both.width,
                    picture.pixel(both.x - region.x, y - region.y));
    }
    return picture;
}

}  // namespace matchlight
