// Patterns that become finer towards the horizon: filtered in closed form, or by more samples a pixel.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "core/parallel.h"
#include "core/transforms.h"
#include "render/surface.h"
#include "report/experiments.h"
#include "report/pattern_reference.h"
#include "scene/surface_pictures.h"

namespace matchlight {

namespace {

constexpr int width = 320, height = 200, kinds = 5, middle_kind = 2;

PatternSettings pattern_of(int kind) {
    PatternSettings pattern;
    pattern.kind = static_cast<PatternKind>(kind);
    pattern.frequency = 24;
    pattern.direction = {0.6, 0.8, 0};
    return pattern;
}

/// A square of a metre for each kind of pattern, side by side, seen along them.
class PatternTrial {
public:
    explicit PatternTrial(ShaderLibrary& shaders, const Probe& probe)
        : shaders_(shaders), environment_(shaders, probe, {.lookups_per_level = 10'000}) {}

    std::shared_ptr<SurfaceRenderer> renderer(bool filtered) const {
        auto made = std::make_shared<SurfaceRenderer>(shaders_);
        Model square = make_shape("plane", "pattern");
        square.materials.front().unlit = true;
        for (int kind = 0; kind < kinds; ++kind) {
            SurfacePictures pictures{.settings = {}, .heights = {}, .layers = {}};
            pictures.settings.pattern = pattern_of(kind);
            pictures.settings.pattern->filtered = filtered;
            Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
            place(0, 3) = kind - middle_kind;
            made->add_object({.model = &square, .world_from_model = place, .id = kind + 1, .pictures = &pictures});
        }
        return made;
    }
    /// With `side`² pixels in the place of one.
    void draw(SurfaceRenderer& renderer, int side) const { renderer.draw(environment_, view(side)); }
    ImageF picture(SurfaceRenderer& renderer, int side) const {
        const SurfacePicture drawn = renderer.draw(environment_, view(side));
        const ImageF fine = drawn.color->read<float>({0, 0, drawn.width, drawn.height}, 3);
        ImageF means(width, height, 3);
        for (int y = 0; y < fine.height(); ++y) {
            for (int x = 0; x < fine.width(); ++x) {
                for (int c = 0; c < 3; ++c)
                    means.at(x / side, y / side, c) += fine.at(x, y, c) / static_cast<float>(side * side);
            }
        }
        return means;
    }
    ImageF reference(int side) const {
        ImageF sums(width, height, 3);
        parallel_for(height, [&](int y) {
            for (int x = 0; x < width; ++x) {
                const int kind = kind_at(point_at(x, y));
                if (kind < 0) continue;
                const Eigen::Vector3d middle(kind - middle_kind, 0, 0);
                const auto at = [&](double right, double down) -> Eigen::Vector3d {
                    return point_at(x + right, y + down) - middle;
                };
                const Eigen::Vector3d color = filtered_pattern(pattern_of(kind), at, side);
                for (int c = 0; c < 3; ++c) sums.at(x, y, c) = static_cast<float>(color[c]);
            }
        });
        return sums;
    }

private:
    static PinholeView pinhole(int side) {
        PinholeView pinhole;
        pinhole.width = side * width;
        pinhole.height = side * height;
        pinhole.fx = pinhole.fy = 0.5 * side * width;
        pinhole.cx = (side * width - 1) / 2.0;
        pinhole.cy = (side * height - 1) / 2.0;
        return pinhole;
    }
    static RigidTransform camera() {
        return camera_looking_along(eye_m(), Eigen::Vector3d(0, 0.94, -0.34).normalized());
    }
    static Eigen::Vector3d eye_m() { return {0, -1, 0.35}; }
    static SurfaceView view(int side) {
        SurfaceView view;
        view.eye_world_m = eye_m();
        view.clip_from_world = clip_from_camera(pinhole(side)) * camera().matrix();
        view.width = side * width;
        view.height = side * height;
        view.samples = 1;
        return view;
    }
    /// Of the ground, under a pixel; above the horizon far behind.
    static Eigen::Vector3d point_at(double x, double y) {
        const PinholeView from = pinhole(1);
        const Eigen::Vector3d along =
            camera().linear().transpose() * Eigen::Vector3d((x - from.cx) / from.fx, (y - from.cy) / from.fy, 1);
        return eye_m() + eye_m().z() / std::max(-along.z(), 1e-6) * along;
    }
    static int kind_at(const Eigen::Vector3d& point) {
        if (std::abs(point.y()) > 0.5 || std::abs(point.x()) > 0.5 * kinds) return -1;
        return std::clamp(static_cast<int>(std::floor(point.x() + 0.5 * kinds)), 0, kinds - 1);
    }

    ShaderLibrary& shaders_;
    Environment environment_;
};

}  // namespace

std::optional<Experiment> pattern_experiment(const SceneStage& stage, const ExperimentOptions& options) {
    if (options.quick && !options.by_name) return std::nullopt;
    const auto trial = std::make_shared<PatternTrial>(stage.shaders, stage.probe);
    Experiment experiment;
    EffectReport& report = experiment.report;
    report.name = "pattern";
    report.what = "Square wave, checker, noise, wood and marble on squares seen along them, as light of their own.";
    report.region = {0, 0, width, height};
    const int side = options.quick ? 8 : 24;
    report.reference = fmt::format("{0}×{0} points under the Gaussian of each pixel, in double precision", side);
    experiment.reference = trial->reference(side);
    experiment.coarse_reference = trial->reference(side * 7 / 10);
    const auto add = [&](const std::string& name, bool filtered, int pixels) {
        const auto renderer = trial->renderer(filtered);
        Candidate candidate;
        candidate.point = {
            .level = name, .knobs = {{"samples", static_cast<double>(pixels * pixels)}}, .precision = "16F"};
        candidate.work = [trial, renderer, pixels] { trial->draw(*renderer, pixels); };
        candidate.picture = [trial, renderer, pixels] { return trial->picture(*renderer, pixels); };
        experiment.candidates.push_back(std::move(candidate));
    };
    add("filtered", true, 1);
    for (const int pixels : {1, 2, 4, 8}) add(fmt::format("{} samples", pixels * pixels), false, pixels);
    return experiment;
}

}  // namespace matchlight
