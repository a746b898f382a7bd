// A box as a glTF file, still or moved by an animation of its node, of any material.
#pragma once

#include <string>
#include <vector>

#include "../unit/scene/gltf_builder.h"
#include "scene/model.h"

namespace matchlight::test {

/// Of side 1. Keys of its node's translation, in glTF's axes; none: it stands still, where `place` says.
struct BoxMotion {
    std::vector<float> times_s;
    std::vector<float> translations;
    std::vector<double> place = {0, 0, 0};
    nlohmann::json material = nullptr;  // as the file has it
};

inline std::string box_glb(const BoxMotion& motion) {
    GltfBuilder builder;
    const ModelMesh box = make_shape("box", "box").meshes.at(0);
    std::vector<float> positions, normals;
    for (const ModelVertex& vertex : box.vertices) {
        const auto add = [](std::vector<float>& to, const std::array<float, 3>& world) {
            to.insert(to.end(), {world[0], world[2], -world[1]});
        };
        add(positions, vertex.position);
        add(normals, vertex.normal);
    }
    const std::size_t position = builder.add<float>(positions, 5126, "VEC3");
    const std::size_t normal = builder.add<float>(normals, 5126, "VEC3");
    const std::size_t indices = builder.add<std::uint32_t>(box.indices, 5125, "SCALAR");
    builder.root["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}, {"indices", indices}}}}});
    builder.root["nodes"][0]["translation"] = motion.place;
    if (!motion.material.is_null()) {
        builder.root["materials"] = {motion.material};
        builder.primitive()["material"] = 0;
    }
    if (motion.times_s.empty()) return builder.glb();
    const std::size_t input = builder.add<float>(motion.times_s, 5126, "SCALAR");
    const std::size_t output = builder.add<float>(motion.translations, 5126, "VEC3");
    builder.root["animations"] = {
        {{"samplers", {{{"input", input}, {"output", output}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    return builder.glb();
}

}  // namespace matchlight::test
