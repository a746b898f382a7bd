// Where composited frames go: a video, PNG pictures or multi-part EXR files.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "compositor/compositor.h"
#include "core/warnings.h"
#include "media/frame_source.h"
#include "scene/scene_file.h"

namespace matchlight {

enum class OutputKind { video, png, exr };

/// By the name's ending: .mp4, .mov, .mkv; .png; .exr. Throws InputError for others, with those that are known.
OutputKind output_kind(const std::filesystem::path& output);

struct OutputRequest {
    std::filesystem::path path;  // a video's name, or a picture's with a pattern such as out_%04d.png
    OutputSettings settings;
    bool overwrite = false;
    std::int64_t first_number = 0;  // number in the name of frame 0 of the footage
    std::filesystem::path scene;
    std::string provenance;  // effective scene, version: recorded in every output
};

class FrameOutput {
public:
    virtual ~FrameOutput() = default;
    /// One frame, whole under its final name on return (pictures).
    virtual void write(const CompositedFrame& frame, const Compositor& compositor) = 0;
    /// After the last frame: gives a video its final name.
    virtual void finish() = 0;
    /// Whether frames must be composited with their layers.
    virtual bool needs_layers() const = 0;
    /// And whether motion vectors and parts must be among them.
    virtual bool needs_exchange() const { return false; }
};

/// Checks that the output can be written before any work is done. Throws InputError.
std::unique_ptr<FrameOutput> open_frame_output(const OutputRequest& request, const FootageInfo& footage,
                                               Warnings& warnings);

}  // namespace matchlight
