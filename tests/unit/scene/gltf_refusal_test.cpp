// glTF files that lie, reach out of their folder, or ask for more than there is are refused in one line.
#include <unistd.h>

#include "media/image_io.h"
#include "model_test.h"

namespace matchlight {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class GltfRefusal : public ModelTest {};

TEST_F(GltfRefusal, BrokenContainers) {
    const std::string good = GltfBuilder::triangle().glb();
    EXPECT_THAT(error_of("a.glb", ""), HasSubstr("JSON is broken"));
    EXPECT_THAT(error_of("a.glb", "glTF"), HasSubstr("ends inside its header"));
    EXPECT_THAT(error_of("a.glb", good.substr(0, good.size() - 10)), HasSubstr("it ends after"));
    std::string first_version = good;
    first_version[4] = 1;
    EXPECT_THAT(error_of("a.glb", first_version), HasSubstr("not glTF 2.0"));
    std::string long_chunk = good;
    long_chunk[15] = '\x7f';
    EXPECT_THAT(error_of("a.glb", long_chunk), HasSubstr("chunk reaches beyond its end"));
    EXPECT_THAT(error_of("a.gltf", "{\"asset\": {\"version\": \"1.0\"}}"), HasSubstr("it is glTF '1.0'"));
    EXPECT_THAT(error_of("a.gltf", "[]"), HasSubstr("no object"));
    EXPECT_THAT(error_of("a.gltf", "{\"asset\": 3"), HasSubstr("JSON is broken"));
    EXPECT_THAT(error_of("a.gltf", "\xff\xfe"), HasSubstr("JSON is broken"));
}

TEST_F(GltfRefusal, DeepJson) {
    const std::string deep(100000, '[');
    EXPECT_THAT(error_of("a.gltf", deep), HasSubstr("nests deeper than 200"));
    EXPECT_THAT(error_of("a.gltf", "{\"a\":" + deep + std::string(100000, ']') + "}"),
                HasSubstr("nests deeper than 200"));
    // Brackets inside text do not nest.
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["asset"]["generator"] = "\"[" + std::string(1000, '[');
    EXPECT_EQ(load(builder).triangle_count(), 1u);
}

TEST_F(GltfRefusal, RequiredExtensions) {
    for (const char* name :
         {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "VENDOR_other"}) {
        GltfBuilder builder = GltfBuilder::triangle();
        builder.root["extensionsRequired"] = {name};
        EXPECT_THAT(error_of(builder), HasSubstr(name));
    }
}

TEST_F(GltfRefusal, NamesThatLeaveTheFolder) {
    const GltfBuilder builder = GltfBuilder::triangle();
    write("outside.bin", builder.binary);
    std::filesystem::create_directories(folder_ / "in");
    std::filesystem::create_symlink(folder_ / "outside.bin", folder_ / "in" / "link.bin");
    std::filesystem::create_directory_symlink(folder_, folder_ / "in" / "up");
    const std::string absolute = (folder_ / "outside.bin").string();
    const std::vector<std::string> names = {"../outside.bin",     "x/../../outside.bin",
                                            "%2e%2e/outside.bin", "..%2Foutside.bin",
                                            "..\\outside.bin",    absolute,
                                            "/etc/passwd",        "%2Fetc%2Fpasswd",
                                            "file://" + absolute, "http://example.com/outside.bin",
                                            "C:\\outside.bin",    "link.bin",
                                            "up/outside.bin"};
    for (const std::string& name : names) {
        EXPECT_THAT(error_of("in/m.gltf", builder.text(name)), HasSubstr("it names the file")) << name;
        GltfBuilder picture = builder;
        picture.root["images"] = {{{"uri", name}}};
        EXPECT_THAT(error_of("in/m.glb", picture.glb()), HasSubstr("it names the file")) << name;
    }
    EXPECT_THAT(error_of("in/m.gltf", builder.text("a%00b")), HasSubstr("no file name"));
    // A link that stays inside is as good as a file.
    write("in/here.bin", builder.binary);
    std::filesystem::create_symlink("here.bin", folder_ / "in" / "inner.bin");
    EXPECT_EQ(load("in/m.gltf", builder.text("inner.bin")).triangle_count(), 1u);
}

TEST_F(GltfRefusal, BuffersThatAreNotThere) {
    const GltfBuilder builder = GltfBuilder::triangle();
    EXPECT_THAT(error_of("m.gltf", builder.text("none.bin")), HasSubstr("buffers[0]: there is no file"));
    write("short.bin", builder.binary.substr(0, 20));
    EXPECT_THAT(error_of("m.gltf", builder.text("short.bin")), HasSubstr("buffers[0] has 20 of"));
    EXPECT_THAT(error_of("m.gltf", builder.text("data:application/octet-stream;base64,AA!A")), HasSubstr("not base64"));
    EXPECT_THAT(error_of("m.gltf", builder.text("data:application/octet-stream;base64,AAAA")), HasSubstr("has 3 of"));
    ASSERT_EQ(mkfifo((folder_ / "pipe.bin").c_str(), 0600), 0);
    EXPECT_THAT(error_of("m.gltf", builder.text("pipe.bin")), HasSubstr("buffers[0]: there is no file"));
}

TEST_F(GltfRefusal, SpansBeyondTheirBuffers) {
    struct Row {
        const char* what;
        std::function<void(GltfBuilder&)> change;
        const char* expected;
    };
    const std::vector<Row> rows = {
        {"view too long", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteLength"] = 1000; }, "bufferViews[0]"},
        {"view too far", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = 1u << 30; }, "bufferViews[0]"},
        {"overflow", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = 18446744073709551615ull; },
         "bufferViews[0].byteOffset"},
        {"negative", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = -4; }, "no whole number"},
        {"fraction", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 2.5; }, "no whole number"},
        {"stride", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 4; }, "byteStride"},
        {"long stride", [](GltfBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 252; }, "accessors[0]"},
        {"buffer", [](GltfBuilder& b) { b.root["bufferViews"][0]["buffer"] = 7; }, "there are 1 buffers"},
        {"count", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 4; }, "accessors[0]"},
        {"huge count", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 1000000000; },
         "accessors[0].count is 1000000000"},
        {"huge count without bytes",
         [](GltfBuilder& b) {
             b.root["accessors"][0]["count"] = 1000000000;
             b.root["accessors"][0].erase("bufferView");
         },
         "does not fit into memory"},
        {"no count", [](GltfBuilder& b) { b.root["accessors"][0]["count"] = 0; }, "count is 0"},
        {"offset", [](GltfBuilder& b) { b.root["accessors"][0]["byteOffset"] = 4; }, "accessors[0]"},
        {"view index", [](GltfBuilder& b) { b.root["accessors"][0]["bufferView"] = 99; }, "there are 3 bufferViews"},
        {"component type", [](GltfBuilder& b) { b.root["accessors"][0]["componentType"] = 5124; }, "componentType"},
        {"aliased type", [](GltfBuilder& b) { b.root["accessors"][0]["componentType"] = 5126 + 65536; },
         "componentType"},
        {"type", [](GltfBuilder& b) { b.root["accessors"][0]["type"] = "VEC5"; }, "type is unknown"},
        {"position of two", [](GltfBuilder& b) { b.root["accessors"][0]["type"] = "VEC2"; },
         "POSITION has 2 components"},
        {"accessor index", [](GltfBuilder& b) { b.primitive()["attributes"]["POSITION"] = 50; },
         "there are 3 accessors"},
        {"index accessor", [](GltfBuilder& b) { b.primitive()["indices"] = 50; }, "there are 3 accessors"},
        {"indices of floats", [](GltfBuilder& b) { b.primitive()["indices"] = 0; }, "no unsigned numbers"},
        {"material", [](GltfBuilder& b) { b.primitive()["material"] = 0; }, "there are 0 materials"},
        {"mode", [](GltfBuilder& b) { b.primitive()["mode"] = 9; }, "mode is above 6"},
        {"mesh", [](GltfBuilder& b) { b.root["nodes"][0]["mesh"] = 3; }, "there are 1 meshes"},
        {"scene", [](GltfBuilder& b) { b.root["scene"] = 3; }, "there are 1 scenes"},
        {"matrix",
         [](GltfBuilder& b) {
             b.root["nodes"][0]["matrix"] = {1, 2};
         },
         "not 16 numbers"},
        {"unequal",
         [](GltfBuilder& b) {
             b.primitive()["attributes"]["NORMAL"] = b.add<float>({0, 0, 1}, 5126, "VEC3");
         },
         "NORMAL has 1 elements for 3 vertices"},
        {"vertex index",
         [](GltfBuilder& b) {
             b.primitive()["indices"] = b.add<std::uint16_t>({0, 1, 3}, 5123, "SCALAR");
         },
         "index 3 is beyond its 3 vertices"},
        {"huge vertex index",
         [](GltfBuilder& b) {
             b.primitive()["indices"] = b.add<std::uint32_t>({0, 1, 0xffffffffu}, 5125, "SCALAR");
         },
         "index 4294967295"},
        {"meshes", [](GltfBuilder& b) { b.root["meshes"] = 3; }, "'meshes' is no array"},
        {"mesh of text", [](GltfBuilder& b) { b.root["meshes"][0] = "mesh"; }, "meshes[0] is no object"},
        {"factor",
         [](GltfBuilder& b) {
             b.root["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", "much"}}}}};
         },
         "metallicFactor is no number"},
        {"texture",
         [](GltfBuilder& b) {
             b.root["materials"] = {{{"normalTexture", {{"index", 0}}}}};
         },
         "there are 0 textures"},
        {"image",
         [](GltfBuilder& b) {
             b.root["textures"] = {{{"source", 2}}};
         },
         "there are 0 images"},
    };
    for (const Row& row : rows) {
        GltfBuilder builder = GltfBuilder::triangle();
        row.change(builder);
        EXPECT_THAT(error_of(builder), HasSubstr(row.expected)) << row.what;
    }
}

TEST_F(GltfRefusal, SparseIndices) {
    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t indices = builder.add_view(std::string("\x03\x00", 2));
    const std::size_t values = builder.add_view(std::string(12, '\0'));
    json& sparse = builder.root["accessors"][0]["sparse"];
    sparse = {{"count", 1},
              {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
              {"values", {{"bufferView", values}}}};
    EXPECT_THAT(error_of(builder), HasSubstr("accessors[0].sparse: index 3 is beyond the 3 elements"));
    sparse["count"] = 2;
    EXPECT_THAT(error_of(builder), HasSubstr("accessors[0].sparse.indices: 2 elements end at byte 4"));
    sparse["count"] = 4;
    EXPECT_THAT(error_of(builder), HasSubstr("sparse.count is above"));
    sparse = {{"count", 1}};
    EXPECT_THAT(error_of(builder), HasSubstr("no indices and values"));
}

TEST_F(GltfRefusal, NodesThatAreNoTree) {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.root["nodes"] = {{{"mesh", 0}, {"children", {0}}}};
    EXPECT_THAT(error_of(builder), HasSubstr("nodes"));
    builder.root["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
    EXPECT_THAT(error_of(builder), HasSubstr("its nodes form a cycle"));
    builder.root["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
    EXPECT_THAT(error_of(builder), HasSubstr("nodes[2] has two parents"));
    builder.root["nodes"] = {{{"children", {5}}}};
    EXPECT_THAT(error_of(builder), HasSubstr("there are 1 nodes"));
    builder.root["nodes"] = {{{"mesh", 0}}};
    builder.root["scenes"] = {{{"nodes", {0, 0}}}};
    EXPECT_THAT(error_of(builder), HasSubstr("lists a node twice"));
    builder.root["scenes"] = {{{"nodes", {0}}}};
    builder.root["nodes"] = json::array();
    for (int i = 0; i < 100000; ++i) builder.root["nodes"].push_back({{"children", {i + 1}}});
    builder.root["nodes"].push_back({{"mesh", 0}});
    EXPECT_THAT(error_of(builder), HasSubstr("nest deeper than 256"));
}

TEST_F(GltfRefusal, MoreInstancesThanMemoryHolds) {
    GltfBuilder builder = GltfBuilder::triangle();
    // A mesh of 2^20 triangles, shown by 2^14 nodes: 16 billion triangles in a file of a few megabytes.
    const std::vector<std::uint8_t> corners(3u << 20, 0);
    builder.primitive()["indices"] = builder.add(corners, 5121, "SCALAR");
    for (int i = 1; i < 1 << 14; ++i) {
        builder.root["nodes"].push_back({{"mesh", 0}});
        builder.root["scenes"][0]["nodes"].push_back(i);
    }
    EXPECT_THAT(error_of(builder), HasSubstr("of memory, more than there is"));
}

TEST_F(GltfRefusal, TextureBombs) {
    // A PNG whose header promises 20000 × 20000 pixels, and nothing else.
    Image8 small(1, 1, 3, 0);
    write_png8(folder_ / "small.png", small);
    std::ifstream file(folder_ / "small.png", std::ios::binary);
    std::string png{std::istreambuf_iterator<char>(file), {}};
    png.replace(16, 8, std::string("\x00\x00\x4e\x20\x00\x00\x4e\x20", 8));
    // The header's checksum (CRC-32 of type and data) belongs to what it says.
    std::uint32_t crc = 0xffffffffu;
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(png[i]);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    crc = ~crc;
    for (std::size_t i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(crc >> (24 - 8 * i) & 0xff);

    GltfBuilder builder = GltfBuilder::triangle();
    const std::size_t view = builder.add_view(png);
    builder.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
    builder.root["textures"] = {{{"source", 0}}};
    builder.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    builder.primitive()["material"] = 0;
    EXPECT_THAT(error_of(builder), HasSubstr("is 20000 × 20000 pixels; the limit is 16384"));
}

TEST_F(GltfRefusal, DamagedBytesNeverEscapeAsAnythingElse) {
    // Bytes of a small file become others: either it loads or it is an InputError.
    const std::string good = GltfBuilder::triangle().glb();
    for (std::size_t i = 0; i < good.size(); i += 5) {
        for (const char replacement : {'\0', '9', '\xff', '"'}) {
            std::string bad = good;
            bad[i] = replacement;
            try {
                load("m.glb", bad);
            } catch (const InputError&) {
            }
        }
    }
    for (std::size_t length = 0; length < good.size(); length += 17) error_of("m.glb", good.substr(0, length));
}

}  // namespace
}  // namespace matchlight
