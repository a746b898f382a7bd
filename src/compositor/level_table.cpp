// Tries every combination of levels; reads and writes the table.
#include "compositor/level_table.h"

#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/user_folder.h"

namespace matchlight {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int format_version = 1;

/// A number that a cost can be: finite and not below 0. Throws json's own errors, and InputError for others.
double cost_of(const json& entry, const char* key) {
    const double value = entry.at(key).get<double>();
    if (std::isfinite(value) && value >= 0) return value;
    throw std::runtime_error(fmt::format("{} is {}", key, value));
}

LevelTable table_of(const json& entry) {
    LevelTable table{entry.at("renderer").get<std::string>(), entry.at("gl_version").get<std::string>(), {}};
    for (const auto& [effect, levels] : entry.at("effects").items()) {
        for (const json& level : levels) {
            table.effects[effect].push_back({level.at("level").get<std::string>(), cost_of(level, "fixed_ms"),
                                             cost_of(level, "ms_per_megapixel"), cost_of(level, "flip")});
        }
    }
    return table;
}

json json_of(const LevelTable& table) {
    json entry{{"renderer", table.renderer}, {"gl_version", table.gl_version}, {"effects", json::object()}};
    for (const auto& [effect, levels] : table.effects) {
        json& list = entry["effects"][effect] = json::array();
        for (const LevelCost& cost : levels) {
            list.push_back({{"level", cost.level},
                            {"fixed_ms", cost.fixed_ms},
                            {"ms_per_megapixel", cost.ms_per_megapixel},
                            {"flip", cost.flip}});
        }
    }
    return entry;
}

std::vector<LevelTable> load_all(const fs::path& path, Warnings& warnings) {
    std::error_code error;
    if (!fs::exists(path, error)) return {};
    try {
        constexpr std::size_t most_bytes = 1u << 20;
        const json file = json::parse(read_text_file(path, most_bytes));
        if (file.at("matchlight_levels") != format_version) throw std::runtime_error("is of another version");
        std::vector<LevelTable> tables;
        for (const json& entry : file.at("machines")) tables.push_back(table_of(entry));
        return tables;
    } catch (const std::exception& what) {
        warnings.add(fmt::format("{}: is no table of levels ({}): run: matchlight report --calibrate-machine",
                                 path.string(), printable(what.what())));
        return {};
    }
}

}  // namespace

LevelChoice choose_levels(const LevelTable& table, std::span<const EffectLoad> loads, double budget_ms) {
    struct Part {
        std::string effect;
        const std::vector<LevelCost>* levels = nullptr;
        double megapixels = 0;
    };
    std::vector<Part> parts;
    for (const EffectLoad& load : loads) {
        const auto found = table.effects.find(load.effect);
        if (found != table.effects.end() && !found->second.empty()) {
            parts.push_back({load.effect, &found->second, load.megapixels});
        }
    }
    // A few effects of a few levels: every combination is tried.
    std::vector<std::size_t> picked(parts.size(), 0);
    LevelChoice best;
    bool any = false;
    while (true) {
        LevelChoice choice;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const LevelCost& cost = (*parts[i].levels)[picked[i]];
            choice.levels[parts[i].effect] = cost.level;
            choice.predicted_ms += cost.ms(parts[i].megapixels);
            choice.predicted_flip += cost.flip;
        }
        choice.within_budget = choice.predicted_ms <= budget_ms;
        const auto is_better = [&] {
            if (choice.within_budget != best.within_budget) return choice.within_budget;
            const bool same_error = choice.predicted_flip == best.predicted_flip;
            if (!choice.within_budget || same_error) return choice.predicted_ms < best.predicted_ms;
            return choice.predicted_flip < best.predicted_flip;
        };
        if (!any || is_better()) best = std::move(choice);
        any = true;
        std::size_t place = 0;
        while (place < parts.size() && ++picked[place] == parts[place].levels->size()) picked[place++] = 0;
        if (place == parts.size()) return best;
    }
}

std::optional<fs::path> level_table_path() {
    const auto caches = user_folder("XDG_CACHE_HOME", ".cache");
    return caches ? std::optional(*caches / "matchlight" / "levels.json") : std::nullopt;
}

std::optional<LevelTable> load_level_table(const fs::path& path, const std::string& renderer,
                                           const std::string& gl_version, Warnings& warnings) {
    for (LevelTable& table : load_all(path, warnings)) {
        if (table.renderer == renderer && table.gl_version == gl_version) return std::move(table);
    }
    return std::nullopt;
}

void save_level_table(const fs::path& path, const LevelTable& table, Warnings& warnings) {
    json machines = json::array();
    for (const LevelTable& other : load_all(path, warnings)) {
        if (other.renderer != table.renderer || other.gl_version != table.gl_version)
            machines.push_back(json_of(other));
    }
    machines.push_back(json_of(table));
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) throw InputError(path, "its folder cannot be made: " + error.message());
    check_output(path, true);
    write_text_file(path, json{{"matchlight_levels", format_version}, {"machines", machines}}.dump(2) + "\n");
}

}  // namespace matchlight
