// One round of sums, or two where the first tells what absorbs.
#include "render/sphere_blending.h"

#include <cassert>
#include <cmath>

#include "render/blending_state.h"

namespace matchlight {

namespace {

constexpr GLuint sums_unit = 25;  // in place of what is seen (surface_spheres.cpp)

const char* define_of(TransparencyMethod method) {
    switch (method) {
        case TransparencyMethod::weighted_sum:
            return "WEIGHTED_SUM";
        case TransparencyMethod::weighted_blended:
            return "WEIGHTED_BLENDED";
        default:
            return "BLEND_BY_MOMENTS";
    }
}

}  // namespace

void SphereBlending::fit(const Texture2D& opaque_depth) {
    const int width = opaque_depth.width(), height = opaque_depth.height();
    if (summed_ && summed_.width() == width && summed_.height() == height && opaque_ == opaque_depth.name()) return;
    TextureShape shape{.format = GL_RGBA32F, .width = width, .height = height};
    summed_ = Texture2D(shape);
    moments_ = Texture2D(shape);
    light_ = Texture2D(shape);
    shape.format = GL_R32F;
    beside_ = Texture2D(shape);
    absorbance_ = Texture2D(shape);
    sums_ = Framebuffer({summed_, beside_}, opaque_depth);
    gathered_ = Framebuffer({moments_, absorbance_}, opaque_depth);
    result_ = Framebuffer({light_});
    opaque_ = opaque_depth.name();
}

void SphereBlending::blend(const Blended& blended) {
    assert(blended.nearest_m > 0 && blended.farthest_m > blended.nearest_m);
    fit(blended.opaque_depth);
    const Region region{0, 0, blended.width, blended.height};
    const Eigen::Vector2f depth_logs(static_cast<float>(std::log(blended.nearest_m)),
                                     static_cast<float>(std::log(blended.farthest_m)));
    const bool by_moments = blended.method == TransparencyMethod::moments;
    const bool weighs = blended.method == TransparencyMethod::weighted_blended;
    if (by_moments) {
        gathered_.bind(region);
        gathered_.clear_color(0, 0, 0, 0, 0);
        gathered_.clear_color(1, 0, 0, 0, 0);
        begin_blending_before_depth(GL_ONE, GL_ONE);
        blended.draw({{"GATHER_MOMENTS", "1"}}, [&](Program& program) { program.set("depth_logs", depth_logs); });
    }
    sums_.bind(region);
    sums_.clear_color(0, 0, 0, 0, 0);
    const float nothing = weighs ? 1 : 0;
    sums_.clear_color(1, nothing, nothing, nothing, nothing);
    begin_blending_before_depth(GL_ONE, GL_ONE);
    if (weighs) glBlendFunci(1, GL_ZERO, GL_ONE_MINUS_SRC_COLOR);
    constexpr double farthest_weighed = 500;  // of the weights' formula
    blended.draw({{define_of(blended.method), "1"}}, [&](Program& program) {
        program.set("depth_logs", depth_logs);
        program.set("weight_per_m", farthest_weighed / blended.farthest_m);
        if (!by_moments) return;
        program.bind_texture("gathered_moments", sums_unit, moments_);
        program.bind_texture("gathered_absorbance", sums_unit + 1, absorbance_);
    });
    end_blending_before_depth();

    Program& as_layer = shaders_.full_screen("spheres/blended.frag", {{define_of(blended.method), "1"}});
    result_.bind(region);
    result_.clear_color(0, 0, 0, 0, 0);
    as_layer.use();
    as_layer.bind_texture("summed", sums_unit, summed_);
    as_layer.bind_texture("beside", sums_unit + 1, by_moments ? absorbance_ : beside_);
    triangle_.draw();
}

}  // namespace matchlight
