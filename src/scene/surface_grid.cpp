// Vertices row by row, two triangles a cell.
#include "scene/surface_grid.h"

#include <iterator>

namespace matchlight {

void add_surface(ModelMesh& mesh, int columns, int rows, const GridSurface& surface) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            const SurfacePoint point = surface(static_cast<double>(column) / columns, static_cast<double>(row) / rows);
            const Eigen::Vector3f position = point.position.cast<float>();
            const Eigen::Vector3f normal = point.normal.cast<float>();
            const Eigen::Vector2f uv = point.uv.cast<float>();
            mesh.vertices.push_back({.position = {position.x(), position.y(), position.z()},
                                     .normal = {normal.x(), normal.y(), normal.z()},
                                     .tangent = {0, 0, 0, 0},
                                     .uv = {uv.x(), uv.y()},
                                     .color = {1, 1, 1, 1},
                                     .uv_second = {}});
        }
    }
    const auto stride = static_cast<std::uint32_t>(columns + 1);
    for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
        for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(columns); ++column) {
            const std::uint32_t top_left = first + row * stride + column;
            const std::uint32_t bottom_left = top_left + stride;
            const std::uint32_t corners[] = {top_left, bottom_left,     bottom_left + 1,
                                             top_left, bottom_left + 1, top_left + 1};
            mesh.indices.insert(mesh.indices.end(), std::begin(corners), std::end(corners));
        }
    }
}

}  // namespace matchlight
