// What a scene's settings are now: as its file has them, and with all that it leaves unsaid.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "preview/scene_history.h"

namespace matchlight {

/// Keys as SceneText has them: "object[1].material.roughness".
class SceneValues {
public:
    SceneValues();
    /// `scene` is what was read of `text`.
    SceneValues(const SceneText& text, const Scene& scene);
    ~SceneValues();
    SceneValues(SceneValues&& other) noexcept;
    SceneValues& operator=(SceneValues&& other) noexcept;

    // With defaults. Nullopt: unset, or of another kind.
    std::optional<bool> flag(const std::string& key) const;
    std::optional<double> number(const std::string& key) const;
    std::optional<std::string> word(const std::string& key) const;
    /// A list of numbers, or one number alone.
    std::vector<double> numbers(const std::string& key) const;

    /// What the file itself says there, on one line; empty where it says nothing.
    std::string written(const std::string& key) const;
    bool is_written(const std::string& key) const { return !written(key).empty(); }
    /// Whether the file has a table there.
    bool is_table(const std::string& key) const;

private:
    struct Tables;
    std::unique_ptr<const Tables> tables_;
};

}  // namespace matchlight
