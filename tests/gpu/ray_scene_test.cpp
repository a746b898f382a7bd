// Rays on the GPU against the same rays in double precision.
#include "render/ray_scene.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "gl/shader_library.h"
#include "gl_fixture.h"
#include "render_scene.h"
#include "scene/ray_caster.h"

namespace matchlight {
namespace {

struct Ray {
    Eigen::Vector3d origin_m, direction;
};

struct PlacedModel {
    Model model;
    Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
};

class RaySceneTest : public GlTest {
protected:
    /// Distances, −1 where nothing is met.
    static std::vector<double> on_the_gpu(const std::vector<PlacedModel>& models, const std::vector<Ray>& rays) {
        RayScene scene;
        std::vector<Eigen::Matrix4d> placements;
        for (const PlacedModel& placed : models) {
            scene.add_object(placed.model, {}, false);
            placements.push_back(placed.world_from_model);
        }
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
        Program& program = shaders.compute("../tests/gpu/shaders/nearest_hit.comp");
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
