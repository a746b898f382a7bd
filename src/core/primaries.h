// Colours of red, green and blue light, and the way from one set of them to Rec.709's.
#pragma once

#include <Eigen/Core>

namespace matchlight {

/// Of footage. All of them have D65 as white, so that grey stays grey.
enum class Primaries { rec709, rec2020, p3 };

/// Linear light of Rec.709 from linear light of these. Its rows sum to 1.
const Eigen::Matrix3d& rec709_from(Primaries primaries);
/// The inverse.
const Eigen::Matrix3d& from_rec709(Primaries primaries);

/// "Rec.709", "Rec.2020", "P3".
const char* name_of(Primaries primaries);

}  // namespace matchlight
