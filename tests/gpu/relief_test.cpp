// Height maps on surfaces: near the displaced surface, at the depth that geometry says, and harmless where they cannot
// be.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render_scene.h"
#include "report/flip.h"
#include "report/relief_trial.h"
#include "report/srgb_picture.h"
#include "scene/relief_map.h"

namespace matchlight {
namespace {

using test::make_square;
using test::TestCamera;
using test::uniform_probe;

double mean_flip(const ImageF& reference, const ImageF& picture) {
    const ImageF errors = flip_error_map(srgb_picture(reference), srgb_picture(picture));
    return std::accumulate(errors.samples().begin(), errors.samples().end(), 0.0) /
           static_cast<double>(errors.samples().size());
}

class Relief : public GlTest {
protected:
    /// A square with these heights, seen from a metre along y and one up unless said otherwise.
    ImageF drawn(Model model, const ImageF& heights, const ReliefSettings& relief, const TestCamera& camera) {
        SurfacePictures pictures{.settings = {}, .heights = heights, .layers = {}};
        pictures.settings.relief = relief;
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &model, .pictures = heights.empty() ? nullptr : &pictures});
        const SurfacePicture picture = renderer.draw(environment_, camera.view(1));
        return picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
    }
    static TestCamera camera_above(double tilt_deg) {
        const double tilt = tilt_deg * EIGEN_PI / 180;
        const Eigen::Vector3d forward(0, std::cos(tilt), -std::sin(tilt));
        return {.eye = -forward, .forward = forward, .right = Eigen::Vector3d::UnitX(), .size = 65, .focal_px = 120};
    }
    static ReliefSettings settings(ReliefMethod method, int steps = 32) {
        return {.height_map = "heights", .depth_m = 0.05, .method = method, .steps = steps};
    }
    static ImageF waves(int width, int height) {
        ImageF heights(width, height, 1);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x)
                heights.at(x, y) = static_cast<float>(0.5 + 0.5 * std::sin(0.3 * x) * std::cos(0.2 * y));
        }
        return heights;
    }
    static constexpr ReliefMethod methods[] = {ReliefMethod::bump,      ReliefMethod::parallax,
                                               ReliefMethod::occlusion, ReliefMethod::relief,
                                               ReliefMethod::cone_step, ReliefMethod::sphere_tracing};

    ShaderLibrary shaders_;
    const Environment environment_{shaders_, test::make_probe(64, test::octant_color)};
};

TEST_F(Relief, IsNearTheDisplacedSurface) {
    const ReliefTrial trial(shaders_, test::make_probe(64, [](const Eigen::Vector3d& d) {
                                return Eigen::Vector3d::Constant(
                                           0.3 + 2 * std::pow(std::max(d.dot(Eigen::Vector3d(0.6, 0.2, 0.77)), 0.0), 8))
                                    .eval();
                            }));
    const ImageF reference = trial.picture(*trial.displaced());
    const auto error_of = [&](ReliefMethod method, int steps) {
        return mean_flip(reference, trial.picture(*trial.renderer(method, steps)));
    };
    const double flat = error_of(ReliefMethod::bump, 0), parallax = error_of(ReliefMethod::parallax, 1),
                 occlusion = error_of(ReliefMethod::occlusion, 64), relief = error_of(ReliefMethod::relief, 64),
                 cone = error_of(ReliefMethod::cone_step, 32), sphere = error_of(ReliefMethod::sphere_tracing, 32);
    EXPECT_LT(relief, 0.03);  // as asked
    EXPECT_LT(occlusion, 0.03);
    EXPECT_LT(cone, 0.03);
    EXPECT_LT(sphere, 0.03);
    EXPECT_LT(parallax, flat);
    EXPECT_LT(relief, 0.2 * parallax);
}

TEST_F(Relief, ShadesItselfAsTheDisplacedSurfaceDoes) {
    const ReliefTrial trial(shaders_, uniform_probe(0.05));
    for (const double angle_deg : {0.0, 6.0}) {
        LampSettings lamp{.type = LampType::directional, .intensity = 3, .direction = {1, 0.4, -0.6}};
        lamp.angle_deg = angle_deg;
        const ImageF reference = trial.picture(*trial.displaced(), lamp);
        for (const ReliefMethod method :
             {ReliefMethod::occlusion, ReliefMethod::relief, ReliefMethod::cone_step, ReliefMethod::sphere_tracing}) {
            const auto carved = trial.renderer(method, 64);
            LampSettings no_shadow = lamp;
            no_shadow.casts_shadow = false;
            const double with = mean_flip(reference, trial.picture(*carved, lamp));
            const double without = mean_flip(reference, trial.picture(*carved, no_shadow));
            EXPECT_LT(with, 0.03) << angle_deg << ' ' << static_cast<int>(method);
            EXPECT_GT(without, 2 * with) << angle_deg << ' ' << static_cast<int>(method);
        }
    }
}

TEST_F(Relief, HasTheDepthOfTheDisplacedSurface) {
    const ReliefTrial trial(shaders_, uniform_probe(1));
    const ImageF reference = trial.depth_m(*trial.displaced());
    const ImageF depth = trial.depth_m(*trial.renderer(ReliefMethod::relief, 64));
    int near = 0;
    for (std::size_t i = 0; i < depth.samples().size(); ++i) {
        // A texel of slope: 1/256 m on stones that rise 5 cm within 3.
        near += std::abs(depth.samples()[i] - reference.samples()[i]) < 2e-3 ? 1 : 0;
    }
    // Where one stone hides another the edge may lie a pixel aside.
    EXPECT_GT(near, 0.97 * static_cast<double>(depth.samples().size()));
}

TEST_F(Relief, OfEvenHeightIsAPlaneBelow) {
    const TestCamera camera = camera_above(60);
    const ImageF even(4, 4, 1, 0.25F);
    for (const ReliefMethod method : methods) {
        if (method == ReliefMethod::bump) continue;
        SurfacePictures pictures{.settings = {}, .heights = even, .layers = {}};
        pictures.settings.relief = settings(method, 64);
        Model square = make_square(1);
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &square, .pictures = &pictures});
        const ImageF depth = renderer.draw_layers(camera.view(1)).depth_m->read<float>({0, 0, 65, 65}, 1);
        // Along the axis: three quarters of the depth, over the ray's steepness; parallax does not divide by that.
        const double steepness = method == ReliefMethod::parallax ? 1 : std::sin(60 * EIGEN_PI / 180);
        EXPECT_NEAR(depth.at(32, 32), 1 + 0.75 * 0.05 / steepness, 2e-4) << static_cast<int>(method);
    }
}

TEST_F(Relief, OfNoHeightChangesNoBit) {
    const TestCamera camera = camera_above(45);
    const ImageF without = drawn(make_square(1), {}, {}, camera);
    for (const ReliefMethod method : methods) {
        // White everywhere: the search finds the surface itself.
        const ImageF white = drawn(make_square(1), ImageF(8, 8, 1, 1.0F), settings(method), camera);
        double worst = 0;
        for (std::size_t i = 0; i < white.samples().size(); ++i)
            worst = std::max(worst, std::abs(static_cast<double>(white.samples()[i]) - without.samples()[i]));
        EXPECT_LT(worst, 1e-3) << static_cast<int>(method);
    }
    SurfacePictures flat{.settings = {}, .heights = {}, .layers = {}};
    Model square = make_square(1);
    SurfaceRenderer renderer(shaders_);
    renderer.add_object({.model = &square, .pictures = &flat});
    const SurfacePicture picture = renderer.draw(environment_, camera.view(1));
    const ImageF bits = picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
    EXPECT_TRUE(std::ranges::equal(bits.samples(), without.samples()));
}

TEST_F(Relief, MirroredOrTurnedLooksTheSame) {
    // The picture lies mirrored on a square whose coordinates are, too: what is seen is the same.
    const TestCamera camera = camera_above(50);
    const ImageF heights = waves(64, 64);
    ImageF reversed(64, 64, 1);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) reversed.at(x, y) = heights.at(63 - x, y);
    }
    Model mirrored = make_square(1);
    for (ModelVertex& vertex : mirrored.meshes[0].vertices) vertex.uv[0] = 1 - vertex.uv[0];
    for (const ReliefMethod method : methods) {
        const ImageF plain = drawn(make_square(1), heights, settings(method), camera);
        const ImageF other = drawn(mirrored, reversed, settings(method), camera);
        double sum = 0;
        for (std::size_t i = 0; i < plain.samples().size(); ++i)
            sum += std::abs(static_cast<double>(plain.samples()[i]) - other.samples()[i]);
        EXPECT_LT(sum / static_cast<double>(plain.samples().size()), 2e-3) << static_cast<int>(method);
    }
}

}  // namespace
}  // namespace matchlight
