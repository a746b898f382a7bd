// The colours of the virtual layer transformed, as `[effects] color_transform` asks for it.
//
// After the shader tutorial's colour transforms: matrix, hue and saturation (Smith 1978, "Color gamut transform pairs";
// NTSC's YIQ), contrast and brightness, look-up table, grey and its tint, fade, mask. What lies behind the layer, and
// how much of it, stays.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/image.h"
#include "gl/objects.h"
#include "gl/shader_library.h"
#include "media/color_table.h"
#include "render/graph.h"
#include "render/virtual_layer.h"
#include "scene/color_transform.h"
#include "scene/scene_file.h"

namespace matchlight {

/// What the files of the settings hold. Throws InputError where one cannot be read.
struct ColorTransformFiles {
    std::optional<ColorTable> table;
    ImageF mask;  // one channel, 0 to 1; empty: everywhere

    static ColorTransformFiles read(const ColorTransformSettings& settings);
};

struct ColorTransformKnobs {
    int table_size = color_table_size;  // every so many nodes of the table that was read are kept
};
ColorTransformKnobs color_transform_knobs(QualityLevel level);

/// What a frame gives.
struct ColorTransformFrame {
    Eigen::Vector3d gain = Eigen::Vector3d::Ones();  // picture-linear light of unit light
    Region mask_frame;                               // where the mask lies, in plate pixels
};

class ColorTransform {
public:
    ColorTransform(const ColorTransformSettings& settings, const ColorTransformFiles& files,
                   const ColorTransformKnobs& knobs);

    const ColorTransformSettings& settings() const { return settings_; }
    PlateLayer add(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                   const ColorTransformFrame& frame) const;

private:
    ColorTransformSettings settings_;
    ShaderDefines defines_;
    int table_size_ = 0;
    Texture2D table_, mask_;
};

}  // namespace matchlight
