// Channels and header strings beside R, G and B.
#include "lighting/probe_record.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "lighting/dominant_lights.h"
#include "lighting/latlong_grid.h"
#include "lighting/resample.h"
#include "media/exr_file.h"
#include "media/picture_format.h"

namespace matchlight {
namespace {

/// What a stored value says.
using Meaning = std::function<float(float)>;

/// A value that is no number says nothing sure: `otherwise`.
Meaning at_least_0_or(float otherwise) {
    return [=](float value) { return std::isfinite(value) ? std::max(value, 0.0f) : otherwise; };
}

std::optional<ImageF> channel_of(const RecordedChannels& recorded, const std::string& name, const ProbeLayout& layout,
                                 const Meaning& meaning) {
    const auto found = std::find(recorded.names.begin(), recorded.names.end(), name);
    if (found == recorded.names.end()) return std::nullopt;
    const auto at = static_cast<int>(found - recorded.names.begin());
    ImageF channel(layout.width, layout.height, 1);
    for (int y = 0; y < layout.height; ++y) {
        for (int x = 0; x < layout.width; ++x) {
            channel.at(x, y) = meaning(recorded.image.at(x, y, at));
        }
    }
    return resample(channel, layout, latlong_layout_for(layout));
}

/// The middle of the weights; nullopt without any.
std::optional<double> weighted_median(std::vector<std::pair<double, double>> values_and_weights) {
    double left = 0;
    for (const auto& [value, weight] : values_and_weights) left += weight / 2;
    std::sort(values_and_weights.begin(), values_and_weights.end());
    for (const auto& [value, weight] : values_and_weights) {
        left -= weight;
        if (left <= 0) return value;
    }
    return std::nullopt;
}

/// The channel `distance_m`: nothing is nearer than a tenth of a millimetre, and half floats end at 65,504.
constexpr const char* distance_channel = "distance_m";
constexpr float nearest_m = 1e-4F, farthest_m = 65504;

float distance_of_nearness(float nearness) {
    return nearness > 1 / farthest_m ? std::max(nearest_m, 1 / nearness) : 0;
}

/// 0 where nothing sensible is stored; infinity, and what a half float makes of it, is far away.
float nearness_of_distance(float distance_m) {
    return distance_m > 0 && distance_m < farthest_m ? 1 / std::max(nearest_m, distance_m) : 0;
}

}  // namespace

void store_distances(RecordedChannels& channels, int c) {
    channels.names.emplace_back(distance_channel);
    for (int y = 0; y < channels.image.height(); ++y) {
        for (int x = 0; x < channels.image.width(); ++x) {
            channels.image.at(x, y, c) = distance_of_nearness(channels.image.at(x, y, c));
        }
    }
}

ProbeRecord read_probe_record(const std::filesystem::path& path, const ProbeImage& file) {
    ProbeRecord record;
    if (recognise_picture(path) != PictureFormat::exr) return record;
    const ExrFile exr(path);
    const Imf::Header& header = exr.header(0);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
        const std::string name = attribute.name();
        const bool of_the_format = name == "name" || name == "type" || name == "view" || name == "capDate";
        if (text && !of_the_format) record.metadata[name] = text->value();
    }
    const RecordedChannels recorded = recorded_channels(path, file.layout);
    record.sigma = channel_of(recorded, "sigma", file.layout, at_least_0_or(1));
    record.seen = channel_of(recorded, "seen", file.layout, at_least_0_or(0));
    record.clipped = channel_of(recorded, "clipped", file.layout, at_least_0_or(1));
    record.nearness = channel_of(recorded, distance_channel, file.layout, nearness_of_distance);
    return record;
}

ImageF clipped_map(const ProbeRecord& record, const ImageF& latlong) {
    return record.clipped ? *record.clipped : flat_tops(latlong);
}

ProbeCoverage coverage_of(const ProbeRecord& record, const ImageF& latlong) {
    const LatlongGrid grid(latlong.width(), latlong.height());
    const ImageF clipped = clipped_map(record, latlong);
    ProbeCoverage coverage;
    double sphere = 0;
    double unseen = 0;
    std::vector<std::pair<double, double>> sigmas;  // with the solid angle that was seen
    for (int y = 0; y < grid.height(); ++y) {
        const double solid_angle = grid.solid_angle(y);
        for (int x = 0; x < grid.width(); ++x) {
            sphere += solid_angle;
            coverage.clipped += solid_angle * std::min(1.0f, clipped.at(x, y));
            const double seen = record.seen ? std::min(1.0f, record.seen->at(x, y)) : 1.0;
            unseen += solid_angle * (1 - seen);
            if (!record.sigma || seen <= 0) continue;
            sigmas.emplace_back(record.sigma->at(x, y), seen * solid_angle);
        }
    }
    coverage.clipped /= sphere;
    if (record.seen) coverage.unseen = unseen / sphere;
    coverage.median_sigma = weighted_median(std::move(sigmas));
    return coverage;
}

std::optional<ProbeDistances> distances_of(const ProbeRecord& record) {
    if (!record.nearness) return std::nullopt;
    const ImageF& nearness = *record.nearness;
    const LatlongGrid grid(nearness.width(), nearness.height());
    ProbeDistances result;
    double sphere = 0, known = 0;
    std::vector<std::pair<double, double>> distances;  // with their solid angle
    for (int y = 0; y < grid.height(); ++y) {
        for (int x = 0; x < grid.width(); ++x) {
            sphere += grid.solid_angle(y);
            const float distance_m = distance_of_nearness(nearness.at(x, y));
            if (distance_m <= 0) continue;
            known += grid.solid_angle(y);
            distances.emplace_back(distance_m, grid.solid_angle(y));
        }
    }
    if (distances.empty()) return std::nullopt;
    result.known_share = known / sphere;
    result.least_m = std::min_element(distances.begin(), distances.end())->first;
    result.median_m = *weighted_median(std::move(distances));
    return result;
}

}  // namespace matchlight
