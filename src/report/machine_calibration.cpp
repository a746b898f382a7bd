// A sphere over a surface, seen from two distances.
#include "report/machine_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "compositor/budget.h"
#include "compositor/compositor.h"
#include "media/blank_source.h"
#include "report/flip.h"
#include "report/image_error.h"
#include "report/scratch_probe.h"

namespace matchlight {
namespace {

constexpr int width = 1280, height = 720;

/// Walls of stripes and five lamps, one of them small and very bright.
ImageF room_with_lamps() {
    ImageF light(512, 256, 3);
    const auto lamp = [&](int cx, int cy, int radius, float radiance) {
        for (int y = cy - radius; y <= cy + radius; ++y) {
            for (int x = cx - radius; x <= cx + radius; ++x) {
                for (int c = 0; c < 3; ++c) light.at(x, y, c) = radiance;
            }
        }
    };
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            const bool stripe = (x / 16 + y / 16) % 2 != 0;
            light.at(x, y, 0) = stripe ? 0.5F : 0.2F;
            light.at(x, y, 1) = stripe ? 0.45F : 0.22F;
            light.at(x, y, 2) = stripe ? 0.4F : 0.25F;
        }
    }
    lamp(100, 60, 3, 200);
    lamp(220, 40, 8, 20);
    lamp(300, 90, 4, 60);
    lamp(400, 50, 6, 30);
    lamp(260, 100, 0, 5000);
    return light;
}

struct Setup {
    double share = 0.5;  // of the frame's height that the sphere takes
    bool shadow = false;
    EffectSettings effects = {};
};

class MadeUpShot {
public:
    explicit MadeUpShot(GlContext& context)
        : context_(context), probe_(room_with_lamps()), plate_(*BlankSource(footage()).next()) {
        warnings_.set_quiet(true);
    }

    std::shared_ptr<Compositor> compositor(const Setup& setup, const Quality& quality) {
        return std::make_shared<Compositor>(context_, scene(setup), solve(setup),
                                            CompositorOptions{.settings = quality}, warnings_);
    }
    std::function<void()> frame(const std::shared_ptr<Compositor>& compositor) {
        return [this, compositor] { compositor->composite(plate_); };
    }
    Image8 picture(Compositor& compositor) { return compositor.composite(plate_).rgb8(); }

    /// Pixels that objects and shadows reach, and the box of the object alone.
    FrameExtent extent(const Setup& setup) {
        const Quality draft = quality_of(QualityLevel::draft);
        const CompositedFrame frame = compositor(setup, draft)->composite(plate_);
        const Region object = object_region(setup);
        constexpr double megapixel = 1e6;
        return {.object_megapixels = static_cast<double>(object.width) * object.height / megapixel,
                .reach_megapixels = static_cast<double>(frame.reach.width) * frame.reach.height / megapixel,
                .light = frame.reach,
                .frame_width = width,
                .frame_height = height};
    }

private:
    static BlankFootage footage() {
        return {.path = "calibration", .width = width, .height = height, .frames = 1, .fps = 25};
    }

    static constexpr double radius_m = 0.1;

    static double distance_m(const Setup& setup) { return 2 * radius_m * width / (setup.share * height); }

    static Region object_region(const Setup& setup) {
        const int side = static_cast<int>(setup.share * height);
        return Region{(width - side) / 2, (height - side) / 2, side, side};
    }

    Scene scene(const Setup& setup) const {
        Scene scene;
        scene.path = "calibration";
        scene.probe.emplace();
        scene.probe->path = probe_.path();
        scene.probe->mapping = ProbeMapping::latlong;
        scene.surface.shadow = setup.shadow;
        scene.effects = setup.effects;
        ObjectSettings sphere;
        sphere.shape = "sphere";
        sphere.translate_m = {0, 0, radius_m};
        sphere.scale = Eigen::Vector3d::Constant(radius_m);
        sphere.material.metallic = 1;
        sphere.material.roughness = 0.1;
        scene.objects.push_back(sphere);
        return scene;
    }

    /// Looks along world +y and somewhat down at the sphere's middle.
    static Solve solve(const Setup& setup) {
        Solve solve;
        solve.footage_file = "calibration";
        solve.frame_count = 1;
        solve.camera = {.width = width,
                        .height = height,
                        .fx = width,
                        .fy = width,
                        .cx = (width - 1) / 2.0,
                        .cy = (height - 1) / 2.0,
                        .distortion = {}};
        constexpr double down = 25 * std::numbers::pi / 180;
        const Eigen::Vector3d forward(0, std::cos(down), -std::sin(down));
        SolvedFrame frame;
        frame.camera_from_world =
            camera_looking_along(Eigen::Vector3d(0, 0, radius_m) - forward * distance_m(setup), forward);
        frame.exposure_ev = 0;
        solve.frames.push_back(frame);
        return solve;
    }

    GlContext& context_;
    ScratchProbe probe_;
    PlateFrame plate_;
    Warnings warnings_;
};

/// The line through two measured points, neither part of it below 0.
LevelCost line_through(const std::string& level, const std::array<double, 2>& megapixels,
                       const std::array<double, 2>& ms) {
    LevelCost cost{.level = level};
    cost.ms_per_megapixel = std::max(0.0, (ms[1] - ms[0]) / (megapixels[1] - megapixels[0]));
    cost.fixed_ms = std::max(0.0, ms[0] - cost.ms_per_megapixel * megapixels[0]);
    return cost;
}

constexpr std::array<double, 2> shares{0.25, 0.9};
constexpr std::array surface_levels{QualityLevel::draft, QualityLevel::final_, QualityLevel::reference};

/// The least time of each: what else the machine does meanwhile is no property of a level.
std::vector<double> least_ms(const std::vector<std::function<void()>>& works, const TimingOptions& timing) {
    std::vector<double> ms;
    for (const RunTime& time : time_in_turn(works, Stopwatch::wall, timing)) ms.push_back(time.min_ms);
    return ms;
}

Quality with_surface(QualityLevel level) {
    Quality quality = without_rays(quality_of(QualityLevel::final_));
    quality.supersampling = quality_of(level).supersampling;
    quality.samples = quality_of(level).samples;
    return quality;
}

double flip_between(const Image8& reference, const Image8& test) {
    return masked_mean(flip_error_map(reference, test)).value_or(0);
}

/// An effect of bright light, and where its level stands.
struct SpillingEffect {
    const char* part;
    EffectSettings settings;
    QualityLevel Quality::*level;
};

/// What each level of an effect adds to the frame without it.
void calibrate_effect(MadeUpShot& shot, const std::array<FrameExtent, 2>& extents, const SpillingEffect& effect,
                      const TimingOptions& timing, LevelTable& table) {
    std::vector<std::function<void()>> works;
    std::vector<Image8> pictures;
    for (const double share : shares) {
        works.push_back(shot.frame(shot.compositor({.share = share}, with_surface(QualityLevel::draft))));
    }
    for (const auto& [name, level] : quality_levels) {
        for (const double share : shares) {
            Quality quality = with_surface(QualityLevel::draft);
            quality.*effect.level = level;
            const auto compositor = shot.compositor({.share = share, .effects = effect.settings}, quality);
            works.push_back(shot.frame(compositor));
            if (share == shares[1]) pictures.push_back(shot.picture(*compositor));
        }
    }
    const std::vector<double> ms = least_ms(works, timing);
    std::array<double, 2> reached{};
    for (std::size_t k = 0; k < 2; ++k) {
        for (const EffectLoad& load : loads_of(effect.settings, extents[k])) {
            if (load.effect == effect.part) reached[k] = load.megapixels;
        }
    }
    for (std::size_t i = 0; i < quality_levels.size(); ++i) {
        LevelCost cost =
            line_through(std::string(quality_levels[i].first), reached, {ms[2 + 2 * i] - ms[0], ms[3 + 2 * i] - ms[1]});
        cost.flip = flip_between(pictures.back(), pictures[i]);
        table.effects[effect.part].push_back(cost);
    }
}

}  // namespace

int calibration_steps() {
    return 4;
}

LevelTable calibrate_machine(GlContext& context, const TimingOptions& timing, const std::function<void()>& done) {
    LevelTable table{context.info().renderer, context.info().version, {}};
    MadeUpShot shot(context);
    const std::array<FrameExtent, 2> extents{shot.extent({.share = shares[0]}), shot.extent({.share = shares[1]})};

    // What a pixel costs that only shadow reaches: the same object with and without it.
    constexpr double pair_share = 0.5;
    const Setup bare{.share = pair_share}, shaded{.share = pair_share, .shadow = true};
    const std::vector<double> pair = least_ms({shot.frame(shot.compositor(bare, with_surface(QualityLevel::draft))),
                                               shot.frame(shot.compositor(shaded, with_surface(QualityLevel::draft)))},
                                              timing);
    const double more_megapixels = shot.extent(shaded).reach_megapixels - shot.extent(bare).reach_megapixels;
    LevelCost frame{.level = any_level};
    if (more_megapixels > 0) frame.ms_per_megapixel = std::max(0.0, (pair[1] - pair[0]) / more_megapixels);
    table.effects[frame_part] = {frame};
    done();

    // Whole frames by the object's size, less what their pixels cost anyway.
    std::vector<std::function<void()>> works;
    std::vector<Image8> pictures;
    for (const QualityLevel level : surface_levels) {
        for (const double share : shares) {
            const auto compositor = shot.compositor({.share = share}, with_surface(level));
            works.push_back(shot.frame(compositor));
            if (share == shares[1]) pictures.push_back(shot.picture(*compositor));
        }
    }
    std::vector<double> ms = least_ms(works, timing);
    for (std::size_t i = 0; i < surface_levels.size(); ++i) {
        std::array<double, 2> of_level{};
        for (std::size_t k = 0; k < 2; ++k) of_level[k] = ms[2 * i + k] - frame.ms(extents[k].reach_megapixels);
        LevelCost cost = line_through(std::string(name_of(surface_levels[i])),
                                      {extents[0].object_megapixels, extents[1].object_megapixels}, of_level);
        cost.flip = flip_between(pictures.back(), pictures[i]);
        table.effects[surface_part].push_back(cost);
    }
    done();

    EffectSettings bloom, streaks;
    bloom.bloom.emplace();
    streaks.glare.emplace();
    calibrate_effect(shot, extents, {bloom_part, bloom, &Quality::bloom}, timing, table);
    done();
    calibrate_effect(shot, extents, {streaks_part, streaks, &Quality::glare}, timing, table);
    done();
    return table;
}

}  // namespace matchlight
