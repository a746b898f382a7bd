// A scene with its footage and compositor, and what the preview's keys change of it.
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
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// What is drawn of a scene.
struct ShotSwitches {
    bool bloom = false;
    bool glare = false;
    bool dazzle = false;    // as the scene has it; or objects send nothing to bloom and glare
    bool exposure = false;  // simulated exposure control
    bool shadow = false;    // on the surface
    QualityLevel level = QualityLevel::final_;
    bool budget = false;  // the scene's budget_ms chooses levels instead
};

/// The scene's effects where they are switched on; where the scene has none of a kind, with its defaults.
EffectSettings switched_effects(const EffectSettings& of_scene, const ShotSwitches& switches);

class Shot {
public:
    /// Reads the scene and all that belongs to it. `context` and `warnings` must outlive it. `quiet`: no progress of
    /// the meter pass. Throws InputError.
    Shot(GlContext& context, const std::filesystem::path& scene_path, bool quiet, Warnings& warnings);
    Shot(const Shot&) = delete;
    Shot& operator=(const Shot&) = delete;

    /// As the scene file has them.
    ShotSwitches scene_switches() const;
    const ShotSwitches& switches() const { return switches_; }
    /// Shadow, level and exposure (and all of them under a budget) make anew what the clip shares, with the next frame;
    /// the rest costs nothing.
    void set_switches(const ShotSwitches& switches);

    FrameCache& frames() { return frames_; }
    const Scene& scene() const { return scene_; }
    const Solve& solve() const { return solve_; }

    /// What render writes of this frame. Throws InputError.
    Image8 composited(const PlateFrame& plate);
    /// What became of each pass of the frame, timed.
    std::vector<PassReport> passes(const PlateFrame& plate);
    ShaderReload reload_shaders();

private:
    void make_compositor();

    GlContext& context_;
    bool quiet_;
    Warnings& warnings_;
    Scene scene_;
    Solve solve_;
    FrameCache frames_;
    ShotSwitches switches_;
    std::unique_ptr<Compositor> compositor_;
    ShaderLibrary files_;  // no programs of its own: what it knows is when files change
};

}  // namespace matchlight
