// Pictures of the state of each pixel, one drawn from the other.
#include "render/sphere_dual_peeling.h"

namespace matchlight {

namespace {

/// These programs have neither light nor material.
constexpr GLuint state_unit = 3;
/// Culling binds others of its own between draws.
constexpr GLuint first_image = 2;
constexpr std::uint32_t no_id = 0xFFFFFFFF;

void fill(const Texture2D& texture, std::uint32_t value) {
    glClearTexImage(texture.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

}  // namespace

void SphereDualPeeling::fit(const Texture2D& opaque_depth) {
    const int width = opaque_depth.width(), height = opaque_depth.height();
    if (between_ && between_.width() == width && between_.height() == height && opaque_ == opaque_depth.name()) return;
    const auto texture = [&](GLenum format) {
        return Texture2D(TextureShape{.format = format, .width = width, .height = height});
    };
    for (State& state : states_) {
        state.depths = texture(GL_RG32F);
        state.last = texture(GL_RG32UI);
        state.target = Framebuffer({state.depths, state.last});
    }
    between_ = texture(GL_RG32F);
    reach_ = texture(GL_DEPTH_COMPONENT32F);
    for (Texture2D* counted : {&near_id_, &far_id_, &near_count_, &far_count_}) *counted = texture(GL_R32UI);
    between_target_ = Framebuffer({between_}, reach_);
    reach_target_ = Framebuffer({}, reach_);
    for (std::size_t end = 0; end < 2; ++end) {
        layer_id_.at(end) = texture(GL_R32UI);
        layer_depth_.at(end) = texture(GL_DEPTH_COMPONENT32F);
        layer_targets_.at(end) = Framebuffer({layer_id_.at(end)}, layer_depth_.at(end));
    }
    opaque_ = opaque_depth.name();
}

void SphereDualPeeling::begin(const Begun& begun) {
    fit(begun.opaque_depth);
    // Nothing lies at these depths, and everything between them.
    const State& state = states_.at(now_);
    state.target.clear_color(0, 2, -1, 0, 0);
    draw_between(begun);
}

void SphereDualPeeling::draw_between(const Begun& begun) {
    const Region region{0, 0, begun.width, begun.height};
    const State& state = states_.at(now_);
    // What is behind the farthest that is left, or behind what is opaque, fails the depth test.
    reach_target_.bind(region);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    Program& reach = shaders_.full_screen("spheres/dual_reach.frag");
    reach.use();
    reach.bind_texture("depths", state_unit, state.depths);
    reach.bind_texture("opaque_depth", state_unit + 1, begun.opaque_depth);
    triangle_.draw();

    fill(near_id_, no_id);
    fill(far_id_, 0);
    fill(near_count_, 0);
    fill(far_count_, 0);
    between_target_.bind(region);
    between_target_.clear_color(0, -1, -1, 0, 0);
    glDepthFunc(GL_GEQUAL);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendEquation(GL_MAX);
    GLuint image = first_image;
    for (const Texture2D* counted : {&near_id_, &far_id_, &near_count_, &far_count_})
        counted->bind_image(image++, GL_READ_WRITE);
    begun.sets.draw_each({.placed = begun.placed,
                          .width = begun.width,
                          .height = begun.height,
                          .fragment = "spheres/dual.frag",
                          .defines = {},
                          .set_up =
                              [&](Program& program) {
                                  program.bind_texture("depths", state_unit, state.depths);
                                  program.bind_texture("last", state_unit + 1, state.last);
                              },
                          .depth = &reach_,
                          .peeled = nullptr});
    glBlendEquation(GL_FUNC_ADD);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void SphereDualPeeling::find_state(const Begun& begun, const Texture2D& covered, double enough) {
    const State& before = states_.at(now_);
    now_ = 1 - now_;
    states_.at(now_).target.bind({0, 0, begun.width, begun.height});
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    Program& program = shaders_.full_screen("spheres/dual_state.frag");
    program.use();
    GLuint unit = state_unit;
    program.bind_texture("depths", unit++, before.depths);
    program.bind_texture("last", unit++, before.last);
    program.bind_texture("between", unit++, between_);
    program.bind_texture("near_id", unit++, near_id_);
    program.bind_texture("far_id", unit++, far_id_);
    program.bind_texture("near_count", unit++, near_count_);
    program.bind_texture("far_count", unit++, far_count_);
    program.bind_texture("covered", unit, covered);
    program.set("enough", enough);
    triangle_.draw();
}

SeenSpheres SphereDualPeeling::layer_of(const Begun& begun, bool farthest) {
    const std::size_t end = farthest ? 1 : 0;
    const Framebuffer& target = layer_targets_.at(end);
    target.bind({0, 0, begun.width, begun.height});
    target.clear_color_integer(0, 0);
    target.clear_depth();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    Program& program =
        shaders_.full_screen("spheres/dual_layer.frag", farthest ? ShaderDefines{{"FARTHEST", "1"}} : ShaderDefines{});
    program.use();
    program.bind_texture("depths", state_unit, states_.at(now_).depths);
    program.bind_texture("found_id", state_unit + 1, farthest ? far_id_ : near_id_);
    program.bind_texture("found_count", state_unit + 2, farthest ? far_count_ : near_count_);
    triangle_.draw();
    glDisable(GL_DEPTH_TEST);
    return {&layer_id_.at(end), &layer_depth_.at(end)};
}

SphereDualPeeling::Layers SphereDualPeeling::next(const Begun& begun, const Texture2D& covered, double enough) {
    find_state(begun, covered, enough);
    draw_between(begun);
    return {layer_of(begun, false), layer_of(begun, true)};
}

}  // namespace matchlight
