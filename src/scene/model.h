// Models as the renderer wants them: flattened meshes in world axes, metallic-roughness materials, decoded textures.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/content_hash.h"
#include "core/image.h"
#include "core/warnings.h"

namespace matchlight {

struct ModelTexture {
    std::string name;
    Image8 rgba;  // 4 channels, row 0 at the top (v = 0), as glTF has it
    bool wrap_repeat_u = true, wrap_repeat_v = true;
};

enum class AlphaMode { opaque, mask, blend };

/// glTF 2.0 metallic-roughness. Factors are scene-linear; base colour and emissive textures are sRGB-coded, the others
/// linear. Texture fields index Model::textures, −1 for none.
struct ModelMaterial {
    std::string name;
    std::array<float, 4> base_color{1, 1, 1, 1};
    float metallic = 0, roughness = 0.5f;
    std::array<float, 3> emissive{0, 0, 0};
    float normal_scale = 1, occlusion_strength = 1;
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    int base_color_texture = -1, metallic_roughness_texture = -1, normal_texture = -1, emissive_texture = -1,
        occlusion_texture = -1;
};

struct ModelVertex {
    std::array<float, 3> position;  // metres, world axes (z up), after the file's own node transforms
    std::array<float, 3> normal;    // unit length
    std::array<float, 4> tangent;   // xyz unit length, w = handedness ±1; zero without a normal map
    std::array<float, 2> uv;
    std::array<float, 4> color;  // vertex colour, linear, 1 where there is none
};

struct ModelMesh {
    std::vector<ModelVertex> vertices;
    std::vector<std::uint32_t> indices;  // triangles
    int material = 0;
};

struct Model {
    std::string name;
    std::vector<ModelMesh> meshes;
    std::vector<ModelMaterial> materials;
    std::vector<ModelTexture> textures;
    Eigen::AlignedBox3d bounds_m;

    std::size_t triangle_count() const;
    /// Makes `bounds_m` the box of all vertices.
    void update_bounds();
};

/// Reads glTF 2.0 (.gltf, .glb), OBJ, PLY or STL. Axes: glTF's y-up becomes z-up, (x, y, z) → (x, −z, y); OBJ, PLY and
/// STL likewise are taken as y-up, as glTF. Degenerate or non-finite triangles are dropped and counted as warnings;
/// missing normals are computed. Throws InputError: files outside the model's folder, indices out of range, node
/// cycles, sizes beyond the memory there is.
Model load_model(const std::filesystem::path& path, Warnings& warnings);

/// "sphere" (radius ½), "box" (side 1), "plane" (side 1, z = 0), "torus" (outer radius ½, tube radius 0.15, about z),
/// "cylinder" and "cone" (radius ½, height 1, about z; the cone's tip up), "teapot" (Newell's, 1 long from handle to
/// spout, the spout along +x, its lid about z), all around the origin. Throws InputError naming the nearest.
Model make_shape(const std::string& shape, const std::filesystem::path& reported);

/// Puts a picture on all materials in place of their base colour. Throws InputError when it cannot be read.
void set_base_color_texture(Model& model, const std::filesystem::path& picture);

/// Adds the bytes of every file that load_model would read. Throws as it does.
void add_model_contents(ContentHash& hash, const std::filesystem::path& path, Warnings& warnings);

}  // namespace matchlight
