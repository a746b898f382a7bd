// What the tags should send to the camera, against what arrived.
#include "tracking/photometry_stage.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "lighting/probe.h"
#include "tracking/noise_fit.h"
#include "tracking/photometry.h"
#include "tracking/probe_card.h"
#include "tracking/response_fit.h"

namespace matchlight {

namespace {

double paper_over_ink(const TagSettings& tags) {
    constexpr double least_black = 0.005;  // of any print
    return tags.white_albedo / std::max(tags.black_albedo, least_black);
}

std::string described(const Response& response) {
    return response.to_json().dump();
}

/// Footage whose curve is only assumed gets a warning when its tags clearly contradict it.
void check_assumed_response(const ClipContext& context, const ClipObservations& clip, PhotometrySummary& summary) {
    const FootageSettings& footage = context.scene.footage;
    const bool is_known = footage.response || !footage.ocio_space.empty();
    if (is_known || footage.solve_response || context.footage.format.transfer != Transfer::camera) return;
    const ResponseFit fit = fit_response(clip.cards, paper_over_ink(context.scene.tags));
    summary.exposure_range_ev = fit.exposure_range_ev;
    if (fit.response.family() == Response::Family::srgb) return;
    context.warn("paper and ink do not keep their ratio under sRGB when exposure changes, but do under " +
                 described(fit.response) + ": give the camera's response, or response = \"solve\"");
}

void take_noise(const ClipContext& context, const ClipObservations& clip, Solve& solve, PhotometrySummary& summary) {
    const std::optional<NoiseFit> noise =
        fit_noise(clip.cards, PlateLight(context.response, context.footage.format.transfer));
    if (!noise) {
        context.warn("the tags show too few even pixels, or only one level of light: noise is not known");
        return;
    }
    solve.noise = {noise->read, noise->shot};
    solve.noise_neighbour_correlation = noise->neighbour_correlation;
    summary.noise_neighbour_correlation = noise->neighbour_correlation;
    summary.noise_relative_error = noise->relative_error;
}

}  // namespace

std::map<int, CardExpectation> card_expectations(const ClipContext& context, const RigSolution& rig) {
    const TagSettings& tags = context.scene.tags;
    const TagFamily family(tags.family);
    const std::optional<Eigen::Vector3d> probe_place_m =
        context.scene.probe ? context.scene.probe->place_m : std::nullopt;
    std::map<int, CardExpectation> expected;
    for (const RigTag& tag : tags.rig) {
        const auto found = rig.world_from_tag.find(tag.id);
        if (found == rig.world_from_tag.end()) continue;
        const RigidTransform& place = found->second;
        CardExpectation& card = expected[tag.id];
        card.place_m = place.translation() - probe_place_m.value_or(Eigen::Vector3d::Zero());
        if (!context.probe) continue;
        const Eigen::Vector3d light = irradiance(*context.probe, place.linear() * Eigen::Vector3d::UnitZ());
        for (std::size_t c = 0; c < 3; ++c) {
            const double reflected = light[static_cast<Eigen::Index>(c)] / std::numbers::pi;
            card.difference[c] = (tags.white_albedo - tags.black_albedo) * reflected;
            card.ink[c] = tags.black_albedo * reflected;
        }
        if (!probe_place_m) continue;
        constexpr double near_m = 0.05;  // closer than this, the probe's own size blurs the difference
        card.weight = 1 / (card.place_m.squaredNorm() + near_m * near_m);
        card.shown_difference =
            card_in_probe(*context.probe, *probe_place_m, family.pattern(tag.id), {tag.size_m, place});
        // A measured tag is good to a percent or two, an assumed albedo and a light assumed even to five or more: ten
        // times the variance.
        if (card.shown_difference) card.weight *= 10;
    }
    return expected;
}

Response solved_response(const Scene& scene, const std::vector<std::vector<CardReading>>& cards, Warnings& warnings,
                         PhotometrySummary& summary) {
    const ResponseFit fit = fit_response(cards, paper_over_ink(scene.tags));
    summary.exposure_range_ev = fit.exposure_range_ev;
    summary.response_solved = fit.told;
    if (!fit.told) {
        warnings.add(
            fmt::format("{}: exposure changes by {:.2f} EV on unclipped tags, too little to tell the camera's "
                        "response: sRGB is taken",
                        scene.footage.video.string(), fit.exposure_range_ev));
    }
    return fit.response;
}

void solve_photometry_stage(const ClipContext& context, const ClipObservations& clip, const GeometrySolution& geometry,
                            Solve& solve, TrackSummary& summary) {
    const auto expected = card_expectations(context, geometry.rig);
    const ClipPhotometry photometry = solve_photometry(clip.cards, expected, !context.probe);
    summary.exposure_from_probe = context.probe.has_value();
    PhotometrySummary& told = summary.photometry;
    for (const auto& [id, card] : expected) told.tags_in_probe += card.shown_difference.has_value();
    for (std::size_t f = 0; f < solve.frames.size(); ++f) {
        const std::optional<FramePhotometry>& frame = photometry.frames[f];
        if (!frame) continue;
        ++(frame->measured ? told.measured : told.interpolated);
        solve.frames[f].exposure_ev = frame->exposure_ev;
        solve.frames[f].white_balance = frame->white_balance;
        solve.frames[f].exposure_confidence = frame->confidence;
    }
    solve.light_gradient_ev_per_m = photometry.light_gradient_ev_per_m;
    if (photometry.vignette) {
        solve.vignette = photometry.vignette->gain;
        told.vignette_corner_sigma = photometry.vignette->corner_sigma;
    }
    if (told.measured == 0) {
        context.warn("no tag is large and unclipped enough to serve as a grey card: exposure is not known");
        return;
    }
    context.warn("frames have no readable tag: their exposure is taken from the frames around them", told.interpolated);
    if (!photometry.white_balance_known) {
        context.warn("red or blue is clipped on the tags in every frame: white balance is not known");
    }
    check_assumed_response(context, clip, told);
    take_noise(context, clip, solve, told);
}

}  // namespace matchlight
