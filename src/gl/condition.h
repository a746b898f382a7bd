// A condition that one pass finds on the GPU and later passes obey there: nobody waits to hear of it.
#pragma once

#include <string>

#include "gl/objects.h"

namespace matchlight {

/// Met or not. Shaders set it through shaders/common/condition.glsl; draws and later shaders read it.
class GpuCondition {
public:
    /// `unmet` says what it means when the condition is not met: "no light above the threshold".
    explicit GpuCondition(std::string unmet);

    void set(bool met);
    /// Its buffer, for shaders that include common/condition.glsl.
    void bind_for_shaders() const;
    /// Draws the triangle when it is met; else the GPU draws none.
    void draw_if_met(const FullScreenTriangle& triangle) const;
    /// Waits for the GPU: for when its results are read back anyway.
    bool is_met() const;
    const std::string& unmet() const { return unmet_; }

    /// Where condition.glsl looks for it.
    static constexpr GLuint storage_binding = 7;

private:
    std::string unmet_;
    Buffer draw_;  // an indirect draw of three vertices, or of none
};

}  // namespace matchlight
