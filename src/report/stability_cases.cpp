// Judges what a case gave.
#include "report/stability_cases.h"

#include <exception>

#include <fmt/format.h>

namespace matchlight {
namespace {

std::string bound_text(const std::string& measure, const Bound& bound) {
    if (bound.least == bound.most) return fmt::format("{} is {:g}", measure, bound.least);
    if (bound.least == 0) return fmt::format("{} at most {:.4g}", measure, bound.most);
    return fmt::format("{} from {:g} to {:g}", measure, bound.least, bound.most);
}

}  // namespace

StabilityRow stability_row(const StabilityCase& tried) {
    StabilityRow row{.effect = tried.effect, .name = tried.name, .bound = bound_text(tried.measure, tried.bound)};
    if (tried.energy) row.bound += "; " + bound_text("energy kept", *tried.energy);
    try {
        const StabilityOutcome outcome = tried.run();
        row.value = outcome.value;
        row.energy_kept = outcome.energy_kept;
        row.beside = outcome.beside;
        Bound bound = tried.bound;
        if (outcome.most) {
            bound.most = *outcome.most;
            row.bound = bound_text(tried.measure, bound);
        }
        row.pass = bound.holds(outcome.value) &&
                   (!tried.energy || (outcome.energy_kept && tried.energy->holds(*outcome.energy_kept)));
    } catch (const std::exception& error) {
        row.value = std::numeric_limits<double>::quiet_NaN();
        row.name += fmt::format(" ({})", error.what());
    }
    return row;
}

std::vector<StabilityCase> stability_cases(bool quick) {
    std::vector<StabilityCase> all = number_cases();
    for (const auto& more :
         {probe_cases(), light_cases(), wave_glare_cases(), defocus_cases(), depth_of_field_cases(),
          motion_blur_cases(), frame_cases(), tag_pose_cases(quick), exposure_cases(), ball_cases(quick),
          surface_picture_cases(), sphere_cases(), near_light_cases(), surface_detail_cases(), lamp_cases()})
        all.insert(all.end(), more.begin(), more.end());
    return all;
}

}  // namespace matchlight
