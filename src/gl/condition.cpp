// The condition is the vertex count of an indirect draw.
#include "gl/condition.h"

#include <array>

namespace matchlight {

namespace {

// glDrawArraysIndirect: count, instances, first vertex, first instance.
using DrawArguments = std::array<std::uint32_t, 4>;

}  // namespace

GpuCondition::GpuCondition(std::string unmet) : unmet_(std::move(unmet)), draw_(sizeof(DrawArguments)) {
    set(false);
}

void GpuCondition::set(bool met) {
    const DrawArguments arguments{met ? 3u : 0u, 1, 0, 0};
    draw_.upload(std::span<const std::uint32_t>(arguments));
}

void GpuCondition::bind_for_shaders() const {
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    draw_.bind(GL_SHADER_STORAGE_BUFFER, storage_binding);
}

void GpuCondition::draw_if_met(const FullScreenTriangle& triangle) const {
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, draw_.name());
    triangle.draw_indirect();
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
}

bool GpuCondition::is_met() const {
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    DrawArguments arguments{};
    draw_.read(std::span<std::uint32_t>(arguments));
    return arguments[0] != 0;
}

}  // namespace matchlight
