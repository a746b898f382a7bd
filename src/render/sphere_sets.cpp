// One picture of numbers and depths for all sets.
#include "render/sphere_sets.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "core/error.h"

namespace matchlight {

namespace {

/// These programs have neither light nor material.
constexpr GLuint peeling_unit = 3;

void set_depth_state() {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
}

}  // namespace

std::size_t SphereSets::add(const SphereSet& set) {
    constexpr std::uint32_t no_sphere = 0x80000000;  // and above: other numbers (shaders/surface/listed.glsl)
    if (set.size() >= no_sphere - next_id_) {
        throw InputError(set.name, fmt::format("{} spheres are more than can be numbered beside {} others", set.size(),
                                               next_id_ - 1));
    }
    sets_.push_back({std::make_unique<SphereGeometry>(set), next_id_});
    next_id_ += static_cast<std::uint32_t>(set.size());
    return sets_.size() - 1;
}

void SphereSets::Targets::fit(int width, int height) {
    if (id && id.width() >= width && id.height() >= height) return;
    constexpr int step = 64;
    const auto rounded = [](int size, int before) { return std::max((size + step - 1) / step * step, before); };
    TextureShape shape{.format = GL_R32UI,
                       .width = rounded(width, id ? id.width() : 0),
                       .height = rounded(height, id ? id.height() : 0)};
    id = Texture2D(shape);
    shape.format = GL_DEPTH_COMPONENT32F;
    depth = Texture2D(shape);
    target = Framebuffer({id}, depth);
}

void SphereSets::draw(std::span<const PlacedSpheres> placed, int width, int height, Targets& targets,
                      const Sought& sought) {
    targets.fit(width, height);
    targets.target.bind({0, 0, width, height});
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, width, height);
    targets.target.clear_color_integer(0, 0);
    targets.target.clear_depth();
    glDisable(GL_SCISSOR_TEST);
    set_depth_state();
    if (sought.begin) sought.begin();
    ShaderDefines defines;
    if (sought.define != nullptr) defines[sought.define] = "1";
    draw_each({.placed = placed,
               .width = width,
               .height = height,
               .fragment = "spheres/visible.frag",
               .defines = defines,
               .set_up = sought.set_up,
               .depth = &targets.depth,
               .peeled = sought.peeled,
               .depth_is_cleared = !sought.begin});
    glDisable(GL_DEPTH_TEST);
    last_ = &targets;
}

void SphereSets::draw_each(const EachDraw& drawn) {
    const std::vector<ShaderStage> stages{{GL_VERTEX_SHADER, "spheres/sphere.vert"},
                                          {GL_FRAGMENT_SHADER, drawn.fragment}};
    for (const PlacedSpheres& one : drawn.placed) {
        const SphereRays rays({.clip_from_world = one.clip_from_world, .width = drawn.width, .height = drawn.height},
                              one.world_from_model);
        ShaderDefines defines = drawn.defines;
        if (rays.is_long_lens()) defines["LONG_LENS"] = "1";
        Program& points = shaders_.program(stages, defines);
        defines["TRIANGLES"] = "1";
        Program& triangles = shaders_.program(stages, defines);
        for (Program* program : {&points, &triangles}) {
            program->use();
            rays.set(*program);
            program->set("first_id", first_id(one.set));
            if (drawn.set_up) drawn.set_up(*program);
        }
        culling_.draw({.geometry = geometry(one.set),
                       .rays = rays,
                       .points = points,
                       .triangles = triangles,
                       .depth = drawn.depth,
                       .width = drawn.width,
                       .height = drawn.height,
                       .peeled = drawn.peeled,
                       .detail = one.detail,
                       .depth_is_cleared = drawn.depth_is_cleared && &one == drawn.placed.data()},
                      visibility);
    }
}

SeenSpheres SphereSets::see(std::span<const PlacedSpheres> placed, int width, int height,
                            const Texture2D* nearer_share) {
    if (nearer_share == nullptr) {
        draw(placed, width, height, nearest_, {});
        return {&nearest_.id, &nearest_.depth};
    }
    draw(placed, width, height, behind_, {.define = "BEHIND", .set_up = [&](Program& program) {
                                              program.bind_texture("nearest_depth_share", peeling_unit, *nearer_share);
                                          }});
    return {&behind_.id, &behind_.depth};
}

SeenSpheres SphereSets::see_next(std::span<const PlacedSpheres> placed, int width, int height, const Texture2D& covered,
                                 double enough) {
    assert(last_ != nullptr);
    const Targets& before = *last_;
    Targets& targets = &before == peeled_.data() ? peeled_[1] : peeled_[0];
    const auto leave_finished = [&] {
        Program& finished = shaders_.full_screen("spheres/finished.frag");
        finished.use();
        finished.bind_texture("nearest_id", peeling_unit, before.id);
        finished.bind_texture("covered", peeling_unit + 1, covered);
        finished.set("enough", enough);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        triangle_.draw();
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    };
    draw(placed, width, height, targets,
         {.define = "PEEL",
          .set_up =
              [&](Program& program) {
                  program.bind_texture("nearest_depth_share", peeling_unit, before.depth);
                  program.bind_texture("nearest_id", peeling_unit + 1, before.id);
              },
          .begin = leave_finished,
          .peeled = &before.depth});
    return {&targets.id, &targets.depth};
}

void SphereSets::cast(std::size_t set, const Eigen::Matrix4d& world_from_model, const SphereCast& cast) {
    const SphereRays rays(cast.view, world_from_model);
    const std::vector<ShaderStage> stages{{GL_VERTEX_SHADER, "spheres/sphere.vert"},
                                          {GL_FRAGMENT_SHADER, cast.fragment}};
    ShaderDefines defines{{"SPHERES", "1"}};
    if (cast.view.is_parallel) defines["PARALLEL"] = "1";
    Program& points = shaders_.program(stages, defines);
    defines["TRIANGLES"] = "1";
    Program& triangles = shaders_.program(stages, defines);
    for (Program* program : {&points, &triangles}) {
        program->use();
        rays.set(*program);
        if (cast.set_up) cast.set_up(*program);
    }
    culling_.draw({.geometry = geometry(set),
                   .rays = rays,
                   .points = points,
                   .triangles = triangles,
                   .depth = cast.depth,
                   .width = cast.view.width,
                   .height = cast.view.height},
                  visibility);
}

}  // namespace matchlight
