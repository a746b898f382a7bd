// Runs, times and scores.
#include "report/track_experiment.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <vector>

#include "core/elapsed.h"
#include "media/frame_source.h"
#include "report/tag_agreement.h"
#include "report/track_peers.h"
#include "report/track_truth.h"
#include "scene/footage_options.h"
#include "tracking/clip_observations.h"
#include "tracking/plate_light.h"
#include "tracking/track.h"

namespace matchlight {

namespace {

struct Way {
    const char* name;
    const char* what;
    TrackLevel level;
    CornerMethod corners;
};
constexpr Way ways[] = {
    {"final", "every tag sought in every frame, corners fitted to all of its pixels", TrackLevel::final_,
     CornerMethod::fit},
    {"normal", "searched again where a tag was lost", TrackLevel::normal, CornerMethod::fit},
    {"fast", "searched again where no tag is left", TrackLevel::fast, CornerMethod::fit},
    {"AprilTag corners", "level final, with the library's corners in linear light", TrackLevel::final_,
     CornerMethod::apriltag},
};

struct PeerWay {
    const char* one_name;
    const char* all_name;
    const char* one_what;
    const char* all_what;
    PeerPixels pixels;
};
constexpr PeerWay peer_ways[] = {
    {"AprilTag pose, light", "solvePnP, light", "estimate_tag_pose of the largest tag, corners in linear light",
     "OpenCV over all tags, AprilTag's corners in linear light", PeerPixels::light},
    {"AprilTag pose, codes", "solvePnP, codes", "estimate_tag_pose of the largest tag, corners in code values",
     "OpenCV over all tags, AprilTag's corners in code values", PeerPixels::codes},
};

template <class Work>
double timed_ms(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return milliseconds_since(start);
}

std::int64_t posed_in(const std::vector<SolvedFrame>& frames) {
    return std::ranges::count_if(frames, [](const SolvedFrame& frame) { return frame.camera_from_world.has_value(); });
}

/// The tags of every frame as a way sees them.
std::vector<FrameObservations> observations(const Scene& scene, const Way& way, const Solve& solve) {
    Warnings unheard;  // track has said it
    unheard.set_quiet(true);
    const auto source = FrameSource::open(scene.footage.video, footage_options(scene.footage, false), unheard);
    ObserveOptions options;
    options.level = way.level;
    options.corners = way.corners;
    options.quiet = true;
    const Response response = footage_response(scene.footage);
    return observe_clip(*source, scene.tags, solve.camera, response, options).frames;
}

/// From the solved pose, so that a single tag left over keeps its branch.
std::optional<RigidTransform> refined_pose(const std::vector<PlacedObservation>& tags, const RigidTransform& known) {
    const auto pose = refine_pose(tags, known);
    return pose ? std::optional(pose->camera_from_world) : std::nullopt;
}

}  // namespace

std::int64_t track_experiment_steps(const TrackExperimentOptions& options) {
    return static_cast<std::int64_t>(options.repeats * (std::size(ways) + std::size(peer_ways)));
}

TrackReport run_track_experiment(const Scene& scene, const TrackExperimentOptions& options, Warnings& warnings) {
    std::optional<TrackTruth> truth;
    if (options.truth) truth = load_track_truth(*options.truth);

    std::vector<Solve> solves(std::size(ways));
    std::vector<PeerPoses> peers(std::size(peer_ways));
    std::vector<std::vector<double>> way_ms(std::size(ways)), peer_ms(std::size(peer_ways));
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (std::size_t w = 0; w < std::size(ways); ++w) {
            TrackOptions track;
            track.level = ways[w].level;
            track.corners = ways[w].corners;
            track.quiet = true;
            TrackSummary summary;
            Warnings unheard;  // the first run says what all would
            unheard.set_quiet(true);
            Warnings& heard = w == 0 && repeat == 0 ? warnings : unheard;
            way_ms[w].push_back(timed_ms([&] { solves[w] = track_footage(scene, track, heard, summary); }));
            options.advance();
        }
        for (std::size_t w = 0; w < std::size(peer_ways); ++w) {
            Warnings unheard;
            unheard.set_quiet(true);
            peer_ms[w].push_back(timed_ms([&] {
                peers[w] = track_with_peers(scene, solves[0].camera, solves[0].rig, peer_ways[w].pixels, unheard);
            }));
            options.advance();
        }
    }

    TrackReport report;
    report.frames = static_cast<std::int64_t>(solves[0].frames.size());
    report.against_truth = truth.has_value();
    double largest_tag_m = 0;
    for (const SolvedTag& tag : solves[0].rig) largest_tag_m = std::max(largest_tag_m, tag.size_m);
    const std::filesystem::path& file = scene.footage.camera;
    const Camera& solved = solves[0].camera;
    const Camera calibrated =
        file.empty() ? solved : camera_for_size(load_camera(file), solved.width, solved.height, file);
    const auto add = [&](const char* name, const char* what, const std::vector<double>& ms,
                         const std::vector<SolvedFrame>& frames, const Camera& camera) -> TrackPoint& {
        TrackPoint& point = report.points.emplace_back();
        point.name = name, point.what = what;
        point.time = run_time_of(ms);
        point.posed = posed_in(frames);
        if (truth) score({frames, camera}, *truth, scored_volume(calibrated, largest_tag_m), *options.truth, point);
        return point;
    };
    for (std::size_t w = 0; w < std::size(ways); ++w) {
        TrackPoint& point = add(ways[w].name, ways[w].what, way_ms[w], solves[w].frames, solves[w].camera);
        point.agreement = tag_agreement(observations(scene, ways[w], solves[w]), solves[w].frames, solves[w].rig,
                                        solves[w].camera, refined_pose);
    }
    for (std::size_t w = 0; w < std::size(peer_ways); ++w) {
        const PeerWay& way = peer_ways[w];
        const Camera& camera = solves[0].camera;
        TrackPoint& one = add(way.one_name, way.one_what, peer_ms[w], peers[w].one_tag, camera);
        one.agreement =
            tag_agreement(peers[w].frames, peers[w].one_tag, solves[0].rig, camera,
                          [](const auto& tags, const RigidTransform&) { return apriltag_pose_of_largest(tags); });
        TrackPoint& all = add(way.all_name, way.all_what, peer_ms[w], peers[w].all_tags, camera);
        all.agreement = tag_agreement(peers[w].frames, peers[w].all_tags, solves[0].rig, camera,
                                      [](const auto& tags, const RigidTransform&) { return solve_pnp_pose_of(tags); });
    }
    return report;
}

}  // namespace matchlight
