// The study's table of depth of field: what a frame costs with it and without, by picture size and method.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "report/measured_time.h"

namespace matchlight {

/// One method at one size, timed in turn with the same frame without it.
struct DepthOfFieldStudyRow {
    int width = 0, height = 0;
    std::string level;
    double widest_coc_px = 0;  // of the frame's objects
    RunTime without, with;     // a whole frame: drawn, composited, read back
    double cost_ms = 0;        // median of the differences within each pair
};

using DepthOfFieldStudy = std::vector<DepthOfFieldStudyRow>;

nlohmann::ordered_json depth_of_field_study_json(const DepthOfFieldStudy& study);
/// One line a method and size, with a header.
std::string depth_of_field_study_csv(const DepthOfFieldStudy& study);
/// For a terminal.
std::string depth_of_field_study_lines(const DepthOfFieldStudy& study);
/// A section of the page.
std::string depth_of_field_study_html(const DepthOfFieldStudy& study);

}  // namespace matchlight
