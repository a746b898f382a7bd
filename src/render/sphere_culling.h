// Which cells of spheres are drawn, in what order, and which are passed over because they lie behind what was drawn.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/sphere_geometry.h"
#include "render/sphere_rays.h"

namespace matchlight {

struct SphereVisibility {
    bool frustum = true;    // what is outside of the picture is passed over
    bool occlusion = true;  // what is behind what was drawn before is passed over
};

/// Of a cell of small spheres 1 in 2ⁿ is drawn, larger by the root of that, so that as much is covered as by all (Cook,
/// Halstead, Planck & Ryu 2007, "Stochastic Simplification of Aggregate Detail").
struct SphereDetail {
    double radius_px = 0;  // spheres are drawn no larger than this, or as they are; 0: all are drawn
};

/// The farthest depths of a picture, or the nearest, level by level: each holds that of 2 × 2 texels of the one before.
class DepthPyramid {
public:
    enum class Holds { farthest, nearest };
    explicit DepthPyramid(Holds holds) : holds_(holds) {}

    /// Of the top-left width × height pixels; GPU work only.
    void build(ShaderLibrary& shaders, const Texture2D& depth, int width, int height);
    /// The uniforms of shaders/spheres/cull.comp.
    void bind(Program& program, GLuint unit) const;
    Holds holds() const { return holds_; }

private:
    Holds holds_;
    Texture2D levels_;
    int width_ = 0, height_ = 0;  // of the first level's part that is used
    int used_levels_ = 0;
};

/// Draws sets of spheres into whatever is bound, the nearest cells first, in rounds: before each but the first, cells
/// that lie behind what is there are taken out of the list on the GPU, without the CPU waiting to know which. Not a
/// pixel depends on it: what is passed over would have failed the depth test.
class SphereCulling {
public:
    explicit SphereCulling(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Drawn {
        const SphereGeometry& geometry;
        const SphereRays& rays;
        Program& points;                    // spheres/sphere.vert
        Program& triangles;                 // the same with TRIANGLES
        const Texture2D* depth = nullptr;   // what is drawn into, for tests of occlusion; null: none are made
        int width = 0, height = 0;          // of its part that is used
        const Texture2D* peeled = nullptr;  // the depth of the layer that was peeled off last; null: nothing was
        SphereDetail detail = {};
        bool depth_is_cleared = false;  // nothing is drawn there
    };
    void draw(const Drawn& drawn, const SphereVisibility& visibility);

    /// Cells that the last draw did not pass over: waits for the GPU. For reports and tests.
    std::size_t cells_drawn() const;
    /// And spheres in them.
    std::size_t spheres_drawn() const;

private:
    struct Round {
        std::size_t points_end = 0, triangles_end = 0;
        bool asks = false;  // what of it is hidden
    };
    std::vector<Round> rounds_of(const Drawn& drawn, const SphereVisibility& visibility, bool culls);
    struct Command {
        std::uint32_t count = 0, instances = 1, first = 0, base_instance = 0;
    };
    using Float4 = std::array<float, 4>;
    struct List {
        std::vector<Command> commands;
        std::vector<Float4> boxes;
        Buffer draws, bounds;
        std::size_t capacity = 0;
        bool is_points = true;

        void clear();
        /// 1 of 2^`level` of its spheres.
        void add(const SphereCell& cell, int level);
        void upload();
        std::vector<Command> left() const;  // that were not taken out
    };
    void draw_round(const Drawn& drawn, const List& list, std::size_t first, std::size_t end) const;
    /// Takes out what the pyramid shows to be hidden or, where it is of a peeled layer, to be before that.
    void cull(const Drawn& drawn, const DepthPyramid& pyramid, const List& list, std::size_t first, std::size_t end);

    ShaderLibrary& shaders_;
    DepthPyramid pyramid_{DepthPyramid::Holds::farthest}, peeled_{DepthPyramid::Holds::nearest};
    List points_, triangles_{.commands = {}, .boxes = {}, .draws = {}, .bounds = {}, .is_points = false};
};

}  // namespace matchlight
