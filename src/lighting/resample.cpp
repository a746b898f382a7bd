// Overlaps of pixels are estimated on a lattice of points and then balanced until both images' solid angles hold.
#include "lighting/resample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/parallel.h"

namespace matchlight {
namespace {

/// Pixels that show a direction.
double pixels_on_sphere(const ProbeLayout& layout) {
    const double all = static_cast<double>(layout.width) * layout.height;
    switch (layout.mapping) {
        case ProbeMapping::latlong:
            return all * 2 / std::numbers::pi;  // the poles are crowded
        case ProbeMapping::angular:
        case ProbeMapping::mirrorball:
            return all * std::numbers::pi / 4;
        case ProbeMapping::cube:
            return 6.0 * layout.face_size() * layout.face_size();
    }
    assert(false);
    return all;
}

/// The matrix W(target, source) of shared solid angles, made anew row by row because it seldom fits in memory.
class Overlaps {
public:
    Overlaps(const ProbeLayout& from, const ProbeLayout& to) : from_(from), to_(to) {
        const double ratio = pixels_on_sphere(from) / pixels_on_sphere(to);
        interpolates_ = ratio < 0.5;
        // About 16 points to a pixel of the finer image; 32 a side are enough to shrink a map a hundredfold, because
        // what they miss of single pixels is put right by the balance of solid angles.
        points_ = std::clamp(static_cast<int>(std::ceil(4 * std::sqrt(ratio))), 4, 32);
    }

    struct Entry {
        std::size_t source;
        double solid_angle;
    };

    /// The source pixels that share solid angle with target pixel (x, y), with repetitions.
    void row(int x, int y, std::vector<Entry>& entries) const {
        entries.clear();
        for (int j = 0; j < points_; ++j) {
            for (int i = 0; i < points_; ++i) {
                const Eigen::Vector2d point(x + (i + 0.5) / points_ - 0.5, y + (j + 0.5) / points_ - 0.5);
                const double solid_angle = solid_angle_density(to_, point) / (points_ * points_);
                if (solid_angle <= 0) continue;
                const Eigen::Vector3d direction = *direction_from_pixel(to_, point);
                if (!interpolates_) {
                    const Eigen::Vector2i pixel = nearest_pixel(from_, direction);
                    entries.push_back({index(pixel.x(), pixel.y()), solid_angle});
                    continue;
                }
                for (const PixelTap& tap : bilinear_taps(from_, direction)) {
                    if (tap.weight > 0) entries.push_back({index(tap.x, tap.y), solid_angle * tap.weight});
                }
            }
        }
    }

private:
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(from_.width) + static_cast<std::size_t>(x);
    }

    ProbeLayout from_, to_;
    int points_ = 4;
    bool interpolates_ = false;
};

/// Bands of target rows; each sums for itself, and the bands are added in their order, so that results do not
/// depend on the number of threads.
struct Bands {
    int count;
    int height;
    int first(int band) const { return static_cast<int>(static_cast<std::int64_t>(height) * band / count); }
};

template <class Body>
void for_each_pixel(const Bands& bands, int width, const Body& body) {
    parallel_for(bands.count, [&](int band) {
        std::vector<Overlaps::Entry> entries;
        for (int y = bands.first(band); y < bands.first(band + 1); ++y) {
            for (int x = 0; x < width; ++x) body(band, x, y, entries);
        }
    });
}

std::vector<float> summed(std::vector<std::vector<float>>& parts) {
    for (std::size_t part = 1; part < parts.size(); ++part) {
        for (std::size_t i = 0; i < parts[0].size(); ++i) parts[0][i] += parts[part][i];
    }
    return std::move(parts[0]);
}

}  // namespace

ImageF resample(const ImageF& source, const ProbeLayout& from, const ProbeLayout& to) {
    assert(source.width() == from.width && source.height() == from.height);
    const int channels = source.channels();
    const Overlaps overlaps(from, to);
    const std::vector<double> source_solid_angles = pixel_solid_angles(from);
    const std::size_t source_pixels = source_solid_angles.size();
    // Four bands keep four cores busy; their sums cost 16 bytes a source pixel, too much for the largest maps.
    const Bands bands{source_pixels < (std::size_t{1} << 25) ? 4 : 1, to.height};

    // Sinkhorn's balance: column gains, so that every source pixel hands out its own solid angle; row gains, so that
    // every target pixel receives its own; once more each. Then uniform light stays uniform exactly, and what a lamp
    // loses is of the second order of the lattice's error.
    std::vector<std::vector<float>> handed_out(static_cast<std::size_t>(bands.count),
                                               std::vector<float>(source_pixels, 0.0f));
    for_each_pixel(bands, to.width, [&](int band, int x, int y, std::vector<Overlaps::Entry>& entries) {
        overlaps.row(x, y, entries);
        auto& sums = handed_out[static_cast<std::size_t>(band)];
        for (const auto& entry : entries) sums[entry.source] += static_cast<float>(entry.solid_angle);
    });
    std::vector<float> gain = summed(handed_out);
    for (std::size_t i = 0; i < source_pixels; ++i) {
        gain[i] = gain[i] > 0 ? static_cast<float>(source_solid_angles[i] / gain[i]) : 0.0f;
    }

    handed_out.assign(static_cast<std::size_t>(bands.count), std::vector<float>(source_pixels, 0.0f));
    for_each_pixel(bands, to.width, [&](int band, int x, int y, std::vector<Overlaps::Entry>& entries) {
        overlaps.row(x, y, entries);
        double own = 0;
        double received = 0;
        for (const auto& entry : entries) {
            own += entry.solid_angle;
            received += entry.solid_angle * gain[entry.source];
        }
        if (received <= 0) return;
        auto& sums = handed_out[static_cast<std::size_t>(band)];
        for (const auto& entry : entries) {
            sums[entry.source] += static_cast<float>(entry.solid_angle * gain[entry.source] * own / received);
        }
    });
    const std::vector<float> balanced = summed(handed_out);
    for (std::size_t i = 0; i < source_pixels; ++i) {
        if (balanced[i] > 0) gain[i] *= static_cast<float>(source_solid_angles[i] / balanced[i]);
    }

    ImageF result(to.width, to.height, channels);
    for_each_pixel(bands, to.width, [&](int, int x, int y, std::vector<Overlaps::Entry>& entries) {
        overlaps.row(x, y, entries);
        double received = 0;
        std::array<double, 4> flux{};
        for (const auto& entry : entries) {
            const double weight = entry.solid_angle * gain[entry.source];
            received += weight;
            const float* pixel = source.samples().data() + entry.source * static_cast<std::size_t>(channels);
            for (int c = 0; c < channels; ++c) flux[static_cast<std::size_t>(c)] += weight * pixel[c];
        }
        if (received <= 0) return;
        for (int c = 0; c < channels; ++c) {
            result.at(x, y, c) = static_cast<float>(flux[static_cast<std::size_t>(c)] / received);
        }
    });
    return result;
}

ImageF image_from_probe(const Probe& probe, const ProbeLayout& to) {
    return resample(probe.latlong, layout_of_size(ProbeMapping::latlong, probe.latlong.height()), to);
}

Probe probe_from_image(const ImageF& image, const ProbeLayout& from, int height) {
    const ProbeLayout latlong = layout_of_size(ProbeMapping::latlong, height);
    const bool same = from.mapping == ProbeMapping::latlong && !from.edge_centred && from.width == latlong.width &&
                      from.height == latlong.height;
    return {same ? image : resample(image, from, latlong)};
}

int latlong_height_for(const ProbeLayout& layout) {
    // Equal pixels a radian in the middle of the image, where the layout is finest for its solid angle.
    switch (layout.mapping) {
        case ProbeMapping::latlong:
            return layout.height;
        case ProbeMapping::angular:
            return std::max(1, (layout.width + 1) / 2);  // width / 2π pixels a radian
        case ProbeMapping::mirrorball:                   // width / 4
            return std::max(1, static_cast<int>(std::lround(std::numbers::pi * layout.width / 4)));
        case ProbeMapping::cube:
            return 2 * layout.face_size();  // the mean over the face, 4 faces around
    }
    assert(false);
    return layout.height;
}

int size_for_latlong(ProbeMapping to, int latlong_height) {
    switch (to) {
        case ProbeMapping::latlong:
            return latlong_height;
        case ProbeMapping::angular:
            return 2 * latlong_height;
        case ProbeMapping::mirrorball:
            return std::max(1, static_cast<int>(std::lround(latlong_height * 4 / std::numbers::pi)));
        case ProbeMapping::cube:
            return std::max(1, (latlong_height + 1) / 2);
    }
    assert(false);
    return latlong_height;
}

ImageF mirror_ball_image(const Probe& probe, int size) {
    const ProbeLayout ball = layout_of_size(ProbeMapping::mirrorball, size);
    ImageF image = image_from_probe(probe, ball);
    const Eigen::Vector3d behind = probe.radiance(-Eigen::Vector3d::UnitY());
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const Eigen::Vector2d offset((2 * x + 1.0) / size - 1, (2 * y + 1.0) / size - 1);
            if (offset.norm() <= 1) continue;  // its centre shows a direction
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(behind[c]);
        }
    }
    return image;
}

}  // namespace matchlight
