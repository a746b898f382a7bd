// The same frame with and without, in turn.
#include "report/depth_of_field_timing.h"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <vector>

#include "compositor/focus.h"
#include "compositor/lens_map.h"
#include "compositor/quality.h"
#include "core/elapsed.h"
#include "core/error.h"
#include "core/stop.h"
#include "report/scene_stage.h"
#include "scene/scene_schema.h"

namespace matchlight {
namespace {

const std::vector<std::string_view>& levels() {
    return find_setting("effects.depth_of_field", "level")->domain.choices;
}

Scene of_size(const Scene& scene, int width, int height) {
    Scene changed = scene;
    CameraSettings& camera = *changed.camera;
    if (camera.lens) {
        const double aspect_before = static_cast<double>(camera.width) / camera.height;
        camera.lens->sensor_width_mm *= static_cast<double>(width) / height / aspect_before;
    }
    camera.width = width;
    camera.height = height;
    return changed;
}

double frame_ms(Compositor& compositor, const EffectSettings& effects, const PlateFrame& plate) {
    compositor.set_effects(effects);
    const auto start = std::chrono::steady_clock::now();
    compositor.composite(plate);  // ends with reading the picture back
    return milliseconds_since(start);
}

DepthOfFieldStudyRow paired(Compositor& compositor, const EffectSettings& without, const EffectSettings& with,
                            const PlateFrame& plate, const TimingOptions& timing) {
    constexpr std::size_t enough = 3;
    std::vector<double> plain_ms, blurred_ms, differences_ms;
    frame_ms(compositor, without, plate);  // programs compile
    frame_ms(compositor, with, plate);
    double spent_ms = 0;
    for (int repeat = 0; repeat < timing.repeats; ++repeat) {
        if (stop_requested()) throw InputError("", "stopped by a signal");
        if (blurred_ms.size() >= enough && spent_ms > timing.most_seconds * 1e3) break;
        plain_ms.push_back(frame_ms(compositor, without, plate));
        blurred_ms.push_back(frame_ms(compositor, with, plate));
        differences_ms.push_back(blurred_ms.back() - plain_ms.back());
        spent_ms += blurred_ms.back();
    }
    DepthOfFieldStudyRow row;
    row.without = run_time_of(plain_ms);
    row.with = run_time_of(blurred_ms);
    row.cost_ms = run_time_of(differences_ms).median_ms;
    return row;
}

/// Of the objects' boxes at the frame.
double widest_coc_px(const SceneStage& stage, Compositor& compositor, const DepthOfFieldSettings& settings) {
    const SolvedFrame& frame = stage.solved();
    const Focus focus = focus_of_frame(settings, stage.solve, frame, {}, stage.warnings);
    const FrameView view{*frame.camera_from_world, make_lens_map(stage.solve.camera).normalized_bounds,
                         stage.solve.camera.fx};
    CocRange range;
    for (std::size_t i = 0; i < compositor.surfaces().object_count(); ++i) {
        range.extend(coc_range_of_box(focus, compositor.surfaces().object_bounds_m(i), view));
    }
    return range.widest_px();
}

}  // namespace

std::size_t depth_of_field_study_steps() {
    return depth_of_field_study_sizes.size() * levels().size();
}

DepthOfFieldStudy measure_depth_of_field_study(GlContext& context, const Scene& scene,
                                               const DepthOfFieldTimingOptions& options, Warnings& warnings) {
    if (!scene.camera) {
        throw InputError(scene.path, "has footage, whose size cannot be changed", "give a scene with a [camera]");
    }
    if (!scene.effects.depth_of_field) {
        throw InputError(scene.path, "has no depth of field to study", "give [effects] depth_of_field = \"auto\"");
    }
    if (!scene.background.image.empty()) {
        throw InputError(scene.path, "has a background picture, whose size cannot be changed",
                         "give [background] probe = true or a color");
    }
    DepthOfFieldStudy study;
    for (const auto& [width, height] : depth_of_field_study_sizes) {
        const SceneStage stage(context, of_size(scene, width, height), options.frame, warnings);
        const std::unique_ptr<Compositor> compositor = stage.compositor(quality_of(scene.quality), false);
        EffectSettings without = scene.effects;
        without.depth_of_field.reset();
        for (std::size_t i = 0; i < levels().size(); ++i) {
            EffectSettings with = scene.effects;
            with.depth_of_field->level = static_cast<DepthOfFieldLevel>(i);
            DepthOfFieldStudyRow row = paired(*compositor, without, with, *stage.plate, options.timing);
            row.width = width;
            row.height = height;
            row.level = std::string(levels()[i]);
            row.widest_coc_px = widest_coc_px(stage, *compositor, *with.depth_of_field);
            study.push_back(std::move(row));
            if (options.advance) options.advance();
        }
    }
    return study;
}

}  // namespace matchlight
