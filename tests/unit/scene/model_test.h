// What tests of models share.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "gltf_builder.h"
#include "scene/model.h"
#include "temporary_folder.h"

namespace matchlight {

class ModelTest : public TemporaryFolder {
protected:
    void SetUp() override {
        TemporaryFolder::SetUp();
        warnings_.set_quiet(true);
    }

    Model load(const GltfBuilder& builder) { return load_model(write("model.glb", builder.glb()), warnings_); }
    Model load(const std::string& name, std::string_view bytes) { return load_model(write(name, bytes), warnings_); }

    /// The line that a bad model gets; it names the file.
    std::string error_of(const std::string& name, std::string_view bytes) {
        try {
            load(name, bytes);
        } catch (const InputError& error) {
            const std::string line = error.what();
            EXPECT_THAT(line, testing::HasSubstr(name));
            EXPECT_EQ(line.find('\n'), std::string::npos);
            return line;
        }
        return "no error";
    }
    std::string error_of(const GltfBuilder& builder) { return error_of("model.glb", builder.glb()); }

    std::string all_warnings() const {
        std::string text;
        for (const auto& entry : warnings_.entries()) text += entry.text + "\n";
        return text;
    }

    Warnings warnings_;
};

inline Eigen::Vector3d position_of(const ModelVertex& v) {
    return {v.position[0], v.position[1], v.position[2]};
}
inline Eigen::Vector3d normal_of(const ModelVertex& v) {
    return {v.normal[0], v.normal[1], v.normal[2]};
}
inline Eigen::Vector3d tangent_of(const ModelVertex& v) {
    return {v.tangent[0], v.tangent[1], v.tangent[2]};
}

/// Volume enclosed by a closed surface, positive when its triangles face outwards (divergence theorem).
inline double signed_volume(const Model& model) {
    double volume = 0;
    for (const ModelMesh& mesh : model.meshes) {
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const Eigen::Vector3d a = position_of(mesh.vertices[mesh.indices[i]]);
            const Eigen::Vector3d b = position_of(mesh.vertices[mesh.indices[i + 1]]);
            const Eigen::Vector3d c = position_of(mesh.vertices[mesh.indices[i + 2]]);
            volume += a.dot(b.cross(c)) / 6;
        }
    }
    return volume;
}

}  // namespace matchlight
