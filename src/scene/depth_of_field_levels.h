// The methods of depth of field by name.
#pragma once

#include <array>
#include <string_view>

namespace matchlight {

/// As scene files have them, in the order of DepthOfFieldLevel.
inline constexpr std::array<std::string_view, 7> depth_of_field_levels{"gather", "two_pass",  "one_pass",    "layers",
                                                                       "mipmap", "diffusion", "lens_samples"};

}  // namespace matchlight
