// What the camera filmed, for what is seen through virtual things.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "compositor/lens_map.h"
#include "core/image.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "render/composite_pass.h"

namespace matchlight {

/// The plate's light in probe units as a lens without distortion would have shown it, blurred by ever wider squares:
/// the uniforms `plate_behind…` of surface/transmission.glsl.
class PlateBehind {
public:
    struct Source {
        const ImageF& code;  // over the whole picture
        Region shown;        // what of it is the footage's frame
        const Camera& camera;
        const LensMap& lens_map;
        const FrameOptics& optics;
        std::function<Eigen::Vector3d(const float* code)> light_from_code;  // Rec.709, plate-linear
    };
    explicit PlateBehind(const Source& source);
    /// Of a background in place of a plate: RGB in probe units, over the whole picture, or one pixel for all of it.
    PlateBehind(const ImageF& background, const Camera& camera, const RigidTransform& camera_from_world);

    void bind(Program& program) const;
    static constexpr GLuint unit = 41;  // beyond those of materials

private:
    void take(const ImageF& picture, const Camera& camera, const RigidTransform& camera_from_world);

    Texture2D picture_;  // premultiplied with whether the frame shows it
    Eigen::Matrix4f picture_from_world_;
};

/// The picture, RGBA.
ImageF undistorted_light(const PlateBehind::Source& source);

}  // namespace matchlight
