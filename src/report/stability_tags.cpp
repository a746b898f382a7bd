// Cases of the tag pose: sizes, tilts, blurs and noise, each a short clip of one tag.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "report/stability_cases.h"
#include "report/tag_pose_trial.h"

namespace matchlight {
namespace {

std::string name_of(const TagPoseTrial& trial) {
    std::string name = fmt::format("{:g} px wide, tilted by {:g}°", trial.side_px, trial.tilt_deg);
    if (trial.defocus_px > 0) name += fmt::format(", defocus {:g} px", trial.defocus_px);
    if (trial.motion_px > 0) name += fmt::format(", motion {:g} px", trial.motion_px);
    if (trial.noise_px > 0) {
        name += fmt::format(", {:g} px of noise on each corner", trial.noise_px);
    } else {
        name += fmt::format(", {:g} codes of noise", trial.noise_codes);
    }
    return name;
}

/// Width of a cell of a tag36h11 (eight between its detection corners) where the tilt narrows it most.
double narrowest_cell_px(const TagPoseTrial& trial) {
    return trial.side_px / 8 * std::cos(trial.tilt_deg * std::numbers::pi / 180);
}

/// Three standard deviations of what noise and the corners' allowance cost; where cells are under two pixels wide no
/// image of them can be told from another and the fit may fall back on the library's corners: there, what IPPE makes
/// of these. And in no case worse than IPPE by more than one such standard deviation.
double largest_error(const TagPoseTrial& trial, const TagPoseErrors& errors) {
    constexpr double resolved_px = 2;
    const double expected = std::hypot(errors.noise_px, errors.allowance_px);
    double most = std::numeric_limits<double>::infinity();
    if (trial.noise_px > 0 || narrowest_cell_px(trial) >= resolved_px) most = 3 * expected;
    if (errors.ippe) most = std::min(most, *errors.ippe + expected);
    return most;
}

/// What is judged of a trial: the error itself, or, where blur or a grazing view leave hardly a tag to find, that no
/// pose claims to be better than it is.
enum class Judged { error, claim };

StabilityOutcome outcome_of(const TagPoseTrial& trial, Judged judged) {
    const TagPoseErrors errors = try_tag_pose(trial);
    StabilityOutcome outcome;
    if (judged == Judged::claim) {
        outcome.value = errors.over_claimed;
    } else {
        outcome.value = errors.ours.value_or(std::numeric_limits<double>::infinity());
        outcome.most = largest_error(trial, errors);
    }
    const auto add = [&](const char* name, const std::optional<double>& value) {
        if (value) outcome.beside.push_back({name, *value});
    };
    if (judged == Judged::claim) add("error", errors.ours);
    add("noise alone", errors.noise_px);
    add("0.02 px a corner", errors.allowance_px);
    add("AprilTag in light", errors.apriltag_light);
    if (trial.noise_px == 0) add("AprilTag in codes", errors.apriltag_codes);
    add("IPPE", errors.ippe);
    add("frames", trial.frames);
    add("posed", errors.found);
    if (trial.noise_px == 0) add("AprilTag posed in codes", errors.found_in_codes);
    add("mirrored", errors.mirrored);
    add("IPPE mirrored", errors.ippe_mirrored);
    if (trial.noise_px == 0) add("px of noise along an edge's normal", errors.edge_noise_px);
    return outcome;
}

}  // namespace

std::vector<StabilityCase> tag_pose_cases(bool quick) {
    struct Listed {
        TagPoseTrial trial;
        bool quick = false;
        Judged judged = Judged::error;
    };
    // Large and blurred tags are slow to draw: fewer frames.
    const Listed listed[] = {
        {{.side_px = 15, .tilt_deg = 30, .noise_codes = 1}, true},
        {{.side_px = 20, .tilt_deg = 45, .noise_codes = 2}},
        {{.side_px = 25, .tilt_deg = 10, .noise_codes = 2}, true},
        {{.side_px = 60, .tilt_deg = 0, .noise_codes = 1}},
        {{.side_px = 60, .tilt_deg = 45, .noise_codes = 8}, true},
        {{.side_px = 60, .tilt_deg = 45, .noise_codes = 30}},
        {{.side_px = 60, .tilt_deg = 80, .noise_codes = 1}},
        {{.side_px = 150, .tilt_deg = 80, .noise_codes = 2}},
        {{.side_px = 250, .tilt_deg = 85, .noise_codes = 2}},
        {{.side_px = 100, .tilt_deg = 30, .defocus_px = 2, .noise_codes = 2, .frames = 4}, true},
        {{.side_px = 100, .tilt_deg = 30, .defocus_px = 5, .noise_codes = 2, .frames = 4}},
        {{.side_px = 200, .tilt_deg = 30, .defocus_px = 10, .noise_codes = 2, .frames = 4}},
        {{.side_px = 600, .tilt_deg = 45, .defocus_px = 20, .noise_codes = 2, .frames = 2}, false, Judged::claim},
        {{.side_px = 200, .tilt_deg = 30, .defocus_px = 20, .noise_codes = 2, .frames = 4}, false, Judged::claim},
        {{.side_px = 100, .tilt_deg = 30, .motion_px = 5, .noise_codes = 2, .frames = 4}, true},
        {{.side_px = 200, .tilt_deg = 30, .motion_px = 10, .noise_codes = 2, .frames = 4}},
        {{.side_px = 200, .tilt_deg = 30, .motion_px = 20, .noise_codes = 2, .frames = 4}},
        {{.side_px = 600, .tilt_deg = 30, .noise_codes = 2, .frames = 3}},
        {{.side_px = 600, .tilt_deg = 70, .noise_codes = 2, .frames = 2}},
        {{.side_px = 600, .tilt_deg = 80, .noise_codes = 2, .frames = 3}, false, Judged::claim},
        {{.side_px = 600, .tilt_deg = 85, .noise_codes = 2, .frames = 3}, false, Judged::claim},
        {{.side_px = 25, .tilt_deg = 85, .noise_codes = 2}, true, Judged::claim},
        {{.side_px = 15, .tilt_deg = 45, .noise_px = 0.3, .frames = 48}, true},
        {{.side_px = 25, .tilt_deg = 10, .noise_px = 0.1, .frames = 48}, true},
        {{.side_px = 25, .tilt_deg = 10, .noise_px = 0.3, .frames = 48}, true},
        {{.side_px = 50, .tilt_deg = 0, .noise_px = 0.3, .frames = 48}, true},
        {{.side_px = 50, .tilt_deg = 80, .noise_px = 0.3, .frames = 48}, true},
        {{.side_px = 100, .tilt_deg = 30, .noise_px = 1, .frames = 48}, true},
        {{.side_px = 100, .tilt_deg = 60, .noise_px = 2, .frames = 48}, true},
        {{.side_px = 200, .tilt_deg = 85, .noise_px = 1, .frames = 48}, true},
        {{.side_px = 600, .tilt_deg = 30, .noise_px = 2, .frames = 48}, true},
    };
    std::vector<StabilityCase> cases;
    for (const Listed& one : listed) {
        if (quick && !one.quick) continue;
        // Errors in two directions stay below three standard deviations of their length in 99.99 % of all draws.
        const bool error = one.judged == Judged::error;
        cases.push_back({"tag pose",
                         name_of(one.trial),
                         error ? "error in px at a point one tag size above it, RMS"
                               : "largest error at a point one tag size above it, over what the pose claims,",
                         {0, error ? std::numeric_limits<double>::infinity() : 3},
                         {},
                         [one] { return outcome_of(one.trial, one.judged); }});
    }
    return cases;
}

}  // namespace matchlight
