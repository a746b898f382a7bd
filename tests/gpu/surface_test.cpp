// Surfaces of known answers: furnaces, mirrors, silhouettes, axes, order.
#include "render/surface.h"

#include <gtest/gtest.h>

#include "gl_fixture.h"
#include "render/surface_mesh.h"
#include "render_scene.h"

namespace matchlight {
namespace {

using test::make_probe;
using test::make_sphere;
using test::make_square;
using test::metal;
using test::octant_color;
using test::TestCamera;
using test::uniform_probe;

const Eigen::Vector3d right = Eigen::Vector3d::UnitX();
const Eigen::Vector3d forward = Eigen::Vector3d::UnitY();

ImageF color_of(const SurfacePicture& picture) {
    return picture.color->read<float>({0, 0, picture.width, picture.height}, 4);
}

Eigen::Vector3d rgb(const ImageF& image, int x, int y) {
    return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

class Surface : public GlTest {
protected:
    ShaderLibrary shaders_;
    SurfaceRenderer renderer_{shaders_};
};

class WhiteFurnace : public Surface, public testing::WithParamInterface<std::pair<double, double>> {};

// In light that is 1 everywhere a white surface sends back 1, at every angle, whatever it is made of.
TEST_P(WhiteFurnace, sends_back_all_the_light) {
    const auto [metallic, roughness] = GetParam();
    Model sphere = make_sphere(1);
    sphere.materials[0].metallic = static_cast<float>(metallic);
    sphere.materials[0].roughness = static_cast<float>(roughness);
    renderer_.add_object({.model = &sphere});
    const Environment environment(shaders_, uniform_probe(1));
    const TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    const ImageF image = color_of(renderer_.draw(environment, camera.view()));
    int inside = 0;
    for (int y = 0; y < camera.size; ++y) {
        for (int x = 0; x < camera.size; ++x) {
            const float alpha = image.at(x, y, 3);
            if (alpha == 1) ++inside;
            // Premultiplied: on the edge radiance goes with coverage.
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(x, y, c), alpha, 1e-2) << x << ' ' << y;
        }
    }
    EXPECT_GT(inside, 1000);
}

INSTANTIATE_TEST_SUITE_P(MetallicAndRoughness, WhiteFurnace,
                         testing::Values(std::pair{1.0, 0.0}, std::pair{1.0, 0.3}, std::pair{1.0, 1.0},
                                         std::pair{0.0, 0.0}, std::pair{0.0, 0.5}, std::pair{0.0, 1.0},
                                         std::pair{0.5, 0.7}));

TEST_F(Surface, grey_metal_absorbs_and_nothing_else_is_lost) {
    Model sphere = make_sphere(1);
    sphere.materials[0] = metal(0.0, 0.5);
    renderer_.add_object({.model = &sphere});
    const Environment environment(shaders_, uniform_probe(2));
    const TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    const ImageF image = color_of(renderer_.draw(environment, camera.view()));
    const int centre = camera.size / 2;
    // Schlick's term at normal incidence is F0 itself; the table holds it to 3e-3.
    EXPECT_NEAR(image.at(centre, centre, 0), 1.0, 1e-2);
}

TEST_F(Surface, a_mirror_ball_shows_the_room_in_the_right_directions) {
    Model sphere = make_sphere(1);
    sphere.materials[0] = metal(0.0);
    renderer_.add_object({.model = &sphere});
    const Probe probe = make_probe(1024, octant_color);
    const Environment environment(shaders_, probe);
    // Seen along each axis, and askew.
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d askew = Eigen::Vector3d(0.5, 0.7, -0.4).normalized();
    const TestCamera cameras[] = {
        {.eye = -4 * forward, .forward = forward, .right = right},
        {.eye = 4 * forward, .forward = -forward, .right = -right},
        {.eye = 4 * right, .forward = -right, .right = forward},
        {.eye = 4 * z, .forward = -z, .right = right},
        {.eye = -4 * askew, .forward = askew, .right = askew.cross(z).normalized()},
    };
    for (const TestCamera& camera : cameras) {
        const ImageF image = color_of(renderer_.draw(environment, camera.view()));
        int compared = 0;
        for (int y = 0; y < camera.size; ++y) {
            for (int x = 0; x < camera.size; ++x) {
                const Eigen::Vector3d ray = camera.ray(x, y);
                const auto hit = test::hit_sphere(camera.eye, ray, 1);
                if (!hit || image.at(x, y, 3) < 1) continue;
                const Eigen::Vector3d n = hit->normalized();
                const Eigen::Vector3d reflected = ray - 2 * n.dot(ray) * n;
                // Where a pixel's whole reflection lies in one octant: it turns by 2/cos over a pixel on the ball.
                const double pixel = 4.0 / camera.focal_px / std::max(0.05, -n.dot(ray));
                if (reflected.cwiseAbs().minCoeff() < 3 * pixel) continue;
                ++compared;
                const Eigen::Vector3d expected = octant_color(reflected);
                // White metal: Fresnel is 1 at every angle. Widening by the pixel's own span leaves 2 % of the
                // neighbouring octants at three pixels' distance.
                EXPECT_LT((rgb(image, x, y) - expected).cwiseAbs().maxCoeff(), 0.03) << x << ' ' << y;
            }
        }
        EXPECT_GT(compared, 500);
    }
}

TEST_F(Surface, coverage_integrates_to_the_silhouette_of_the_sphere) {
    const Model sphere = make_sphere(1, 256);
    renderer_.add_object({.model = &sphere});
    const Environment environment(shaders_, uniform_probe(1));
    TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    // A cone of half-angle asin(1/4) cut by the image plane: a disc of radius f·tan.
    const double radius_px = camera.focal_px * std::tan(std::asin(0.25));
    const double expected = std::numbers::pi * radius_px * radius_px;
    for (const int samples : {1, 4}) {
        const ImageF image = color_of(renderer_.draw(environment, camera.view(samples)));
        double area = 0;
        bool partial = false;
        for (int y = 0; y < camera.size; ++y) {
            for (int x = 0; x < camera.size; ++x) {
                area += image.at(x, y, 3);
                partial |= image.at(x, y, 3) > 0 && image.at(x, y, 3) < 1;
            }
        }
        // About 2π·41 edge pixels, each wrong by up to 1/8 with four samples, of random sign: 2 px² of 5360.
        EXPECT_NEAR(area / expected, 1, samples == 1 ? 5e-3 : 2e-3) << samples;
        EXPECT_EQ(partial, samples > 1);
    }
}

TEST_F(Surface, the_picture_is_where_the_camera_puts_it) {
    // A small square off to the right and up: its image lies right of and above the middle, row 0 being the top.
    const Model square = make_square(0.2);
    Eigen::Isometry3d placed = Eigen::Isometry3d::Identity();
    placed.translation() = 0.5 * right + 0.8 * Eigen::Vector3d::UnitZ();
    placed.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, right).toRotationMatrix();  // +z turns to −y, to the eye
    renderer_.add_object({.model = &square, .world_from_model = placed.matrix()});
    const Environment environment(shaders_, uniform_probe(1));
    const TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    const ImageF image = color_of(renderer_.draw(environment, camera.view()));
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();
    double area = 0;
    for (int y = 0; y < camera.size; ++y) {
        for (int x = 0; x < camera.size; ++x) {
            centroid += image.at(x, y, 3) * Eigen::Vector2d(x, y);
            area += image.at(x, y, 3);
        }
    }
    centroid /= area;
    EXPECT_NEAR(centroid.x(), 64 + 160 * 0.5 / 4, 0.1);  // four samples place a straight edge to an eighth of a pixel
    EXPECT_NEAR(centroid.y(), 64 - 160 * 0.8 / 4, 0.1);
}

TEST_F(Surface, back_faces_of_single_sided_meshes_are_not_drawn_even_when_mirrored) {
    Model square = make_square(1);
    Eigen::Matrix4d facing = Eigen::Matrix4d::Identity();  // seen from above, towards +z
    Eigen::Matrix4d mirrored = facing;
    mirrored(0, 0) = -1;
    Eigen::Matrix4d turned = facing;
    turned.topLeftCorner<3, 3>() = Eigen::AngleAxisd(std::numbers::pi, right).toRotationMatrix();
    const Environment environment(shaders_, uniform_probe(1));
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const TestCamera camera{.eye = 4 * z, .forward = -z, .right = right};
    const std::size_t object = renderer_.add_object({.model = &square});
    const auto alpha = [&](const Eigen::Matrix4d& world_from_model) {
        renderer_.place_object(object, world_from_model);
        return color_of(renderer_.draw(environment, camera.view())).at(64, 64, 3);
    };
    EXPECT_EQ(alpha(facing), 1);
    EXPECT_EQ(alpha(mirrored), 1);
    EXPECT_EQ(alpha(turned), 0);
    square.materials[0].double_sided = true;
    renderer_.add_object({.model = &square, .world_from_model = turned});
    EXPECT_EQ(alpha(turned), 1);
}

TEST(ClosedSurface, is_told_from_open_and_inside_out_ones) {
    const ModelMesh sphere = make_sphere(1, 12).meshes[0];
    EXPECT_TRUE(is_closed_outward_surface(sphere));  // along the seam two vertices share each position
    EXPECT_FALSE(is_closed_outward_surface(make_square(1).meshes[0]));
    ModelMesh with_hole = sphere;
    with_hole.indices.resize(with_hole.indices.size() - 3);
    EXPECT_FALSE(is_closed_outward_surface(with_hole));
    ModelMesh inside_out = sphere;
    for (std::size_t i = 0; i < inside_out.indices.size(); i += 3)
        std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
    EXPECT_FALSE(is_closed_outward_surface(inside_out));
    // A hollow ball: the inner shell, wound inwards, shows its front only to those inside; it is not counted as closed.
    ModelMesh hollow = sphere;
    const auto offset = static_cast<std::uint32_t>(hollow.vertices.size());
    for (ModelVertex vertex : inside_out.vertices) {
        for (float& value : vertex.position) value *= 0.5F;
        hollow.vertices.push_back(vertex);
    }
    for (const std::uint32_t index : inside_out.indices) hollow.indices.push_back(index + offset);
    EXPECT_FALSE(is_closed_outward_surface(hollow));
}

TEST_F(Surface, leaving_out_the_back_of_closed_meshes_changes_no_bit) {
    // The same ball, once with a speck of an open triangle inside it, which no one sees but which makes it open.
    Model closed = make_sphere(1);
    closed.materials[0].double_sided = true;
    Model open = closed;
    ModelMesh& mesh = open.meshes[0];
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const float x : {0.F, 0.01F, 0.02F}) {
        ModelVertex vertex = mesh.vertices[0];
        vertex.position = {x, x * x, 0};
        mesh.vertices.push_back(vertex);
    }
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
    EXPECT_TRUE(is_closed_outward_surface(closed.meshes[0]));
    EXPECT_FALSE(is_closed_outward_surface(open.meshes[0]));
    const Environment environment(shaders_, make_probe(128, octant_color));
    SurfaceRenderer other(shaders_);
    renderer_.add_object({.model = &closed});
    other.add_object({.model = &open});
    const Eigen::Vector3d askew = Eigen::Vector3d(0.5, 0.7, -0.4).normalized();
    for (const double distance : {4.0, 0.2}) {  // from outside, and from within
        const TestCamera camera{
            .eye = -distance * askew, .forward = askew, .right = askew.cross(Eigen::Vector3d::UnitZ()).normalized()};
        const ImageF with_culling = color_of(renderer_.draw(environment, camera.view()));
        const ImageF without = color_of(other.draw(environment, camera.view()));
        EXPECT_TRUE(std::ranges::equal(with_culling.samples(), without.samples())) << distance;
        EXPECT_EQ(with_culling.at(64, 64, 3), 1);
    }
}

TEST_F(Surface, sphere_map_and_cube_agree_away_from_the_pole) {
    // Light that changes slowly, so that filtering plays no part.
    const Probe probe =
        make_probe(512, [](const Eigen::Vector3d& d) { return Eigen::Vector3d(1.5 * Eigen::Vector3d::Ones() + d); });
    const Environment environment(shaders_, probe);
    Model sphere = make_sphere(1);
    sphere.materials[0] = metal(0.0);
    renderer_.add_object({.model = &sphere});
    SurfaceRenderer classic(shaders_);
    MaterialOverride chrome;
    chrome.diffuse = {0, 0, 0};
    chrome.specular = {1, 1, 1};
    classic.add_object({.model = &sphere, .material = chrome, .reflection = ReflectionForm::sphere_map});
    // Towards the pole (world −y) the map is stretched around the rim and squeezed across it: a pixel's lookup, as wide
    // as its longer side, blurs more and more. Half the sphere of directions is free of that.
    constexpr double pole_begins = 0.0;
    int compared = 0;
    double worst = 0;
    for (const double side : {-4.0, 4.0}) {
        const TestCamera camera{.eye = side * forward, .forward = forward * (side < 0 ? 1 : -1), .right = right};
        const ImageF cube = color_of(renderer_.draw(environment, camera.view()));
        const ImageF map = color_of(classic.draw(environment, camera.view()));
        for (int y = 0; y < camera.size; ++y) {
            for (int x = 0; x < camera.size; ++x) {
                const Eigen::Vector3d ray = camera.ray(x, y);
                const auto hit = test::hit_sphere(camera.eye, ray, 1);
                if (!hit || cube.at(x, y, 3) < 1) continue;
                const Eigen::Vector3d n = hit->normalized();
                const Eigen::Vector3d reflected = ray - 2 * n.dot(ray) * n;
                const double difference = (rgb(map, x, y) - rgb(cube, x, y)).cwiseAbs().maxCoeff();
                // On the ball's own rim one pixel spans more than 10° of the room.
                if (reflected.y() > pole_begins && -n.dot(ray) > 0.25) worst = std::max(worst, difference);
                // Near the pole it is a wide mean of the light, but still that: within the light's own range.
                EXPECT_GE(rgb(map, x, y).minCoeff(), 0.5 - 1e-3);
                EXPECT_LE(rgb(map, x, y).maxCoeff(), 2.5 + 2e-3);
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 6000);
    EXPECT_LT(worst, 0.03);  // of light from 0.5 to 2.5; half floats and a texel's width of gradient
}

TEST_F(Surface, the_classic_model_is_diffuse_plus_specular_times_environment) {
    const Model sphere = make_sphere(1);
    MaterialOverride material;
    material.diffuse = {0.5, 0.25, 0};
    material.specular = {0.25, 0.5, 0.75};
    const Environment environment(shaders_, uniform_probe(2));
    const TestCamera camera{.eye = -4 * right, .forward = right, .right = -forward};
    for (const ReflectionForm form : {ReflectionForm::sphere_map, ReflectionForm::cube}) {
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &sphere, .material = material, .reflection = form});
        const ImageF image = color_of(renderer.draw(environment, camera.view()));
        // Od·E/π + Ks·L with E = π·L = 2π.
        EXPECT_LT((rgb(image, 64, 64) - Eigen::Vector3d(1.5, 1.5, 1.5)).norm(), 5e-3);
    }
}

TEST_F(Surface, blended_objects_lie_over_what_is_behind_them_in_any_order_of_adding) {
    Model near_square = make_square(1);
    near_square.materials[0].alpha_mode = AlphaMode::blend;
    near_square.materials[0].base_color = {1, 0, 0, 0.5F};
    near_square.materials[0].roughness = 1;
    Model far_square = near_square;
    far_square.materials[0].base_color = {0, 1, 0, 0.25F};
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    Eigen::Matrix4d higher = Eigen::Matrix4d::Identity();
    higher(2, 3) = 0.5;
    const Environment environment(shaders_, uniform_probe(1));
    const TestCamera camera{.eye = 4 * z, .forward = -z, .right = right};
    std::vector<Eigen::Vector3d> seen;
    for (const bool near_first : {true, false}) {
        SurfaceRenderer renderer(shaders_);
        if (near_first) renderer.add_object({.model = &near_square, .world_from_model = higher, .id = 1});
        renderer.add_object({.model = &far_square, .id = 2});
        if (!near_first) renderer.add_object({.model = &near_square, .world_from_model = higher, .id = 1});
        const ImageF image = color_of(renderer.draw(environment, camera.view()));
        EXPECT_NEAR(image.at(64, 64, 3), 1 - 0.5 * 0.75, 1e-3);
        seen.push_back(rgb(image, 64, 64));
    }
    EXPECT_EQ(seen[0], seen[1]);
    // Red covers half; green's quarter is seen through the other half. Both carry the 4 % of a dielectric's reflection
    // besides their colour.
    EXPECT_NEAR(seen[0].x(), 0.5 + 0.125 * 0.04, 0.02);
    EXPECT_NEAR(seen[0].y(), 0.125 + 0.5 * 0.04, 0.02);
}

TEST_F(Surface, masked_textures_cut_and_srgb_is_decoded) {
    Model square = make_square(1);
    ModelTexture texture;
    texture.name = "halves";
    texture.rgba = Image8(2, 2, 4, 255);
    for (int y = 0; y < 2; ++y) {
        texture.rgba.at(0, y, 3) = 0;                                // the left half is cut away
        for (int c = 0; c < 3; ++c) texture.rgba.at(1, y, c) = 188;  // sRGB 188 is 0.5029 in linear light
    }
    square.textures.push_back(texture);
    square.materials[0] = {};
    square.materials[0].alpha_mode = AlphaMode::mask;
    square.materials[0].texture(MaterialSlot::base_color) = 0;
    square.materials[0].metallic = 1;
    square.materials[0].roughness = 0;
    renderer_.add_object({.model = &square});
    const Environment environment(shaders_, uniform_probe(1));
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const TestCamera camera{.eye = 4 * z, .forward = -z, .right = right};
    const ImageF image = color_of(renderer_.draw(environment, camera.view()));
    EXPECT_EQ(image.at(64 - 10, 64, 3), 0);
    EXPECT_EQ(image.at(64 + 10, 64, 3), 1);
    EXPECT_NEAR(image.at(64 + 10, 64, 0), 0.5029, 5e-3);
}

TEST_F(Surface, a_normal_map_turns_the_reflection) {
    Model square = make_square(1);
    square.materials[0] = metal(0.0);
    square.materials[0].texture(MaterialSlot::normal) = 0;
    ModelTexture texture;
    texture.name = "tilt";
    texture.rgba = Image8(1, 1, 4, 255);
    // Tilted by 30° towards the tangent (+x): (sin, 0, cos).
    texture.rgba.at(0, 0, 0) =
        static_cast<std::uint8_t>(std::lround((0.5 + 0.5 * std::sin(std::numbers::pi / 6)) * 255));
    texture.rgba.at(0, 0, 1) = 128;
    texture.rgba.at(0, 0, 2) =
        static_cast<std::uint8_t>(std::lround((0.5 + 0.5 * std::cos(std::numbers::pi / 6)) * 255));
    square.textures.push_back(texture);
    renderer_.add_object({.model = &square});
    const Probe probe =
        make_probe(512, [](const Eigen::Vector3d& d) { return Eigen::Vector3d(1.5 * Eigen::Vector3d::Ones() + d); });
    const Environment environment(shaders_, probe);
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const TestCamera camera{.eye = 4 * z, .forward = -z, .right = right};
    const ImageF image = color_of(renderer_.draw(environment, camera.view()));
    // Seen straight down, a mirror tilted by 30° shows what lies 60° from the zenith.
    const Eigen::Vector3d expected(1.5 + std::sin(std::numbers::pi / 3), 1.5, 1.5 + std::cos(std::numbers::pi / 3));
    EXPECT_LT((rgb(image, 64, 64) - expected).cwiseAbs().maxCoeff(), 0.02);  // 8-bit normals: half a degree
}

TEST_F(Surface, normals_too_fine_for_the_picture_widen_what_is_mirrored) {
    // Grooves that tilt by 20° to either side, 64 across the square: a mirror shows what lies 40° from the zenith on
    // both sides, seen far away as much as nearby.
    constexpr int grooves = 64, tilt_deg = 20;
    ModelTexture texture;
    texture.name = "grooves";
    texture.rgba = Image8(2 * grooves, 1, 4, 255);
    for (int x = 0; x < 2 * grooves; ++x) {
        const double tilt = (x % 2 == 0 ? tilt_deg : -tilt_deg) * std::numbers::pi / 180;
        const double code[] = {std::sin(tilt), 0, std::cos(tilt)};
        for (int c = 0; c < 3; ++c)
            texture.rgba.pixel(x, 0)[c] = static_cast<std::uint8_t>(std::lround(127.5 * (code[c] + 1)));
    }
    texture.sampling.is_smooth_near = false;
    const Probe probe = make_probe(512, [](const Eigen::Vector3d& d) {
        const double above = std::acos(std::clamp(d.z(), -1.0, 1.0)) * 180 / std::numbers::pi;
        return Eigen::Vector3d::Constant(std::abs(above - 40) < 15 ? 1 : 0.02).eval();
    });
    const Environment environment(shaders_, probe);
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const auto mean_light = [&](bool with_grooves, double distance_m, int size) {
        Model square = make_square(1);
        square.materials[0] = metal(0.1);
        if (with_grooves) square.materials[0].texture(MaterialSlot::normal) = 0;
        square.textures.push_back(texture);
        SurfaceRenderer renderer(shaders_);
        renderer.add_object({.model = &square});
        TestCamera camera{.eye = distance_m * z, .forward = -z, .right = right};
        camera.size = size;
        const ImageF image = color_of(renderer.draw(environment, camera.view()));
        double sum = 0;
        int pixels = 0;
        for (int y = size / 2 - 4; y <= size / 2 + 4; ++y) {
            for (int x = size / 2 - 4; x <= size / 2 + 4; ++x, ++pixels) sum += image.at(x, y, 0);
        }
        return sum / pixels;
    };
    const double nearby = mean_light(true, 0.05, 129), far = mean_light(true, 4, 129), flat = mean_light(false, 4, 129);
    EXPECT_GT(nearby, 0.8);  // each groove mirrors the bright ring
    EXPECT_LT(flat, 0.1);
    EXPECT_GT(far, 0.3);  // as widely as a round lobe spreads what two directions send
}

TEST_F(Surface, layers_hold_depth_normal_and_object) {
    const Model sphere = make_sphere(1, 192);
    renderer_.add_object({.model = &sphere, .id = 7});
    const TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    const SurfacePicture picture = renderer_.draw_layers(camera.view());
    const Region all{0, 0, camera.size, camera.size};
    const ImageF depth_m = picture.depth_m->read<float>(all, 1);
    const ImageF normal = picture.normal->read<float>(all, 3);
    const auto id = picture.object_id->read<std::uint32_t>(all, 1);
    for (int y = 0; y < camera.size; y += 4) {
        for (int x = 0; x < camera.size; x += 4) {
            const Eigen::Vector3d ray = camera.ray(x, y);
            const auto hit = test::hit_sphere(camera.eye, ray, 1);
            if (!hit) {
                EXPECT_EQ(id.at(x, y), 0U);
                EXPECT_EQ(depth_m.at(x, y), 0);
                continue;
            }
            if (-hit->dot(ray) < 0.2) continue;  // the rim, where facets show
            EXPECT_EQ(id.at(x, y), 7U);
            EXPECT_NEAR(depth_m.at(x, y), (*hit - camera.eye).dot(camera.forward), 1e-3);
            EXPECT_LT((rgb(normal, x, y) - *hit).norm(), 2e-3);
        }
    }
}

TEST_F(Surface, a_view_of_a_part_equals_that_part_of_the_whole) {
    const Model sphere = make_sphere(1);
    renderer_.add_object({.model = &sphere});
    const Probe probe = make_probe(256, octant_color);
    const Environment environment(shaders_, probe);
    const TestCamera camera{.eye = -4 * forward, .forward = forward, .right = right};
    const ImageF whole = color_of(renderer_.draw(environment, camera.view()));
    PinholeView pinhole;
    pinhole.fx = pinhole.fy = camera.focal_px;
    pinhole.cx = pinhole.cy = 64;
    pinhole.origin_x = 30;
    pinhole.origin_y = 50;
    pinhole.width = 40;
    pinhole.height = 24;
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
    camera_from_world.linear() = camera.world_from_camera().transpose();
    camera_from_world.translation() = -(camera_from_world.linear() * camera.eye);
    SurfaceView view = camera.view();
    view.clip_from_world = clip_from_camera(pinhole) * camera_from_world.matrix();
    view.width = 40;
    view.height = 24;
    const ImageF part = color_of(renderer_.draw(environment, view));
    double worst = 0;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 40; ++x) {
            worst = std::max(worst, (rgb(part, x, y) - rgb(whole, x + 30, y + 50)).cwiseAbs().maxCoeff());
        }
    }
    // Other rounding of the same positions; on an octant's border a texel's width of it.
    EXPECT_LT(worst, 0.02);
}

TEST_F(Surface, bounds_and_casters_follow_the_placement) {
    Model sphere = make_sphere(1);
    Eigen::Matrix4d placed = Eigen::Matrix4d::Identity();
    placed(0, 3) = 5;
    renderer_.add_object({.model = &sphere, .world_from_model = placed});
    Model ghost = make_sphere(1);
    ghost.materials[0].alpha_mode = AlphaMode::blend;
    ghost.materials[0].base_color[3] = 0.2F;
    renderer_.add_object({.model = &ghost});
    renderer_.add_object({.model = &sphere, .casts_shadow = false});
    EXPECT_NEAR(renderer_.bounds_m().min().x(), -1, 1e-6);
    EXPECT_NEAR(renderer_.shadow_caster_bounds_m().min().x(), 4, 1e-6);
    EXPECT_NEAR(renderer_.shadow_caster_bounds_m().max().x(), 6, 1e-6);
}

}  // namespace
}  // namespace matchlight
