// Every sphere that each pixel of a picture meets, at once, and layer by layer from the front.
//
// Peeling draws all spheres anew for each layer. Here they are drawn twice: to count how many each pixel meets, and to
// keep which (after Yang, Hensley, Grün & Thibieroz 2010, "Real-Time Concurrent Linked List Construction on the GPU",
// with each pixel's spheres side by side in place of a list). Each pixel's are then made a heap (Williams 1964,
// "Algorithm 232: Heapsort"), from which a layer takes the nearest: layers that nobody asks for are not sorted. What
// comes out is what peeling finds, sphere by sphere.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "render/sphere_sets.h"

namespace matchlight {

class SphereLists {
public:
    explicit SphereLists(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Gathered {
        SphereSets& sets;
        std::span<const PlacedSpheres> placed;
        int width = 0, height = 0;
        int first_row = 0, rows = 0;    // of the picture, for which they are gathered
        const Texture2D& opaque_depth;  // what lies behind is hidden
        /// Draws what is listed beside the spheres, with shaders that include surface/listed.glsl: counted first, then
        /// kept with its light. Empty: nothing is.
        std::function<void(bool counts)> draw_others = {};
    };
    /// False where they are more than a buffer can hold: fewer rows then. Waits for the GPU once.
    bool gather(const Gathered& gathered);
    /// The most that a buffer of this driver holds; tests lower it.
    static std::uint32_t most_entries();
    void limit_entries(std::uint32_t most) { most_entries_ = most; }

    /// Of the rows that were gathered, the next sphere of each pixel that `covered` (its alpha) covers less than
    /// `enough`; null: of each pixel. Each call takes one away.
    SeenSpheres next(const Texture2D* covered, double enough);
    /// Draws the light of those that `layer` took which are no spheres, premultiplied, with the state that is set.
    void draw_others(const SeenSpheres& layer);

private:
    void fit(int width, int height);

    ShaderLibrary& shaders_;
    Texture2D counts_, starts_;  // of each pixel's spheres; R32UI
    Buffer total_, entries_;
    Buffer light_;  // of entries that are no spheres
    std::uint32_t capacity_ = 0, light_capacity_ = 0, most_entries_ = 0;
    Texture2D id_, depth_;
    Framebuffer target_;
    Framebuffer opaque_;
    GLuint opaque_depth_ = 0;
    Region rows_;
    FullScreenTriangle triangle_;
};

}  // namespace matchlight
