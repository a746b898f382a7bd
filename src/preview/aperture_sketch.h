// The opening of a lens, drawn by hand as a polygon; written as the picture that the scene's aperture is made of.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/image.h"
#include "preview/controls.h"
#include "preview/session.h"

namespace matchlight {

/// White inside the polygon, black outside, edges by the share of a pixel that is inside; `side` × `side`. Corners are
/// in shares of the side, x to the right and y down; where its edges cross, what they go round an odd number of times
/// is inside.
Image8 picture_of_polygon(std::span<const Eigen::Vector2d> corners, int side);

/// Writes the picture beside the scene, under a name of its own for every shape, so that a changed shape is another
/// file. Throws InputError.
std::filesystem::path write_aperture(const std::filesystem::path& scene, std::span<const Eigen::Vector2d> corners);

/// A square to draw in, and what takes the drawing into the table `key` ("effects.glare.aperture").
void lay_out_aperture_sketch(Session& session, Controls& controls, const std::string& key);

}  // namespace matchlight
