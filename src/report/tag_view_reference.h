// Pictures of tags as a camera takes them, with exactly known places: the reference that tracking is held against.
//
// Plain ray casting in double precision. A pixel is the mean over its own area, the lens' aperture and the exposure,
// by samples that are symmetric about the pixel's centre, the middle of the lens and mid-exposure: what moves or blurs
// evenly is not shifted.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include "calibration/camera.h"
#include "calibration/response.h"
#include "calibration/tag_family.h"
#include "core/image.h"
#include "core/transforms.h"
#include "media/plate.h"

namespace matchlight {

/// A printed tag; light is linear and diffuse.
struct TagSheet {
    TagPattern pattern;
    int id = 0;
    double size_m = 0.08;  // between the detection corners
    RigidTransform world_from_tag = RigidTransform::Identity();
    double paper = 0.8, ink = 0.05;  // light
    double margin_cells = 1;         // of paper around the pattern's cells
};

/// An even rectangle in z = 0 of its own frame, seen from both sides: what hides a tag.
struct HidingCard {
    RigidTransform world_from_card = RigidTransform::Identity();
    double width_m = 0.1, height_m = 0.1;
    double light = 0.2;
};

struct TagView {
    Camera camera;
    /// At seconds from mid-exposure of the middle row.
    std::function<RigidTransform(double time_s)> camera_from_world;
    double exposure_s = 0;
    double readout_s = 0;  // rolling shutter: from the first row to the last
    /// Thin lens: circle of confusion (diameter, px) = fx · aperture_m · |1/focus_distance_m − 1/z|.
    double aperture_m = 0;
    double focus_distance_m = std::numeric_limits<double>::infinity();
    double ground = 0.3;  // light where no sheet is
    std::vector<TagSheet> tags;
    std::vector<HidingCard> cards;
    int rays = 257;  // of a pixel that is not even; odd
};

/// Linear light, one channel. All cores; the same bits on any number of them.
ImageF reference_light(const TagView& view);

/// When a row is at mid-exposure, seconds from the middle row's.
double row_time_s(const TagView& view, double row_px);

/// Where the detection corners of a tag are at mid-exposure of the rows they fall on, in tag_corners_m's order.
Eigen::Matrix<double, 2, 4> reference_corners_px(const TagView& view, const TagSheet& tag);

/// From light to what is recorded: plate light = light · 2^exposure_ev · white balance · vignette + noise.
struct Recording {
    Response response = Response::srgb();
    double exposure_ev = 0;
    std::array<double, 3> white_balance{1, 1, 1};
    std::array<double, 2> vignette{};       // gain = 1 + v1 r² + v2 r⁴, r = 1 at the corner
    double read_noise = 0, shot_noise = 0;  // variance = read² + shot · signal, of plate light
    double code_noise = 0;                  // standard deviation of the code value, of 255
    unsigned seed = 1;
};

/// RGB in 8 bits.
Image8 recorded_picture(const ImageF& light, const Recording& recording);

/// The picture as a frame of footage.
PlateFrame recorded_frame(const Image8& picture, std::int64_t index, double time_s);

}  // namespace matchlight
