// Optics of clips that are drawn through a thin lens and a shutter, recorded in 8 bits with noise.
#include "tracking/optics_stage.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/transfer.h"
#include "report/tag_view_reference.h"
#include "synthetic_view.h"
#include "tracking/blur_kernel.h"
#include "tracking/tag_fit.h"

namespace matchlight {
namespace {

using test::orbit_pose;
using test::ordinary_camera;

constexpr double frame_s = 1.0 / 24;

struct LensCase {
    std::size_t frames = 5;
    double coc_scale = 0;  // px·m
    std::function<double(std::size_t)> focus_m = [](std::size_t) { return 0.6; };
    double shutter = 0;
    double turn_deg = 0;  // of the camera about the tags, a frame
};

/// Two rows of tags on a table, 0.5 to 0.75 m from the camera.
std::vector<TagSheet> tags_on_a_table() {
    std::vector<TagSheet> tags(3);
    for (int i = 0; i < 3; ++i) {
        TagSheet& tag = tags[static_cast<std::size_t>(i)];
        tag.pattern = TagFamily("tag36h11").pattern(i);
        tag.id = i;
        tag.world_from_tag.translation() = Eigen::Vector3d(0.11 * i - 0.11, i == 1 ? 0.12 : -0.08, 0);
    }
    return tags;
}

TagView view_of(const LensCase& clip, std::size_t frame) {
    TagView view;
    view.camera = ordinary_camera();
    view.camera_from_world = [&clip, frame](double time_s) {
        return orbit_pose(0.6, 50, 20 + clip.turn_deg * (static_cast<double>(frame) + time_s / frame_s), 0);
    };
    view.exposure_s = clip.shutter * frame_s;
    view.aperture_m = clip.coc_scale / view.camera.fx;
    view.focus_distance_m = clip.focus_m(frame);
    view.tags = tags_on_a_table();
    view.rays = 65;
    return view;
}

std::vector<TagObservation> seen_in(const TagView& view, unsigned seed) {
    Recording recording;
    recording.code_noise = 1.5;
    recording.seed = seed;
    const Image8 picture = recorded_picture(reference_light(view), recording);
    ImageF light(picture.width(), picture.height(), 1);
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            light.at(x, y) = static_cast<float>(linear_from_srgb_code(picture.at(x, y, 1) / 255.0));
        }
    }
    const LensGrid lens(view.camera);
    std::vector<TagObservation> seen;
    for (const TagSheet& tag : view.tags) {
        TagDetection detection;
        detection.id = tag.id;
        const Eigen::Matrix<double, 2, 4> corners = reference_corners_px(view, tag);
        for (int i = 0; i < 4; ++i) detection.corners_px[static_cast<std::size_t>(i)] = corners.col(i);
        const auto fit = fit_tag({light, 0, 0, lens, 2.0}, tag.pattern, detection);
        if (fit) seen.push_back(fit->observation);
    }
    return seen;
}

struct StageResult {
    Solve solve;
    TrackSummary summary;
};

StageResult optics_of(const LensCase& clip) {
    ClipObservations observations;
    GeometrySolution geometry;
    geometry.camera = ordinary_camera();
    for (const TagSheet& tag : tags_on_a_table()) geometry.rig.world_from_tag[tag.id] = tag.world_from_tag;
    StageResult result;
    for (std::size_t f = 0; f < clip.frames; ++f) {
        const TagView view = view_of(clip, f);
        FrameObservations& frame = observations.frames.emplace_back();
        frame.frame = static_cast<std::int64_t>(f);
        frame.tags = seen_in(view, static_cast<unsigned>(f + 1));
        PathFrame& path = geometry.path.frames.emplace_back();
        path.pose.emplace();
        path.pose->camera_from_world = view.camera_from_world(0);
        result.solve.frames.emplace_back();
    }
    const Scene scene;
    const TrackOptions options;
    const FootageInfo footage;
    const std::optional<Probe> probe;
    Warnings warnings;
    const ClipContext context{scene, options, footage, geometry.camera, Response::srgb(), probe, warnings};
    solve_optics_stage(context, observations, geometry, result.solve, result.summary);
    return result;
}

TEST(EdgeBlur, SeesTheLensFromNearToFar) {
    LensCase clip;
    clip.coc_scale = 12;
    clip.focus_m = [](std::size_t) { return 0.55; };
    const TagView view = view_of(clip, 0);
    int compared = 0;
    double squares = 0;
    for (const TagObservation& seen : seen_in(view, 1)) {
        ASSERT_FALSE(seen.edge_blur.edges.empty());
        const RigidTransform camera_from_tag =
            view.camera_from_world(0) * view.tags[static_cast<std::size_t>(seen.id)].world_from_tag;
        for (std::size_t i = 0; i < seen.edge_blur.edges.size(); ++i) {
            const EdgeBlur& edge = seen.edge_blur.edges[i];
            const Eigen::Vector3d normal = camera_from_tag.linear().col(2);
            const double depth = normal.dot(camera_from_tag.translation()) / normal.dot(edge.normalized.homogeneous());
            const double coc_px = clip.coc_scale * (1 / clip.focus_m(0) - 1 / depth);
            const double expected = fitted_variance({coc_px * coc_px / 16, 0, 0, edge.normal}).value;
            const auto k = static_cast<Eigen::Index>(i);
            const double sigma = std::sqrt(seen.edge_blur.covariance(k, k));
            // A strip spans some depths itself, and a cell's corners are blurred as if its edges were straight.
            EXPECT_NEAR(edge.variance_px2, expected, 0.06 + 0.05 * expected + 3 * sigma) << "tag " << seen.id;
            EXPECT_LT(sigma, 0.1);
            squares += std::pow((edge.variance_px2 - expected) / std::hypot(sigma, 0.02 + 0.02 * expected), 2);
            ++compared;
        }
    }
    ASSERT_GT(compared, 12);
    EXPECT_LT(squares / compared, 3);
}

TEST(OpticsStage, FindsFocusAndApertureOfAnOrbit) {
    for (const double focus_m : {0.52, 0.8}) {
        LensCase clip;
        clip.coc_scale = 8;
        clip.focus_m = [=](std::size_t) { return focus_m; };
        clip.turn_deg = 2;
        const StageResult result = optics_of(clip);
        ASSERT_TRUE(result.summary.optics.coc_scale_px_m) << focus_m << " " << result.summary.optics.focus_unknown;
        EXPECT_NEAR(*result.summary.optics.coc_scale_px_m, 8, 0.08 * 8) << focus_m;
        for (const SolvedFrame& frame : result.solve.frames) {
            ASSERT_TRUE(frame.focus_distance_m);
            EXPECT_NEAR(*frame.focus_distance_m, focus_m, 0.03 * focus_m);
            EXPECT_EQ(*frame.coc_scale_px_m, *result.summary.optics.coc_scale_px_m);
            EXPECT_GT(*frame.focus_confidence, 0.5);
        }
    }
}

TEST(OpticsStage, FollowsARackThroughTheTags) {
    LensCase clip;
    clip.frames = 7;
    clip.coc_scale = 10;
    clip.turn_deg = 1;
    clip.focus_m = [](std::size_t f) { return 0.5 + 0.04 * static_cast<double>(f); };
    const StageResult result = optics_of(clip);
    for (std::size_t f = 0; f < clip.frames; ++f) {
        ASSERT_TRUE(result.solve.frames[f].focus_distance_m);
        EXPECT_NEAR(*result.solve.frames[f].focus_distance_m, clip.focus_m(f), 0.03 * clip.focus_m(f)) << f;
    }
}

TEST(OpticsStage, FindsTheShutterOfASharpPan) {
    LensCase clip;
    clip.shutter = 0.5;
    clip.turn_deg = 2;  // up to 7 px a frame
    const StageResult result = optics_of(clip);
    ASSERT_TRUE(result.summary.optics.shutter_fraction) << result.summary.optics.shutter_unknown;
    EXPECT_NEAR(*result.summary.optics.shutter_fraction, 0.5, 0.1);
    EXPECT_GT(*result.solve.frames[0].shutter_confidence, 0.5);
    EXPECT_FALSE(result.summary.optics.coc_scale_px_m);
    EXPECT_FALSE(result.solve.frames[0].focus_distance_m);
    EXPECT_FALSE(result.summary.optics.focus_unknown.empty());
}

TEST(OpticsStage, SaysWhatStillAndSharpFootageDoesNotTell) {
    const StageResult result = optics_of({});
    EXPECT_FALSE(result.solve.frames[0].focus_distance_m);
    EXPECT_FALSE(result.solve.frames[0].coc_scale_px_m);
    EXPECT_FALSE(result.solve.frames[0].shutter_fraction);
    EXPECT_FALSE(result.summary.optics.focus_unknown.empty());
    EXPECT_FALSE(result.summary.optics.shutter_unknown.empty());
    // No codec, no aberrations: nothing but pixels.
    EXPECT_LT(result.solve.softness_px.value_or(0), 0.25);
}

}  // namespace
}  // namespace matchlight
