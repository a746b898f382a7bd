// Tables of the response, and their use on regions of a frame.
#include "tracking/plate_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include <Eigen/Core>

#include "media/ocio_space.h"

namespace matchlight {

namespace {

// Y'CbCr reaches a little below 0 and above 1; the table holds that too, in steps of a quarter of a 10-bit code.
constexpr double first_code = -0.1;
constexpr double last_code = 1.15;
constexpr int steps_per_unit = 4096;
constexpr int table_size = static_cast<int>((last_code - first_code) * steps_per_unit) + 2;

}  // namespace

Response footage_response(const FootageSettings& footage) {
    if (!footage.ocio_space.empty()) {
        OcioSpace space = ocio_space(footage.ocio_config, footage.ocio_space);
        std::array<Response::Curve, 3> curves;
        for (std::size_t c = 0; c < 3; ++c) curves[c] = {space.codes, std::move(space.linear[c])};
        return Response::from_curves(std::move(curves), footage.ocio_config);
    }
    return footage.response ? Response::load(*footage.response) : Response::srgb();
}

Response effective_response(const Response& scene_response, Transfer transfer) {
    switch (transfer) {
        case Transfer::pq:
            return Response::pq();
        case Transfer::hlg:
            return Response::hlg();
        case Transfer::camera:
            break;
    }
    return scene_response;
}

PlateLight::PlateLight(const Response& response, Transfer transfer) {
    const Response curve = effective_response(response, transfer);
    for (int channel = 0; channel < 3; ++channel) {
        std::vector<float>& table = tables_[static_cast<std::size_t>(channel)];
        table.resize(table_size);
        for (int i = 0; i < table_size; ++i) {
            const double code = first_code + static_cast<double>(i) / steps_per_unit;
            table[static_cast<std::size_t>(i)] = static_cast<float>(curve.linear_from_code(code, channel));
        }
        clipped_light_[static_cast<std::size_t>(channel)] = curve.linear_from_code(clipped_code, channel);
    }
}

double PlateLight::light_from_code(float code, int channel) const {
    const std::vector<float>& table = tables_[static_cast<std::size_t>(channel)];
    const float position = (code - static_cast<float>(first_code)) * steps_per_unit;
    const float clamped = std::clamp(position, 0.0f, static_cast<float>(table_size - 2));
    const auto index = static_cast<std::size_t>(clamped);
    const float fraction = clamped - static_cast<float>(index);
    return table[index] + fraction * (table[index + 1] - table[index]);
}

ImageF PlateLight::gray(const PlateFrame& frame, const Region& region) const {
    ImageF image = frame.gray_code(region);
    for (float& sample : image.samples()) sample = static_cast<float>(light_from_code(sample, 1));
    return image;
}

ImageF PlateLight::rgb(const PlateFrame& frame, const Region& region) const {
    ImageF image = frame.rgb_code(region);
    const Eigen::Matrix3d& light_from_footage = rec709_from(frame.format().primaries);
    const std::span<float> samples = image.samples();
    for (std::size_t i = 0; i < samples.size(); i += 3) {
        Eigen::Vector3d footage_linear;
        for (int c = 0; c < 3; ++c) footage_linear[c] = light_from_code(samples[i + static_cast<std::size_t>(c)], c);
        Eigen::Map<Eigen::Vector3f> pixel(&samples[i]);
        pixel = (light_from_footage * footage_linear).cast<float>();
    }
    return image;
}

}  // namespace matchlight
