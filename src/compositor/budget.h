// A time for each frame instead of a level: every effect gets the level that this machine's table makes best.
#pragma once

#include <optional>
#include <vector>

#include "compositor/level_table.h"
#include "compositor/quality.h"
#include "core/image.h"
#include "gl/context.h"
#include "scene/scene_file.h"

namespace matchlight {

struct FrameBudget {
    double ms = 0;
    LevelTable table;
};

/// The scene's budget with the table of this machine. Nullopt where the scene has none, or, with a warning that names
/// the command that makes it, where there is no table.
std::optional<FrameBudget> budget_of_scene(const Scene& scene, GlContext& context, Warnings& warnings);

/// How much of a frame has work.
struct FrameExtent {
    double object_megapixels = 0;  // of the box around all objects
    double reach_megapixels = 0;   // of the tiles that objects and their shadows touch
    Region light;                  // around those tiles
    int frame_width = 0, frame_height = 0;
};

// Names of what the table has besides the effects' own.
inline constexpr const char* frame_part = "frame";      // all that no level changes, by the pixels reached
inline constexpr const char* surface_part = "surface";  // drawing the objects, by the pixels of their box
inline constexpr const char* any_level = "any";         // of what no level changes
inline constexpr const char* bloom_part = "bloom";      // by the pixels that it spreads over
inline constexpr const char* streaks_part = "streaks";  // the same

/// What a frame asks of each part that the scene has.
std::vector<EffectLoad> loads_of(const EffectSettings& effects, const FrameExtent& extent);

/// `quality` with the chosen levels in place of its own.
Quality with_levels(Quality quality, const LevelChoice& choice);

}  // namespace matchlight
