// What a report says: error against run time of every effect, stability, and the machine it was measured on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "report/depth_of_field_study.h"
#include "report/knob.h"
#include "report/measured_time.h"
#include "report/sphere_study.h"
#include "report/track_report.h"

namespace matchlight {

/// Of one picture of light against the reference; absent where the measure has no value (a black reference).
struct PointErrors {
    std::optional<double> flip;  // mean over the effect's region
    std::optional<double> hdr_flip;
    std::optional<double> psnr_db;
    std::optional<double> relative_rms;  // of linear light
    // Of the light that an effect spreads and must keep: mean over the reference's, less 1.
    std::optional<double> mean_light = {};
};

/// One way to compute an effect.
struct EffectPoint {
    std::string level;  // "final", "pyramid"; the point's label
    std::vector<Knob> knobs;
    std::string precision;  // "16F" or "32F": of what is kept between passes
    RunTime time = {};
    double bytes = 0;                             // moved, where known
    std::optional<double> bandwidth_bounds = {};  // time as a multiple of moving these bytes once
    PointErrors errors = {};
    Image8 picture = {}, flip_map = {};  // for the page
};

/// What skipping an effect is worth where it is the identity by its definition.
struct LeftOutRow {
    std::string condition;  // "no light above the threshold"
    double ms_saved = 0;
    int max_code_difference = 0;  // of 255, between the frame with it drawn and with it left out
    std::vector<Knob> cost = {};  // what the condition costs where the effect is not quite the identity
};

/// How often an effect's work is done.
enum class WorkUnit { frame, clip };

struct EffectReport {
    std::string name;  // key in report.json
    std::string what;  // one line of what is measured
    WorkUnit unit = WorkUnit::frame;
    Region region;                                    // of the frame, pixels; what the errors are taken over
    std::string left_out_of_frame;                    // why this frame does not need it; empty where it does
    std::string reference;                            // what the reference is
    std::optional<double> reference_self_error_flip;  // half the effort against the reference's
    std::vector<EffectPoint> points;
    std::optional<LeftOutRow> left_out;
    Image8 reference_picture;
};

/// A stiff or extreme case.
struct StabilityRow {
    std::string effect;
    std::string name;
    std::string bound;                       // in words: "finite, at most 65504"
    double value = 0;                        // what came out, compared with the bound
    std::optional<double> energy_kept = {};  // out over in, where light is spread
    bool pass = false;
    std::vector<Knob> beside = {};  // what else came out: "IPPE 0.3"
};

/// The whole frame at one quality level, against how the scene really looked.
struct TruthRow {
    std::string level;
    RunTime time;
    std::optional<double> flip_in;  // mean over the region that the objects change
};

/// What the budget chose, and what came of it.
struct BudgetRow {
    double budget_ms = 0;
    double predicted_ms = 0, measured_ms = 0;
    std::string choice;  // "antialiasing 2, contact_shadow final"
};

struct Machine {
    std::string renderer, gl_version;
    bool timer_queries = false;  // else wall clock between two glFinish
    unsigned cores = 0;
    double copy_bytes_per_second = 0;
};

struct Report {
    std::string scene;  // file name; empty where there is none
    std::int64_t frame = 0;
    int width = 0, height = 0;
    Machine machine;
    std::string provenance;  // effective settings
    std::vector<EffectReport> effects;
    std::vector<StabilityRow> stability;
    std::vector<TruthRow> truth;
    std::vector<BudgetRow> budget;
    std::optional<TrackReport> track;
    DepthOfFieldStudy depth_of_field_study;
    SphereStudy sphere_study;
};

/// For each point whether no other is both quicker and nearer to the reference (FLIP).
std::vector<bool> pareto_front(const std::vector<EffectPoint>& points);

// The three files of a report.
std::string report_json(const Report& report);
std::string report_csv(const Report& report);
std::string report_html(const Report& report);

}  // namespace matchlight
