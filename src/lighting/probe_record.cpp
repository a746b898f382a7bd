// Channels and header strings beside R, G and B.
#include "lighting/probe_record.h"

#include <algorithm>
#include <cmath>
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

/// A value that is no number says nothing sure: `otherwise`.
std::optional<ImageF> channel_of(const RecordedChannels& recorded, const std::string& name, const ProbeLayout& layout,
                                 float otherwise) {
    const auto found = std::find(recorded.names.begin(), recorded.names.end(), name);
    if (found == recorded.names.end()) return std::nullopt;
    const auto at = static_cast<int>(found - recorded.names.begin());
    ImageF channel(layout.width, layout.height, 1);
    for (int y = 0; y < layout.height; ++y) {
        for (int x = 0; x < layout.width; ++x) {
            const float value = recorded.image.at(x, y, at);
            channel.at(x, y) = std::isfinite(value) ? std::max(value, 0.0f) : otherwise;
        }
    }
    return resample(channel, layout, latlong_layout_for(layout));
}

}  // namespace

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
    record.sigma = channel_of(recorded, "sigma", file.layout, 1);
    record.seen = channel_of(recorded, "seen", file.layout, 0);
    record.clipped = channel_of(recorded, "clipped", file.layout, 1);
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
    double seen_weight = 0;
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
            seen_weight += seen * solid_angle;
        }
    }
    coverage.clipped /= sphere;
    if (record.seen) coverage.unseen = unseen / sphere;
    std::sort(sigmas.begin(), sigmas.end());
    double left = seen_weight / 2;
    for (const auto& [sigma, weight] : sigmas) {
        left -= weight;
        if (left > 0) continue;
        coverage.median_sigma = sigma;
        break;
    }
    return coverage;
}

}  // namespace matchlight
