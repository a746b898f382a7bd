// The report as JSON and as CSV.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/version.h"
#include "report/csv_text.h"
#include "report/report.h"
#include "report/track_text.h"

namespace matchlight {
namespace {

using nlohmann::ordered_json;

/// JSON has no infinity and no NaN: null.
ordered_json number(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json time_json(const RunTime& time) {
    return {{"ms_median", time.median_ms}, {"ms_min", time.min_ms}, {"ms_max", time.max_ms}};
}

ordered_json point_json(const EffectPoint& point) {
    ordered_json knobs = ordered_json::object();
    for (const Knob& knob : point.knobs) knobs[knob.name] = knob.value;
    ordered_json json{{"level", point.level}, {"knobs", std::move(knobs)}, {"precision", point.precision}};
    json.update(time_json(point.time));
    json["bytes"] = point.bytes;
    json["bandwidth_bounds"] = number(point.bandwidth_bounds);
    json["flip"] = number(point.errors.flip);
    json["hdr_flip"] = number(point.errors.hdr_flip);
    json["psnr_db"] = number(point.errors.psnr_db);
    json["relative_rms"] = number(point.errors.relative_rms);
    if (point.errors.mean_light) json["mean_light"] = number(point.errors.mean_light);
    return json;
}

ordered_json effect_json(const EffectReport& effect) {
    ordered_json json{{"what", effect.what}, {"per", effect.unit == WorkUnit::frame ? "frame" : "clip"}};
    const Region& region = effect.region;
    json["region"] = {{"x", region.x}, {"y", region.y}, {"width", region.width}, {"height", region.height}};
    if (!effect.left_out_of_frame.empty()) json["left_out_of_frame"] = effect.left_out_of_frame;
    json["reference"] = effect.reference;
    json["reference_self_error_flip"] = number(effect.reference_self_error_flip);
    json["points"] = ordered_json::array();
    for (const EffectPoint& point : effect.points) json["points"].push_back(point_json(point));
    if (const auto& left_out = effect.left_out) {
        json["left_out"] = {{"condition", left_out->condition},
                            {"ms_saved", left_out->ms_saved},
                            {"max_code_difference", left_out->max_code_difference}};
        for (const Knob& cost : left_out->cost) json["left_out"]["cost"][cost.name] = number(cost.value);
    } else {
        json["left_out"] = nullptr;
    }
    return json;
}

std::string field(const std::optional<double>& value) {
    return value && std::isfinite(*value) ? fmt::format("{:.9g}", *value) : std::string();
}

}  // namespace

std::vector<bool> pareto_front(const std::vector<EffectPoint>& points) {
    std::vector<bool> front;
    for (const EffectPoint& point : points) {
        const auto beats = [&](const EffectPoint& other) {
            if (!other.errors.flip) return false;
            const double ms = other.time.median_ms - point.time.median_ms;
            const double error = *other.errors.flip - *point.errors.flip;
            return ms <= 0 && error <= 0 && (ms < 0 || error < 0);
        };
        front.push_back(point.errors.flip && std::ranges::none_of(points, beats));
    }
    return front;
}

std::string report_json(const Report& report) {
    const Machine& machine = report.machine;
    ordered_json json{{"matchlight_report", 1}, {"version", version}};
    json["machine"] = {{"renderer", machine.renderer},
                       {"gl_version", machine.gl_version},
                       {"timer", machine.timer_queries ? "timer queries" : "wall clock"},
                       {"cores", machine.cores},
                       {"copy_bytes_per_second", machine.copy_bytes_per_second}};
    if (!report.scene.empty()) {
        json["scene"] = report.scene;
    }
    if (report.track) json["track"] = track_json(*report.track);
    if (!report.sphere_study.empty()) json["sphere_study"] = sphere_study_json(report.sphere_study);
    if (!report.depth_of_field_study.empty()) {
        json["depth_of_field_study"] = depth_of_field_study_json(report.depth_of_field_study);
    } else if (!report.scene.empty() && !report.track) {
        json["frame"] = report.frame;
        json["width"] = report.width;
        json["height"] = report.height;
        json["effects"] = ordered_json::object();
        for (const EffectReport& effect : report.effects) json["effects"][effect.name] = effect_json(effect);
    }
    if (!report.stability.empty()) {
        json["stability"] = ordered_json::array();
        for (const StabilityRow& row : report.stability) {
            ordered_json entry{{"effect", row.effect},
                               {"case", row.name},
                               {"bound", row.bound},
                               {"value", number(row.value)},
                               {"energy_kept", number(row.energy_kept)},
                               {"pass", row.pass}};
            for (const Knob& knob : row.beside) entry["beside"][knob.name] = number(knob.value);
            json["stability"].push_back(std::move(entry));
        }
    }
    if (!report.truth.empty()) {
        json["frame_error_against_truth"] = ordered_json::array();
        for (const TruthRow& row : report.truth) {
            ordered_json entry{{"level", row.level}};
            entry.update(time_json(row.time));
            entry["flip_in"] = number(row.flip_in);
            json["frame_error_against_truth"].push_back(std::move(entry));
        }
    }
    if (!report.budget.empty()) {
        json["budget"] = ordered_json::array();
        for (const BudgetRow& row : report.budget) {
            json["budget"].push_back({{"budget_ms", row.budget_ms},
                                      {"predicted_ms", row.predicted_ms},
                                      {"measured_ms", row.measured_ms},
                                      {"choice", row.choice}});
        }
    }
    if (!report.provenance.empty()) json["provenance"] = report.provenance;
    return json.dump(2) + "\n";
}

std::string report_csv(const Report& report) {
    if (report.track) return track_csv(*report.track);
    if (!report.depth_of_field_study.empty()) return depth_of_field_study_csv(report.depth_of_field_study);
    if (!report.sphere_study.empty()) return sphere_study_csv(report.sphere_study);
    std::string csv =
        "effect,level,knobs,precision,per,ms_median,ms_min,ms_max,bytes,bandwidth_bounds,flip,hdr_flip,psnr_db,"
        "relative_rms,mean_light,reference_self_error_flip,ms_saved,max_code_difference\n";
    for (const EffectReport& effect : report.effects) {
        const char* per = effect.unit == WorkUnit::frame ? "frame" : "clip";
        for (const EffectPoint& point : effect.points) {
            csv +=
                fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},,\n", csv_text(effect.name),
                            csv_text(point.level), csv_text(knobs_text(point.knobs)), point.precision, per,
                            field(point.time.median_ms), field(point.time.min_ms), field(point.time.max_ms),
                            field(point.bytes), field(point.bandwidth_bounds), field(point.errors.flip),
                            field(point.errors.hdr_flip), field(point.errors.psnr_db), field(point.errors.relative_rms),
                            field(point.errors.mean_light), field(effect.reference_self_error_flip));
        }
        if (const auto& left_out = effect.left_out) {
            csv += fmt::format("{},\"left out\",{},,{},,,,,,,,,,,,{},{}\n", csv_text(effect.name),
                               csv_text(left_out->condition), per, field(left_out->ms_saved),
                               left_out->max_code_difference);
        }
    }
    return csv;
}

}  // namespace matchlight
