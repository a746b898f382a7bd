// How an object's light is shaded in place of its physical material.
#pragma once

#include <array>

namespace matchlight {

enum class ShadingModel { physical, phong, blinn_phong, cartoon, gooch };

/// Of all models but the physical one, each what it needs. Colours are scene-linear.
struct ClassicShading {
    ShadingModel model = ShadingModel::physical;
    double shininess = 32;                  // the highlight's exponent
    int tones = 3;                          // of cartoon: steps of light
    std::array<double, 3> cool{0, 0, 0.4};  // of Gooch: away from the light, and towards it
    std::array<double, 3> warm{0.4, 0.4, 0};
    double cool_share = 0.2, warm_share = 0.6;  // of the object's own colour in them
    double outline_px = 0;                      // edges, plate pixels wide; 0: none
    std::array<double, 3> outline_color{0, 0, 0};

    bool operator==(const ClassicShading&) const = default;
};

}  // namespace matchlight
