// Three flat tags and a camera that moves while its shutter is open.
#pragma once

#include <random>

#include "core/transfer.h"
#include "report/tag_view_reference.h"
#include "synthetic_view.h"
#include "tracking/rig_image_fit.h"

namespace matchlight::test {

/// Sheets of 80, 60 and 60 mm, 36h11.
inline std::vector<TagSheet> three_sheets() {
    const TagFamily family("tag36h11");
    std::vector<TagSheet> sheets;
    for (int id = 0; id < 3; ++id) {
        TagSheet sheet;
        sheet.pattern = family.pattern(id);
        sheet.id = id;
        sheet.size_m = id == 0 ? 0.08 : 0.06;
        sheet.world_from_tag.linear() = rotation_from_degrees({0, 0, 25.0 * id});
        sheet.world_from_tag.translation() = Eigen::Vector3d(id == 0 ? 0 : (id == 1 ? -0.11 : 0.11), 0.01 * id, 0);
        sheets.push_back(sheet);
    }
    return sheets;
}

inline std::vector<PlacedSheet> placed(const std::vector<TagSheet>& sheets) {
    std::vector<PlacedSheet> result;
    for (const TagSheet& sheet : sheets) {
        result.push_back({sheet.id, sheet.size_m, sheet.world_from_tag, sheet.pattern});
    }
    return result;
}

/// One second is one exposure; `motion` and `bend` as in MovingCamera.
inline TagView moving_view(const RigidTransform& camera_from_world, const PoseStep& motion, const PoseStep& bend) {
    TagView view;
    view.camera = ordinary_camera();
    view.exposure_s = 1;
    view.camera_from_world = [=](double time) {
        return perturbed(camera_from_world, time * motion + 0.5 * time * time * bend);
    };
    view.tags = three_sheets();
    return view;
}

/// Noise of `codes` in sRGB code values, rounded to 8 bits.
inline void add_noise(ImageF& light, double codes, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, codes);
    for (float& sample : light.samples()) {
        const double code = 255 * srgb_code_from_linear(sample) + noise(random);
        sample = static_cast<float>(linear_from_srgb_code(std::clamp(std::round(code), 0.0, 255.0) / 255));
    }
}

/// Mean distance in the picture between where two poses show the corners of the sheets.
inline double corner_distance_px(const RigidTransform& a, const RigidTransform& b, const Camera& camera) {
    double sum = 0;
    const std::vector<TagSheet> sheets = three_sheets();
    for (const TagSheet& sheet : sheets) {
        const Eigen::Matrix<double, 3, 4> corners = sheet.world_from_tag * tag_corners_m(sheet.size_m);
        for (int i = 0; i < 4; ++i) {
            sum += (camera.pixel_from_camera(a * corners.col(i)) - camera.pixel_from_camera(b * corners.col(i))).norm();
        }
    }
    return sum / (4.0 * static_cast<double>(sheets.size()));
}

}  // namespace matchlight::test
