// The environment on the GPU against sums over the probe in double precision.
#include "render/environment.h"

#include <random>

#include <Eigen/Geometry>

#include "gl_fixture.h"
#include "render/split_sum.h"
#include "render_scene.h"

namespace matchlight {
namespace {

using test::make_probe;
using test::uniform_probe;

/// Direction of a texel of a cube face (OpenGL 4.5, table 8.19), not normalised.
Eigen::Vector3d cube_direction(int face, double u, double v) {
    const double s = 2 * u - 1;
    const double t = 2 * v - 1;
    switch (face) {
        case 0:
            return {1, -t, -s};
        case 1:
            return {-1, -t, s};
        case 2:
            return {s, 1, t};
        case 3:
            return {s, -1, -t};
        case 4:
            return {s, -t, 1};
        default:
            return {-s, -t, -1};
    }
}

struct Texel {
    Eigen::Vector3d direction;
    double solid_angle;
    Eigen::Vector3d radiance;
};

std::vector<Texel> texels_of(const TextureCube& cube, int level) {
    const int size = cube.face_size(level);
    std::vector<Texel> texels;
    for (int face = 0; face < 6; ++face) {
        std::vector<float> values(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 3);
        cube.read<float>(level, face, values);
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const Eigen::Vector3d toward = cube_direction(face, (x + 0.5) / size, (y + 0.5) / size);
                const float* value = values.data() + (static_cast<std::size_t>(y) * size + x) * 3;
                texels.push_back({toward.normalized(), 4.0 / size / size * std::pow(toward.norm(), -3),
                                  Eigen::Vector3d(value[0], value[1], value[2])});
            }
        }
    }
    return texels;
}

/// Radiance under the GGX lobe about `axis`, by summing over all pixels of the probe.
Eigen::Vector3d lobe_reference(const Probe& probe, const Eigen::Vector3d& axis, double roughness) {
    const int width = probe.latlong.width();
    const int height = probe.latlong.height();
    const double alpha2 = std::pow(roughness, 4);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (int y = 0; y < height; ++y) {
        const double solid_angle =
            (std::cos(std::numbers::pi * y / height) - std::cos(std::numbers::pi * (y + 1) / height)) * 2 *
            std::numbers::pi / width;
        for (int x = 0; x < width; ++x) {
            const Eigen::Vector3d direction = latlong_direction(x, y, width, height);
            const double cosine = axis.dot(direction);
            if (cosine <= 0) continue;
            const double half2 = (1 + cosine) / 2;  // cos² of half the angle
            const double base = half2 * (alpha2 - 1) + 1;
            const double weight = cosine * alpha2 / (base * base) * solid_angle;
            const float* value = probe.latlong.pixel(x, y);
            sum += weight * Eigen::Vector3d(value[0], value[1], value[2]);
            weights += weight;
        }
    }
    return sum / weights;
}

/// Soft light of low order with one broad lamp: nothing narrower than the coarsest texel under test.
Eigen::Vector3d soft_light(const Eigen::Vector3d& d) {
    const double lamp = 20 * std::exp(8 * (d.dot(Eigen::Vector3d(0.6, 0.3, 0.74).normalized()) - 1));
    return {1 + 0.5 * d.x() + lamp, 1 + 0.5 * d.y() * d.z() + lamp, 1 + 0.3 * d.z() + 0.8 * lamp};
}

class EnvironmentTest : public GlTest {
protected:
    ShaderLibrary shaders_;
};

TEST_F(EnvironmentTest, uniform_light_stays_uniform) {
    const Environment environment(shaders_, uniform_probe(1));
    for (int level = 0; level < environment.cube().levels(); ++level) {
        for (const Texel& texel : texels_of(environment.cube(), level)) {
            // A half float has 11 bits.
            EXPECT_NEAR((texel.radiance - Eigen::Vector3d::Ones()).norm(), 0, 1e-3) << "level " << level;
        }
    }
    const ImageF ball = environment.sphere_map().read<float>(environment.sphere_map().bounds(), 3);
    for (const float value : ball.samples()) EXPECT_NEAR(value, 1, 1e-3);
    EXPECT_EQ(environment.clamped_values(), 0);
}

TEST_F(EnvironmentTest, the_mirror_level_holds_the_probe) {
    const Probe probe = make_probe(512, soft_light);
    const Environment environment(shaders_, probe);
    EXPECT_EQ(environment.cube().face_size(), 128);
    for (const Texel& texel : texels_of(environment.cube(), 0)) {
        const Eigen::Vector3d expected = soft_light(texel.direction);
        // Averages over pixels of 0.7° and rounding to half floats: 0.2 % of light that changes over 20°.
        EXPECT_LT((texel.radiance - expected).norm(), 2e-3 * expected.norm());
    }
}

TEST_F(EnvironmentTest, a_light_of_one_pixel_keeps_its_energy) {
    std::mt19937 random(1);
    for (int trial = 0; trial < 6; ++trial) {
        Probe probe = uniform_probe(0);
        probe.latlong = ImageF(1024, 512, 3);
        const int x = std::uniform_int_distribution(0, 1023)(random);
        const int y = std::uniform_int_distribution(60, 451)(random);
        for (int c = 0; c < 3; ++c) probe.latlong.at(x, y, c) = 50000;
        const double expected = 50000 * 2 * std::numbers::pi / 1024 *
                                (std::cos(std::numbers::pi * y / 512) - std::cos(std::numbers::pi * (y + 1) / 512));
        const Environment environment(shaders_, probe);
        for (const int level : {0, 2, 4}) {
            double power = 0;
            for (const Texel& texel : texels_of(environment.cube(), level))
                power += texel.radiance.x() * texel.solid_angle;
            // Three by three bilinear lookups a texel, at worst half a pixel beside the light.
            EXPECT_NEAR(power / expected, 1, 0.1) << "level " << level << " pixel " << x << ' ' << y;
        }
    }
}

TEST_F(EnvironmentTest, rough_levels_hold_the_ggx_lobe) {
    const Probe probe = make_probe(256, soft_light);
    const Environment environment(shaders_, probe);
    for (int level = 1; level < environment.cube().levels(); ++level) {
        const double roughness = environment.roughness_of_level(level);
        const auto texels = texels_of(environment.cube(), level);
        double worst = 0;
        const std::size_t step = std::max<std::size_t>(1, texels.size() / 96);
        for (std::size_t i = 0; i < texels.size(); i += step) {
            const Eigen::Vector3d expected = lobe_reference(probe, texels[i].direction, roughness);
            worst = std::max(worst, (texels[i].radiance - expected).norm() / expected.norm());
        }
        // Measured: 1 % at level 1, 2.6 % at roughness 1, whose lookups read mip levels of a few texels.
        EXPECT_LT(worst, 0.03) << "roughness " << roughness;
    }
}

TEST_F(EnvironmentTest, the_sphere_map_is_a_mirror_ball_that_looks_along_y) {
    const Probe probe = make_probe(512, [](const Eigen::Vector3d& d) { return Eigen::Vector3d(d.array() + 1.5); });
    const Environment environment(shaders_, probe, {.sphere_map_size = 256});
    const ImageF ball = environment.sphere_map().read<float>(environment.sphere_map().bounds(), 3);
    for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 256; ++x) {
            const double nx = (x + 0.5) / 128 - 1;
            const double ny = 1 - (y + 0.5) / 128;
            const double radius2 = nx * nx + ny * ny;
            if (radius2 > 0.98) continue;  // the rim's texels span more than 10° of the room
            const double nz = std::sqrt(1 - radius2);
            // The ball is seen along its z; right is world +x, up is world +z, and its middle shows world +y.
            const Eigen::Vector3d reflected(2 * nz * nx, 2 * nz * nz - 1, 2 * nz * ny);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(ball.at(x, y, c), reflected[c] + 1.5, 5e-3);
        }
    }
}

TEST_F(EnvironmentTest, values_beyond_half_floats_are_clamped_and_counted) {
    Probe probe = uniform_probe(1);
    probe.latlong.at(10, 12, 0) = 1e6F;
    probe.latlong.at(11, 12, 2) = 1e30F;
    const Environment environment(shaders_, probe);
    EXPECT_EQ(environment.clamped_values(), 2);
    for (const Texel& texel : texels_of(environment.cube(), 0)) EXPECT_TRUE(texel.radiance.allFinite());
    EXPECT_THROW(Environment(shaders_, probe, {.face_size = 100}), std::invalid_argument);
}

TEST(SplitSum, agrees_with_its_own_limits) {
    for (const double n_dot_v : {0.1, 0.5, 0.9}) {
        // A mirror: Schlick's term itself.
        const Eigen::Vector2d mirror = split_sum(n_dot_v, 1e-3, 64);
        EXPECT_NEAR(mirror.x() + mirror.y(), 1, 1e-3);
        EXPECT_NEAR(mirror.y(), std::pow(1 - n_dot_v, 5), 1e-3);
        for (const double roughness : {0.1, 0.4, 0.7, 1.0}) {
            const Eigen::Vector2d coarse = split_sum(n_dot_v, roughness, 128);
            const Eigen::Vector2d fine = split_sum(n_dot_v, roughness, 1 << 16);
            EXPECT_NEAR((coarse - fine).norm(), 0, 3e-3) << n_dot_v << ' ' << roughness;
            EXPECT_LT(fine.sum(), 1);
        }
    }
}

}  // namespace
}  // namespace matchlight
