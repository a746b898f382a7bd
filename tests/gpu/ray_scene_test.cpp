// Rays on the GPU against the same rays in double precision.
#include "render/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "gl/shader_library.h"
#include "gl_fixture.h"
#include "render_scene.h"
#include "scene/ray_caster.h"
#include "scene/sphere_caster.h"
#include "sphere_sets.h"

namespace matchlight {
namespace {

struct Ray {
    Eigen::Vector3d origin_m, direction;
};

struct PlacedModel {
    Model model;
    Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
};

struct PlacedSet {
    SphereSet set;
    RigidTransform world_from_set = RigidTransform::Identity();
};

class RaySceneTest : public GlTest {
protected:
    /// Distances, −1 where nothing is met.
    static std::vector<double> on_the_gpu(const std::vector<PlacedModel>& models, const std::vector<Ray>& rays,
                                          const std::vector<PlacedSet>& sets = {}) {
        RayScene scene;
        std::vector<Eigen::Matrix4d> placements;
        const auto add_sets = [&](std::span<const PlacedSet> some) {
            for (const PlacedSet& placed : some) {
                scene.add_spheres(placed.set, {});
                placements.push_back(placed.world_from_set.matrix());
            }
        };
        // One before the models, the others after: objects keep their order.
        const std::size_t before = std::min<std::size_t>(sets.size(), 1);
        add_sets(std::span(sets).first(before));
        for (const PlacedModel& placed : models) {
            scene.add_object(placed.model, {}, false);
            placements.push_back(placed.world_from_model);
        }
        add_sets(std::span(sets).subspan(before));
        scene.finish();
        scene.place(placements);
        std::vector<float> values;
        for (const Ray& ray : rays) {
            for (const Eigen::Vector3d& v : {ray.origin_m, ray.direction}) {
                for (int axis = 0; axis < 3; ++axis) values.push_back(static_cast<float>(v[axis]));
                values.push_back(0);
            }
        }
        const Buffer in{std::span<const float>(values)};
        const Buffer out(rays.size() * 4 * sizeof(float));
        ShaderLibrary shaders;
        Program& program = shaders.compute("../tests/gpu/shaders/nearest_hit.comp",
                                           sets.empty() ? ShaderDefines{} : ShaderDefines{{"RAY_SPHERES", "1"}});
        program.use();
        scene.bind(program);
        in.bind(GL_SHADER_STORAGE_BUFFER, 0);
        out.bind(GL_SHADER_STORAGE_BUFFER, 1);
        program.set("ray_count", static_cast<int>(rays.size()));
        glDispatchCompute(static_cast<GLuint>((rays.size() + 63) / 64), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        std::vector<float> hits(rays.size() * 4);
        out.read(std::span(hits));
        std::vector<double> distances;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            distances.push_back(hits[4 * i]);
            if (hits[4 * i] < 0) continue;
            const Eigen::Vector3d met(hits[4 * i + 1], hits[4 * i + 2], hits[4 * i + 3]);
            const Eigen::Vector3d expected = rays[i].origin_m + hits[4 * i] * rays[i].direction;
            EXPECT_LT((met - expected).norm(), 1e-4 * (1 + expected.norm()));
        }
        return distances;
    }

    static std::vector<double> in_double(const std::vector<PlacedModel>& models, const std::vector<Ray>& rays) {
        RayCaster caster;
        for (const PlacedModel& placed : models) {
            for (const ModelMesh& mesh : placed.model.meshes) {
                std::vector<Eigen::Vector3d> positions;
                for (const ModelVertex& vertex : mesh.vertices) {
                    const Eigen::Vector3d at = Eigen::Vector3f(vertex.position.data()).cast<double>();
                    positions.emplace_back((placed.world_from_model * at.homogeneous()).hnormalized());
                }
                caster.add_mesh(positions, mesh.indices);
            }
        }
        caster.build();
        std::vector<double> distances;
        for (const Ray& ray : rays) {
            const auto hit = caster.nearest(ray.origin_m, ray.direction, 0);
            distances.push_back(hit ? hit->distance_m : -1);
        }
        return distances;
    }
};

std::vector<Ray> rays_around(double radius_m, int count) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto point = [&](double scale) {
        return Eigen::Vector3d(scale * Eigen::Vector3d(normal(random), normal(random), normal(random)));
    };
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d from = 3 * radius_m * point(1).normalized();
        rays.push_back({from, point(0.4 * radius_m) - from});
    }
    return rays;
}

TEST_F(RaySceneTest, finds_what_double_precision_finds) {
    std::vector<PlacedModel> models;
    for (const char* shape : {"teapot", "torus", "box"}) models.push_back({make_shape(shape, "scene.toml")});
    models[0].world_from_model.block<3, 1>(0, 3) = Eigen::Vector3d(0.3, 0, 0.2);
    // Scaled unevenly, mirrored, and sheared.
    models[1].world_from_model.topLeftCorner<3, 3>() = Eigen::Vector3d(-1, 0.3, 2).asDiagonal();
    models[2].world_from_model(0, 2) = 0.7;
    models[2].world_from_model.block<3, 1>(0, 3) = Eigen::Vector3d(-0.8, 0.2, -0.1);
    const std::vector<Ray> rays = rays_around(1, 4000);
    const std::vector<double> gpu = on_the_gpu(models, rays), exact = in_double(models, rays);
    int met = 0, otherwise = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        met += exact[i] > 0;
        // A ray within rounding of a silhouette may pass on either side of it.
        otherwise += std::abs(gpu[i] - exact[i]) > 1e-4;
    }
    EXPECT_GT(met, 1000);
    EXPECT_LE(otherwise, 4);
}

TEST_F(RaySceneTest, finds_the_spheres_that_double_precision_finds) {
    std::vector<PlacedModel> models;
    models.push_back({make_shape("box", "scene.toml")});
    models[0].world_from_model.topLeftCorner<3, 3>() *= 0.5;
    std::vector<PlacedSet> sets{{test::random_set(2000, 0.005F, 0.05F)}, {test::random_set(300, 0.02F, 0.1F)}};
    sets[0].world_from_set.translation() = Eigen::Vector3d(0.6, 0.1, 0);
    sets[1].world_from_set.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
    const std::vector<Ray> rays = rays_around(1, 4000);
    const std::vector<double> gpu = on_the_gpu(models, rays, sets), boxes = in_double(models, rays);
    SphereCaster caster;
    for (const PlacedSet& placed : sets) caster.add_set(placed.set, placed.world_from_set);
    int spheres = 0, otherwise = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto sphere = caster.nearest({.origin_m = rays[i].origin_m, .direction = rays[i].direction});
        const bool is_sphere = sphere && (boxes[i] < 0 || sphere->distance < boxes[i]);
        spheres += is_sphere;
        const double expected = is_sphere ? sphere->distance : boxes[i];
        // A ray within rounding of a silhouette may pass on either side of it.
        otherwise += std::abs(gpu[i] - expected) > 1e-4;
    }
    EXPECT_GT(spheres, 500);
    EXPECT_LT(spheres, 3500) << "the box is met, too";
    EXPECT_LE(otherwise, 4);
}

TEST_F(RaySceneTest, what_leaves_a_sphere_does_not_meet_it_again) {
    const std::vector<PlacedSet> sets{{test::set_of({{{0, 0, 0}, 0.3F}, {{100, 0, 0}, 0.3F}})}};
    std::vector<PlacedModel> far_away(1);
    far_away[0].model = test::make_square(1);
    far_away[0].world_from_model(2, 3) = -50;
    std::vector<Ray> rays;
    for (const Ray& ray : rays_around(1, 2000)) {
        const Eigen::Vector3d outward = ray.origin_m.normalized();
        // Just outside and just inside, as floats are, and along the tangent.
        rays.push_back({(0.3 + 1e-7) * outward, outward + 0.999 * outward.unitOrthogonal()});
        rays.push_back({(0.3 - 1e-7) * outward, outward + Eigen::Vector3d(0, 0, 1)});
        rays.push_back({(0.3 + 3e-7) * outward, outward.unitOrthogonal() + 1e-3 * outward});
    }
    int met = 0;
    for (const double distance : on_the_gpu(far_away, rays, sets)) met += distance > 0 && distance < 40;
    EXPECT_EQ(met, 0);
}

TEST_F(RaySceneTest, no_ray_leaves_a_closed_shape_between_its_triangles) {
    std::vector<PlacedModel> models;
    models.push_back({test::make_sphere(0.5, 48)});
    test::turn_inside_out(models[0].model);
    std::vector<Ray> rays = rays_around(1, 8000);
    // Through vertices and along meridians, too.
    for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].origin_m = Eigen::Vector3d::Zero();
        if (i % 2 == 0) {
            const auto& vertices = models[0].model.meshes[0].vertices;
            rays[i].direction = Eigen::Vector3f(vertices[(i * 7) % vertices.size()].position.data()).cast<double>();
        }
    }
    for (const double distance : on_the_gpu(models, rays)) EXPECT_GT(distance, 0);
}

TEST_F(RaySceneTest, a_triangle_edge_on_is_passed_by) {
    Model sliver = test::make_square(1);
    std::vector<PlacedModel> models;
    models.push_back({sliver});
    const std::vector<Ray> rays{{{-2, 0, 0}, {1, 0, 0}}, {{0, 0, 1}, {0, 0, -1}}, {{2, 0.1, 1e-3}, {-1, 0, 0}}};
    const std::vector<double> hits = on_the_gpu(models, rays);
    EXPECT_LT(hits[0], 0);
    EXPECT_NEAR(hits[1], 1, 1e-6);
    EXPECT_LT(hits[2], 0);
}

}  // namespace
}  // namespace matchlight
