// Composites the frame at every level.
#include "report/truth.h"

#include <functional>
#include <memory>
#include <string>

#include "report/change_region.h"
#include "report/flip.h"
#include "report/image_error.h"

namespace matchlight {

std::vector<TruthRow> frame_error_against_truth(const SceneStage& stage, const Image8& truth,
                                                const ExperimentOptions& options, const TimingOptions& timing) {
    const PlateFormat& format = stage.plate->format();
    const Image8 region = change_region(stage.plate->rgb8({0, 0, format.width, format.height}), truth);
    std::vector<TruthRow> rows;
    std::vector<std::function<void()>> works;
    for (const auto& [name, level] : quality_levels) {
        if (options.quick && level == QualityLevel::reference) continue;
        const std::shared_ptr<Compositor> compositor = stage.compositor_with_rays(quality_of(level), false);
        const Image8 picture = compositor->composite(*stage.plate).rgb8();
        rows.push_back({std::string(name), {}, masked_mean(flip_error_map(truth, picture), &region)});
        works.emplace_back([&stage, compositor] { compositor->composite(*stage.plate); });
    }
    const std::vector<RunTime> times = time_in_turn(works, Stopwatch::wall, timing);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].time = times[i];
    return rows;
}

}  // namespace matchlight
