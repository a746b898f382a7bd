// What the tags should send to the camera, against what arrived.
#include "tracking/photometry_stage.h"

#include <map>
#include <numbers>
#include <string>

#include "lighting/probe.h"
#include "tracking/photometry.h"

namespace matchlight {

namespace {

/// What each tag would send to the camera under the probe, tags nearest its place weighing most.
std::map<int, CardExpectation> expectations(const ClipContext& context, const RigSolution& rig) {
    std::map<int, CardExpectation> expected;
    const double albedo_difference = context.scene.tags.white_albedo - context.scene.tags.black_albedo;
    for (const auto& [id, place] : rig.world_from_tag) {
        CardExpectation card;
        if (context.probe) {
            const Eigen::Vector3d light = irradiance(*context.probe, place.linear() * Eigen::Vector3d::UnitZ());
            for (std::size_t c = 0; c < 3; ++c) {
                const double reflected = light[static_cast<Eigen::Index>(c)] / std::numbers::pi;
                card.difference[c] = albedo_difference * reflected;
                card.ink[c] = context.scene.tags.black_albedo * reflected;
            }
            if (context.scene.probe->place_m) {
                constexpr double near_m = 0.05;  // closer than this, the probe's own size blurs the difference
                const double distance = (place.translation() - *context.scene.probe->place_m).norm();
                card.weight = 1 / (distance * distance + near_m * near_m);
            }
        }
        expected[id] = card;
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
    const std::string file = context.scene.footage.video.string();
    if (!any) {
        context.warnings.add(file +
                             ": no tag is large and unclipped enough to serve as a grey card: exposure is not known");
    } else if (!photometry.white_balance_known) {
        context.warnings.add(file + ": red or blue is clipped on the tags in every frame: white balance is not known");
    }
}

}  // namespace matchlight
