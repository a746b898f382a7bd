// Other people's models: triangle counts and bounds against values computed from the files by other means.
#include <cmath>

#include "model_test.h"
#include "scene/model_pose.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

TEST(SampleModel, KeepsTheNormalsOfItsFile) {
    Warnings warnings;
    warnings.set_quiet(true);
    const Model model = load_model(std::string(MATCHLIGHT_SOURCE_DIR) + "/samples/table/objects.glb", warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(model.triangle_count(), 30912u);
    ASSERT_EQ(model.meshes.size(), 3u);
    std::vector<std::string> names;
    for (const ModelMesh& mesh : model.meshes)
        names.push_back(model.materials[static_cast<std::size_t>(mesh.material)].name);
    EXPECT_THAT(names, testing::ElementsAre("chrome", "head", "ring"));
    // The ball's are those of the sphere, so they are exact where the facets' own would be off by a degree.
    const ModelMesh& ball = model.meshes[0];
    Eigen::AlignedBox3d box;
    for (const ModelVertex& vertex : ball.vertices) box.extend(position_of(vertex));
    const double radius = box.sizes().z() / 2;
    double worst = 0;
    for (const ModelVertex& vertex : ball.vertices) {
        worst = std::max(worst, (normal_of(vertex) - (position_of(vertex) - box.center()) / radius).norm());
    }
    EXPECT_LT(worst, 1e-3);
}

struct KnownModel {
    const char* file;
    std::size_t triangles;
    std::size_t without_area;
    std::array<double, 3> low, high;  // metres, world axes
};

// Walked with numpy: accessors by hand, node matrices multiplied, axes turned; triangles with two equal corners are
// counted apart, and vertices that no other triangle uses do not count for the bounds.
const KnownModel known_models[] = {
    {"real/models/2CylinderEngine.glb",
     110336,
     11160,
     {-371.69226, -128.00000, -180.97156},
     {371.69217, 139.99999, 92.04156}},
    {"real/models/AlphaBlendModeTest.glb", 61, 0, {-4.30000, -0.55000, -0.10000}, {4.30000, 0.75000, 2.29953}},
    {"real/models/AnisotropyDiscTest.glb", 2788, 0, {-3.68008, -0.00100, 0.08581}, {2.62016, 0.00008, 2.67989}},
    {"real/models/AnisotropyRotationTest.glb", 13876, 0, {-5.55602, -1.00000, -3.53637}, {6.67531, 1.00000, 2.47140}},
    {"real/models/AnisotropyStrengthTest.glb", 97240, 0, {-4.17014, -0.40000, -0.98727}, {3.40000, 0.40000, 6.40000}},
    {"real/models/AttenuationTest.glb", 292, 0, {-10.00000, -2.00000, -10.00000}, {10.00000, 2.00000, 10.00000}},
    {"real/models/BoxTextured.glb", 12, 0, {-0.50000, -0.50000, -0.50000}, {0.50000, 0.50000, 0.50000}},
    {"real/models/BoxVertexColors.glb", 12, 0, {-0.50000, -0.50000, -0.50000}, {0.50000, 0.50000, 0.50000}},
    {"real/models/CesiumMilkTruck.glb", 3624, 0, {-2.43091, -1.39600, 0.00145}, {2.43800, 1.39600, 2.58437}},
    {"real/models/ClearCoatTest/ClearCoatTest.gltf",
     37116,
     0,
     {-7.35780, -1.05000, -6.25000},
     {3.10000, 0.06000, 6.85452}},
    {"real/models/DamagedHelmet.glb", 15452, 0, {-0.94746, -0.81285, -0.90097}, {0.94250, 1.18716, 0.90100}},
    {"real/models/Duck.glb", 4212, 0, {-0.69298, -0.53925, 0.09929}, {0.96180, 0.61328, 1.63970}},
    {"real/models/FlightHelmet/FlightHelmet.gltf",
     94722,
     0,
     {-0.20364, -0.20003, -0.00002},
     {0.16294, 0.17155, 0.71600}},
    {"real/models/OrientationTest.glb", 524, 0, {-5.33065, -5.33065, -5.33065}, {5.33065, 5.33065, 5.33065}},
    {"real/models/meshes/nefertiti.obj", 99938, 0, {-119.323, -247.337, -181.293}, {119.363, 247.268, 181.241}},
    {"real/models/meshes/ogre.obj", 124004, 4, {-15.610, -4.267, -0.008192}, {15.610, 5.456, 32.030}},
    {"real/models/meshes/spot.obj", 5856, 0, {-0.471552, -1.049, -0.736784}, {0.471552, 0.668909, 0.953646}},
    {"real/models/meshes/stanford-bunny.obj", 69451, 0, {-0.09469, -0.0588, 0.032987}, {0.061009, 0.061874, 0.187321}},
    {"real/models/meshes/suzanne.obj", 968, 0, {-3.86125, -4.95545, 0.267311}, {-1.12688, -3.25233, 2.23606}},
    {"real/models/meshes/teapot.obj", 6320, 0, {-3, -2, 0}, {3.434, 2, 3.15}},
};

class RealModels : public testing::Test {
protected:
    void SetUp() override {
        const char* data = std::getenv("MATCHLIGHT_DATA");
        if (data == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA does not name the data folder";
        data_ = data;
        warnings_.set_quiet(true);
    }
    std::filesystem::path data_;
    Warnings warnings_;
};

TEST_F(RealModels, HaveTheirTrianglesInTheirPlaces) {
    for (const KnownModel& known : known_models) {
        Warnings warnings;
        warnings.set_quiet(true);
        const Model model = load_model(data_ / known.file, warnings);
        EXPECT_EQ(model.triangle_count(), known.triangles) << known.file;
        // The bounds above have five decimals, OBJ's six significant digits.
        const double tolerance = 1e-5 * std::max(1.0, model.bounds_m.sizes().maxCoeff());
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(model.bounds_m.min()[axis], known.low[static_cast<std::size_t>(axis)], tolerance) << known.file;
            EXPECT_NEAR(model.bounds_m.max()[axis], known.high[static_cast<std::size_t>(axis)], tolerance)
                << known.file;
        }
        std::size_t dropped = 0;
        for (const auto& warning : warnings.entries()) {
            const std::size_t at = warning.text.find(" triangles without area");
            if (at == std::string::npos) continue;
            dropped = std::stoul(warning.text.substr(warning.text.rfind(' ', at - 1) + 1));
        }
        EXPECT_EQ(dropped, known.without_area) << known.file;
        for (const ModelMesh& mesh : model.meshes) {
            for (const ModelVertex& vertex : mesh.vertices) {
                ASSERT_NEAR(normal_of(vertex).norm(), 1, 1e-5) << known.file;
                ASSERT_TRUE(std::isfinite(vertex.uv[0]) && std::isfinite(vertex.tangent[0])) << known.file;
            }
        }
    }
}

TEST_F(RealModels, TheFoxMovesAsItsFileSays) {
    // Keys, joints and weights followed with numpy: the mean of all corners, and two of them.
    struct Pose {
        const char* animation;
        double time_s;
        Vector3d sum, first, thousandth;
    };
    const Pose poses[] = {
        {"Survey",
         0,
         {-5644.65156063, 4892.93164201, 55588.6203181},
         {2.05521592, 20.55247379, 33.48856295},
         {7.03364402, -23.10144498, 27.52571707}},
        {"Walk",
         0.3,
         {-88.87558858, 2012.76043344, 59353.64725075},
         {1.94988011, 21.89386249, 33.14064948},
         {7.01332149, -22.26284632, 27.27157855}},
        {"Run",
         0.5,
         {181.17385769, 10290.68999071, 64375.4466932},
         {3.01368538, 28.3519801, 32.50791835},
         {7.96436465, -34.60104219, 30.3770475}},
    };
    const Model fox = load_model(data_ / "real/models/Fox.glb", warnings_);
    for (const Pose& pose : poses) {
        PosedModel posed(fox, pose.animation, "Fox.glb");
        ASSERT_TRUE(posed.moves());
        const ModelMesh& mesh = posed.at(pose.time_s).at(0);
        ASSERT_EQ(mesh.indices.size(), 1728u);
        const auto corner = [&](std::size_t i) { return position_of(mesh.vertices[mesh.indices[i]]); };
        Vector3d sum = Vector3d::Zero();
        for (std::size_t i = 0; i < mesh.indices.size(); ++i) sum += corner(i);
        // Times are floats, and so are positions of up to 100 units.
        EXPECT_LT((sum - pose.sum).norm() / 1728, 2e-5) << pose.animation;
        EXPECT_LT((corner(0) - pose.first).norm(), 2e-5) << pose.animation;
        EXPECT_LT((corner(1000) - pose.thousandth).norm(), 2e-5) << pose.animation;
    }
}

TEST_F(RealModels, HaveTheirTextures) {
    const Model helmet = load_model(data_ / "real/models/DamagedHelmet.glb", warnings_);
    EXPECT_EQ(helmet.textures.size(), 5u);
    const ModelMaterial& material = helmet.materials[0];
    for (const int slot : {material.texture(MaterialSlot::base_color),
                           material.texture(MaterialSlot::metallic_roughness), material.texture(MaterialSlot::normal),
                           material.texture(MaterialSlot::emissive), material.texture(MaterialSlot::occlusion)}) {
        ASSERT_GE(slot, 0);
        EXPECT_EQ(helmet.textures[static_cast<std::size_t>(slot)].rgba.width(), 2048);
    }
    // A normal map is mostly flat: blue, with red and green around the middle.
    const Image8& normals = helmet.textures[static_cast<std::size_t>(material.texture(MaterialSlot::normal))].rgba;
    double mean[3] = {};
    for (int y = 0; y < normals.height(); y += 16) {
        for (int x = 0; x < normals.width(); x += 16) {
            for (int c = 0; c < 3; ++c) mean[c] += normals.at(x, y, c) / (128.0 * 128.0);
        }
    }
    EXPECT_NEAR(mean[0], 128, 8);
    EXPECT_NEAR(mean[1], 128, 8);
    EXPECT_GT(mean[2], 220);
    for (const ModelVertex& vertex : helmet.meshes[0].vertices) ASSERT_NEAR(tangent_of(vertex).norm(), 1, 1e-5);

    EXPECT_EQ(load_model(data_ / "real/models/FlightHelmet/FlightHelmet.gltf", warnings_).textures.size(), 15u);
    EXPECT_EQ(load_model(data_ / "real/models/Duck.glb", warnings_).textures.size(), 1u);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(RealModels, ShowVertexColoursAndAlphaModes) {
    const Model box = load_model(data_ / "real/models/BoxVertexColors.glb", warnings_);
    Eigen::AlignedBox3d colors;
    for (const ModelVertex& vertex : box.meshes[0].vertices) {
        colors.extend(Vector3d(vertex.color[0], vertex.color[1], vertex.color[2]));
    }
    EXPECT_TRUE(colors.sizes().minCoeff() > 0.9);  // its corners span the colour cube
    const Model alpha = load_model(data_ / "real/models/AlphaBlendModeTest.glb", warnings_);
    std::map<std::string, std::pair<AlphaMode, float>> modes;
    for (const ModelMaterial& material : alpha.materials)
        modes[material.name] = {material.alpha_mode, material.alpha_cutoff};
    EXPECT_EQ(modes["MatOpaque"].first, AlphaMode::opaque);
    EXPECT_EQ(modes["MatBlend"].first, AlphaMode::blend);
    EXPECT_EQ(modes["MatCutoff25"], std::pair(AlphaMode::mask, 0.25f));
    EXPECT_EQ(modes["MatCutoffDefault"], std::pair(AlphaMode::mask, 0.5f));
    EXPECT_EQ(modes["MatCutoff75"], std::pair(AlphaMode::mask, 0.75f));
}

}  // namespace
}  // namespace matchlight
