// Martin Newell's bicubic Bézier patches ("The Utilization of Procedure Models in Digital Image Synthesis", 1975) with
// the bottom that F. Crow added ("The Origins of the Teapot", 1987), written as what repeats in them: profiles that are
// turned about the axis, and halves of handle and spout that are mirrored.
#include "scene/teapot.h"

#include <array>

#include "scene/surface_grid.h"

namespace matchlight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Control points: rows along v, columns along u.
using Patch = std::array<std::array<Vector3d, 4>, 4>;

/// A control point of a profile in the pot's own units: the base is z = 0, the belly's radius 2. `handle` is how far
/// the inner control points of a quarter turn lie off its ends: Newell's 0.56 radii, and once a rounded one.
struct ProfilePoint {
    double radius, z, handle;
};
constexpr double quarter_turn = 0.56;
constexpr ProfilePoint at(double radius, double z) {
    return {radius, z, quarter_turn * radius};
}

struct Profile {
    int rows;  // of the grid that is made of it
    std::array<ProfilePoint, 4> points;
};
// From the knob down. The ring is ours: it closes the gap between lid and rim, through which one would look into a pot
// that has no inside.
constexpr Profile profiles[] = {
    {24, {at(0, 3.15), ProfilePoint{0.8, 3.15, 0.45}, at(0, 2.85), at(0.2, 2.7)}},  // knob
    {24, {at(0.2, 2.7), at(0.4, 2.55), at(1.3, 2.55), at(1.3, 2.4)}},               // lid
    {1, {at(1.3, 2.4), at(4.0 / 3, 2.4), at(4.1 / 3, 2.4), at(1.4, 2.4)}},          // ring
    {16, {at(1.4, 2.4), at(1.3375, 2.53125), at(1.4375, 2.53125), at(1.5, 2.4)}},   // rim
    {16, {at(1.5, 2.4), at(1.75, 1.875), at(2, 1.35), at(2, 0.9)}},                 // belly, upper half
    {24, {at(2, 0.9), at(2, 0.45), at(1.5, 0.225), at(1.5, 0.15)}},                 // belly, lower half
    {12, {at(1.5, 0.15), at(1.5, 0.075), at(1.425, 0), at(0, 0)}},                  // bottom
};

/// x and z of a half tube's control points by rows; in the outer columns y is 0, in the inner ones `half_width`.
struct HalfTube {
    std::array<std::array<Vector2d, 4>, 4> xz;
    std::array<double, 4> half_width;
};
const std::array<HalfTube, 2> handle{{
    {{{{{{-1.6, 2.025}, {-1.6, 2.025}, {-1.5, 2.25}, {-1.5, 2.25}}},
       {{{-2.3, 2.025}, {-2.3, 2.025}, {-2.5, 2.25}, {-2.5, 2.25}}},
       {{{-2.7, 2.025}, {-2.7, 2.025}, {-3, 2.25}, {-3, 2.25}}},
       {{{-2.7, 1.8}, {-2.7, 1.8}, {-3, 1.8}, {-3, 1.8}}}}},
     {0.3, 0.3, 0.3, 0.3}},
    {{{{{{-2.7, 1.8}, {-2.7, 1.8}, {-3, 1.8}, {-3, 1.8}}},
       {{{-2.7, 1.575}, {-2.7, 1.575}, {-3, 1.35}, {-3, 1.35}}},
       {{{-2.5, 1.125}, {-2.5, 1.125}, {-2.65, 0.9375}, {-2.65, 0.9375}}},
       {{{-2, 0.9}, {-2, 0.9}, {-1.9, 0.6}, {-1.9, 0.6}}}}},
     {0.3, 0.3, 0.3, 0.3}},
}};
const std::array<HalfTube, 2> spout{{
    {{{{{{1.7, 1.425}, {1.7, 1.425}, {1.7, 0.6}, {1.7, 0.6}}},
       {{{2.6, 1.425}, {2.6, 1.425}, {3.1, 0.825}, {3.1, 0.825}}},
       {{{2.3, 2.1}, {2.3, 2.1}, {2.4, 2.025}, {2.4, 2.025}}},
       {{{2.7, 2.4}, {2.7, 2.4}, {3.3, 2.4}, {3.3, 2.4}}}}},
     {0.66, 0.66, 0.25, 0.25}},
    {{{{{{2.7, 2.4}, {2.7, 2.4}, {3.3, 2.4}, {3.3, 2.4}}},
       {{{2.8, 2.475}, {2.8, 2.475}, {3.525, 2.49375}, {3.525, 2.49375}}},
       {{{2.9, 2.475}, {2.9, 2.475}, {3.45, 2.5125}, {3.45, 2.5125}}},
       {{{2.8, 2.4}, {2.8, 2.4}, {3.2, 2.4}, {3.2, 2.4}}}}},
     {0.25, 0.25, 0.15, 0.15}},
}};

/// The pot reaches from x = −3 to 3.434 (where the spout's lip turns back) and from z = 0 to 3.15.
constexpr double pot_length = 6.4341;
constexpr double pot_height = 3.15;

/// The cubic Bernstein polynomials at t.
std::array<double, 4> bernstein(double t) {
    const double s = 1 - t;
    return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
}
/// Their derivatives.
std::array<double, 4> bernstein_slope(double t) {
    const double s = 1 - t;
    return {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t};
}

Vector3d weighted(const Patch& patch, const std::array<double, 4>& rows, const std::array<double, 4>& columns) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t row = 0; row < 4; ++row) {
        Vector3d across = Vector3d::Zero();
        for (std::size_t column = 0; column < 4; ++column) across += columns[column] * patch[row][column];
        sum += rows[row] * across;
    }
    return sum;
}

/// Right × up as seen from outside. Where a row of the patch is one point, at the knob's top and in the bottom's
/// middle, the derivative along u is 0 and its direction is that of the mixed one on the way there.
Vector3d normal_of(const Patch& patch, double u, double v) {
    const Vector3d along_v = weighted(patch, bernstein_slope(v), bernstein(u));
    Vector3d along_u = weighted(patch, bernstein(v), bernstein_slope(u));
    constexpr double least = 1e-9;  // of the pot's units, whose patches are near 1 wide
    if (along_u.norm() < least) {
        const Vector3d mixed = weighted(patch, bernstein_slope(v), bernstein_slope(u));
        along_u = v < 0.5 ? mixed : Vector3d(-mixed);
    }
    return along_v.cross(along_u).normalized();
}

/// Where a patch lies in the texture.
struct TextureArea {
    double u, v, width, height;
};

void add_patch(ModelMesh& mesh, int columns, int rows, const Patch& patch, const TextureArea& area) {
    add_surface(mesh, columns, rows, [&](double u, double v) {
        const Vector3d position = weighted(patch, bernstein(v), bernstein(u)) - Vector3d(0, 0, pot_height / 2);
        return SurfacePoint{position / pot_length, normal_of(patch, u, v),
                            Vector2d(area.u + u * area.width, area.v + v * area.height)};
    });
}

void add_turned(ModelMesh& mesh, const Profile& profile, double texture_v, double texture_height) {
    Patch patch;
    for (std::size_t row = 0; row < 4; ++row) {
        const auto& [radius, z, handle_length] = profile.points[row];
        patch[row] = {Vector3d(radius, 0, z), Vector3d(radius, handle_length, z), Vector3d(handle_length, radius, z),
                      Vector3d(0, radius, z)};
    }
    constexpr int quarters = 4;
    for (int quarter = 0; quarter < quarters; ++quarter) {
        add_patch(mesh, pieces_around / quarters, profile.rows, patch,
                  {quarter / 4.0, texture_v, 0.25, texture_height});
        for (auto& row : patch) {
            for (Vector3d& point : row) point = Vector3d(-point.y(), point.x(), point.z());
        }
    }
}

void add_tube(ModelMesh& mesh, const std::array<HalfTube, 2>& tube) {
    constexpr int columns = 24, rows = 32;
    for (std::size_t part = 0; part < tube.size(); ++part) {
        const HalfTube& half = tube[part];
        for (const double side : {1.0, -1.0}) {
            Patch patch;
            for (std::size_t row = 0; row < 4; ++row) {
                for (std::size_t column = 0; column < 4; ++column) {
                    // The other half runs on from where this one ends.
                    const std::size_t from = side > 0 ? column : 3 - column;
                    const double y = from == 0 || from == 3 ? 0 : side * half.half_width[row];
                    patch[row][column] = Vector3d(half.xz[row][from].x(), y, half.xz[row][from].y());
                }
            }
            const double first_u = side > 0 ? 0 : 0.5;
            add_patch(mesh, columns, rows, patch, {first_u, part == 0 ? 0 : 0.5, 0.5, 0.5});
        }
    }
}

}  // namespace

void add_teapot(ModelMesh& mesh) {
    const double share = 1.0 / static_cast<double>(std::size(profiles));
    double texture_v = 0;
    for (const Profile& profile : profiles) {
        add_turned(mesh, profile, texture_v, share);
        texture_v += share;
    }
    add_tube(mesh, handle);
    add_tube(mesh, spout);
}

}  // namespace matchlight
