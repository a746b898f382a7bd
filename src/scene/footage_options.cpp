// Names of matrices and ranges were checked when the scene was read.
#include "scene/footage_options.h"

#include "media/blank_source.h"
#include "media/ocio_space.h"

namespace matchlight {

FootageOptions footage_options(const FootageSettings& footage, bool strict) {
    FootageOptions options;
    options.sequence_fps = footage.fps;
    options.strict = strict;
    if (footage.color_matrix == "bt601") options.matrix = ColorMatrix::bt601;
    if (footage.color_matrix == "bt709") options.matrix = ColorMatrix::bt709;
    if (footage.color_matrix == "bt2020") options.matrix = ColorMatrix::bt2020;
    if (footage.color_range == "limited") options.range = ColorRange::limited;
    if (footage.color_range == "full") options.range = ColorRange::full;
    if (!footage.ocio_space.empty()) options.primaries = ocio_space(footage.ocio_config, footage.ocio_space).primaries;
    return options;
}

std::unique_ptr<FrameSource> open_frames(const Scene& scene, bool strict, Warnings& warnings) {
    if (!scene.camera) return FrameSource::open(scene.footage.video, footage_options(scene.footage, strict), warnings);
    const CameraSettings& camera = *scene.camera;
    return std::make_unique<BlankSource>(BlankFootage{.path = scene.path,
                                                      .width = camera.width,
                                                      .height = camera.height,
                                                      .frames = camera.frames,
                                                      .fps = camera.fps});
}

}  // namespace matchlight
