// The plate's code values as scene-linear light, fast enough for whole frames.
#pragma once

#include <array>
#include <vector>

#include "calibration/response.h"
#include "core/image.h"
#include "media/plate.h"
#include "scene/scene_file.h"

namespace matchlight {

/// Linear light of code values through the camera's response, tabulated once a clip.
class PlateLight {
public:
    /// A code from here on is taken as clipped: it is a lower bound of the light only.
    static constexpr double clipped_code = 0.98;

    /// `response` is the scene's; footage marked PQ or HLG uses that curve instead.
    PlateLight(const Response& response, Transfer transfer);

    double light_from_code(float code, int channel) const;
    /// The light above which `channel` is clipped.
    double clipped_light(int channel) const { return clipped_light_[static_cast<std::size_t>(channel)]; }

    /// One channel for geometry: luma (or green) through the green curve. The edge of ink on paper lies at the same
    /// place in it as in light, because both sides have about the same colour.
    ImageF gray(const PlateFrame& frame, const Region& region) const;
    /// Of Rec.709's primaries, whatever the footage's are.
    ImageF rgb(const PlateFrame& frame, const Region& region) const;

private:
    std::array<std::vector<float>, 3> tables_;
    std::array<double, 3> clipped_light_{};
};

/// The curve that a scene says: of its OpenColorIO space, of its response, or sRGB. Throws InputError.
Response footage_response(const FootageSettings& footage);

/// The curve that holds for footage of this transfer.
Response effective_response(const Response& scene_response, Transfer transfer);

}  // namespace matchlight
