// Cards before the lens as objects of a scene: what the compositor makes of them stands against thin_lens_reference.h.
#pragma once

#include <optional>

#include "compositor/quality.h"
#include "core/image.h"
#include "gl/context.h"
#include "report/thin_lens_reference.h"
#include "scene/scene_file.h"
#include "tracking/solve_file.h"

namespace matchlight {

/// A scene of glowing rectangles without any other light, and where its camera stands.
struct LensCardShot {
    Scene scene;
    Solve solve;
};

/// Of the cards only r, g, b of their light are taken: they are opaque. The lens is the view's; level and knobs are
/// those of `settings`, and without it there is no depth of field.
LensCardShot lens_card_shot(const ThinLensView& view, const std::optional<DepthOfFieldSettings>& settings);

/// The virtual layer over the whole frame, premultiplied RGBA in the units of the cards' light.
ImageF composited_cards(GlContext& context, const LensCardShot& shot, const Quality& quality);
/// RGB of the whole picture, over what the shot's scene has behind the cards.
ImageF composited_frame(GlContext& context, const LensCardShot& shot, const Quality& quality);

}  // namespace matchlight
