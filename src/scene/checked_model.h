// A model file after its checks: everything a loader may read of it, held in memory, and nothing else.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/warnings.h"
#include "scene/model.h"
#include "scene/model_rig.h"

namespace matchlight {

/// A picture that the model names "texture-0", "texture-1", …: encoded bytes, or a file inside the model's folder.
struct TextureSource {
    std::string name;            // for messages
    std::string bytes;           // PNG, JPEG, …
    std::filesystem::path file;  // read when the texture is used; empty where `bytes` hold it
};

/// A material as its file has it: textures are numbers of TextureSources.
struct CheckedMaterial {
    /// How a texture lies: rows times (u, v, 1) of one of the file's sets of texture coordinates.
    struct Placement {
        unsigned set = 0;
        std::array<double, 6> rows{1, 0, 0, 0, 1, 0};
        TextureSampling sampling;
    };
    ModelMaterial material;
    std::array<Placement, material_slots> placements;
};

/// What the vertices of a primitive hang on, in the file's order.
struct CheckedPrimitive {
    std::size_t vertex_count = 0;
    std::size_t influences = 0;  // a vertex; 0: none
    std::vector<std::uint32_t> joints;
    std::vector<float> weights;
    std::vector<MorphTarget> targets;
};

/// What moves in a glTF file, whose nodes are called "node-0", "node-1", … then.
struct CheckedRig {
    ModelRig rig;                                        // its bindings are made with the meshes
    std::vector<std::optional<std::size_t>> skins;       // of nodes
    std::vector<char> moves;                             // nodes that an animation moves
    std::map<std::string, CheckedPrimitive> primitives;  // by the name of the mesh
};

/// What the loader is given. What was checked is what is read: no file is opened twice.
struct CheckedModel {
    std::filesystem::path path;                // of the model, for messages
    std::string entry;                         // the name to load; its extension says the format
    std::map<std::string, std::string> files;  // name → contents
    std::vector<TextureSource> textures;
    std::vector<CheckedMaterial> materials = {};  // of glTF: "material-0", "material-1", … in the file
    std::shared_ptr<const CheckedRig> rig = {};   // null: nothing moves
    std::vector<ModelLamp> lamps = {};
};

// Each reads one format and throws InputError for everything a loader should not see: truncated files, counts beyond
// the file, indices out of range, names that lead out of the model's folder, sizes beyond the memory there is.
CheckedModel check_gltf(const std::filesystem::path& path, Warnings& warnings);
CheckedModel check_obj(const std::filesystem::path& path, Warnings& warnings);
CheckedModel check_ply(const std::filesystem::path& path);
CheckedModel check_stl(const std::filesystem::path& path);

}  // namespace matchlight
