// What each level of each effect costs on this machine and how far it is from its reference: measured once by
// `matchlight report --calibrate-machine`, kept in the user's cache folder.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/warnings.h"

namespace matchlight {

/// Milliseconds of a level are fixed_ms + ms_per_megapixel · megapixels of the region that the effect works on.
struct LevelCost {
    std::string level;  // "draft", "preview", "final", "reference"
    double fixed_ms = 0, ms_per_megapixel = 0;
    double flip = 0;  // against the effect's reference, over that region

    double ms(double megapixels) const { return fixed_ms + ms_per_megapixel * megapixels; }
};

struct LevelTable {
    std::string renderer, gl_version;                       // whose it is
    std::map<std::string, std::vector<LevelCost>> effects;  // by name: "surface", "bloom", …
};

/// What a clip asks of an effect.
struct EffectLoad {
    std::string effect;
    double megapixels = 0;
};

struct LevelChoice {
    std::map<std::string, std::string> levels;  // of each load whose effect the table has
    double predicted_ms = 0;
    double predicted_flip = 0;   // Σ over the effects
    bool within_budget = false;  // false: the quickest there is, which is too slow
};

/// The levels whose errors add up to the least within the budget; of equals the quicker. Where none fits, the quickest.
LevelChoice choose_levels(const LevelTable& table, std::span<const EffectLoad> loads, double budget_ms);

/// $XDG_CACHE_HOME/matchlight/levels.json, else ~/.cache/…; nullopt where neither is known.
std::optional<std::filesystem::path> level_table_path();

/// The table of this renderer and version. Nullopt where there is none; a file that cannot be understood is warned of.
std::optional<LevelTable> load_level_table(const std::filesystem::path& path, const std::string& renderer,
                                           const std::string& gl_version, Warnings& warnings);

/// Puts the table in the place of the one of the same renderer and version, and keeps the others. Makes the folder.
/// Throws InputError where it cannot be written.
void save_level_table(const std::filesystem::path& path, const LevelTable& table, Warnings& warnings);

}  // namespace matchlight
