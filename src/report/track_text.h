// Tracking in the report's files.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "report/track_report.h"

namespace matchlight {

nlohmann::ordered_json track_json(const TrackReport& track);
/// One line a way, with a header.
std::string track_csv(const TrackReport& track);
/// For a terminal.
std::string track_lines(const TrackReport& track);
/// A section of the page: plots of error against run time and over the clip, and the table.
std::string track_html(const TrackReport& track);

}  // namespace matchlight
