// Measures the study's table of depth of field.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "core/warnings.h"
#include "gl/context.h"
#include "report/depth_of_field_study.h"
#include "report/run_time.h"
#include "scene/scene_file.h"

namespace matchlight {

/// Width and height of the study's pictures.
inline constexpr std::array<std::pair<int, int>, 3> depth_of_field_study_sizes{{{512, 512}, {1024, 512}, {1024, 1024}}};

struct DepthOfFieldTimingOptions {
    std::optional<std::int64_t> frame;  // the first unless given
    TimingOptions timing;
    std::function<void()> advance;  // after each row; may be empty
};

std::size_t depth_of_field_study_steps();

/// A frame of the scene at each size by each method, at the scene's quality. The camera keeps its vertical angle and
/// the height of its sensor, so that a wider picture shows more and blurs alike. Throws InputError where the scene has
/// no camera of its own or no depth of field, or a background picture, which has one size.
DepthOfFieldStudy measure_depth_of_field_study(GlContext& context, const Scene& scene,
                                               const DepthOfFieldTimingOptions& options, Warnings& warnings);

}  // namespace matchlight
