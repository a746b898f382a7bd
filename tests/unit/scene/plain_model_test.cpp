// OBJ, PLY and STL files, good and bad.
#include <cmath>
#include <cstring>

#include "media/image_io.h"
#include "model_test.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

class ObjModel : public ModelTest {
protected:
    static constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    Model with_material(const std::string& material) {
        write("m.mtl", "newmtl a\n" + material);
        return load("m.obj", std::string("mtllib m.mtl\n") + square + "usemtl a\nf 1/1 2/2 3/3 4/4\n");
    }
    void write_picture(const std::string& name) {
        std::filesystem::create_directories((folder_ / name).parent_path());
        write_png8(folder_ / name, Image8(2, 2, 3, 128));
    }
};

TEST_F(ObjModel, PolygonsAxesAndTextureCoordinates) {
    const Model model = load("m.obj", std::string(square) + "f 1/1 2/2 3/3 4/4\n");
    EXPECT_EQ(model.triangle_count(), 2u);
    EXPECT_EQ(model.bounds_m.max(), Vector3d(1, 0, 1));
    for (const ModelVertex& vertex : model.meshes[0].vertices) {
        EXPECT_TRUE(normal_of(vertex).isApprox(Vector3d(0, -1, 0), 1e-6));
        EXPECT_NEAR(vertex.uv[0], vertex.position[0], 1e-6);
        EXPECT_NEAR(vertex.uv[1], 1 - vertex.position[2], 1e-6);  // OBJ's v grows upwards, ours downwards
    }
    EXPECT_EQ(model.materials[0].metallic, 0);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ObjModel, RelativeIndicesContinuedLinesAndWindowsLineEnds) {
    EXPECT_EQ(load("m.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf -3 \\\r\n -2 -1\r\n").triangle_count(), 1u);
    EXPECT_EQ(load("m.obj", "# a comment\nf 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n# end").triangle_count(), 1u);
}

TEST_F(ObjModel, NormalsOfTheFileAreKept) {
    const Model model = load("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0.6 0.8\nf 1//1 2//1 3//1\n");
    EXPECT_TRUE(normal_of(model.meshes[0].vertices[0]).isApprox(Vector3d(0, -0.8, 0.6), 1e-6));
}

TEST_F(ObjModel, VertexColoursAreDecoded) {
    const Model model = load("m.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 1 1 0 1 0.5 0\nf 1 2 3\n");
    const auto& color = model.meshes[0].vertices[0].color;
    EXPECT_NEAR(color[0], 1, 1e-6);
    EXPECT_NEAR(color[1], 0.2140, 1e-4);  // sRGB 0.5
    EXPECT_EQ(model.materials[0].base_color, (std::array<float, 4>{1, 1, 1, 1}));
}

TEST_F(ObjModel, ClassicMaterialsBecomeMetallicRoughness) {
    const ModelMaterial plastic =
        with_material("Kd 0.5 0.25 0.125\nKs 0.04 0.04 0.04\nNs 30\nd 0.5\nKe 1 2 3\n").materials[0];
    EXPECT_EQ(plastic.base_color, (std::array<float, 4>{0.5f, 0.25f, 0.125f, 0.5f}));
    EXPECT_EQ(plastic.metallic, 0);
    EXPECT_NEAR(plastic.roughness, 0.5, 1e-6);  // (2/32)^(1/4)
    EXPECT_EQ(plastic.emissive, (std::array<float, 3>{1, 2, 3}));
    EXPECT_EQ(plastic.alpha_mode, AlphaMode::blend);

    const ModelMaterial mirror = with_material("Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 100000\n").materials[0];
    EXPECT_EQ(mirror.metallic, 1);
    EXPECT_EQ(mirror.base_color[1], 0.8f);
    EXPECT_LT(mirror.roughness, 0.1f);

    const ModelMaterial physical = with_material("Kd 0.5 0.5 0.5\nPr 0.3\nPm 0.6\n").materials[0];
    EXPECT_EQ(physical.roughness, 0.3f);
    EXPECT_EQ(physical.metallic, 0.6f);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(ObjModel, TexturesLieBesideTheirMaterials) {
    write_picture("parts/a wood.png");
    write("parts/m.mtl", "newmtl a\nmap_Kd -clamp on -s 1 1 1 a wood.png\nmap_Bump bump.png\n");
    const Model model = load("m.obj", std::string("mtllib parts/m.mtl\n") + square + "usemtl a\nf 1/1 2/2 3/3 4/4\n");
    ASSERT_EQ(model.textures.size(), 1u);
    EXPECT_EQ(model.materials[0].texture(MaterialSlot::base_color), 0);
    EXPECT_EQ(model.textures[0].sampling.wrap_u, TextureWrap::clamp);
    EXPECT_THAT(all_warnings(), HasSubstr("the texture of 'map_bump' is left out"));
}

TEST_F(ObjModel, MissingMaterialsAndTexturesAreCounted) {
    load("m.obj", std::string("mtllib none.mtl\n") + square + "f 1 2 3\n");
    EXPECT_THAT(all_warnings(), HasSubstr("its materials 'none.mtl' are missing"));
    EXPECT_EQ(with_material("map_Kd none.png\n").materials[0].texture(MaterialSlot::base_color), -1);
    EXPECT_EQ(with_material("map_Kd C:\\Users\\me\\wood.png\n").materials[0].texture(MaterialSlot::base_color), -1);
    EXPECT_EQ(with_material("map_Kd ../../etc/passwd\n").materials[0].texture(MaterialSlot::base_color), -1);
    EXPECT_EQ(warnings_.total(), 4);
}

TEST_F(ObjModel, StrangeMaterialFilesDoNoHarm) {
    for (const char* text :
         {"aniso 1\n", "Kd\n", "newmtl\nKd 1 1 1\n", "newmtl a\naniso\nKd x y z\nNs", "\n\n", "newmtl a\nmap_Kd\n"}) {
        write("m.mtl", text);
        EXPECT_EQ(load("m.obj", std::string("mtllib m.mtl\n") + square + "usemtl a\nf 1 2 3\n").triangle_count(), 1u)
            << text;
    }
}

TEST_F(ObjModel, BadIndicesNameTheLine) {
    const std::string three = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    EXPECT_THAT(error_of("m.obj", three + "f 0 1 2\n"), HasSubstr("m.obj:4: vertex index 0"));
    EXPECT_THAT(error_of("m.obj", three + "f 1 2 4\n"), HasSubstr("m.obj:4: vertex index 4 is beyond the 3"));
    EXPECT_THAT(error_of("m.obj", three + "f 1 2 -4\n"), HasSubstr("m.obj:4: vertex index -4 reaches before"));
    EXPECT_THAT(error_of("m.obj", three + "f 1/1 2/1 3/1\n"), HasSubstr("texture coordinate index 1 is beyond the 0"));
    EXPECT_THAT(error_of("m.obj", three + "f 1//9 2//9 3//9\n"), HasSubstr("normal index 9 is beyond the 0"));
    EXPECT_THAT(error_of("m.obj", three + "f 1 2 99999999999999999999\n"), HasSubstr("is no vertex index"));
    EXPECT_THAT(error_of("m.obj", three + "f a b c\n"), HasSubstr("m.obj:4: 'a' is no vertex index"));
    EXPECT_THAT(error_of("m.obj", "v 0 0\nf 1 1 1\n"), HasSubstr("m.obj:1: 'v' has 2 numbers"));
    EXPECT_THAT(error_of("m.obj", three + "mtllib ../m.mtl\nf 1 2 3\n"), HasSubstr("it names the file '../m.mtl'"));
    EXPECT_THAT(error_of("m.obj", three + "mtllib /etc/passwd\nf 1 2 3\n"), HasSubstr("an absolute path"));
    EXPECT_NE(error_of("m.obj", ""), "no error");
    EXPECT_NE(error_of("m.obj", three + "f 1 2\n"), "no error");
}

TEST_F(ObjModel, NumbersThatAreNotFiniteAreDropped) {
    const Model model = load("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv nan 0 0\nv inf 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    EXPECT_EQ(model.triangle_count(), 1u);
    EXPECT_THAT(all_warnings(), HasSubstr("2 triangles"));
}

class PlyModel : public ModelTest {
protected:
    static std::string header(const std::string& format, int vertices, int faces) {
        return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(vertices) +
               "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
               "\nproperty list uchar int vertex_indices\nend_header\n";
    }
    static std::string binary_triangle(int last_index = 2) {
        const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
        const std::int32_t indices[] = {0, 1, last_index};
        std::string bytes(reinterpret_cast<const char*>(positions), sizeof positions);
        return bytes + '\3' + std::string(reinterpret_cast<const char*>(indices), sizeof indices);
    }
    static std::string byte_swapped_triangle() {
        std::string bytes = binary_triangle();
        for (std::size_t at : {0, 4, 8, 12, 16, 20, 24, 28, 32, 37, 41, 45}) {
            std::swap(bytes[at], bytes[at + 3]);
            std::swap(bytes[at + 1], bytes[at + 2]);
        }
        return bytes;
    }
};

TEST_F(PlyModel, TextAndBinary) {
    const Vector3d corner(1, 0, 1);
    EXPECT_EQ(load("m.ply", header("ascii", 3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").bounds_m.max(), corner);
    EXPECT_EQ(load("m.ply", header("binary_little_endian", 3, 1) + binary_triangle()).bounds_m.max(), corner);
    EXPECT_EQ(load("m.ply", header("binary_big_endian", 3, 1) + byte_swapped_triangle()).bounds_m.max(), corner);
}

TEST_F(PlyModel, ColoursAreDecoded) {
    const Model model =
        load("m.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
             "z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\nproperty "
             "list uchar int vertex_indices\nend_header\n0 0 0 255 188 0\n1 0 0 255 188 0\n0 1 0 255 188 0\n3 0 1 2\n");
    const auto& color = model.meshes[0].vertices[0].color;
    EXPECT_NEAR(color[0], 1, 1e-6);
    EXPECT_NEAR(color[1], 0.5029, 1e-3);  // sRGB 188/255
    EXPECT_NEAR(color[3], 1, 1e-6);
}

TEST_F(PlyModel, Lies) {
    EXPECT_THAT(error_of("m.ply", header("binary_little_endian", 1000000000, 1) + binary_triangle()),
                HasSubstr("promises 1000000000 of 'vertex'"));
    EXPECT_THAT(error_of("m.ply", header("ascii", 3, 1000000000) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
                HasSubstr("promises 1000000000 of 'face'"));
    EXPECT_THAT(error_of("m.ply", header("binary_little_endian", 3, 1) + binary_triangle(3)),
                HasSubstr("face 0 has vertex 3, but there are 3"));
    EXPECT_THAT(error_of("m.ply", header("binary_little_endian", 3, 1) + binary_triangle(-1)),
                HasSubstr("face 0 has vertex 4294967295"));
    EXPECT_THAT(error_of("m.ply", header("binary_little_endian", 3, 1) + binary_triangle().substr(0, 45)),
                HasSubstr("it ends inside 'face'"));
    EXPECT_NE(error_of("m.ply", header("ascii", 3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"), "no error");
    EXPECT_THAT(error_of("m.ply", ""), HasSubstr("no PLY file"));
    EXPECT_THAT(error_of("m.ply", "ply\nformat ascii 1.0\n"), HasSubstr("header does not end"));
    EXPECT_THAT(error_of("m.ply", "ply\nformat odd 1.0\nend_header\n"), HasSubstr("format is unknown"));
    EXPECT_THAT(error_of("m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n"),
                HasSubstr("unknown type 'quad'"));
}

class StlModel : public ModelTest {
protected:
    /// A cube of side 1, facets only, as STL has them.
    static std::string cube(std::uint32_t promised = 12, std::size_t bytes_cut = 0) {
        const Model box = make_shape("box", "");
        std::string stl(80, '\0');
        stl += GltfBuilder::u32(promised);
        const ModelMesh& mesh = box.meshes[0];
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            stl += std::string(12, '\0');
            for (std::size_t i = 0; i < 3; ++i) {
                const auto& p = mesh.vertices[mesh.indices[t + i]].position;
                const float y_up[] = {p[0], p[2], -p[1]};
                stl.append(reinterpret_cast<const char*>(y_up), sizeof y_up);
            }
            stl += std::string(2, '\0');
        }
        return stl.substr(0, stl.size() - bytes_cut);
    }
};

TEST_F(StlModel, FacetsBecomeASurfaceWithCreases) {
    const Model model = load("m.stl", cube());
    EXPECT_EQ(model.triangle_count(), 12u);
    EXPECT_EQ(model.meshes[0].vertices.size(), 24u);  // each corner once for each of its three sides
    EXPECT_NEAR(signed_volume(model), 1, 1e-6);
    EXPECT_EQ(load("m.stl", cube() + "trailing bytes").triangle_count(), 12u);
}

TEST_F(StlModel, TextIsRead) {
    const Model model =
        load("m.stl",
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
             "endfacet\nendsolid a\n");
    EXPECT_EQ(model.bounds_m.max(), Vector3d(1, 0, 1));
}

TEST_F(StlModel, Lies) {
    EXPECT_THAT(error_of("m.stl", cube(1000000000)), HasSubstr("it holds 12 of the 1000000000 triangles"));
    EXPECT_THAT(error_of("m.stl", cube(12, 30)), HasSubstr("it holds 11 of the 12 triangles"));
    EXPECT_THAT(error_of("m.stl", ""), HasSubstr("no STL file"));
    EXPECT_NE(error_of("m.stl", "solid but no facets, nothing at all"), "no error");
}

TEST_F(ModelTest, UnknownKindsAreNamed) {
    EXPECT_THAT(error_of("m.fbx", "x"), HasSubstr("models of kind '.fbx' are not supported; use .gltf"));
    EXPECT_THROW(load_model(folder_ / "none.glb", warnings_), InputError);
    std::filesystem::create_directory(folder_ / "folder.obj");
    EXPECT_THROW(load_model(folder_ / "folder.obj", warnings_), InputError);
}

TEST_F(ModelTest, UpperCaseEndingsAreKnown) {
    EXPECT_EQ(load("M.GLB", GltfBuilder::triangle().glb()).triangle_count(), 1u);
}

}  // namespace
}  // namespace matchlight
