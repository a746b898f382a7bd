// From what a frame shows to what its effects cost.
#include "compositor/budget.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/effects/streaks_model.h"

namespace matchlight {
namespace {

constexpr double pixels_a_megapixel = 1e6;

/// Megapixels of the frame that light from its lit part reaches.
double reached_megapixels(const FrameExtent& extent, double reach_px) {
    const Region frame{0, 0, extent.frame_width, extent.frame_height};
    // Beyond the frame's own size more reach is the same.
    const int grown = static_cast<int>(std::ceil(std::min(reach_px, 2.0 * std::max(frame.width, frame.height))));
    const Region reached = extent.light.grown(grown).intersected(frame);
    return static_cast<double>(reached.width) * reached.height / pixels_a_megapixel;
}

const std::string* level_of(const LevelChoice& choice, const char* part) {
    const auto found = choice.levels.find(part);
    return found == choice.levels.end() ? nullptr : &found->second;
}

std::optional<QualityLevel> level_named(const std::string* name) {
    if (name == nullptr) return std::nullopt;
    const auto found =
        std::ranges::find(quality_levels, std::string_view(*name), &std::pair<std::string_view, QualityLevel>::first);
    if (found == quality_levels.end()) return std::nullopt;
    return found->second;
}

}  // namespace

std::optional<FrameBudget> budget_of_scene(const Scene& scene, GlContext& context, Warnings& warnings) {
    if (!scene.budget_ms) return std::nullopt;
    const auto path = level_table_path();
    std::optional<LevelTable> table;
    if (path) table = load_level_table(*path, context.info().renderer, context.info().version, warnings);
    if (!table) {
        warnings.add(
            fmt::format("{}: budget_ms needs a table of this machine, and level final is used without: run: "
                        "matchlight report --calibrate-machine",
                        scene.path.string()));
        return std::nullopt;
    }
    return FrameBudget{*scene.budget_ms, std::move(*table)};
}

std::vector<EffectLoad> loads_of(const EffectSettings& effects, const FrameExtent& extent) {
    std::vector<EffectLoad> loads{{frame_part, extent.reach_megapixels}, {surface_part, extent.object_megapixels}};
    // The table is of the pyramid; the other levels of bloom are asked for by name, and stay.
    if (effects.bloom && effects.bloom->level == BloomLevel::pyramid && !extent.light.empty()) {
        constexpr double cut_sigmas = 3;
        loads.push_back(
            {bloom_part, reached_megapixels(extent, cut_sigmas * effects.bloom->radius * extent.frame_height)});
    }
    // So with streaks; one row of the table stands for any number of directions.
    if (effects.glare && effects.glare->level == GlareLevel::streaks && !extent.light.empty()) {
        const double length_px = streak_shape(*effects.glare, extent.frame_height).length_px;
        loads.push_back({streaks_part, reached_megapixels(extent, length_px)});
    }
    return loads;
}

Quality with_levels(Quality quality, const LevelChoice& choice) {
    if (const auto level = level_named(level_of(choice, surface_part))) {
        quality.supersampling = quality_of(*level).supersampling;
        quality.samples = quality_of(*level).samples;
    }
    if (const auto level = level_named(level_of(choice, bloom_part))) quality.bloom = *level;
    if (const auto level = level_named(level_of(choice, streaks_part))) quality.glare = *level;
    return quality;
}

}  // namespace matchlight
