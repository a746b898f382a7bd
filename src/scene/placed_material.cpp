// Finds how the textures of a glTF material lie on its vertices, and decodes them.
#include <fmt/format.h>

#include "scene/assimp_import.h"
#include "scene/texture_image.h"

namespace matchlight {

namespace {

using Rows = std::array<double, 6>;

/// `rows` for coordinates that went through `first`, which has an extent.
UvMapping mapping_from(const Rows& first, const Rows& rows) {
    UvMapping mapping;
    if (rows == first) return mapping;
    const double determinant = first[0] * first[4] - first[1] * first[3];
    const Rows back{
        first[4] / determinant,  -first[1] / determinant, (first[1] * first[5] - first[4] * first[2]) / determinant,
        -first[3] / determinant, first[0] / determinant,  (first[3] * first[2] - first[0] * first[5]) / determinant};
    for (const std::size_t row : {std::size_t{0}, std::size_t{3}}) {
        for (std::size_t column = 0; column < 3; ++column) {
            const double moved = column == 2 ? rows[row + 2] : 0;
            mapping.rows[row + column] =
                static_cast<float>(rows[row] * back[column] + rows[row + 1] * back[column + 3] + moved);
        }
    }
    return mapping;
}

}  // namespace

int TextureTable::index_of(std::size_t source, const TextureSampling& sampling) {
    for (const Known& known : known_) {
        if (known.source == source && known.sampling == sampling) return known.index;
    }
    known_.push_back({source, sampling, -1});
    if (source >= checked_.textures.size()) return -1;
    const TextureSource& picture = checked_.textures[source];
    if (auto pixels = read_texture(picture, checked_.path, warnings_)) {
        known_.back().index = static_cast<int>(model_.textures.size());
        model_.textures.push_back({picture.name, std::move(*pixels), sampling});
    }
    return known_.back().index;
}

ImportedMaterial placed_material(const CheckedMaterial& checked_material, const CheckedModel& checked,
                                 TextureTable& textures, Warnings& warnings) {
    ImportedMaterial placed;
    placed.material = checked_material.material;
    std::optional<unsigned> first_set;
    for (std::size_t i = 0; i < material_slots; ++i) {
        TextureUse& use = placed.material.textures[i];
        const CheckedMaterial::Placement& placement = checked_material.placements[i];
        if (use.index < 0) continue;
        use.index = textures.index_of(static_cast<std::size_t>(use.index), placement.sampling);
        if (use.index < 0) continue;
        if (!first_set) {
            first_set = placement.set;
            placed.first_rows = placement.rows;
        }
        if (placement.set == *first_set) {
            use.mapping = mapping_from(placed.first_rows, placement.rows);
        } else if (!placed.second_set || *placed.second_set == placement.set) {
            placed.second_set = placement.set;
            use.mapping = mapping_from({1, 0, 0, 0, 1, 0}, placement.rows);
            use.mapping.of_second = true;
        } else {
            warnings.add(fmt::format("{}: a texture of material '{}' uses a third set of texture coordinates, left out",
                                     checked.path.string(), placed.material.name));
            use.index = -1;
        }
    }
    placed.first_set = first_set.value_or(0);
    return placed;
}

}  // namespace matchlight
