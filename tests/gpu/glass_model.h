// A model that lets light through.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace matchlight::test {

/// A square of 2 m, upright, that lets `1 − alpha` of the light through; gone with the test.
class GlassModel {
public:
    explicit GlassModel(double alpha)
        : path_(std::filesystem::temp_directory_path() / fmt::format("matchlight_glass_{}.gltf", getpid())) {
        // Positions of four corners, indices of two triangles.
        const std::string buffer =
            "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAA"
            "gD8AAAAAAACAvwAAgD8AAAAAAAABAAIAAAACAAMA";
        const nlohmann::json gltf = {
            {"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", 0}}}}}}},
            {"materials",
             {{{"alphaMode", "BLEND"},
               {"doubleSided", true},
               {"emissiveFactor", {0, 0, 1}},
               {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, alpha}}, {"metallicFactor", 0}}}}}},
            {"buffers", {{{"byteLength", 60}, {"uri", "data:application/octet-stream;base64," + buffer}}}},
            {"bufferViews",
             {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
              {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 12}}}},
            {"accessors",
             {{{"bufferView", 0},
               {"componentType", 5126},
               {"count", 4},
               {"type", "VEC3"},
               {"min", {-1, -1, 0}},
               {"max", {1, 1, 0}}},
              {{"bufferView", 1}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}}}};
        std::ofstream(path_) << gltf;
    }
    ~GlassModel() { std::filesystem::remove(path_); }
    GlassModel(const GlassModel&) = delete;
    GlassModel& operator=(const GlassModel&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace matchlight::test
