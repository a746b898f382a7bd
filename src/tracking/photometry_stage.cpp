// What the tags should send to the camera, against what arrived.
#include "tracking/photometry_stage.h"

#include <map>
#include <numbers>
#include <string>

#include "lighting/probe.h"
#include "tracking/photometry.h"
#include "tracking/probe_card.h"

namespace matchlight {

namespace {

/// What each tag would send to the camera under the probe; what the probe shows of the tags themselves comes first,
/// then the tags nearest its place.
std::map<int, CardExpectation> expectations(const ClipContext& context, const RigSolution& rig) {
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

}  // namespace

void solve_photometry_stage(const ClipContext& context, const ClipObservations& clip, const GeometrySolution& geometry,
                            Solve& solve, TrackSummary& summary) {
    const ClipPhotometry photometry = solve_photometry(clip.cards, expectations(context, geometry.rig), !context.probe);
    summary.exposure_from_probe = context.probe.has_value();
    bool any = false;
    for (std::size_t f = 0; f < solve.frames.size(); ++f) {
        const std::optional<FramePhotometry>& frame = photometry.frames[f];
        if (!frame) continue;
        any = true;
        solve.frames[f].exposure_ev = frame->exposure_ev;
        solve.frames[f].white_balance = frame->white_balance;
        solve.frames[f].exposure_confidence = frame->confidence;
    }
    if (photometry.vignette) solve.vignette = photometry.vignette->gain;
    solve.light_gradient_ev_per_m = photometry.light_gradient_ev_per_m;
    const std::string file = context.scene.footage.video.string();
    if (!any) {
        context.warnings.add(file +
                             ": no tag is large and unclipped enough to serve as a grey card: exposure is not known");
    } else if (!photometry.white_balance_known) {
        context.warnings.add(file + ": red or blue is clipped on the tags in every frame: white balance is not known");
    }
}

}  // namespace matchlight
