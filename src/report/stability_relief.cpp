// Stiff cases of what the scene lays on surfaces: relief where rays, coordinates or maps are hard, patterns far too
// fine.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/transforms.h"
#include "render/surface.h"
#include "report/stability_cases.h"
#include "scene/surface_pictures.h"

namespace matchlight {

namespace {

constexpr int side_px = 64;

struct LaidSquare {
    Model model = make_shape("plane", "stability");
    SurfacePictures pictures{.settings = {}, .heights = {}, .layers = {}};
    double tilt_deg = 30;
};

/// What a square under even light of 1 sends to the eye, a metre away.
ImageF drawn(const LaidSquare& square) {
    ShaderLibrary shaders;
    const Environment environment(shaders, Probe{ImageF(64, 32, 3, 1.0F)});
    const double tilt = square.tilt_deg * std::numbers::pi / 180;
    const Eigen::Vector3d forward(0, std::cos(tilt), -std::sin(tilt));
    PinholeView pinhole;
    pinhole.width = pinhole.height = side_px;
    pinhole.fx = pinhole.fy = 2 * side_px;
    pinhole.cx = pinhole.cy = (side_px - 1) / 2.0;
    SurfaceView view;
    view.eye_world_m = -forward;
    view.clip_from_world = clip_from_camera(pinhole) * camera_looking_along(view.eye_world_m, forward).matrix();
    view.width = view.height = side_px;
    view.samples = 1;
    SurfaceRenderer renderer(shaders);
    renderer.add_object({.model = &square.model, .pictures = &square.pictures});
    const SurfacePicture picture = renderer.draw(environment, view);
    return picture.color->read<float>({0, 0, side_px, side_px}, 4);
}

/// NaN where any sample is; the largest of RGB else.
double brightest(const ImageF& image) {
    double most = 0;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                if (!std::isfinite(image.at(x, y, c))) return std::numeric_limits<double>::quiet_NaN();
                most = std::max(most, static_cast<double>(image.at(x, y, c)));
            }
        }
    }
    return most;
}

ImageF waves(int width, int height) {
    ImageF heights(width, height, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x)
            heights.at(x, y) = static_cast<float>(0.5 + 0.5 * std::sin(0.3 * x) * std::cos(0.2 * y));
    }
    return heights;
}

void for_each_vertex(LaidSquare& square, const std::function<void(ModelVertex&)>& change) {
    for (ModelVertex& vertex : square.model.meshes.front().vertices) change(vertex);
}

/// By every method: no more light than falls in.
StabilityCase relief_case(const char* name, LaidSquare square) {
    // What scatters between facets comes back as the tables have it.
    return {
        "relief", name, "largest radiance under light of 1", {0, 1.005}, {}, [square]() mutable {
            double most = 0;
            for (int method = 0; method <= static_cast<int>(ReliefMethod::sphere_tracing); ++method) {
                square.pictures.settings.relief = {
                    .height_map = "waves", .depth_m = 0.05, .method = static_cast<ReliefMethod>(method), .steps = 32};
                const double radiance = brightest(drawn(square));
                if (!(radiance <= most)) most = radiance;
                if (std::isnan(most)) break;
            }
            return StabilityOutcome{most};
        }};
}

/// The mean of a pattern whose periods are far below a pixel is known, and every pixel has it.
StabilityCase pattern_case(PatternKind kind, double frequency) {
    static constexpr const char* names[] = {"square wave", "checker", "noise", "wood", "marble"};
    const char* name = names[static_cast<std::size_t>(kind)];
    return {"pattern",
            fmt::format("{}, {:g} periods a unit", name, frequency),
            "largest step between pixels",
            {0, 0.01},
            {},
            [kind, frequency] {
                LaidSquare square;
                square.tilt_deg = 90;
                square.model.materials.front().unlit = true;
                PatternSettings& pattern = square.pictures.settings.pattern.emplace();
                pattern.kind = kind;
                pattern.frequency = frequency;
                pattern.direction = {1, 0.3, 0.1};
                const ImageF image = drawn(square);
                double low = 1, high = 0;
                for (int x = 0; x < side_px; ++x) {
                    const double value = image.at(x, side_px / 2);
                    if (!std::isfinite(value)) return StabilityOutcome{};
                    low = std::min(low, value);
                    high = std::max(high, value);
                }
                return StabilityOutcome{high - low};
            }};
}

}  // namespace

std::vector<StabilityCase> surface_detail_cases() {
    const auto square_with = [](ImageF heights, double tilt_deg) {
        LaidSquare square;
        square.pictures.heights = std::move(heights);
        square.tilt_deg = tilt_deg;
        return square;
    };
    const auto changed = [&](const std::function<void(ModelVertex&)>& change) {
        LaidSquare square = square_with(waves(64, 64), 30);
        for_each_vertex(square, change);
        return square;
    };
    LaidSquare far_away = square_with(waves(64, 64), 3);
    for_each_vertex(far_away, [](ModelVertex& vertex) {
        for (float& component : vertex.position) component *= 1000;
    });
    LaidSquare turned = changed([](ModelVertex& vertex) { vertex.position[0] = -vertex.position[0]; });
    std::ranges::reverse(turned.model.meshes.front().indices);
    std::vector<StabilityCase> cases = {
        relief_case("seen at half a degree", square_with(waves(64, 64), 0.5)),
        relief_case("a square of a kilometre at 3 degrees", far_away),
        relief_case("mirrored coordinates", changed([](ModelVertex& vertex) { vertex.uv[0] = -vertex.uv[0]; })),
        relief_case("no coordinates", changed([](ModelVertex& vertex) {
                        vertex.uv = {0, 0};
                    })),
        relief_case("tangents of no length", changed([](ModelVertex& vertex) {
                        vertex.tangent = {0, 0, 0, 0};
                    })),
        relief_case("a mirrored mesh", turned),
        relief_case("a map of one texel", square_with(waves(1, 1), 30)),
        relief_case("a map of 16384 by 1", square_with(waves(16384, 1), 30)),
        relief_case("a map of one height", square_with(ImageF(64, 64, 1, 0.5F), 30))};
    for (const PatternKind kind :
         {PatternKind::square_wave, PatternKind::checker, PatternKind::noise, PatternKind::wood, PatternKind::marble}) {
        for (const double frequency : {1e3, 1e6}) cases.push_back(pattern_case(kind, frequency));
    }
    return cases;
}

}  // namespace matchlight
