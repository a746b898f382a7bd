// Composites the frame under each budget.
#include "report/budgets.h"

#include <functional>
#include <memory>
#include <optional>

#include <fmt/format.h>

namespace matchlight {

std::vector<BudgetRow> budgets_predicted_and_measured(const SceneStage& stage, const TimingOptions& timing) {
    const auto path = level_table_path();
    std::optional<LevelTable> table;
    if (path) {
        const GlInfo& info = stage.context.info();
        table = load_level_table(*path, info.renderer, info.version, stage.warnings);
    }
    if (!table) return {};
    const auto frame_of = [&stage](const std::shared_ptr<Compositor>& compositor) {
        return [&stage, compositor] { compositor->composite(*stage.plate); };
    };
    const std::vector<std::function<void()>> at_final{
        frame_of(stage.compositor(quality_of(QualityLevel::final_), false))};
    const double final_ms = time_in_turn(at_final, Stopwatch::wall, timing).front().median_ms;
    std::vector<double> budgets{final_ms / 2, final_ms, final_ms * 2};
    if (stage.scene.budget_ms) budgets.insert(budgets.begin(), *stage.scene.budget_ms);

    Warnings unheard;  // that a budget is too small is what the table shows
    unheard.set_quiet(true);
    std::vector<BudgetRow> rows;
    std::vector<std::function<void()>> works;
    for (const double budget_ms : budgets) {
        const auto compositor =
            std::make_shared<Compositor>(stage.context, stage.scene, stage.solve,
                                         CompositorOptions{.budget = FrameBudget{budget_ms, *table}}, unheard);
        const std::optional<LevelChoice>& choice = compositor->level_choice();
        if (!choice) continue;
        BudgetRow row{.budget_ms = budget_ms, .predicted_ms = choice->predicted_ms, .measured_ms = 0, .choice = {}};
        for (const auto& [effect, level] : choice->levels) {
            if (level == any_level) continue;
            row.choice += fmt::format("{}{} {}", row.choice.empty() ? "" : ", ", effect, level);
        }
        rows.push_back(row);
        works.push_back(frame_of(compositor));
    }
    const std::vector<RunTime> times = time_in_turn(works, Stopwatch::wall, timing);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].measured_ms = times[i].median_ms;
    return rows;
}

}  // namespace matchlight
