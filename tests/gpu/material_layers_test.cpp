// Coat, sheen, tinted and stretched reflections: all the light comes back, and as the integrals in double precision
// say.
#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render_scene.h"
#include "report/material_reference.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using test::make_sphere;
using test::TestCamera;
using test::uniform_probe;

struct NamedMaterial {
    const char* name;
    ModelMaterial material;
};

ModelMaterial plain(double base, double metallic, double roughness) {
    ModelMaterial material = test::metal(roughness, base);
    material.metallic = static_cast<float>(metallic);
    return material;
}

/// Of every layer one, white where it has a colour.
std::vector<NamedMaterial> layered(double base, double metallic, double roughness) {
    std::vector<NamedMaterial> all(6, {"", plain(base, metallic, roughness)});
    const auto rough = static_cast<float>(roughness);
    all[0].name = "coat";
    all[0].material.coat = CoatFactors{.strength = 1, .roughness = rough};
    all[1].name = "sheen";
    all[1].material.sheen = SheenFactors{.color = {1, 1, 1}, .roughness = rough};
    all[2].name = "specular";
    all[2].material.specular = SpecularFactors{.strength = 0.5F, .color = {2, 2, 2}};
    all[3].name = "ior";
    all[3].material.ior = 2.4F;
    all[4].name = "anisotropy";
    all[4].material.anisotropy = AnisotropyFactors{.strength = 0.8F, .rotation_rad = 0.5F};
    all[5].name = "all of them";
    for (int i = 0; i < 5; ++i) {
        const ModelMaterial& one = all[static_cast<std::size_t>(i)].material;
        ModelMaterial& sum = all[5].material;
        if (one.coat) sum.coat = one.coat;
        if (one.sheen) sum.sheen = one.sheen;
        if (one.specular) sum.specular = one.specular;
        if (one.ior != 1.5F) sum.ior = one.ior;
        if (one.anisotropy) sum.anisotropy = one.anisotropy;
    }
    return all;
}

class MaterialLayers : public GlTest {
protected:
    /// A ball of radius 1 from a distance of 4 along y, by one sample a pixel.
    ImageF drawn(const ModelMaterial& material, const Environment& environment) {
        Model sphere = make_sphere(1, 48);
        sphere.materials[0] = material;
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &sphere});
        const SurfacePicture picture = renderer.draw(environment, camera_.view(1));
        return picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
    }
    /// The reference where a pixel sees the ball; its tangents go round the z axis.
    Vector3d reference(const ModelMaterial& material, const Vector3d& normal, const RadianceFrom& radiance) const {
        ReferencePoint point;
        point.to_eye = (camera_.eye - normal).normalized();
        const Vector3d tangent = Vector3d::UnitZ().cross(normal).normalized();
        point.world_from_surface << tangent, normal.cross(tangent), normal;
        return material_reference(material, point, radiance, 1024);
    }
    std::optional<Vector3d> normal_at(int x, int y) const {
        return test::hit_sphere(camera_.eye, camera_.ray(x, y), 1);
    }

    ShaderLibrary shaders_;
    const Environment furnace_{shaders_, uniform_probe(1)};
    const TestCamera camera_{
        .eye = {0, -4, 0}, .forward = Vector3d::UnitY(), .right = Vector3d::UnitX(), .size = 65, .focal_px = 80};
};

TEST_F(MaterialLayers, send_back_all_the_light_of_a_white_furnace) {
    for (const double metallic : {0.0, 1.0}) {
        for (const double roughness : {0.05, 0.5, 1.0}) {
            for (const NamedMaterial& next : layered(1, metallic, roughness)) {
                const ImageF image = drawn(next.material, furnace_);
                double worst = 0;
                int inside = 0;
                for (int y = 0; y < camera_.size; ++y) {
                    for (int x = 0; x < camera_.size; ++x) {
                        if (image.at(x, y, 3) < 1) continue;
                        ++inside;
                        for (int c = 0; c < 3; ++c)
                            worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y, c)) - 1));
                    }
                }
                EXPECT_GT(inside, 1000);
                EXPECT_LT(worst, 5e-3) << next.name << " metallic " << metallic << " roughness " << roughness;
            }
        }
    }
}

TEST_F(MaterialLayers, absorb_as_much_as_the_reference_in_even_light) {
    const RadianceFrom white = [](const Vector3d&) { return Vector3d::Ones().eval(); };
    for (const double metallic : {0.0, 1.0}) {
        for (const double roughness : {0.2, 0.6}) {
            for (const NamedMaterial& next : layered(0.5, metallic, roughness)) {
                const ImageF image = drawn(next.material, furnace_);
                for (const int x : {32, 40, 47}) {
                    const Vector3d expected = reference(next.material, normal_at(x, 36).value(), white);
                    // The tables' interpolation; what is stretched takes the table of a round lobe of the same area.
                    const double tolerance = next.material.anisotropy ? 0.02 : 0.005;
                    EXPECT_NEAR(image.at(x, 36, 0), expected.x(), tolerance)
                        << next.name << " metallic " << metallic << " roughness " << roughness << " at " << x;
                }
            }
        }
    }
}

/// Glass of a thickness, in units of the ball's radius; 0: a thin wall.
ModelMaterial glass(double roughness, double thickness) {
    ModelMaterial material = plain(1, 0, roughness);
    material.transmission = TransmissionFactors{.strength = 1, .thickness = static_cast<float>(thickness)};
    return material;
}

TEST_F(MaterialLayers, glass_in_a_white_furnace_is_white) {
    for (const double thickness : {0.0, 2.0}) {
        for (const double roughness : {0.0, 0.3, 1.0}) {
            const ImageF image = drawn(glass(roughness, thickness), furnace_);
            for (int y = 0; y < camera_.size; ++y) {
                for (int x = 0; x < camera_.size; ++x) {
                    if (image.at(x, y, 3) < 1) continue;
                    ASSERT_NEAR(image.at(x, y, 0), 1, 5e-3) << thickness << " " << roughness << " " << x << " " << y;
                }
            }
        }
    }
}

TEST_F(MaterialLayers, glass_absorbs_by_its_thickness) {
    ModelMaterial material = glass(0, 2);
    material.transmission->attenuation_distance = 4;
    material.transmission->attenuation_color = {0.25F, 0.5F, 1};
    const ImageF image = drawn(material, furnace_);
    // Straight through the middle of the ball, two units of thickness are half the distance; 0.04 is mirrored.
    const double expected[] = {0.04 + 0.96 * 0.5, 0.04 + 0.96 * std::sqrt(0.5), 1};
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(32, 32, c), expected[c], 5e-3);
}

// Behind the ball the light rises to the right: a thin wall shows it as it is, a ball of glass turned round.
TEST_F(MaterialLayers, glass_shows_what_is_behind_it) {
    const RadianceFrom light = [](const Vector3d& direction) {
        return Vector3d::Constant(0.5 + 0.4 * direction.x()).eval();
    };
    const Environment probe(shaders_, test::make_probe(128, light));
    const ImageF solid = drawn(glass(0, 2), probe);
    EXPECT_GT(solid.at(20, 32, 0), solid.at(44, 32, 0) + 0.1);
    for (const double roughness : {0.0, 0.4}) {
        const ImageF thin = drawn(glass(roughness, 0), probe);
        for (const int x : {20, 32, 44}) {
            const Vector3d expected = reference(glass(roughness, 0), normal_at(x, 32).value(), light);
            // One look along the middle of a lobe stands for all of it.
            EXPECT_NEAR(thin.at(x, 32, 0), expected.x(), 0.01) << roughness << " at " << x;
        }
    }
}

// A soft lamp at the left, above: what a stretched highlight shows of it depends on how it lies.
TEST_F(MaterialLayers, stretched_highlights_lie_where_the_reference_has_them) {
    const Vector3d lamp = Vector3d(-0.7, -0.6, 0.4).normalized();
    const RadianceFrom light = [&](const Vector3d& direction) {
        return Vector3d::Constant(0.1 + 4 * std::exp(40 * (direction.dot(lamp) - 1))).eval();
    };
    const Environment probe(shaders_, test::make_probe(256, light));
    for (const double rotation : {0.0, 0.8, std::numbers::pi / 2}) {
        ModelMaterial material = test::metal(0.3);
        material.anisotropy = AnisotropyFactors{.strength = 0.8F, .rotation_rad = static_cast<float>(rotation)};
        const ImageF image = drawn(material, probe);
        double error2 = 0, round_error2 = 0, energy = 0;
        ModelMaterial round = material;
        round.anisotropy.reset();
        const ImageF round_image = drawn(round, probe);
        for (int y = 20; y < 45; y += 4) {
            for (int x = 16; x < 50; x += 3) {
                const auto normal = normal_at(x, y);
                if (!normal) continue;
                const double expected = reference(material, *normal, light).x();
                error2 += std::pow(static_cast<double>(image.at(x, y, 0)) - expected, 2);
                round_error2 += std::pow(static_cast<double>(round_image.at(x, y, 0)) - expected, 2);
                energy += expected * expected;
            }
        }
        EXPECT_LT(std::sqrt(error2 / energy), 0.1) << rotation;
        EXPECT_GT(std::sqrt(round_error2 / energy), 0.3) << rotation;
    }
}

TEST_F(MaterialLayers, a_coat_keeps_its_gloss_over_a_rough_base) {
    const Vector3d lamp = Vector3d(-0.5, -0.8, 0.3).normalized();
    const RadianceFrom light = [&](const Vector3d& direction) {
        return Vector3d::Constant(0.1 + 20 * std::exp(60 * (direction.dot(lamp) - 1))).eval();
    };
    const Environment probe(shaders_, test::make_probe(256, light));
    const ModelMaterial bare = plain(0.5, 0, 0.9);
    ModelMaterial coated = bare;
    coated.coat = CoatFactors{.strength = 1, .roughness = 0.1F};
    const ImageF bare_image = drawn(bare, probe), image = drawn(coated, probe);
    double worst = 0, bare_worst = 0, brightest = 0;
    for (int y = 20; y < 45; y += 3) {
        for (int x = 16; x < 50; x += 3) {
            const auto normal = normal_at(x, y);
            if (!normal || image.at(x, y, 3) < 1) continue;
            const double of_bare = reference(bare, *normal, light).x();
            const double of_coated = reference(coated, *normal, light).x();
            brightest = std::max(brightest, of_coated - of_bare);
            bare_worst = std::max(bare_worst, std::abs(static_cast<double>(bare_image.at(x, y, 0)) - of_bare));
            worst = std::max(worst, std::abs(static_cast<double>(image.at(x, y, 0)) - of_coated));
        }
    }
    // The base's own error, of diffuse light by order 2, shows through the coat, which adds little to it.
    EXPECT_LT(worst, bare_worst + 0.05 * brightest);
    EXPECT_GT(brightest, 4 * bare_worst);
}

TEST_F(MaterialLayers, cost_plain_materials_nothing) {
    drawn(plain(0.5, 0, 0.5), furnace_);
    const std::size_t before = shaders_.made_programs().size();
    drawn(layered(0.5, 0, 0.5)[5].material, furnace_);
    EXPECT_EQ(shaders_.made_programs().size(), before + 1);
    // A layer of no strength is none.
    ModelMaterial none = plain(0.5, 0, 0.5);
    none.coat = CoatFactors{};
    none.sheen = SheenFactors{};
    none.anisotropy = AnisotropyFactors{};
    const ImageF with = drawn(none, furnace_), without = drawn(plain(0.5, 0, 0.5), furnace_);
    EXPECT_TRUE(std::ranges::equal(with.samples(), without.samples()));
    EXPECT_EQ(shaders_.made_programs().size(), before + 1);
}

}  // namespace
}  // namespace matchlight
