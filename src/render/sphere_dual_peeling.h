// Layers of spheres from the front and from the back at once.
//
// Each time the spheres are drawn, every pixel's nearest one and its farthest one are taken off (Bavoil & Myers 2008,
// "Order Independent Transparency with Dual Depth Peeling": the greatest of both −z and z by blending), and the depths
// of the next two are found among the rest. Of spheres at one depth the first of the list counts as the nearest, as
// when they are peeled from the front: they are taken off one by one, while their depth stays.
#pragma once

#include <array>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/sphere_sets.h"

namespace matchlight {

class SphereDualPeeling {
public:
    explicit SphereDualPeeling(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Begun {
        SphereSets& sets;
        std::span<const PlacedSpheres> placed;
        int width = 0, height = 0;
        const Texture2D& opaque_depth;  // what lies behind is hidden
    };
    /// Before the first next(): of each pixel the first depths at both ends.
    void begin(const Begun& begun);
    struct Layers {
        SeenSpheres nearest, farthest;  // where a single one is left it is the nearest
    };
    /// Of the pixels that `covered` (the alpha of the layers in front) covers less than `enough`. Until the next one.
    Layers next(const Begun& begun, const Texture2D& covered, double enough);

private:
    void fit(const Texture2D& opaque_depth);
    /// Finds which spheres lie at the depths that the state names, and the depths next to those.
    void draw_between(const Begun& begun);
    void find_state(const Begun& begun, const Texture2D& covered, double enough);
    SeenSpheres layer_of(const Begun& begun, bool farthest);

    ShaderLibrary& shaders_;
    struct State {
        Texture2D depths, last;  // of the nearest and the farthest; which were taken off at these depths
        Framebuffer target;
    };
    std::array<State, 2> states_;
    std::size_t now_ = 0;                                  // of the states
    Texture2D between_;                                    // the next depths at both ends
    Texture2D near_id_, far_id_, near_count_, far_count_;  // at the depths of the state
    Texture2D reach_;                                      // what is drawn lies before it
    std::array<Texture2D, 2> layer_id_, layer_depth_;      // nearest, farthest
    Framebuffer between_target_, reach_target_;
    std::array<Framebuffer, 2> layer_targets_;
    GLuint opaque_ = 0;
    FullScreenTriangle triangle_;
};

}  // namespace matchlight
