// A scene with its footage and compositor, and what of it is made anew when it changes.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compositor/compositor.h"
#include "core/warnings.h"
#include "gl/context.h"
#include "preview/frame_cache.h"
#include "preview/free_shot.h"
#include "preview/probe_picture.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// How exactly a scene is drawn.
struct ShotLevel {
    QualityLevel level = QualityLevel::final_;
    bool budget = false;          // the scene's budget_ms chooses levels instead
    bool opaque_spheres = false;  // sets of spheres let no light through
    bool operator==(const ShotLevel&) const = default;
};

class Shot {
public:
    /// Reads the scene and all that belongs to it. `context` and `warnings` must outlive it. `quiet`: no progress of
    /// the meter pass. Throws InputError.
    Shot(GlContext& context, const std::filesystem::path& scene_path, bool quiet, Warnings& warnings);
    Shot(const Shot&) = delete;
    Shot& operator=(const Shot&) = delete;

    /// As the scene has it.
    ShotLevel scene_level() const;
    /// Makes anew what the clip shares, with the next frame.
    void set_level(const ShotLevel& level);
    /// The scene as it was changed: from the next frame on, at the cost of what changed. Throws InputError.
    void set_scene(const Scene& scene);
    /// While true, shadows and reflections of what set_scene() moves may be coarse.
    void set_dragging(bool dragging);

    FrameCache& frames() { return *frames_; }
    const Scene& scene() const { return scene_; }
    const Solve& solve() const { return solve_; }

    /// What render writes of this frame. Throws InputError.
    Image8 composited(const PlateFrame& plate);
    /// What is seen from elsewhere, at the time of that frame.
    Image8 seen_from(const CameraView& view, std::int64_t frame);
    /// Of that picture.
    const Camera& free_camera() const { return free_->camera(); }
    /// The scene's probe, as bright as it is in that frame; empty where it has none.
    Image8 probe_seen(ProbeForm form, const PlateFrame& plate);
    /// What a pass of composited() leaves, from the next frame on; "": of none.
    void watch(const std::string& pass);
    std::optional<WatchedTexture> watched() const;
    /// What became of each pass of the frame, timed.
    std::vector<PassReport> passes(const PlateFrame& plate);
    ShaderReload reload_shaders();

private:
    Scene drawn_scene() const;
    void make_compositor();

    GlContext& context_;
    bool quiet_;
    Warnings& warnings_;
    Scene scene_;
    Solve solve_;
    std::unique_ptr<FrameCache> frames_;
    ShotLevel level_;
    bool dragging_ = false;
    std::unique_ptr<Compositor> compositor_;
    std::unique_ptr<FreeShot> free_;
    std::string watched_pass_;
    std::optional<ProbeSettings> read_probe_;  // that probe_ is of
    Probe probe_;
    ShaderLibrary files_;  // no programs of its own: what it knows is when files change
};

}  // namespace matchlight
