// Models as the renderer wants them: flattened meshes in world axes, metallic-roughness materials, decoded textures.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "core/content_hash.h"
#include "core/image.h"
#include "core/warnings.h"
#include "scene/lamp.h"

namespace matchlight {

enum class TextureWrap { repeat, clamp, mirror };
enum class TextureMipmaps { none, nearest, linear };

/// How a texture is read, as glTF's samplers say it.
struct TextureSampling {
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    TextureMipmaps mipmaps = TextureMipmaps::linear;
    bool is_smooth_near = true, is_smooth_far = true;  // between texels: where they are larger than pixels, and smaller
    int anisotropy = 1;  // how much longer than wide a pixel may lie on it and still be read as long

    bool operator==(const TextureSampling&) const = default;
};

struct ModelTexture {
    std::string name;
    Image8 rgba;  // 4 channels, row 0 at the top (v = 0), as glTF has it
    TextureSampling sampling;
};

enum class AlphaMode { opaque, mask, blend };

/// What a material has textures of.
enum class MaterialSlot {
    base_color,
    metallic_roughness,
    normal,
    occlusion,
    emissive,
    coat,
    coat_roughness,
    coat_normal,
    sheen_color,
    sheen_roughness,
    specular,
    specular_color,
    anisotropy,
    transmission,
    thickness
};
inline constexpr std::size_t material_slots = 15;
/// Colours are sRGB-coded, all else is linear.
bool is_color(MaterialSlot slot);

/// Where a texture lies on a mesh: two rows times (u, v, 1), of the vertex's first or second pair.
struct UvMapping {
    std::array<float, 6> rows{1, 0, 0, 0, 1, 0};
    bool of_second = false;

    bool operator==(const UvMapping&) const = default;
    bool is_plain() const { return *this == UvMapping{}; }
    std::array<float, 2> operator()(const std::array<float, 2>& first, const std::array<float, 2>& second) const;
};

/// A texture that a material uses: its index in Model::textures, −1 for none.
struct TextureUse {
    int index = -1;
    UvMapping mapping;
};

using Rgb = std::array<float, 3>;

// Layers of glTF's extensions KHR_materials_clearcoat, _sheen, _specular and _anisotropy.
struct CoatFactors {
    float strength = 0, roughness = 0, normal_scale = 1;
};
struct SheenFactors {
    Rgb color{0, 0, 0};
    float roughness = 0;
};
struct SpecularFactors {
    float strength = 1;
    Rgb color{1, 1, 1};
};
struct AnisotropyFactors {
    float strength = 0, rotation_rad = 0;
};
/// Of KHR_materials_transmission and KHR_materials_volume: light that passes through instead of being scattered below.
struct TransmissionFactors {
    float strength = 0;
    float thickness = 0;  // of what is behind the surface, in the mesh's own units; 0: a thin wall, which bends nothing
    float attenuation_distance = std::numeric_limits<float>::infinity();  // after which light has the colour
    Rgb attenuation_color{1, 1, 1};
};

/// glTF 2.0 metallic-roughness and its layers. Factors are scene-linear.
struct ModelMaterial {
    std::string name;
    std::array<float, 4> base_color{1, 1, 1, 1};
    float metallic = 0, roughness = 0.5f;
    Rgb emissive{0, 0, 0};
    float normal_scale = 1, occlusion_strength = 1;
    AlphaMode alpha_mode = AlphaMode::opaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;  // base colour is radiance
    float ior = 1.5f;
    std::optional<CoatFactors> coat;
    std::optional<SheenFactors> sheen;
    std::optional<SpecularFactors> specular;
    std::optional<AnisotropyFactors> anisotropy;
    std::optional<TransmissionFactors> transmission;
    std::array<TextureUse, material_slots> textures;

    TextureUse& use(MaterialSlot slot) { return textures[static_cast<std::size_t>(slot)]; }
    const TextureUse& use(MaterialSlot slot) const { return textures[static_cast<std::size_t>(slot)]; }
    int& texture(MaterialSlot slot) { return use(slot).index; }
    int texture(MaterialSlot slot) const { return use(slot).index; }
};

struct ModelVertex {
    std::array<float, 3> position;  // metres, world axes (z up), after the file's own node transforms
    std::array<float, 3> normal;    // unit length
    std::array<float, 4> tangent;   // xyz unit length, w = handedness ±1; zero without a normal map
    std::array<float, 2> uv;
    std::array<float, 4> color;      // vertex colour, linear, 1 where there is none
    std::array<float, 2> uv_second;  // of textures that lie otherwise than the first; else zero
};

struct ModelMesh {
    std::vector<ModelVertex> vertices;
    std::vector<std::uint32_t> indices;  // triangles
    int material = 0;
    /// The number of its binding in the model's rig, which tells of its first vertices; absent: it stands still.
    std::optional<std::size_t> binding = {};
    /// The rest of a bound mesh's vertices: each halfway between two before it, or the back of one that is given twice.
    std::vector<std::array<std::uint32_t, 2>> derived = {};
};

/// A light of KHR_lights_punctual, as the file has it: candela or lux, about its node, shining along its −z.
struct ModelLamp {
    LampSettings lamp;
    std::size_t node = 0;                                           // in the rig, where there is one
    Eigen::Matrix4d model_from_node = Eigen::Matrix4d::Identity();  // at rest
};

struct ModelRig;

struct Model {
    std::string name;
    std::vector<ModelMesh> meshes;
    std::vector<ModelMaterial> materials;
    std::vector<ModelTexture> textures;
    std::vector<ModelLamp> lamps = {};
    Eigen::AlignedBox3d bounds_m;              // at rest
    std::shared_ptr<const ModelRig> rig = {};  // null: nothing of it can move

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
