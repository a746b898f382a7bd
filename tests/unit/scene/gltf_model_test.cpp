// What glTF files say arrives: places, directions, colours, textures, in every encoding the format has.
#include <cmath>
#include <limits>

#include "media/image_io.h"
#include "model_test.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using testing::HasSubstr;

class GltfModel : public ModelTest {
protected:
    /// A PNG of 2 × 2 pixels: red, green / blue, white.
    std::string four_colours(int channels = 3) {
        Image8 image(2, 2, channels, 255);
        const std::uint8_t colours[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
        for (int i = 0; i < 4; ++i) {
            for (int c = 0; c < 3; ++c) image.at(i % 2, i / 2, c) = colours[i][c];
            if (channels == 4) image.at(i % 2, i / 2, 3) = static_cast<std::uint8_t>(10 + i);
        }
        const auto path = folder_ / "four.png";
        write_png8(path, image);
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static void add_picture(GltfBuilder& builder, const std::string& bytes) {
        const std::size_t view = builder.add_view(bytes);
        builder.root["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
        builder.root["textures"].push_back({{"source", builder.root["images"].size() - 1}});
    }
};

TEST_F(GltfModel, ModelAxesBecomeWorldAxes) {
    const Model model = load(GltfBuilder::triangle());
    ASSERT_EQ(model.triangle_count(), 1u);
    const ModelMesh& mesh = model.meshes[0];
    // glTF's x, y (up) and z (towards the viewer) are the world's x, z and −y.
    EXPECT_EQ(position_of(mesh.vertices[mesh.indices[1]]), Vector3d(1, 0, 0));
    EXPECT_EQ(position_of(mesh.vertices[mesh.indices[2]]), Vector3d(0, 0, 1));
    for (const ModelVertex& vertex : mesh.vertices) {
        EXPECT_TRUE(normal_of(vertex).isApprox(Vector3d(0, -1, 0), 1e-6));
        EXPECT_EQ(vertex.color, (std::array<float, 4>{1, 1, 1, 1}));
        EXPECT_EQ(vertex.tangent, (std::array<float, 4>{0, 0, 0, 0}));
    }
    EXPECT_EQ(model.bounds_m.min(), Vector3d(0, 0, 0));
    EXPECT_EQ(model.bounds_m.max(), Vector3d(1, 0, 1));
    // A file without materials has glTF's default one.
    EXPECT_EQ(model.materials[0].metallic, 1);
    EXPECT_EQ(model.materials[0].roughness, 1);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfModel, NodeTransformsMultiply) {
    GltfBuilder builder = GltfBuilder::triangle();
    const double h = std::sqrt(0.5);
    builder.root["nodes"] = {
        {{"children", {1}}, {"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}},
        {{"mesh", 0}, {"rotation", {0, 0, h, h}}, {"translation", {0, 1, 0}}}};  // 90° about glTF's z
    const Model model = load(builder);
    const ModelMesh& mesh = model.meshes[0];
    // (1,0,0) → turned (0,1,0) → moved (0,2,0) → doubled and moved (10,4,0) → world (10,0,4).
    EXPECT_TRUE(position_of(mesh.vertices[mesh.indices[1]]).isApprox(Vector3d(10, 0, 4), 1e-6));
    EXPECT_TRUE(normal_of(mesh.vertices[0]).isApprox(Vector3d(0, -1, 0), 1e-6));
}

TEST_F(GltfModel, MatricesAreColumnMajor) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
    EXPECT_TRUE(load(builder).bounds_m.min().isApprox(Vector3d(5, -7, 6), 1e-6));
}

TEST_F(GltfModel, MirroredNodesStillFaceOutwards) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"][0]["scale"] = {-1, 1, 1};
    const ModelMesh mesh = load(builder).meshes[0];
    const Vector3d a = position_of(mesh.vertices[mesh.indices[0]]);
    const Vector3d face =
        (position_of(mesh.vertices[mesh.indices[1]]) - a).cross(position_of(mesh.vertices[mesh.indices[2]]) - a);
    EXPECT_TRUE(face.normalized().isApprox(Vector3d(0, -1, 0), 1e-6));
    EXPECT_TRUE(normal_of(mesh.vertices[0]).isApprox(Vector3d(0, -1, 0), 1e-6));
}

TEST_F(GltfModel, UnevenScaleTurnsNormalsAsPlanes) {
    GltfBuilder builder = GltfBuilder::triangle();
    // The plane through (1,0,0), (0,1,0), (0,0,1), stretched along x by 3: x/3 + y + z = 1.
    const std::size_t positions = builder.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1}, 5126, "VEC3");
    const float n = static_cast<float>(std::sqrt(1.0 / 3));
    const std::size_t normals = builder.add<float>({n, n, n, n, n, n, n, n, n}, 5126, "VEC3");
    builder.primitive()["attributes"] = {{"POSITION", positions}, {"NORMAL", normals}};
    builder.root["nodes"][0]["scale"] = {3, 1, 1};
    const Vector3d expected = Vector3d(1.0 / 3, -1, 1).normalized();
    EXPECT_TRUE(normal_of(load(builder).meshes[0].vertices[0]).isApprox(expected, 1e-6));
}

TEST_F(GltfModel, AMeshShownTwiceIsThereTwice) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {3, 0, 0}}}};
    builder.root["scenes"] = {{{"nodes", {0, 1}}}};
    const Model model = load(builder);
    EXPECT_EQ(model.triangle_count(), 2u);
    EXPECT_EQ(model.materials.size(), 1u);
    EXPECT_EQ(model.bounds_m.max().x(), 4);
}

TEST_F(GltfModel, OnlyTheSceneThatIsNamedIsShown) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {3, 0, 0}}}};
    builder.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    builder.root["scene"] = 1;
    EXPECT_EQ(load(builder).bounds_m.min().x(), 3);
    builder.root.erase("scene");
    builder.root.erase("scenes");  // then every root is
    EXPECT_EQ(load(builder).triangle_count(), 2u);
}

TEST_F(GltfModel, MaterialsArrive) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["materials"] = {
        {{"name", "gold"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.9, 0.6, 0.3, 0.5}}, {"metallicFactor", 0.75}, {"roughnessFactor", 0.2}}},
         {"emissiveFactor", {0.1, 0.2, 0.3}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true}}};
    builder.primitive()["material"] = 0;
    const ModelMaterial material = load(builder).materials[0];
    EXPECT_EQ(material.name, "gold");
    EXPECT_EQ(material.base_color, (std::array<float, 4>{0.9f, 0.6f, 0.3f, 0.5f}));
    EXPECT_EQ(material.metallic, 0.75f);
    EXPECT_EQ(material.roughness, 0.2f);
    EXPECT_THAT(material.emissive, testing::ElementsAre(testing::FloatEq(1), testing::FloatEq(2), testing::FloatEq(3)));
    EXPECT_EQ(material.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(material.alpha_cutoff, 0.25f);
    EXPECT_TRUE(material.double_sided);

    builder.root["materials"][0]["alphaMode"] = "BLEND";
    builder.root["materials"][0]["doubleSided"] = false;
    EXPECT_EQ(load(builder).materials[0].alpha_mode, AlphaMode::blend);
    EXPECT_FALSE(load(builder).materials[0].double_sided);
}

TEST_F(GltfModel, LayersArrive) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["materials"] = {
        {{"extensions",
          {{"KHR_materials_clearcoat",
            {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.25}, {"clearcoatNormalTexture", {{"index", 0}}}}},
           {"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0.25, 2}}, {"sheenRoughnessFactor", 0.75}}},
           {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 0}}}},
           {"KHR_materials_ior", {{"ior", 1.25}}},
           {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyRotation", 1}}}}}}};
    add_picture(builder, four_colours());
    builder.primitive()["material"] = 0;
    const ModelMaterial material = load(builder).materials[0];
    ASSERT_TRUE(material.coat && material.sheen && material.specular && material.anisotropy);
    EXPECT_EQ(material.coat->strength, 0.5f);
    EXPECT_EQ(material.coat->roughness, 0.25f);
    EXPECT_EQ(material.texture(MaterialSlot::coat_normal), 0);
    EXPECT_EQ(material.sheen->color, (Rgb{0.5f, 0.25f, 1}));
    EXPECT_EQ(material.sheen->roughness, 0.75f);
    EXPECT_EQ(material.specular->strength, 0.5f);
    EXPECT_EQ(material.specular->color, (Rgb{2, 1, 0}));
    EXPECT_EQ(material.ior, 1.25f);
    EXPECT_EQ(material.anisotropy->strength, 0.5f);
    EXPECT_EQ(material.anisotropy->rotation_rad, 1);
    builder.root["materials"][0]["extensions"]["KHR_materials_ior"]["ior"] = 0.5;
    EXPECT_THAT(error_of(builder), HasSubstr("ior is below 1"));
}

TEST_F(GltfModel, TexturesArriveTheRightWayUp) {
    GltfBuilder builder = GltfBuilder::triangle();
    add_picture(builder, four_colours());
    builder.primitive()["attributes"]["TEXCOORD_0"] = builder.add<float>({0, 0.75f, 1, 1, 0.25f, 0}, 5126, "VEC2");
    builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.primitive()["material"] = 0;
    const Model model = load(builder);
    ASSERT_EQ(model.materials[0].texture(MaterialSlot::base_color), 0);
    const ModelTexture& texture = model.textures[0];
    EXPECT_EQ(texture.rgba.channels(), 4);
    EXPECT_EQ(texture.rgba.at(0, 0, 0), 255);  // red at the top left, v = 0
    EXPECT_EQ(texture.rgba.at(0, 0, 1), 0);
    EXPECT_EQ(texture.rgba.at(0, 1, 2), 255);  // blue at the bottom left
    EXPECT_EQ(texture.rgba.at(0, 1, 3), 255);
    EXPECT_TRUE(texture.sampling == TextureSampling{});
    const ModelMesh& mesh = model.meshes[0];
    EXPECT_EQ(mesh.vertices[mesh.indices[0]].uv, (std::array<float, 2>{0, 0.75f}));
    EXPECT_EQ(mesh.vertices[mesh.indices[2]].uv, (std::array<float, 2>{0.25f, 0}));
}

TEST_F(GltfModel, AlphaOfTexturesIsNotMultipliedIn) {
    GltfBuilder builder = GltfBuilder::triangle();
    add_picture(builder, four_colours(4));
    builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.primitive()["material"] = 0;
    const Model model = load(builder);
    const Image8& pixels = model.textures.at(0).rgba;
    EXPECT_EQ(pixels.at(0, 0, 0), 255);
    EXPECT_EQ(pixels.at(0, 0, 3), 10);
    EXPECT_EQ(pixels.at(1, 1, 2), 255);
    EXPECT_EQ(pixels.at(1, 1, 3), 13);
}

TEST_F(GltfModel, EverySlotAndSamplerArrives) {
    GltfBuilder builder = GltfBuilder::triangle();
    for (int i = 0; i < 5; ++i) add_picture(builder, four_colours());
    builder.root["samplers"] = {{{"wrapS", 33071}, {"wrapT", 10497}}};
    builder.root["textures"][1]["sampler"] = 0;
    builder.primitive()["attributes"]["TEXCOORD_0"] = builder.add<float>({0, 1, 1, 1, 0, 0}, 5126, "VEC2");
    builder.root["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
         {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
         {"occlusionTexture", {{"index", 3}, {"strength", 0.25}}},
         {"emissiveTexture", {{"index", 4}}},
         {"emissiveFactor", {1, 1, 1}}}};
    builder.primitive()["material"] = 0;
    const Model model = load(builder);
    const ModelMaterial& material = model.materials[0];
    std::set<int> slots = {material.texture(MaterialSlot::base_color),
                           material.texture(MaterialSlot::metallic_roughness), material.texture(MaterialSlot::normal),
                           material.texture(MaterialSlot::occlusion), material.texture(MaterialSlot::emissive)};
    EXPECT_EQ(slots, (std::set<int>{0, 1, 2, 3, 4}));
    EXPECT_EQ(material.normal_scale, 0.5f);
    EXPECT_EQ(material.occlusion_strength, 0.25f);
    const auto& clamped = model.textures[static_cast<std::size_t>(material.texture(MaterialSlot::metallic_roughness))];
    EXPECT_EQ(clamped.sampling.wrap_u, TextureWrap::clamp);
    EXPECT_EQ(clamped.sampling.wrap_v, TextureWrap::repeat);
    // With a normal map there are tangents: u runs along glTF's x, and up in the picture is up.
    for (const ModelVertex& vertex : model.meshes[0].vertices) {
        EXPECT_TRUE(tangent_of(vertex).isApprox(Vector3d::UnitX(), 1e-6));
        EXPECT_EQ(vertex.tangent[3], 1);
    }
}

TEST_F(GltfModel, TangentsOfTheFileAreKept) {
    GltfBuilder builder = GltfBuilder::triangle();
    add_picture(builder, four_colours());
    builder.primitive()["attributes"]["TEXCOORD_0"] = builder.add<float>({0, 1, 1, 1, 0, 0}, 5126, "VEC2");
    builder.primitive()["attributes"]["TANGENT"] =
        builder.add<float>({0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1}, 5126, "VEC4");
    builder.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    builder.primitive()["material"] = 0;
    const Model shown = load(builder);
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        EXPECT_TRUE(tangent_of(vertex).isApprox(Vector3d::UnitZ(), 1e-6));
        EXPECT_EQ(vertex.tangent[3], -1);
    }
    // Mirrored in x the frame's other hand points the same way in the picture.
    builder.root["nodes"][0]["scale"] = {-1, 1, 1};
    EXPECT_EQ(load(builder).meshes[0].vertices[0].tangent[3], 1);
}

TEST_F(GltfModel, NormalisedIntegersAreRead) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.primitive()["attributes"]["TEXCOORD_0"] =
        builder.add<std::uint16_t>({0, 65535, 13107, 0, 65535, 65535}, 5123, "VEC2");
    builder.root["accessors"].back()["normalized"] = true;
    builder.primitive()["attributes"]["COLOR_0"] =
        builder.add<std::uint8_t>({255, 51, 0, 255, 51, 0, 255, 51, 0}, 5121, "VEC3");
    builder.root["accessors"].back()["normalized"] = true;
    const ModelMesh mesh = load(builder).meshes[0];
    EXPECT_FLOAT_EQ(mesh.vertices[mesh.indices[0]].uv[1], 1);
    EXPECT_FLOAT_EQ(mesh.vertices[mesh.indices[1]].uv[0], 0.2f);
    for (const ModelVertex& vertex : mesh.vertices) {
        EXPECT_FLOAT_EQ(vertex.color[0], 1);
        EXPECT_FLOAT_EQ(vertex.color[1], 0.2f);  // glTF's are linear already
        EXPECT_FLOAT_EQ(vertex.color[3], 1);
    }
}

TEST_F(GltfModel, ColoursWithoutAlphaAreOpaque) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.primitive()["attributes"]["COLOR_0"] =
        builder.add<float>({0.5f, 0.25f, 1, 0.5f, 0.25f, 1, 0.5f, 0.25f, 1}, 5126, "VEC3");
    const Model shown = load(builder);
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        EXPECT_EQ(vertex.color, (std::array<float, 4>{0.5f, 0.25f, 1, 1}));
    }
}

TEST_F(GltfModel, QuantisedPositionsAreRead) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["extensionsRequired"] = {"KHR_mesh_quantization"};
    builder.root["extensionsUsed"] = {"KHR_mesh_quantization"};
    // Each position takes 8 bytes, as the format's alignment wants.
    builder.primitive()["attributes"]["POSITION"] =
        builder.add<std::int16_t>({0, 0, 0, 0, 300, 0, 0, 0, 0, -32767, 0, 0}, 5122, "VEC4");
    json& accessor = builder.root["accessors"].back();
    accessor["type"] = "VEC3";
    builder.root["bufferViews"].back()["byteStride"] = 8;
    const Model model = load(builder);
    EXPECT_EQ(model.bounds_m.max().x(), 300);
    EXPECT_EQ(model.bounds_m.min().z(), -32767);
    accessor["normalized"] = true;
    EXPECT_NEAR(load(builder).bounds_m.min().z(), -1, 1e-6);
}

TEST_F(GltfModel, SparseAccessorsAreRead) {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t indices = builder.add_view(std::string("\x02\x00", 2));
    const float moved[3] = {0, 7, 0};
    const std::size_t values = builder.add_view({reinterpret_cast<const char*>(moved), sizeof moved});
    builder.root["accessors"][0]["sparse"] = {{"count", 1},
                                              {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                              {"values", {{"bufferView", values}}}};
    EXPECT_EQ(load(builder).bounds_m.max(), Vector3d(1, 0, 7));
    builder.root["accessors"][0].erase("bufferView");  // zeros but for the sparse part: no area
    EXPECT_THAT(error_of(builder), HasSubstr("no triangles"));
}

TEST_F(GltfModel, InterleavedBuffersMayEndWithTheirLastElement) {
    GltfBuilder builder = GltfBuilder::triangle();
    // Position and normal side by side; the last normal ends the buffer, 12 bytes short of a whole stride for it.
    const std::vector<float> interleaved = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
    const std::size_t view =
        builder.add_view({reinterpret_cast<const char*>(interleaved.data()), interleaved.size() * sizeof(float)});
    builder.root["bufferViews"][view]["byteStride"] = 24;
    json& second = builder.root["bufferViews"].emplace_back(builder.root["bufferViews"][view]);
    second["byteOffset"] = second["byteOffset"].get<std::size_t>() + 12;
    second["byteLength"] = 60;
    builder.root["accessors"][0] = {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
    builder.root["accessors"][1] = {{"bufferView", view + 1}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
    const Model model = load(builder);
    EXPECT_EQ(model.bounds_m.max(), Vector3d(1, 0, 1));
    EXPECT_TRUE(normal_of(model.meshes[0].vertices[2]).isApprox(Vector3d(0, -1, 0), 1e-6));
}

TEST_F(GltfModel, StripsAndFansAreTriangles) {
    GltfBuilder builder = GltfBuilder::triangle();
    // A square in z = 0, in the order of a strip.
    const std::size_t positions = builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, 5126, "VEC3");
    builder.primitive() = {{"attributes", {{"POSITION", positions}}}, {"mode", 5}};
    const auto faces_forward = [](const Model& model) {
        for (const ModelVertex& vertex : model.meshes[0].vertices) {
            if (!normal_of(vertex).isApprox(Vector3d(0, -1, 0), 1e-6)) return false;
        }
        return model.triangle_count() == 2;
    };
    EXPECT_TRUE(faces_forward(load(builder)));
    builder.primitive()["indices"] = builder.add<std::uint32_t>({0, 1, 3, 2}, 5125, "SCALAR");
    builder.primitive()["mode"] = 6;
    EXPECT_TRUE(faces_forward(load(builder)));
    builder.primitive()["mode"] = 0;
    EXPECT_THAT(error_of(builder), HasSubstr("no triangles"));
    EXPECT_THAT(all_warnings(), HasSubstr("meshes[0].primitives[0] holds no triangles, left out"));
}

TEST_F(GltfModel, MissingNormalsAndCoordinatesAreNoError) {
    GltfBuilder builder = GltfBuilder::triangle();
    add_picture(builder, four_colours());
    builder.primitive()["attributes"].erase("NORMAL");
    builder.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    builder.primitive()["material"] = 0;
    const Model shown = load(builder);
    for (const ModelVertex& vertex : shown.meshes[0].vertices) {
        EXPECT_TRUE(normal_of(vertex).isApprox(Vector3d(0, -1, 0), 1e-6));
        EXPECT_NEAR(tangent_of(vertex).norm(), 1, 1e-6);
    }
}

TEST_F(GltfModel, TrianglesThatAreNotFiniteAreDroppedAndCounted) {
    GltfBuilder builder = GltfBuilder::triangle();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    builder.primitive()["attributes"] = {
        {"POSITION", builder.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0, inf, 0, 0}, 5126, "VEC3")}};
    builder.primitive()["indices"] = builder.add<std::uint16_t>({0, 1, 2, 0, 1, 3, 0, 1, 4, 1, 1, 2}, 5123, "SCALAR");
    const Model model = load(builder);
    EXPECT_EQ(model.triangle_count(), 1u);
    EXPECT_TRUE(model.bounds_m.max().allFinite());
    EXPECT_THAT(all_warnings(), HasSubstr("3 triangles without area or with positions that are not finite, dropped"));
}

TEST_F(GltfModel, MissingAndDamagedTexturesAreLeftOutAndCounted) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["images"] = {{{"uri", "none.png"}}};
    builder.root["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}, json::object()};
    std::string truncated = four_colours();
    truncated.resize(truncated.size() / 2);
    builder.root["images"].push_back(
        {{"bufferView", builder.add_view("no picture at all")}, {"mimeType", "image/png"}});
    builder.root["images"].push_back({{"bufferView", builder.add_view(truncated)}, {"mimeType", "image/png"}});
    builder.root["materials"] = {{{"pbrMetallicRoughness",
                                   {{"baseColorFactor", {0.5, 0.5, 0.5, 1}},
                                    {"baseColorTexture", {{"index", 0}}},
                                    {"metallicRoughnessTexture", {{"index", 3}}}}},
                                  {"normalTexture", {{"index", 1}}},
                                  {"emissiveTexture", {{"index", 2}}}}};
    builder.primitive()["material"] = 0;
    const Model model = load(builder);
    EXPECT_EQ(model.materials[0].texture(MaterialSlot::base_color), -1);
    EXPECT_EQ(model.materials[0].texture(MaterialSlot::normal), -1);
    EXPECT_EQ(model.materials[0].texture(MaterialSlot::emissive), -1);
    EXPECT_EQ(model.materials[0].base_color[0], 0.5f);  // the factor alone
    EXPECT_EQ(warnings_.total(), 4);
    EXPECT_THAT(all_warnings(), HasSubstr("texture 'none.png' is missing, left out"));
}

TEST_F(GltfModel, FilesBesideTheModelAreFound) {
    GltfBuilder builder = GltfBuilder::triangle();
    four_colours();
    write("my parts/größe 1.bin", builder.binary);
    builder.root["images"] = {{{"uri", "four.png"}}};
    builder.root["textures"] = {{{"source", 0}}};
    builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.primitive()["material"] = 0;
    const Model model = load("my model.gltf", builder.text("my%20parts/gr%C3%B6%C3%9Fe%201.bin"));
    EXPECT_EQ(model.name, "my model");
    EXPECT_EQ(model.triangle_count(), 1u);
    EXPECT_EQ(model.textures.size(), 1u);
    EXPECT_EQ(load("raw.gltf", builder.text("./my parts/größe 1.bin")).triangle_count(), 1u);
}

TEST_F(GltfModel, DataUrisAreRead) {
    // 36 bytes of positions: (0,0,0) (1,0,0) (0,1,0), as any base64 encoder writes them.
    const char* text = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
    EXPECT_EQ(load("data.gltf", text).bounds_m.max(), Vector3d(1, 0, 1));
}

TEST_F(GltfModel, WhatIsLeftOutIsSaid) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["extensionsUsed"] = {"KHR_materials_iridescence"};
    load(builder);
    EXPECT_THAT(all_warnings(), HasSubstr("its extension KHR_materials_iridescence is left out"));
}

}  // namespace
}  // namespace matchlight
