// How textures of glTF files lie on a mesh, and how they are read.
#include <cmath>

#include "media/image_io.h"
#include "model_test.h"

namespace matchlight {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::FloatNear;
using testing::HasSubstr;

using Pair = std::array<float, 2>;

class GltfTexture : public ModelTest {
protected:
    GltfTexture() {
        const Image8 image(1, 1, 3, 255);
        const auto path = std::filesystem::temp_directory_path() / ("white" + std::to_string(::getpid()) + ".png");
        write_png8(path, image);
        std::ifstream file(path, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        std::filesystem::remove(path);
        const std::size_t view = builder_.add_view(bytes);
        builder_.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
        builder_.root["textures"] = {{{"source", 0}}};
        for (const char* set : {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"}) {
            // Other coordinates in each set: of the second corner (1, 0), (0.5, 0.25), (0.5, 0.25).
            const bool is_first = set == std::string("TEXCOORD_0");
            builder_.primitive()["attributes"][set] =
                is_first ? builder_.add<float>({0, 0, 1, 0, 0, 1}, 5126, "VEC2")
                         : builder_.add<float>({0.25f, 0.25f, 0.5f, 0.25f, 0.25f, 0.5f}, 5126, "VEC2");
        }
        builder_.primitive()["material"] = 0;
    }

    static json texture(int set, const json& transform = {}) {
        json info = {{"index", 0}, {"texCoord", set}};
        if (!transform.is_null()) info["extensions"]["KHR_texture_transform"] = transform;
        return info;
    }
    Model with(const json& base, const json& occlusion, const json& emissive = {}) {
        json material = {{"pbrMetallicRoughness", {{"baseColorTexture", base}}}, {"occlusionTexture", occlusion}};
        if (!emissive.is_null()) material["emissiveTexture"] = emissive;
        builder_.root["materials"] = {material};
        return load(builder_);
    }
    /// Where the file's second corner lies on a texture.
    static Pair corner(const Model& model, MaterialSlot slot) {
        const ModelMesh& mesh = model.meshes.at(0);
        const ModelVertex& vertex = mesh.vertices.at(mesh.indices.at(1));
        return model.materials.at(0).use(slot).mapping(vertex.uv, vertex.uv_second);
    }
    static auto near(double u, double v) {
        return ElementsAre(FloatNear(static_cast<float>(u), 1e-6F), FloatNear(static_cast<float>(v), 1e-6F));
    }

    GltfBuilder builder_ = GltfBuilder::triangle();
};

TEST_F(GltfTexture, LiesOnTheCoordinatesThatItNames) {
    const Model model = with(texture(1), texture(0));
    EXPECT_THAT(corner(model, MaterialSlot::base_color), near(0.5, 0.25));
    EXPECT_THAT(corner(model, MaterialSlot::occlusion), near(1, 0));
    // The base colour's are the vertices' own, so that what only asks for alpha needs no second pair.
    EXPECT_TRUE(model.materials[0].use(MaterialSlot::base_color).mapping.is_plain());
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfTexture, IsScaledTurnedAndMoved) {
    const json transform = {{"offset", {0.25, -1}}, {"rotation", std::numbers::pi / 2}, {"scale", {2, 3}}};
    const Model model = with(texture(0, transform), texture(0));
    // (1, 0) scaled is (2, 0); a quarter turn against the clock, v growing downwards, makes (0, −2).
    EXPECT_THAT(corner(model, MaterialSlot::base_color), near(0.25, -3));
    EXPECT_THAT(corner(model, MaterialSlot::occlusion), near(1, 0));
    EXPECT_TRUE(model.materials[0].use(MaterialSlot::base_color).mapping.is_plain());
    EXPECT_FALSE(model.materials[0].use(MaterialSlot::occlusion).mapping.of_second);
    const Model same = with(texture(0, transform), texture(0, transform));
    EXPECT_TRUE(same.materials[0].use(MaterialSlot::occlusion).mapping.is_plain());
}

TEST_F(GltfTexture, TransformMayNameItsCoordinates) {
    const Model model = with(texture(0), texture(0, {{"texCoord", 1}, {"scale", {2, 2}}}));
    EXPECT_THAT(corner(model, MaterialSlot::occlusion), near(1, 0.5));
}

TEST_F(GltfTexture, ThirdCoordinatesAreLeftOutAndSaid) {
    const Model model = with(texture(0), texture(1), texture(2));
    EXPECT_GE(model.materials[0].texture(MaterialSlot::occlusion), 0);
    EXPECT_EQ(model.materials[0].texture(MaterialSlot::emissive), -1);
    EXPECT_THAT(all_warnings(), HasSubstr("a third set of texture coordinates, left out"));
}

TEST_F(GltfTexture, TransformsThatLeaveNothingAreLeftOutAndSaid) {
    const Model model = with(texture(0, {{"scale", {0, 1}}}), texture(0));
    EXPECT_THAT(corner(model, MaterialSlot::base_color), near(1, 0));
    EXPECT_THAT(all_warnings(), HasSubstr("leaves the texture no extent"));
    EXPECT_THAT(error_of("bad.glb",
                         [&] {
                             builder_.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
                                 texture(0, {{"scale", "large"}});
                             return builder_.glb();
                         }()),
                HasSubstr("scale is not 2 numbers"));
}

TEST_F(GltfTexture, IsReadAsItsSamplerSays) {
    builder_.root["samplers"] = {{{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}, {"minFilter", 9985}},
                                 {{"minFilter", 9729}}};
    builder_.root["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}, {"sampler", 1}}, {{"source", 0}}};
    json second = texture(0), third = texture(0);
    second["index"] = 1;
    third["index"] = 2;
    const Model model = with(texture(0), second, third);
    const auto sampling = [&](MaterialSlot slot) {
        return model.textures.at(static_cast<std::size_t>(model.materials[0].texture(slot))).sampling;
    };
    EXPECT_EQ(sampling(MaterialSlot::base_color), (TextureSampling{.wrap_u = TextureWrap::mirror,
                                                                   .wrap_v = TextureWrap::clamp,
                                                                   .mipmaps = TextureMipmaps::nearest,
                                                                   .is_smooth_near = false,
                                                                   .is_smooth_far = true}));
    EXPECT_EQ(sampling(MaterialSlot::occlusion), (TextureSampling{.mipmaps = TextureMipmaps::none}));
    EXPECT_EQ(sampling(MaterialSlot::emissive), TextureSampling{});
    // One picture, read in three ways.
    EXPECT_EQ(model.textures.size(), 3u);
}

TEST_F(GltfTexture, TangentsThatPointNowhereAreReplaced) {
    builder_.primitive()["attributes"]["TANGENT"] =
        builder_.add<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 1}, 5126, "VEC4");
    builder_.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    const Model model = load(builder_);
    const ModelMesh& mesh = model.meshes[0];
    // The first has no length and the second lies along the normal: u runs along the world's x.
    EXPECT_TRUE(tangent_of(mesh.vertices[mesh.indices[0]]).isApprox(Eigen::Vector3d::UnitX(), 1e-6));
    EXPECT_TRUE(tangent_of(mesh.vertices[mesh.indices[1]]).isApprox(Eigen::Vector3d::UnitX(), 1e-6));
    EXPECT_TRUE(tangent_of(mesh.vertices[mesh.indices[2]]).isApprox(Eigen::Vector3d::UnitZ(), 1e-6));
    EXPECT_THAT(all_warnings(), HasSubstr("2 tangents that are zero or lie along the normal, replaced"));
}

TEST_F(GltfTexture, TangentsFollowTheNormalMapsOwnPlace) {
    builder_.root["materials"] = {{{"normalTexture", texture(0, {{"rotation", std::numbers::pi / 2}})}}};
    // Turned a quarter against the clock the picture's u grows with the file's v, which here goes up.
    const Model model = load(builder_);
    for (const ModelVertex& vertex : model.meshes[0].vertices)
        EXPECT_TRUE(tangent_of(vertex).isApprox(Eigen::Vector3d::UnitZ(), 1e-6));
}

TEST_F(GltfTexture, UnlitIsKept) {
    builder_.root["materials"] = {{{"extensions", {{"KHR_materials_unlit", json::object()}}}}};
    builder_.root["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_transform"};
    EXPECT_TRUE(load(builder_).materials[0].unlit);
    EXPECT_TRUE(warnings_.empty());
}

}  // namespace
}  // namespace matchlight
