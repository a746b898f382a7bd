// The equations of the mappings, and the table of cube faces.
#include "lighting/mappings.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

using std::numbers::pi;

struct CubeFace {
    Eigen::Vector3i outward, right, down;  // world directions of the face's middle, of image right and of image down
    int cell_x, cell_y;                    // where it lies, in faces
};
using CubeFaces = std::array<CubeFace, 6>;

const Eigen::Vector3i px(1, 0, 0), nx(-1, 0, 0), py(0, 1, 0), ny(0, -1, 0), pz(0, 0, 1), nz(0, 0, -1);

const CubeFaces vertical_cross_faces = {{{px, ny, nz, 2, 1},
                                         {nx, py, nz, 0, 1},
                                         {pz, px, py, 1, 0},
                                         {nz, px, ny, 1, 2},
                                         {py, px, nz, 1, 1},
                                         {ny, px, pz, 1, 3}}};
const CubeFaces horizontal_cross_faces = {{{px, ny, nz, 2, 1},
                                           {nx, py, nz, 0, 1},
                                           {pz, px, py, 1, 0},
                                           {nz, px, ny, 1, 2},
                                           {py, px, nz, 1, 1},
                                           {ny, nx, nz, 3, 1}}};
const CubeFaces strip_faces = {{{px, ny, nz, 0, 0},
                                {nx, py, nz, 1, 0},
                                {pz, px, py, 2, 0},
                                {nz, px, ny, 3, 0},
                                {py, px, nz, 4, 0},
                                {ny, nx, nz, 5, 0}}};
// OpenEXR, ImfEnvmap.h. Its X is our −x, its Y our z, its Z our y.
const CubeFaces column_faces = {{{nx, py, nz, 0, 0},
                                 {px, ny, nz, 0, 1},
                                 {pz, nx, ny, 0, 2},
                                 {nz, nx, py, 0, 3},
                                 {py, px, nz, 0, 4},
                                 {ny, nx, nz, 0, 5}}};

struct CubeGrid {
    int columns, rows;
};

CubeGrid grid_of(CubeLayout layout) {
    switch (layout) {
        case CubeLayout::vertical_cross:
            return {3, 4};
        case CubeLayout::horizontal_cross:
            return {4, 3};
        case CubeLayout::strip:
            return {6, 1};
        case CubeLayout::column:
            return {1, 6};
    }
    assert(false);
    return {};
}

const CubeFaces& faces_of(CubeLayout layout) {
    switch (layout) {
        case CubeLayout::vertical_cross:
            return vertical_cross_faces;
        case CubeLayout::horizontal_cross:
            return horizontal_cross_faces;
        case CubeLayout::strip:
            return strip_faces;
        case CubeLayout::column:
            return column_faces;
    }
    assert(false);
    return vertical_cross_faces;
}

double dot(const Eigen::Vector3i& axis, const Vector3d& v) {
    return axis.x() * v.x() + axis.y() * v.y() + axis.z() * v.z();
}

/// Pixel coordinate of a fraction 0..1 along an axis of `size` pixels, and back.
double pixel_of(double fraction, int size, bool edge_centred) {
    return edge_centred ? fraction * (size - 1) : fraction * size - 0.5;
}
double fraction_of(double pixel, int size, bool edge_centred) {
    return edge_centred ? pixel / (size - 1) : (pixel + 0.5) / size;
}
double fraction_step(int size, bool edge_centred) {
    return 1.0 / (edge_centred ? size - 1 : size);
}

/// The face a direction leaves the cube through.
const CubeFace& face_towards(const CubeFaces& faces, const Vector3d& direction) {
    const CubeFace* best = faces.data();
    for (const CubeFace& face : faces) {
        if (dot(face.outward, direction) > dot(best->outward, direction)) best = &face;
    }
    return *best;
}

const CubeFace* face_at(const ProbeLayout& layout, const Vector2d& pixel) {
    const int size = layout.face_size();
    const int cell_x = static_cast<int>(std::floor((pixel.x() + 0.5) / size));
    const int cell_y = static_cast<int>(std::floor((pixel.y() + 0.5) / size));
    for (const CubeFace& face : faces_of(layout.cube)) {
        if (face.cell_x == cell_x && face.cell_y == cell_y) return &face;
    }
    return nullptr;
}

/// Coordinates −1..1 within a face, right and down, of a pixel position.
Vector2d face_coordinates(const ProbeLayout& layout, const CubeFace& face, const Vector2d& pixel) {
    const int size = layout.face_size();
    return {2 * fraction_of(pixel.x() - face.cell_x * size, size, layout.edge_centred) - 1,
            2 * fraction_of(pixel.y() - face.cell_y * size, size, layout.edge_centred) - 1};
}

struct FacePosition {
    const CubeFace* face;
    Vector2d pixel;
};

FacePosition face_position(const ProbeLayout& layout, const Vector3d& direction) {
    const CubeFace& face = face_towards(faces_of(layout.cube), direction);
    const double depth = dot(face.outward, direction);
    const int size = layout.face_size();
    const double u = dot(face.right, direction) / depth;
    const double v = dot(face.down, direction) / depth;
    return {&face,
            {pixel_of((u + 1) / 2, size, layout.edge_centred) + face.cell_x * size,
             pixel_of((v + 1) / 2, size, layout.edge_centred) + face.cell_y * size}};
}

/// Offset from a disc's centre in units of its radius; right and up.
Vector2d disc_coordinates(const ProbeLayout& layout, const Vector2d& pixel) {
    return {2 * fraction_of(pixel.x(), layout.width, false) - 1, 1 - 2 * fraction_of(pixel.y(), layout.height, false)};
}

/// Moves a position on or beyond the rim to the nearest pixel centre's reach within the disc.
Vector2d kept_in_disc(const ProbeLayout& layout, const Vector2d& pixel) {
    const Vector2d centre((layout.width - 1) / 2.0, (layout.height - 1) / 2.0);
    // Half the diagonal of a pixel: wherever the position is rounded to, that pixel's centre lies inside.
    const double reach = std::max(0.0, std::min(layout.width, layout.height) / 2.0 - std::numbers::sqrt2 / 2);
    const Vector2d offset = pixel - centre;
    const double distance = offset.norm();
    if (distance <= reach) return pixel;
    return centre + offset * (reach / distance);
}

/// Solid angles of pixels, addressed as the image is.
class SolidAngles {
public:
    explicit SolidAngles(const ProbeLayout& layout)
        : width_(static_cast<std::size_t>(layout.width)), values_(width_ * static_cast<std::size_t>(layout.height)) {}
    double& at(int x, int y) { return values_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)]; }
    std::vector<double> take() { return std::move(values_); }

private:
    std::size_t width_;
    std::vector<double> values_;
};

/// The part 0..1 of an axis where a pixel's side at `pixel` ± ½ lies; outermost pixels centred on the edge are halves.
double side(double pixel, int size, bool edge_centred) {
    return std::clamp(fraction_of(pixel, size, edge_centred), 0.0, 1.0);
}

std::vector<double> latlong_solid_angles(const ProbeLayout& layout) {
    SolidAngles result(layout);
    for (int y = 0; y < layout.height; ++y) {
        const double top = side(y - 0.5, layout.height, layout.edge_centred) * pi;
        const double bottom = side(y + 0.5, layout.height, layout.edge_centred) * pi;
        const double band = 2 * std::sin((top + bottom) / 2) * std::sin((bottom - top) / 2);
        for (int x = 0; x < layout.width; ++x) {
            const double left = side(x - 0.5, layout.width, layout.edge_centred);
            const double right = side(x + 0.5, layout.width, layout.edge_centred);
            result.at(x, y) = band * (right - left) * 2 * pi;
        }
    }
    return result.take();
}

/// Solid angle of the part of a cube's face from its middle to (u, v).
double corner_solid_angle(double u, double v) {
    return std::atan2(u * v, std::sqrt(1 + u * u + v * v));
}

std::vector<double> cube_solid_angles(const ProbeLayout& layout) {
    SolidAngles result(layout);
    const int size = layout.face_size();
    for (int y = 0; y < size; ++y) {
        const double top = 2 * side(y - 0.5, size, layout.edge_centred) - 1;
        const double bottom = 2 * side(y + 0.5, size, layout.edge_centred) - 1;
        for (int x = 0; x < size; ++x) {
            const double left = 2 * side(x - 0.5, size, layout.edge_centred) - 1;
            const double right = 2 * side(x + 0.5, size, layout.edge_centred) - 1;
            const double solid_angle = corner_solid_angle(right, bottom) - corner_solid_angle(left, bottom) -
                                       corner_solid_angle(right, top) + corner_solid_angle(left, top);
            for (const CubeFace& face : faces_of(layout.cube)) {
                result.at(face.cell_x * size + x, face.cell_y * size + y) = solid_angle;
            }
        }
    }
    return result.take();
}

/// The part outside the last whole pixel counts for its neighbour inside, as in nearest_pixel. Eight by eight points a
/// pixel put the rim's area within 1 %, all pixels together within 1e-4; the sum is made exact.
std::vector<double> disc_solid_angles(const ProbeLayout& layout) {
    SolidAngles result(layout);
    constexpr int points = 8;
    double sum = 0;
    for (int y = 0; y < layout.height; ++y) {
        for (int x = 0; x < layout.width; ++x) {
            for (int j = 0; j < points; ++j) {
                for (int i = 0; i < points; ++i) {
                    const Vector2d point(x + (i + 0.5) / points - 0.5, y + (j + 0.5) / points - 0.5);
                    const double solid_angle = solid_angle_density(layout, point) / (points * points);
                    if (solid_angle <= 0) continue;
                    const Vector2d kept = kept_in_disc(layout, point);
                    result.at(std::clamp(static_cast<int>(std::lround(kept.x())), 0, layout.width - 1),
                              std::clamp(static_cast<int>(std::lround(kept.y())), 0, layout.height - 1)) += solid_angle;
                    sum += solid_angle;
                }
            }
        }
    }
    std::vector<double> solid_angles = result.take();
    for (double& solid_angle : solid_angles) solid_angle *= 4 * pi / sum;
    return solid_angles;
}

}  // namespace

bool is_disc(ProbeMapping mapping) {
    return mapping == ProbeMapping::angular || mapping == ProbeMapping::mirrorball;
}

int ProbeLayout::face_size() const {
    assert(mapping == ProbeMapping::cube);
    return width / grid_of(cube).columns;
}

ProbeLayout layout_of_size(ProbeMapping mapping, int size, CubeLayout cube) {
    assert(size > 0);
    switch (mapping) {
        case ProbeMapping::latlong:
            return {mapping, cube, 2 * size, size, false};
        case ProbeMapping::angular:
        case ProbeMapping::mirrorball:
            return {mapping, cube, size, size, false};
        case ProbeMapping::cube:
            return {mapping, cube, size * grid_of(cube).columns, size * grid_of(cube).rows, false};
    }
    assert(false);
    return {};
}

std::optional<CubeLayout> cube_layout_of_shape(int width, int height) {
    for (const CubeLayout layout :
         {CubeLayout::vertical_cross, CubeLayout::horizontal_cross, CubeLayout::strip, CubeLayout::column}) {
        const auto [columns, rows] = grid_of(layout);
        if (width % columns == 0 && height % rows == 0 && width / columns == height / rows) return layout;
    }
    return std::nullopt;
}

Vector2d pixel_from_direction(const ProbeLayout& layout, const Vector3d& direction) {
    if (layout.mapping == ProbeMapping::cube) return face_position(layout, direction).pixel;
    if (layout.mapping == ProbeMapping::latlong) {
        const double polar = std::atan2(direction.head<2>().norm(), direction.z());
        const double azimuth = std::atan2(direction.x(), direction.y());
        return {pixel_of(azimuth / (2 * pi) + 0.5, layout.width, layout.edge_centred),
                pixel_of(polar / pi, layout.height, layout.edge_centred)};
    }
    // θ is the angle from forward. Angular (Debevec 1998, Rendering Synthetic Objects into Real Scenes): r = θ/π.
    // Mirror ball seen from afar: the normal lies at θ/2, so r = sin(θ/2).
    const double sideways = std::hypot(direction.x(), direction.z());
    const double angle = std::atan2(sideways, direction.y());
    const double radius = layout.mapping == ProbeMapping::angular ? angle / pi : std::sin(angle / 2);
    Vector2d offset(0, 0);
    if (sideways > 0) {
        offset = Vector2d(direction.x(), direction.z()) * (radius / sideways);
    } else if (direction.y() < 0) {
        offset = {0, -radius};
    }
    return {pixel_of((offset.x() + 1) / 2, layout.width, false), pixel_of((1 - offset.y()) / 2, layout.height, false)};
}

std::optional<Vector3d> direction_from_pixel(const ProbeLayout& layout, const Vector2d& pixel) {
    if (layout.mapping == ProbeMapping::cube) {
        const CubeFace* face = face_at(layout, pixel);
        if (!face) return std::nullopt;
        const Vector2d uv = face_coordinates(layout, *face, pixel);
        return (face->outward.cast<double>() + uv.x() * face->right.cast<double>() + uv.y() * face->down.cast<double>())
            .normalized();
    }
    if (layout.mapping == ProbeMapping::latlong) {
        const double azimuth = (fraction_of(pixel.x(), layout.width, layout.edge_centred) - 0.5) * 2 * pi;
        const double polar = fraction_of(pixel.y(), layout.height, layout.edge_centred) * pi;
        return Vector3d(std::sin(polar) * std::sin(azimuth), std::sin(polar) * std::cos(azimuth), std::cos(polar));
    }
    const Vector2d offset = disc_coordinates(layout, pixel);
    const double radius = offset.norm();
    if (radius > 1) return std::nullopt;
    const double angle = layout.mapping == ProbeMapping::angular ? pi * radius : 2 * std::asin(radius);
    const double sideways = radius > 0 ? std::sin(angle) / radius : 0;
    return Vector3d(offset.x() * sideways, std::cos(angle), offset.y() * sideways);
}

double solid_angle_density(const ProbeLayout& layout, const Vector2d& pixel) {
    if (layout.mapping == ProbeMapping::latlong) {
        const double polar = fraction_of(pixel.y(), layout.height, layout.edge_centred) * pi;
        return std::max(0.0, std::sin(polar)) * pi * fraction_step(layout.height, layout.edge_centred) * 2 * pi *
               fraction_step(layout.width, layout.edge_centred);
    }
    if (layout.mapping == ProbeMapping::cube) {
        const CubeFace* face = face_at(layout, pixel);
        if (!face) return 0;
        const double step = 2 * fraction_step(layout.face_size(), layout.edge_centred);
        const double distance2 = 1 + face_coordinates(layout, *face, pixel).squaredNorm();
        return step * step / (distance2 * std::sqrt(distance2));
    }
    const double radius = disc_coordinates(layout, pixel).norm();
    if (radius > 1) return 0;
    const double pixel_area = 4.0 / (static_cast<double>(layout.width) * layout.height);  // in squared radii
    // dω = sin θ dθ dφ over dA = r dr dφ: (π² sin θ)/θ for r = θ/π; 4 everywhere for r = sin(θ/2).
    if (layout.mapping == ProbeMapping::mirrorball) return 4 * pixel_area;
    const double angle = pi * radius;
    return pi * pi * (angle > 0 ? std::sin(angle) / angle : 1) * pixel_area;
}

Eigen::Vector2i nearest_pixel(const ProbeLayout& layout, const Vector3d& direction) {
    if (layout.mapping == ProbeMapping::cube) {
        const auto [face, pixel] = face_position(layout, direction);
        const int size = layout.face_size();
        const int x = static_cast<int>(std::lround(pixel.x())) - face->cell_x * size;
        const int y = static_cast<int>(std::lround(pixel.y())) - face->cell_y * size;
        return {std::clamp(x, 0, size - 1) + face->cell_x * size, std::clamp(y, 0, size - 1) + face->cell_y * size};
    }
    Vector2d pixel = pixel_from_direction(layout, direction);
    if (is_disc(layout.mapping)) pixel = kept_in_disc(layout, pixel);
    return {std::clamp(static_cast<int>(std::lround(pixel.x())), 0, layout.width - 1),
            std::clamp(static_cast<int>(std::lround(pixel.y())), 0, layout.height - 1)};
}

double reach_of_pixel(const ProbeLayout& layout, const Vector3d& direction) {
    const Vector2d pixel = nearest_pixel(layout, direction).cast<double>();
    double reach = 0;
    for (int j = -2; j <= 2; ++j) {
        for (int i = -2; i <= 2; ++i) {
            // Not on the corner itself, which may be the next face's.
            const auto shown = direction_from_pixel(layout, pixel + 0.24 * Vector2d(i, j));
            if (shown) reach = std::max(reach, std::atan2(shown->cross(direction).norm(), shown->dot(direction)));
        }
    }
    return reach;
}

std::array<PixelTap, 4> bilinear_taps(const ProbeLayout& layout, const Vector3d& direction) {
    Region limits{0, 0, layout.width, layout.height};
    Vector2d pixel;
    if (layout.mapping == ProbeMapping::cube) {
        const auto position = face_position(layout, direction);
        const int size = layout.face_size();
        limits = {position.face->cell_x * size, position.face->cell_y * size, size, size};
        pixel = position.pixel;
    } else {
        pixel = pixel_from_direction(layout, direction);
        if (is_disc(layout.mapping)) pixel = kept_in_disc(layout, pixel);
    }
    const double left = std::floor(pixel.x());
    const double top = std::floor(pixel.y());
    const double tx = pixel.x() - left;
    const double ty = pixel.y() - top;
    const bool wraps = layout.mapping == ProbeMapping::latlong && !layout.edge_centred;

    std::array<PixelTap, 4> taps;
    double sum = 0;
    for (int i = 0; i < 4; ++i) {
        int x = static_cast<int>(left) + i % 2;
        int y = static_cast<int>(top) + i / 2;
        double weight = (i % 2 ? tx : 1 - tx) * (i / 2 ? ty : 1 - ty);
        if (wraps) x = (x + layout.width) % layout.width;
        x = std::clamp(x, limits.x, limits.x + limits.width - 1);
        y = std::clamp(y, limits.y, limits.y + limits.height - 1);
        if (is_disc(layout.mapping) && disc_coordinates(layout, Vector2d(x, y)).norm() > 1) weight = 0;
        taps[static_cast<std::size_t>(i)] = {x, y, weight};
        sum += weight;
    }
    for (PixelTap& tap : taps) tap.weight /= sum;
    return taps;
}

std::vector<double> pixel_solid_angles(const ProbeLayout& layout) {
    switch (layout.mapping) {
        case ProbeMapping::latlong:
            return latlong_solid_angles(layout);
        case ProbeMapping::angular:
        case ProbeMapping::mirrorball:
            return disc_solid_angles(layout);
        case ProbeMapping::cube:
            return cube_solid_angles(layout);
    }
    assert(false);
    return {};
}

}  // namespace matchlight
