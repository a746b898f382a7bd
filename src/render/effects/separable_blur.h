// One kernel along rows, then along columns, over light and coverage of the virtual layer.
#pragma once

#include <string>
#include <vector>

#include "gl/shader_library.h"
#include "render/graph.h"
#include "render/virtual_layer.h"

namespace matchlight {

/// `taps` count from the middle to one side. Beyond the frame's edge the layer goes on as it ends there.
PlateLayer add_separable_blur(RenderGraph& graph, ShaderLibrary& shaders, const PlateLayer& layer,
                              const std::vector<float>& taps, const std::string& name);

}  // namespace matchlight
