// Copies a texture that is larger than any cache.
#include "gl/bandwidth.h"

#include <algorithm>

#include "gl/timer.h"

namespace matchlight {

namespace {

double measure() {
    constexpr int size = 2048;  // 32 MB each
    constexpr int repeats = 5;
    const TextureShape shape{.format = GL_RGBA16F, .width = size, .height = size};
    Texture2D from(shape);
    const Texture2D to(shape);
    from.clear(1, 1, 1, 1);
    GpuTimer timer;
    double best_ms = 1e9;
    for (int i = 0; i < repeats; ++i) {
        glFinish();
        timer.start();
        glCopyImageSubData(from.name(), GL_TEXTURE_2D, 0, 0, 0, 0, to.name(), GL_TEXTURE_2D, 0, 0, 0, 0, size, size, 1);
        best_ms = std::min(best_ms, timer.stop());
    }
    constexpr double bytes = 2.0 * size * size * 8;
    return bytes / (std::max(best_ms, 1e-3) * 1e-3);
}

}  // namespace

double copy_bytes_per_second() {
    static const double measured = measure();
    return measured;
}

}  // namespace matchlight
