// A plate of even grey, and a camera before the sample's table: for tests and benchmarks that need a frame but no film.
#pragma once

#include <algorithm>
#include <filesystem>
#include <memory>

#include <Eigen/Geometry>

#include "core/transforms.h"
#include "media/plate.h"
#include "media/plate_format.h"

extern "C" {
#include <libavutil/frame.h>
}

namespace matchlight::test {

/// A 4:2:0 plate.
inline PlateFrame grey_plate(int width, int height, std::uint8_t luma = 120, std::int64_t frame_number = 0) {
    AVFrame* raw = av_frame_alloc();
    raw->width = width;
    raw->height = height;
    raw->format = AV_PIX_FMT_YUV420P;
    av_frame_get_buffer(raw, 0);
    std::fill_n(raw->data[0], static_cast<std::size_t>(raw->linesize[0]) * height, luma);
    for (int plane = 1; plane < 3; ++plane) {
        std::fill_n(raw->data[plane], static_cast<std::size_t>(raw->linesize[plane]) * height / 2, std::uint8_t{128});
    }
    const std::shared_ptr<AVFrame> samples(raw, [](AVFrame* frame) { av_frame_free(&frame); });
    return {samples, plate_format_of(*samples, 0, {}, "grey plate"), frame_number, 0.0};
}

/// Half a metre before the objects and as much above them, looking at them: about where the sample's camera stood.
inline RigidTransform camera_before_the_table() {
    const Eigen::Vector3d eye(0, -0.45, 0.42), target(0, 0.02, 0.03);
    return camera_looking_along(eye, (target - eye).normalized());
}

}  // namespace matchlight::test
