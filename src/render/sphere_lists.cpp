// Counts, places, keeps, heaps.
#include "render/sphere_lists.h"

#include <algorithm>
#include <array>

namespace matchlight {

namespace {

/// These programs have neither light nor material.
constexpr GLuint picture_unit = 3;
/// Culling binds others of its own between draws.
constexpr GLuint counts_image = 2, starts_image = 3;
constexpr GLuint total_buffer = 2, entries_buffer = 3, light_buffer = 5;

struct Entry {
    std::uint32_t id = 0;
    float depth_share = 0;
};

/// Of what is no sphere.
using HalfLight = std::array<std::uint16_t, 4>;

}  // namespace

std::uint32_t SphereLists::most_entries() {
    GLint64 bytes = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    constexpr GLint64 enough_bytes = GLint64{1} << 29;
    return static_cast<std::uint32_t>(std::min(bytes, enough_bytes) / static_cast<GLint64>(sizeof(Entry)));
}

void SphereLists::fit(int width, int height) {
    if (counts_ && counts_.width() >= width && counts_.height() >= height) return;
    TextureShape shape{.format = GL_R32UI, .width = width, .height = height};
    counts_ = Texture2D(shape);
    starts_ = Texture2D(shape);
    id_ = Texture2D(shape);
    shape.format = GL_DEPTH_COMPONENT32F;
    depth_ = Texture2D(shape);
    target_ = Framebuffer({id_}, depth_);
    total_ = Buffer(2 * sizeof(std::uint32_t));
}

bool SphereLists::gather(const Gathered& gathered) {
    fit(gathered.width, gathered.height);
    if (most_entries_ == 0) most_entries_ = most_entries();
    if (opaque_depth_ != gathered.opaque_depth.name()) {
        opaque_ = Framebuffer({}, gathered.opaque_depth);
        opaque_depth_ = gathered.opaque_depth.name();
    }
    rows_ = {0, gathered.first_row, gathered.width, gathered.rows};
    const std::uint32_t none = 0;
    glClearTexImage(counts_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
    total_.clear();

    const auto draw = [&](bool counts) {
        opaque_.bind({0, 0, gathered.width, gathered.height});
        glEnable(GL_SCISSOR_TEST);
        glScissor(rows_.x, rows_.y, rows_.width, rows_.height);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_GREATER);
        glDepthMask(GL_FALSE);
        glDisable(GL_BLEND);
        glDisable(GL_CULL_FACE);
        counts_.bind_image(counts_image, GL_READ_WRITE);
        starts_.bind_image(starts_image, GL_READ_WRITE);
        gathered.sets.draw_each(
            {.placed = gathered.placed,
             .width = gathered.width,
             .height = gathered.height,
             .fragment = "spheres/gather.frag",
             .defines = {{counts ? "COUNT" : "KEEP", "1"}},
             .set_up =
                 [&](Program& program) { program.set("end_px", Eigen::Vector2i(rows_.width, rows_.y + rows_.height)); },
             .depth = &gathered.opaque_depth,
             .peeled = nullptr});
        if (gathered.draw_others) gathered.draw_others(counts);
        glDepthMask(GL_TRUE);
        glDisable(GL_DEPTH_TEST);
        glDisable(GL_SCISSOR_TEST);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    };
    const auto run = [&](const char* file) {
        Program& program = shaders_.program({{GL_COMPUTE_SHADER, file}});
        program.use();
        program.set("first_row", rows_.y);
        program.set("size_px", Eigen::Vector2i(rows_.width, rows_.height));
        counts_.bind_image(counts_image, GL_READ_WRITE);
        starts_.bind_image(starts_image, GL_READ_WRITE);
        total_.bind(GL_SHADER_STORAGE_BUFFER, total_buffer);
        constexpr int group = 8;
        glDispatchCompute(static_cast<GLuint>((rows_.width + group - 1) / group),
                          static_cast<GLuint>((rows_.height + group - 1) / group), 1);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                        GL_BUFFER_UPDATE_BARRIER_BIT);
    };
    draw(true);
    run("spheres/lists_place.comp");
    std::array<std::uint32_t, 2> total{};
    total_.read(std::span<std::uint32_t>(total));
    if (total[0] > most_entries_ || total[1] != 0) return false;
    if (!entries_.name() || capacity_ < total[0]) {
        capacity_ = std::min(most_entries_, std::max(total[0] + total[0] / 4, 1U << 16));
        entries_ = Buffer(std::size_t{capacity_} * sizeof(Entry));
    }
    const bool has_others = static_cast<bool>(gathered.draw_others);
    if (has_others && (!light_.name() || light_capacity_ < total[0])) {
        light_ = Buffer(std::size_t{capacity_} * sizeof(HalfLight));
        light_capacity_ = capacity_;
    }
    entries_.bind(GL_SHADER_STORAGE_BUFFER, entries_buffer);
    if (has_others) light_.bind(GL_SHADER_STORAGE_BUFFER, light_buffer);
    draw(false);
    entries_.bind(GL_SHADER_STORAGE_BUFFER, entries_buffer);
    run("spheres/lists_heap.comp");
    return true;
}

SeenSpheres SphereLists::next(const Texture2D* covered, double enough) {
    target_.bind({0, 0, rows_.width, rows_.y + rows_.height});
    glEnable(GL_SCISSOR_TEST);
    glScissor(rows_.x, rows_.y, rows_.width, rows_.height);
    target_.clear_color_integer(0, 0);
    target_.clear_depth();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    Program& program = shaders_.full_screen("spheres/lists_next.frag");
    program.use();
    counts_.bind_image(counts_image, GL_READ_WRITE);
    starts_.bind_image(starts_image, GL_READ_WRITE);
    entries_.bind(GL_SHADER_STORAGE_BUFFER, entries_buffer);
    if (light_.name()) light_.bind(GL_SHADER_STORAGE_BUFFER, light_buffer);
    program.set("is_first", covered == nullptr);
    if (covered != nullptr) program.bind_texture("covered", picture_unit, *covered);
    program.set("enough", enough);
    triangle_.draw();
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_SCISSOR_TEST);
    return {&id_, &depth_};
}

void SphereLists::draw_others(const SeenSpheres& layer) {
    Program& program = shaders_.full_screen("surface/listed_layer.frag");
    program.use();
    program.bind_texture("taken", picture_unit, *layer.id);
    program.bind_texture("taken_depth", picture_unit + 1, *layer.depth_share);
    light_.bind(GL_SHADER_STORAGE_BUFFER, light_buffer);
    triangle_.draw();
}

}  // namespace matchlight
