// Gathers the picture of the real surface: frames in, texels out, each on its own.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "compositor/plane_grid.h"
#include "compositor/sensor.h"
#include "compositor/surface_edges.h"
#include "compositor/surface_frames.h"
#include "compositor/surface_holdouts.h"
#include "compositor/surface_picture.h"
#include "compositor/surface_texel.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/stop.h"
#include "scene/footage_options.h"

namespace matchlight {

namespace {

/// Decoded frames are held at once, six bytes a pixel: of large pictures fewer.
constexpr std::size_t most_bytes_held = std::size_t{512} << 20;
constexpr int fewest_frames = 5;

int frames_to_hold(const Camera& camera, int most) {
    const std::size_t bytes =
        std::size_t{6} * static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
    const auto held = static_cast<int>(std::min(most_bytes_held / std::max<std::size_t>(bytes, 1), std::size_t{1000}));
    return std::clamp(held, std::min(fewest_frames, most), most);
}

/// Frames that cannot be decoded are left out: rendering warns of them.
std::vector<SurfaceFrame> read_frames(const std::vector<const SolvedFrame*>& wanted, FrameSource& source,
                                      const SurfaceClip& clip, bool quiet) {
    // Reading on is quicker than decoding from a key frame, which may lie a few seconds back.
    constexpr std::int64_t longest_read_on = 50;
    std::vector<SurfaceFrame> frames;
    Progress progress("surface", static_cast<std::int64_t>(wanted.size()), quiet);
    std::int64_t next = 0;
    for (const SolvedFrame* solved : wanted) {
        if (solved->frame - next > longest_read_on) source.seek(solved->frame);
        std::optional<PlateFrame> plate = source.next();
        while (plate && plate->index() < solved->frame) plate = source.next();
        progress.advance();
        if (!plate) break;
        next = plate->index() + 1;
        if (plate->index() == solved->frame && plate->format().width == clip.solve.camera.width &&
            plate->format().height == clip.solve.camera.height)
            frames.emplace_back(clip, *plate, *solved);
        if (stop_requested()) throw InputError(source.info().path, solved->frame, "gathering was stopped by a signal");
    }
    return frames;
}

GatheredSurface texels_of(const std::vector<SurfaceFrame>& frames, const PlaneGrid& grid) {
    GatheredSurface gathered{ImageF(grid.columns, grid.rows, 4), ImageF(grid.columns, grid.rows, 1), grid.rectangle_m};
    parallel_for(grid.rows, [&](int row) {
        std::vector<SurfaceSample> samples;
        for (int column = 0; column < grid.columns; ++column) {
            samples.clear();
            const Eigen::Vector3d point_m = grid.point_m(column, row);
            for (const SurfaceFrame& frame : frames) {
                if (const auto sample = frame.sample(point_m, grid.texel_m)) samples.push_back(*sample);
            }
            const SurfaceTexel texel = agreed_texel(samples);
            float* out = gathered.radiance.pixel(column, row);
            for (std::size_t c = 0; c < 3; ++c) out[c] = static_cast<float>(texel.radiance[c]);
            out[3] = static_cast<float>(texel.knowledge);
            gathered.clipped.at(column, row) = texel.clipped ? 1.0f : 0.0f;
        }
    });
    return gathered;
}

}  // namespace

std::optional<GatheredSurface> gather_surface(const Scene& scene, const Solve& solve,
                                              const SurfacePictureOptions& options, Warnings& warnings) {
    if (!options.needed || scene.camera || !scene.surface.present) return std::nullopt;
    const std::vector<const SolvedFrame*> wanted =
        spread_frames(solve, frames_to_hold(solve.camera, options.most_frames));
    std::vector<RigidTransform> cameras_from_world;
    for (const SolvedFrame* frame : wanted) cameras_from_world.push_back(*frame->camera_from_world);
    const std::unique_ptr<FrameSource> source = open_frames(scene, options.strict, warnings);
    SurfaceClip clip(solve, vignette_of(scene.effects.vignette, solve), source->info().format);
    const SurfaceHoldouts holdouts(scene, solve, warnings);
    clip.holdouts = &holdouts;
    const PlaneGrid grid =
        plan_plane_grid(cameras_from_world, solve, clip.lens_map, scene.surface.z_m, options.most_texels);
    if (grid.columns == 0) return std::nullopt;
    const std::vector<SurfaceFrame> frames = read_frames(wanted, *source, clip, options.quiet);
    if (frames.empty()) return std::nullopt;
    GatheredSurface gathered = texels_of(frames, grid);
    close_holes(gathered);
    soften_edges(gathered);
    round_to_half(gathered.radiance);
    return gathered;
}

}  // namespace matchlight
