// Depth of field by gathering: classes of circles before and beyond the focus, each at a resolution of its own.
//
// The layer's points are sorted by the width of their circle into classes that double from one to the next, on either
// side of the focus; what hides behind the nearest surface is drawn, too. Each class scatters by gathering (a texel
// collects what its neighbours' discs send it, each disc sharing its light evenly) on texels as coarse as its discs
// allow, no farther than the widest disc near by. Then the classes go over each other from near to far: signed circles
// grow with depth, so classes are slices of depth. Coverages add up, so that a surface that crosses classes has no
// seam. After the near and far fields of Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced
// Warfare", and the slices of Kraus & Strengert 2007, "Depth-of-Field Rendering by Pyramidal Image Processing".
#pragma once

#include <functional>
#include <memory>

#include "gl/objects.h"
#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "render/graph.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What trades error for time.
struct GatherKnobs {
    double first_class_px = 4;  // circles narrower than this are one class, from 2 to 16
    int fine_classes = 3;       // so many are gathered at full resolution, from 1 to 4; then texels double, too
    bool hidden = true;         // draw what the nearest surface hides
    bool reflections = true;    // may have a focus of their own, at their virtual image
    bool full_float = false;    // textures of 32 bits a channel instead of 16

    /// Throws std::invalid_argument naming what is out of range.
    void check() const;
};
GatherKnobs gather_knobs(QualityLevel quality);

struct GatherInput {
    GraphTexture layer_drawn;                  // what the layer's pass provides
    std::function<void(Program&)> bind_layer;  // uniforms of common/lens_map.glsl, composite/layer.glsl and
                                               // effects/depth_of_field/gather_resolve.frag but for those of the focus
    ShaderDefines layer_defines;               // of composite/layer.glsl
    bool is_transparent = false;               // the layer lets light through, and has its depths times its coverage
    Region region;                             // plate pixels that the blurred layer can reach
    double layer_density = 1;                  // layer pixels along a plate pixel
    double magnification = 1;                  // a disc may be drawn this much larger: lenses bend
    Focus focus;
    CocRange range;
    BokehSettings bokeh;
};

/// Widest circle that is drawn, in plate pixels: wider ones, which cover the frame from any place in it, are as this.
double widest_gathered_coc_px(int frame_width, int frame_height);

/// How far a circle sends its light as it is drawn, in plate pixels: on coarse texels it ends less sharply.
double gathered_reach_px(double coc_px, const GatherKnobs& knobs);

class GatherDefocus {
public:
    explicit GatherDefocus(ShaderLibrary& shaders) : shaders_(shaders) {}

    /// RGBA32F over the region: premultiplied radiance in probe units, coverage. Points whose circle is narrower than
    /// least_coc_px stay where they are, bit for bit.
    GraphTexture add(RenderGraph& graph, const GatherInput& input, const GatherKnobs& knobs);

private:
    class Passes;

    ShaderLibrary& shaders_;
    Texture2D discs_;  // disc_table() of the settings last used
    BokehSettings discs_bokeh_;
    double discs_radius_ = 0;
};

}  // namespace matchlight
