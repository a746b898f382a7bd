// What making a probe costs and how far it is from the truth: photographs merged, balls unwrapped, parallax, mappings.
#include "report/probe_experiments.h"

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "calibration/hdr_merge.h"
#include "core/parallel.h"
#include "lighting/ball_probe.h"
#include "lighting/ball_unwrap.h"
#include "lighting/resample.h"
#include "report/srgb_picture.h"
#include "report/synthetic_ball.h"
#include "report/synthetic_bracket.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

const Vector3d lamp = Vector3d(0.3, 0.5, 0.8).normalized();
constexpr double lamp_radiance = 500;
const MirrorBall ball{{0, 0, 0.05}, 0.035};

/// The mean of `side` × `side` points of every pixel.
ImageF supersampled(int width, int height, int side, const std::function<Vector3d(double x, double y)>& light) {
    ImageF image(width, height, 3);
    const MapSamples samples = map_samples(side);
    parallel_for(height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            Vector3d sum = Vector3d::Zero();
            for (const auto& [across, down] : samples) sum += light(x + across, y + down);
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(sum[c] / (side * side));
        }
    });
    return image;
}

/// Of any layout; black where it shows nothing.
ImageF probe_of_sky(const Sky& sky, const ProbeLayout& layout, int side) {
    return supersampled(layout.width, layout.height, side, [&](double x, double y) -> Vector3d {
        const auto towards = direction_from_pixel(layout, Eigen::Vector2d(x, y));
        return towards ? sky(*towards) : Vector3d::Zero();
    });
}

/// A candidate whose picture is what its work made last.
Candidate candidate_of(std::string level, std::vector<Knob> knobs, std::function<ImageF()> made) {
    Candidate candidate;
    candidate.point.level = std::move(level);
    candidate.point.knobs = std::move(knobs);
    candidate.point.precision = "32F";
    candidate.work = [made] { made(); };
    candidate.picture = std::move(made);
    return candidate;
}

Experiment named(std::string name, std::string what, std::string reference, const ImageF& truth) {
    Experiment experiment;
    experiment.report.name = std::move(name);
    experiment.report.what = std::move(what);
    experiment.report.reference = std::move(reference);
    experiment.report.unit = WorkUnit::clip;
    experiment.report.region = truth.bounds();
    experiment.stopwatch = Stopwatch::wall;
    experiment.reference = truth;
    return experiment;
}

/// Light of a wall with a window, in front of which something stands.
Vector3d wall(double x, double y) {
    if (std::hypot(x - 150, y - 40) < 7) return {300, 280, 250};
    const double stripes = 1 + 0.5 * std::sin(0.31 * x + 0.05 * y) * std::cos(0.23 * y);
    return Vector3d(1, 0.8, 0.6) * stripes * std::exp2(-6 * (1 - x / 192));
}

/// Pixels that each of five photographs by hand is off.
constexpr std::array<std::array<double, 2>, 5> hand_moved = {
    {{1.6, -0.7}, {-0.9, 1.2}, {0, 0}, {0.8, 0.9}, {-1.3, 0.4}}};

/// Those photographs; something dark goes by in the second.
ExposureSeries handheld_bracket() {
    constexpr int width = 192, height = 128;
    ExposureSeries series;
    for (std::size_t i = 0; i < hand_moved.size(); ++i) {
        const ImageF light = supersampled(width, height, 4, [&](double x, double y) -> Vector3d {
            const bool passing = i == 1 && std::abs(x - 100) < 9 && y > 60;
            return passing ? Vector3d(0.02, 0.02, 0.03) : wall(x + hand_moved[i][0], y + hand_moved[i][1]);
        });
        SyntheticCamera camera;
        camera.seed = static_cast<unsigned>(i + 1);
        ExposureSeries one = photographed(light, {8 * std::exp2(-3.0 * static_cast<double>(i))}, camera);
        one.shots.front().path = "synthetic_" + std::to_string(i) + ".png";
        series.shots.push_back(std::move(one.shots.front()));
    }
    return series;
}

Experiment merge_experiment() {
    const auto series = std::make_shared<const ExposureSeries>(handheld_bracket());
    const auto merged = [series](const MergeOptions& options) {
        Warnings unheard;
        unheard.set_quiet(true);
        return merge_exposures(*series, Response::srgb(), options, unheard);
    };
    const std::size_t reference = merged({}).reference;
    const auto truth_of = [reference](int side) {
        return supersampled(192, 128, side, [reference](double x, double y) {
            return wall(x + hand_moved[reference][0], y + hand_moved[reference][1]);
        });
    };
    Experiment experiment =
        named("probe_merge", "five photographs by hand, three stops apart, in one of which something goes by",
              "the wall itself, 8 × 8 points a pixel in double precision, as the best exposed photograph sees it",
              truth_of(8));
    experiment.coarse_reference = truth_of(4);
    const auto add = [&](const char* level, Alignment align, bool deghost) {
        const MergeOptions options{align, deghost, false};
        experiment.candidates.push_back(
            candidate_of(level, {{"aligned", align == Alignment::off ? 0.0 : 1.0}, {"deghosted", deghost ? 1.0 : 0.0}},
                         [merged, options] { return merged(options).radiance; }));
    };
    add("plain", Alignment::off, false);
    add("deghosted", Alignment::off, true);
    add("aligned", Alignment::automatic, false);
    add("final", Alignment::automatic, true);
    return experiment;
}

/// A screen stands close behind the ball; else the room is far away.
Surroundings room_with_screen() {
    return [room = room_with_lamp(lamp, lamp_radiance)](const Vector3d& place_m, const Vector3d& towards) -> Vector3d {
        const double distance_m = (0.14 - place_m.y()) / towards.y();
        const Vector3d meets = place_m + distance_m * towards;
        if (distance_m <= 0 || std::abs(meets.x()) > 0.06 || meets.z() > 0.14 || meets.z() < 0.02) return room(towards);
        return Vector3d(0.5, 0.1, 0.1) * (1 + 0.25 * std::sin(300 * meets.x()) * std::cos(250 * meets.z()) +
                                          0.25 * std::sin(170 * meets.x() + 90 * meets.z()));
    };
}

using Views = std::shared_ptr<const std::vector<BallView>>;

Views two_views(const Surroundings& near) {
    std::vector<BallView> views;
    for (const Vector3d& eye : {Vector3d(0.45, -0.2, 0.5), Vector3d(-0.5, -0.15, 0.45)}) {
        BallShot shot;
        shot.camera = long_lens(160, 120, 900);
        shot.ball = ball;
        shot.camera_from_world = looking_at(eye, ball.centre_m);
        shot.near = near;
        views.push_back(photographed(shot, room_with_lamp(lamp, lamp_radiance)));
        views.back().camera_from_world = shot.camera_from_world;
    }
    return std::make_shared<const std::vector<BallView>>(std::move(views));
}

constexpr int map_rows = 128;

ImageF unwrapped(const Views& views, BallParallax parallax, int samples_a_side) {
    BallProbeOptions options;
    options.height = map_rows;
    options.place_m = ball.centre_m;
    options.parallax = parallax;
    options.samples_a_side = samples_a_side;
    return probe_from_balls({*views, ball, Vector3d::Ones(), std::nullopt, nullptr}, options).radiance;
}

Experiment unwrap_experiment() {
    const Views views = two_views({});
    const ProbeLayout layout = layout_of_size(ProbeMapping::latlong, map_rows);
    const Sky room = room_with_lamp(lamp, lamp_radiance);
    Experiment experiment =
        named("probe_unwrap", "two views of a mirror ball 48 pixels in radius, in a room that is far away",
              "the room itself, 8 × 8 directions a pixel in double precision", probe_of_sky(room, layout, 8));
    experiment.coarse_reference = probe_of_sky(room, layout, 4);
    for (const auto& [level, samples] :
         {std::pair{"1 sample", 1}, std::pair{"final", 2}, std::pair{"16 samples", 4}, std::pair{"64 samples", 8}}) {
        experiment.candidates.push_back(
            candidate_of(level, {{"samples", 1.0 * samples * samples}},
                         [views, side = samples] { return unwrapped(views, BallParallax::off, side); }));
    }
    return experiment;
}

Experiment parallax_experiment() {
    const Surroundings near = room_with_screen();
    const Views views = two_views(near), far_views = two_views({});
    const auto truth_of = [&](int side) {
        return probe_of_sky([&](const Vector3d& towards) { return near(ball.centre_m, towards); },
                            layout_of_size(ProbeMapping::latlong, map_rows), side);
    };
    Experiment experiment =
        named("probe_parallax", "the same ball with a screen 14 cm behind it",
              "the room as seen from the ball's middle, 8 × 8 directions a pixel in double precision", truth_of(8));
    experiment.coarse_reference = truth_of(4);
    for (const auto& [level, rows, parallax] :
         {std::tuple{"off", 0, BallParallax::off}, std::tuple{"coarse", 64, BallParallax::coarse},
          std::tuple{"full", map_rows, BallParallax::full}}) {
        experiment.candidates.push_back(
            candidate_of(level, {{"rows", 1.0 * rows}}, [views, how = parallax] { return unwrapped(views, how, 2); }));
    }
    const auto of_far = [far_views](BallParallax parallax) { return unwrapped(far_views, parallax, 2); };
    experiment.left_out = LeftOutTrial{"nothing near the ball", [of_far] { of_far(BallParallax::full); },
                                       [of_far] { of_far(BallParallax::off); },
                                       [of_far] {
                                           return largest_code_difference(probe_codes(of_far(BallParallax::full)),
                                                                          probe_codes(of_far(BallParallax::off)));
                                       }};
    return experiment;
}

Experiment resample_experiment() {
    const ProbeLayout from = layout_of_size(ProbeMapping::latlong, 128), to = layout_of_size(ProbeMapping::cube, 40);
    const Sky room = room_with_lamp(lamp, lamp_radiance);
    const auto source = std::make_shared<const ImageF>(probe_of_sky(room, from, 8));
    Experiment experiment =
        named("probe_resample", "a lat-long map of 128 rows into a cube map of 40 pixels a side",
              "the room itself, 8 × 8 points a pixel in double precision", probe_of_sky(room, to, 8));
    experiment.coarse_reference = probe_of_sky(room, to, 4);
    const auto weights = std::make_shared<const std::vector<double>>(pixel_solid_angles(to));
    const auto green_light = [weights](const ImageF& image) {
        double sum = 0;
        for (std::size_t i = 0; i < weights->size(); ++i) sum += (*weights)[i] * image.samples()[3 * i + 1];
        return sum / (4 * pi);
    };
    experiment.input_light = 0;
    const std::vector<double> source_angles = pixel_solid_angles(from);
    for (std::size_t i = 0; i < source_angles.size(); ++i) {
        experiment.input_light += source_angles[i] * source->samples()[3 * i + 1] / (4 * pi);
    }
    experiment.reference_light = experiment.input_light;
    const auto add = [&](const char* level, const ResampleOptions& options) {
        const auto made = [source, from, to, options] { return resample(*source, from, to, options); };
        Candidate candidate = candidate_of(
            level, {{"points_a_side", 1.0 * options.points_a_side}, {"most_passes", 1.0 * options.most_passes}}, made);
        candidate.light = [made, green_light] { return green_light(made()); };
        experiment.candidates.push_back(std::move(candidate));
    };
    add("1 point", {1, 2});
    add("unbalanced", {3, 1});
    add("final", {});
    add("6 x 6 points", {6, 48});
    return experiment;
}

}  // namespace

std::vector<Experiment> probe_experiments(const std::function<void()>& done) {
    std::vector<Experiment> experiments;
    for (Experiment (*make)() : {merge_experiment, unwrap_experiment, parallax_experiment, resample_experiment}) {
        experiments.push_back(make());
        done();
    }
    return experiments;
}

Image8 probe_codes(const ImageF& light) {
    ImageF shown = light;
    for (float& sample : shown.samples()) sample *= 0.3F;
    return srgb_picture(shown);
}

}  // namespace matchlight
