// What is blended before a depth buffer that stays as it is.
#pragma once

#include "gl/objects.h"

namespace matchlight {

/// What is nearer than the depth (reversed: greater) is blended by these factors, both sides of it.
inline void begin_blending_before_depth(GLenum source, GLenum destination) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFunc(source, destination);
    glDisable(GL_CULL_FACE);
}

inline void end_blending_before_depth() {
    glDepthMask(GL_TRUE);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
}

}  // namespace matchlight
