// The contact shadow on the GPU against its double-precision reference, for casters whose rays are known in closed
// form.
#include "render/effects/contact_shadow.h"

#include <numbers>

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "report/contact_shadow_reference.h"

namespace matchlight {
namespace {

/// A finely tessellated sphere as a caster.
class SphereCaster {
public:
    SphereCaster(const Eigen::Vector3d& centre_m, double radius_m) : centre_(centre_m), radius_(radius_m) {
        constexpr int rings = 96, segments = 192;
        std::vector<float> positions;
        std::vector<std::uint32_t> indices;
        for (int i = 0; i <= rings; ++i) {
            for (int j = 0; j <= segments; ++j) {
                const double theta = std::numbers::pi * i / rings;
                const double phi = 2 * std::numbers::pi * j / segments;
                const Eigen::Vector3d p =
                    centre_m + radius_m * Eigen::Vector3d(std::sin(theta) * std::cos(phi),
                                                          std::sin(theta) * std::sin(phi), std::cos(theta));
                for (int c = 0; c < 3; ++c) positions.push_back(static_cast<float>(p[c]));
                if (i == rings || j == segments) continue;
                const std::uint32_t a = i * (segments + 1) + j, b = a + segments + 1;
                for (const std::uint32_t index : {a, b, a + 1, a + 1, b, b + 1}) indices.push_back(index);
            }
        }
        count_ = static_cast<GLsizei>(indices.size());
        vertices_ = Buffer(std::span<const float>(positions));
        indices_ = Buffer(std::span<const std::uint32_t>(indices));
        const VertexArray::Attribute position{.location = 0, .components = 3};
        array_.set_vertex_buffer(0, vertices_, 3 * sizeof(float), {&position, 1});
        array_.set_index_buffer(indices_);
    }

    ShadowCasters casters() const {
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(radius_);
        return {Eigen::AlignedBox3d(centre_ - half, centre_ + half), [this](Program& program) {
                    program.set("world_from_model", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
                    array_.bind();
                    glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
                }};
    }

    Occlusion occlusion() const {
        return [this](const Eigen::Vector3d& point, const Eigen::Vector3d& direction) {
            const Eigen::Vector3d to_centre = centre_ - point;
            const double along = to_centre.dot(direction);
            return along > 0 && (to_centre - along * direction).norm() < radius_;
        };
    }

private:
    Eigen::Vector3d centre_;
    double radius_;
    Buffer vertices_, indices_;
    VertexArray array_;
    GLsizei count_ = 0;
};

/// A room: dim coloured walls and one warm lamp of about 10° across at 50° elevation.
Probe room_with_lamp() {
    Probe probe;
    probe.latlong = ImageF(256, 128, 3);
    const Eigen::Vector3d lamp = Eigen::Vector3d(0.5, 0.4, 0.77).normalized();
    for (int y = 0; y < 128; ++y) {
        for (int x = 0; x < 256; ++x) {
            const Eigen::Vector3d direction = latlong_direction(x, y, 256, 128);
            float* p = probe.latlong.pixel(x, y);
            p[0] = 0.3f;
            p[1] = 0.35f + 0.1f * static_cast<float>(direction.x());
            p[2] = 0.4f;
            if (direction.dot(lamp) > std::cos(5.0 * std::numbers::pi / 180)) {
                p[0] += 60;
                p[1] += 50;
                p[2] += 35;
            }
        }
    }
    return probe;
}

class ContactShadowTest : public GlTest {
protected:
    ShaderLibrary shaders_;
};

SurfaceLight light_of(const Probe& probe, int directions) {
    return make_surface_light(probe, 0, directions);
}

/// The shadow as the shader looks it up, at texel centres.
class ShadowOnCpu {
public:
    explicit ShadowOnCpu(const ContactShadow& shadow)
        : shadow_(shadow),
          fine_(shadow.fine.loss.read<float>(shadow.fine.loss.bounds(), 3)),
          far_(shadow.far.loss.read<float>(shadow.far.loss.bounds(), 3)) {}

    Eigen::Vector3d ratio(const Eigen::Vector2d& point_m) const {
        return Eigen::Vector3d::Ones() - loss(fine_, shadow_.fine, point_m) - loss(far_, shadow_.far, point_m);
    }

private:
    static Eigen::Vector3d loss(const ImageF& image, const ShadowMap& map, const Eigen::Vector2d& point_m) {
        const Eigen::Vector2d share = (point_m - map.rectangle_m.min()).cwiseQuotient(map.rectangle_m.sizes());
        const float* p =
            image.pixel(static_cast<int>(share.x() * image.width()), static_cast<int>(share.y() * image.height()));
        return {p[0], p[1], p[2]};
    }

    const ContactShadow& shadow_;
    ImageF fine_, far_;
};

TEST_F(ContactShadowTest, AgreesWithTheReference) {
    const SphereCaster sphere({0.01, -0.02, 0.04}, 0.035);
    const Probe probe = room_with_lamp();
    ContactShadowSettings settings;
    settings.directions = 256;
    const auto shadow = make_contact_shadow(shaders_, sphere.casters(), light_of(probe, settings.directions), settings);
    ASSERT_TRUE(shadow);
    const ShadowOnCpu on_cpu(*shadow);
    double sum = 0, worst = 0;
    int count = 0;
    for (double y = -0.08; y <= 0.05; y += 0.01) {
        for (double x = -0.08; x <= 0.08; x += 0.01) {
            const Eigen::Vector3d reference = reference_contact_shadow(probe, {x, y, 0}, sphere.occlusion());
            const double error = (on_cpu.ratio({x, y}) - reference).cwiseAbs().maxCoeff();
            sum += error;
            worst = std::max(worst, error);
            ++count;
        }
    }
    // 256 strata: a stratum holds 0.4 % of the light, and a shadow's edge crosses a few of them.
    EXPECT_LT(sum / count, 0.006);
    EXPECT_LT(worst, 0.05);
}

TEST_F(ContactShadowTest, ErrorFallsWithTheNumberOfDirections) {
    const SphereCaster sphere({0, 0, 0.04}, 0.035);
    const Probe probe = room_with_lamp();
    double last_error = 1;
    for (const int directions : {8, 64, 512}) {
        ContactShadowSettings settings;
        settings.directions = directions;
        const auto shadow = make_contact_shadow(shaders_, sphere.casters(), light_of(probe, directions), settings);
        ASSERT_TRUE(shadow);
        const ShadowOnCpu on_cpu(*shadow);
        double sum = 0;
        for (double y = -0.06; y <= 0.06; y += 0.02) {
            for (double x = -0.06; x <= 0.06; x += 0.02) {
                const Eigen::Vector3d reference = reference_contact_shadow(probe, {x, y, 0}, sphere.occlusion());
                sum += (on_cpu.ratio({x, y}) - reference).cwiseAbs().sum();
            }
        }
        EXPECT_LT(sum, last_error * 49);
        last_error = sum / 49 / 1.5;  // each step must better the last by half at least
    }
}

TEST_F(ContactShadowTest, TouchesAtTheContactAndNowhereUnderAHoveringCastersFreeSide) {
    // A sphere that rests on the surface leaves no light at the very contact.
    const SphereCaster resting({0, 0, 0.035}, 0.035);
    const Probe probe = room_with_lamp();
    const auto shadow = make_contact_shadow(shaders_, resting.casters(), light_of(probe, 128), {});
    ASSERT_TRUE(shadow);
    const ShadowOnCpu on_cpu(*shadow);
    EXPECT_LT(on_cpu.ratio({0, 0}).maxCoeff(), 0.03);
}

TEST_F(ContactShadowTest, OfNothingAboveTheSurfaceIsNothing) {
    const SphereCaster buried({0, 0, -0.1}, 0.05);
    EXPECT_FALSE(make_contact_shadow(shaders_, buried.casters(), light_of(room_with_lamp(), 16), {}));
    Probe black;
    black.latlong = ImageF(16, 8, 3);
    const SphereCaster sphere({0, 0, 0.1}, 0.05);
    EXPECT_FALSE(make_contact_shadow(shaders_, sphere.casters(), light_of(black, 16), {}));
}

TEST_F(ContactShadowTest, BeyondItsReachLessThanTheLostShareIsBlocked) {
    const SphereCaster sphere({0, 0, 0.04}, 0.03);
    const Probe probe = room_with_lamp();
    const auto samples = sample_directions(probe, 256, 0, true);
    const Eigen::AlignedBox2d reach = contact_shadow_reach(sphere.casters().bounds_m, 0, samples, 0.01);
    for (double angle = 0; angle < 6.2; angle += 0.4) {
        // Just outside the rectangle, in every direction.
        Eigen::Vector2d point = reach.sizes().norm() * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const Eigen::Vector3d ratio = reference_contact_shadow(probe, {point.x(), point.y(), 0}, sphere.occlusion());
        EXPECT_GT(ratio.minCoeff(), 1 - 0.012);
    }
}

}  // namespace
}  // namespace matchlight
