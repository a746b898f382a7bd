// Spheres that let light through, summed in one or two rounds without an order: quick, and wrong by what the order
// would have told.
//
// Weighted sums keep the first orders in the opacity (Meshkin 2007, "Sort-Independent Alpha Blending"): exact for one
// layer, right for thin ones. Weighted blending takes a mean in which what is near counts more (McGuire & Bavoil 2013,
// "Weighted Blended Order-Independent Transparency"). Moments tell from four powers of the depth how much absorbs
// before each sphere (Münstermann, Krumpen, Klein & Peters 2018, "Moment-Based Order-Independent Transparency"). The
// exact composite in double precision is report/transparency_reference.h.
#pragma once

#include <functional>

#include "gl/framebuffer.h"
#include "gl/shader_library.h"
#include "scene/scene_file.h"

namespace matchlight {

class SphereBlending {
public:
    explicit SphereBlending(ShaderLibrary& shaders) : shaders_(shaders) {}

    struct Blended {
        TransparencyMethod method = TransparencyMethod::weighted_sum;  // one that keeps no order
        int width = 0, height = 0;
        const Texture2D& opaque_depth;  // what lies behind is hidden; of a size that holds the picture
        /// Of all that can be met, along the camera's z.
        double nearest_m = 0, farthest_m = 0;
        /// Draws every sphere, lit by shaders/surface/surface.frag with these defines, into what is bound, with the
        /// state that is set.
        std::function<void(const ShaderDefines&, const std::function<void(Program&)>& set_up)> draw;
    };
    void blend(const Blended& blended);

    /// Premultiplied light, alpha what they cover; RGBA32F. Until the next blend().
    const Texture2D& light() const { return light_; }

private:
    void fit(const Texture2D& opaque_depth);

    ShaderLibrary& shaders_;
    Texture2D summed_, beside_, moments_, absorbance_, light_;
    Framebuffer sums_, gathered_, result_;
    GLuint opaque_ = 0;
    FullScreenTriangle triangle_;
};

}  // namespace matchlight
