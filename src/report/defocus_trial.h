// A method of depth of field on a layer made up on the CPU.
#pragma once

#include <functional>

#include "gl/shader_library.h"
#include "render/effects/depth_of_field.h"
#include "report/defocus_reference.h"

namespace matchlight {

using AddDefocus = std::function<GraphTexture(RenderGraph&, ShaderLibrary&, const DefocusInput&)>;

/// Runs it on `region` of the images, which is all of the frame unless it is given; what it makes of that, RGBA over
/// the frame. Circles of 64ths of a pixel come to the method as they are;
/// beyond the focus they are under 16384 px.
ImageF run_defocus(ShaderLibrary& shaders, const DefocusImages& images, const AddDefocus& add, Region region = {});

/// Share of a point's light (coverage 1, all of it in the picture) that is not where the round disc has it.
double share_beside_disc(const ImageF& picture, int x, int y, double coc_px);

}  // namespace matchlight
