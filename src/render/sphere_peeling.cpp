// Front to back in full float, each layer under those before it.
#include "render/sphere_peeling.h"

#include <algorithm>

namespace matchlight {

namespace {

/// Layers between looks at whether any pixel still has one: looking waits for the GPU.
constexpr int layers_a_look = 4;

class AnySamples {
public:
    AnySamples() {
        GLuint name = 0;
        glCreateQueries(GL_ANY_SAMPLES_PASSED, 1, &name);
        name_ = GlName<gl_detail::delete_query>(name);
    }
    void begin() const { glBeginQuery(GL_ANY_SAMPLES_PASSED, name_.get()); }
    static void end() { glEndQuery(GL_ANY_SAMPLES_PASSED); }
    bool any() const {
        GLuint passed = 0;
        glGetQueryObjectuiv(name_.get(), GL_QUERY_RESULT, &passed);
        return passed != 0;
    }

private:
    GlName<gl_detail::delete_query> name_;
};

void set_under_state() {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);  // premultiplied, below what is there
    glDisable(GL_CULL_FACE);
}

void leave_state() {
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

}  // namespace

int SpherePeeling::peel(const Peeled& peeled) {
    const Texture2D& depth = peeled.opaque_depth;
    if (!light_ || light_.width() != depth.width() || light_.height() != depth.height() ||
        target_depth_ != depth.name()) {
        const TextureShape shape{.format = GL_RGBA32F, .width = depth.width(), .height = depth.height()};
        light_ = Texture2D(shape);
        target_ = Framebuffer({light_}, depth);
        target_depth_ = depth.name();
    }
    light_.clear(0, 0, 0, 0);
    const Region region{0, 0, peeled.width, peeled.height};
    const AnySamples query;
    SeenSpheres layer;
    int layers = 0;
    while (layers < peeled.most_layers) {
        const bool looks = layers % layers_a_look == layers_a_look - 1;
        if (layers == 0) {
            first_ = layer = peeled.sets.see(peeled.placed, peeled.width, peeled.height);
        } else {
            layer = peeled.sets.see_next(peeled.placed, peeled.width, peeled.height, light_, 1 - peeled.residual);
        }
        target_.bind(region);
        set_under_state();
        if (looks) query.begin();
        peeled.light(layer);
        if (looks) AnySamples::end();
        leave_state();
        ++layers;
        if (looks && !query.any()) break;
    }
    return layers;
}

}  // namespace matchlight
