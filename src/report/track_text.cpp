// Tracking as JSON, CSV and lines: one list of columns for all.
#include "report/track_text.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace matchlight {
namespace {

using nlohmann::ordered_json;

struct Column {
    const char* key;
    std::optional<double> value;
};

std::vector<Column> columns_of(const TrackPoint& point) {
    const TrackErrors none;
    const TrackErrors& errors = point.errors ? *point.errors : none;
    const auto known = [&](double value) { return point.errors ? std::optional(value) : std::nullopt; };
    return {{"mean_px", known(errors.mean_px)},
            {"median_px", known(errors.median_px)},
            {"p95_px", known(errors.p95_px)},
            {"max_px", known(errors.max_px)},
            {"slow_mean_px", errors.slow_mean_px},
            {"fast_mean_px", errors.fast_mean_px},
            {"jitter_px", errors.jitter_px},
            {"lost", known(static_cast<double>(errors.lost))},
            {"nees_median", errors.nees_median},
            {"ev_mean", errors.ev_mean},
            {"ev_spread", errors.ev_spread},
            {"white_balance", errors.white_balance},
            {"focus", errors.focus},
            {"coc_scale", errors.coc_scale},
            {"shutter", errors.shutter},
            {"reprojection_px", point.agreement.reprojection_px},
            {"leave_one_out_px", point.agreement.leave_one_out_px},
            {"leave_one_out_median_px", point.agreement.leave_one_out_median_px},
            {"leave_one_out_jitter_px", point.agreement.leave_one_out_jitter_px}};
}

bool is_number(const std::optional<double>& value) {
    return value && std::isfinite(*value);
}

}  // namespace

ordered_json track_json(const TrackReport& track) {
    ordered_json json{{"frames", track.frames}, {"against_truth", track.against_truth}};
    json["points"] = ordered_json::array();
    for (const TrackPoint& point : track.points) {
        ordered_json entry{
            {"name", point.name},          {"what", point.what},          {"ms_median", point.time.median_ms},
            {"ms_min", point.time.min_ms}, {"ms_max", point.time.max_ms}, {"posed", point.posed}};
        for (const Column& column : columns_of(point)) {
            if (is_number(column.value)) entry[column.key] = *column.value;
        }
        json["points"].push_back(std::move(entry));
    }
    return json;
}

std::string track_csv(const TrackReport& track) {
    std::string csv = "name,frames,posed,ms_median,ms_min,ms_max";
    for (const Column& column : columns_of({})) csv += fmt::format(",{}", column.key);
    csv += "\n";
    for (const TrackPoint& point : track.points) {
        csv += fmt::format("\"{}\",{},{},{:.9g},{:.9g},{:.9g}", point.name, track.frames, point.posed,
                           point.time.median_ms, point.time.min_ms, point.time.max_ms);
        for (const Column& column : columns_of(point)) {
            csv += is_number(column.value) ? fmt::format(",{:.9g}", *column.value) : ",";
        }
        csv += "\n";
    }
    return csv;
}

std::string track_lines(const TrackReport& track) {
    std::string text;
    for (const TrackPoint& point : track.points) {
        text += fmt::format("{:<22}{:>8.1f} frames/s  {} of {} posed", point.name,
                            1e3 * static_cast<double>(track.frames) / point.time.median_ms, point.posed, track.frames);
        const auto add = [&](const char* words, const std::optional<double>& value) {
            if (is_number(value)) text += fmt::format("  {} {:.3g}", words, *value);
        };
        if (point.errors) {
            add("mean px", point.errors->mean_px);
            add("p95", point.errors->p95_px);
            add("max", point.errors->max_px);
            add("jitter", point.errors->jitter_px);
            add("NEES/6", point.errors->nees_median);
            add("EV", point.errors->ev_mean);
            add("±", point.errors->ev_spread);
        }
        add("reprojection px", point.agreement.reprojection_px);
        add("one tag left out px", point.agreement.leave_one_out_px);
        add("median", point.agreement.leave_one_out_median_px);
        add("its jitter", point.agreement.leave_one_out_jitter_px);
        text += "\n";
    }
    return text;
}

}  // namespace matchlight
