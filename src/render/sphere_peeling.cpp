// Front to back in full float, each layer under those before it.
#include "render/sphere_peeling.h"

#include <algorithm>

#include "render/blending_state.h"

namespace matchlight {

namespace {

/// Layers between looks at whether any pixel still has one: looking waits for the GPU.
constexpr int layers_a_look = 4;
/// This program has neither light nor material.
constexpr GLuint behind_unit = 3;

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

}  // namespace

void SpherePeeling::keep_first_depth(const SeenSpheres& layer, const Region& rows) {
    glCopyImageSubData(layer.depth_share->name(), GL_TEXTURE_2D, 0, rows.x, rows.y, 0, first_depth_.name(),
                       GL_TEXTURE_2D, 0, rows.x, rows.y, 0, rows.width, rows.height, 1);
}

int SpherePeeling::peel_rows(const Peeled& peeled, int first_row, int rows, const NextLayer& next_layer) {
    const Region region{0, 0, peeled.width, peeled.height};
    const AnySamples query;
    int layers = 0;
    while (layers < peeled.most_layers) {
        const bool looks = layers % layers_a_look == layers_a_look - 1;
        const SeenSpheres layer = next_layer(layers);
        if (layers == 0) keep_first_depth(layer, {0, first_row, peeled.width, rows});
        target_.bind(region);
        glEnable(GL_SCISSOR_TEST);
        glScissor(0, first_row, peeled.width, rows);
        begin_blending_before_depth(GL_ONE_MINUS_DST_ALPHA, GL_ONE);  // premultiplied, below what is there
        if (looks) query.begin();
        peeled.light(layer);
        if (looks) AnySamples::end();
        end_blending_before_depth();
        glDisable(GL_SCISSOR_TEST);
        ++layers;
        if (looks && !query.any()) break;
    }
    return layers;
}

void SpherePeeling::fit(const Texture2D& opaque_depth) {
    if (light_ && light_.width() == opaque_depth.width() && light_.height() == opaque_depth.height() &&
        target_depth_ == opaque_depth.name())
        return;
    TextureShape shape{.format = GL_RGBA32F, .width = opaque_depth.width(), .height = opaque_depth.height()};
    light_ = Texture2D(shape);
    light_behind_ = {};
    shape.format = GL_DEPTH_COMPONENT32F;
    first_depth_ = Texture2D(shape);
    target_ = Framebuffer({light_}, opaque_depth);
    target_depth_ = opaque_depth.name();
}

int SpherePeeling::peel_both_ends(const Peeled& peeled) {
    if (!light_behind_) {
        light_behind_ = Texture2D(light_.shape());
        target_behind_ = Framebuffer({light_behind_}, peeled.opaque_depth);
    }
    light_behind_.clear(0, 0, 0, 0);
    const Region region{0, 0, peeled.width, peeled.height};
    const SphereDualPeeling::Begun begun{.sets = peeled.sets,
                                         .placed = peeled.placed,
                                         .width = peeled.width,
                                         .height = peeled.height,
                                         .opaque_depth = peeled.opaque_depth};
    dual_.begin(begun);
    const AnySamples query;
    int layers = 0;
    for (bool any = true; any && layers < peeled.most_layers; layers += 2) {
        const bool looks = layers % layers_a_look == layers_a_look - 2;
        const SphereDualPeeling::Layers next = dual_.next(begun, light_, 1 - peeled.residual);
        if (layers == 0) keep_first_depth(next.nearest, region);
        target_.bind(region);
        begin_blending_before_depth(GL_ONE_MINUS_DST_ALPHA, GL_ONE);  // premultiplied, below what is there
        if (looks) query.begin();
        peeled.light(next.nearest);
        if (looks) AnySamples::end();
        target_behind_.bind(region);
        begin_blending_before_depth(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);  // and above it
        peeled.light(next.farthest);
        end_blending_before_depth();
        if (looks) any = query.any();
    }
    Program& under = shaders_.full_screen("spheres/dual_under.frag");
    target_.bind(region);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    under.use();
    under.bind_texture("behind", behind_unit, light_behind_);
    triangle_.draw();
    glDisable(GL_BLEND);
    return layers;
}

int SpherePeeling::peel(const Peeled& peeled) {
    const Texture2D& depth = peeled.opaque_depth;
    fit(depth);
    light_.clear(0, 0, 0, 0);
    if (peeled.method == TransparencyMethod::dual_peeling) return peel_both_ends(peeled);
    const double enough = 1 - peeled.residual;
    const auto by_peeling = [&](int layer) {
        return layer == 0 ? peeled.sets.see(peeled.placed, peeled.width, peeled.height)
                          : peeled.sets.see_next(peeled.placed, peeled.width, peeled.height, light_, enough);
    };
    if (peeled.method == TransparencyMethod::peeling) return peel_rows(peeled, 0, peeled.height, by_peeling);

    int layers = 0;
    Peeled listed = peeled;
    if (peeled.draw_others) {
        listed.light = [&](const SeenSpheres& layer) {
            peeled.light(layer);
            lists_.draw_others(layer);
        };
    }
    unlisted_rows_.clear();
    if (listed_rows_ == 0) listed_rows_ = peeled.height;
    for (int row = 0; row < peeled.height;) {
        const int rows = std::min(listed_rows_, peeled.height - row);
        const bool held = lists_.gather({.sets = peeled.sets,
                                         .placed = peeled.placed,
                                         .width = peeled.width,
                                         .height = peeled.height,
                                         .first_row = row,
                                         .rows = rows,
                                         .opaque_depth = depth,
                                         .draw_others = peeled.draw_others});
        if (!held && rows > 1) {
            listed_rows_ = (rows + 1) / 2;
            continue;
        }
        // What not even a row's lists hold is peeled.
        if (!held) unlisted_rows_.push_back({0, row, peeled.width, rows});
        const int found =
            held ? peel_rows(listed, row, rows,
                             [&](int layer) { return lists_.next(layer == 0 ? nullptr : &light_, enough); })
                 : peel_rows(peeled, row, rows, by_peeling);
        layers = std::max(layers, found);
        row += rows;
    }
    return layers;
}

}  // namespace matchlight
