// Overlaps of pixels are estimated on a lattice of points and then balanced until both images' solid angles hold.
#include "lighting/resample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
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

/// A source pixel's share in a target pixel.
struct Overlap {
    std::uint32_t source;
    float solid_angle;
};

/// The matrix of solid angles that target pixels share with source pixels.
class Overlaps {
public:
    Overlaps(const ProbeLayout& from, const ProbeLayout& to) : from_(from), to_(to) {
        // At least three points a side to a pixel of the finer image; 32 are enough to shrink a map by more than ten a
        // side, because what they miss of single pixels is put right by the balance of solid angles.
        points_ = std::clamp(static_cast<int>(std::ceil(3 * std::sqrt(pixels_on_sphere(from) / pixels_on_sphere(to)))),
                             4, 32);
        // Kept where it fits in some 300 MB, made anew for every pass where not.
        const std::int64_t entries = static_cast<std::int64_t>(to.width) * to.height * 12 +
                                     static_cast<std::int64_t>(from.width) * from.height * 4;
        kept_ = entries * static_cast<std::int64_t>(sizeof(Overlap)) < (std::int64_t{300} << 20);
        // Four bands of rows keep four cores busy; each sums for itself and the bands are added in their order, so that
        // results do not depend on the number of threads. Their sums cost 16 bytes a source pixel, too much for the
        // largest maps.
        bands_ = static_cast<std::int64_t>(from.width) * from.height < (1 << 25) ? 4 : 1;
        if (!kept_) return;
        rows_.resize(static_cast<std::size_t>(to.height));
        parallel_for(to.height, [&](int y) { rows_[static_cast<std::size_t>(y)] = make_row(y); });
    }

    bool kept() const { return kept_; }

    /// Calls body(band, x, y, overlaps) for every target pixel; calls of one band come in order, on one thread.
    template <class Body>
    void for_each_pixel(const Body& body) const {
        parallel_for(bands_, [&](int band) {
            for (int y = first_row(band); y < first_row(band + 1); ++y) {
                const Row made = kept_ ? Row{} : make_row(y);
                const Row& row = kept_ ? rows_[static_cast<std::size_t>(y)] : made;
                for (int x = 0; x < to_.width; ++x) {
                    const std::size_t first = row.first[static_cast<std::size_t>(x)];
                    const std::size_t last = row.first[static_cast<std::size_t>(x) + 1];
                    body(band, x, y, std::span(row.entries).subspan(first, last - first));
                }
            }
        });
    }

    /// What every source pixel hands out in all with these gains, when every target pixel is scaled to receive its own
    /// solid angle.
    std::vector<float> handed_out(const std::vector<float>& source_gain) const {
        const std::size_t source_pixels = source_gain.size();
        std::vector<std::vector<float>> parts(static_cast<std::size_t>(bands_),
                                              std::vector<float>(source_pixels, 0.0f));
        for_each_pixel([&](int band, int, int, std::span<const Overlap> overlaps) {
            double own = 0;
            double received = 0;
            for (const Overlap& overlap : overlaps) {
                own += overlap.solid_angle;
                received += static_cast<double>(overlap.solid_angle) * source_gain[overlap.source];
            }
            if (received <= 0) return;
            const auto row_gain = static_cast<float>(own / received);
            auto& sums = parts[static_cast<std::size_t>(band)];
            for (const Overlap& overlap : overlaps) {
                sums[overlap.source] += overlap.solid_angle * source_gain[overlap.source] * row_gain;
            }
        });
        for (std::size_t part = 1; part < parts.size(); ++part) {
            for (std::size_t i = 0; i < source_pixels; ++i) parts[0][i] += parts[part][i];
        }
        return std::move(parts[0]);
    }

private:
    struct Row {
        std::vector<std::size_t> first;  // per target pixel, one more at the end
        std::vector<Overlap> entries;
    };

    int first_row(int band) const { return static_cast<int>(static_cast<std::int64_t>(to_.height) * band / bands_); }

    Row make_row(int y) const {
        Row row;
        row.first.reserve(static_cast<std::size_t>(to_.width) + 1);
        row.first.push_back(0);
        for (int x = 0; x < to_.width; ++x) {
            const std::size_t first = row.first.back();
            for (int j = 0; j < points_; ++j) {
                for (int i = 0; i < points_; ++i) {
                    add_point({x + (i + 0.5) / points_ - 0.5, y + (j + 0.5) / points_ - 0.5}, first, row.entries);
                }
            }
            row.first.push_back(row.entries.size());
        }
        return row;
    }

    /// Shares the solid angle at a point of the target among the four source pixels around it, adding to those that
    /// the target pixel (entries from `first` on) already has.
    void add_point(const Eigen::Vector2d& point, std::size_t first, std::vector<Overlap>& entries) const {
        const double solid_angle = solid_angle_density(to_, point) / (points_ * points_);
        if (solid_angle <= 0) return;
        for (const PixelTap& tap : bilinear_taps(from_, *direction_from_pixel(to_, point))) {
            if (tap.weight <= 0) continue;
            const auto source = static_cast<std::uint32_t>(tap.y) * static_cast<std::uint32_t>(from_.width) +
                                static_cast<std::uint32_t>(tap.x);
            const auto share = static_cast<float>(solid_angle * tap.weight);
            // Neighbouring points meet the same pixels: the latest entries are the likeliest.
            std::size_t known = entries.size();
            const std::size_t oldest = std::max(first, known > 64 ? known - 64 : 0);
            while (known > oldest && entries[known - 1].source != source) --known;
            if (known > oldest) {
                entries[known - 1].solid_angle += share;
            } else {
                entries.push_back({source, share});
            }
        }
    }

    ProbeLayout from_, to_;
    int points_ = 4;
    int bands_ = 1;
    bool kept_ = false;
    std::vector<Row> rows_;
};

}  // namespace

ImageF resample(const ImageF& source, const ProbeLayout& from, const ProbeLayout& to) {
    assert(source.width() == from.width && source.height() == from.height);
    if (from == to) return source;
    const int channels = source.channels();
    assert(channels <= 4);
    const Overlaps overlaps(from, to);

    // Sinkhorn's balance (Sinkhorn & Knopp 1967, Concerning Nonnegative Matrices and Doubly Stochastic Matrices): gains
    // of source pixels, so that each hands out its own solid angle, against gains of target pixels, so that each
    // receives its own. Target pixels come last: uniform light stays uniform exactly, and what a lamp of one pixel
    // gains or loses is what the source pixels' sums still lack: up to 3e-3 measured after two rounds, 3e-4 after
    // sixteen.
    const int rounds = overlaps.kept() ? 16 : 2;
    const std::vector<double> solid_angles = pixel_solid_angles(from);
    std::vector<float> gain(solid_angles.size(), 1.0f);
    for (int round = 0; round < rounds; ++round) {
        const std::vector<float> handed_out = overlaps.handed_out(gain);
        for (std::size_t i = 0; i < gain.size(); ++i) {
            if (handed_out[i] > 0) gain[i] *= static_cast<float>(solid_angles[i] / handed_out[i]);
        }
    }

    ImageF result(to.width, to.height, channels);
    overlaps.for_each_pixel([&](int, int x, int y, std::span<const Overlap> row) {
        double received = 0;
        std::array<double, 4> flux{};
        for (const Overlap& overlap : row) {
            const double weight = static_cast<double>(overlap.solid_angle) * gain[overlap.source];
            received += weight;
            const float* pixel =
                source.samples().data() + std::size_t{overlap.source} * static_cast<std::size_t>(channels);
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
    return {resample(image, from, layout_of_size(ProbeMapping::latlong, height))};
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

}  // namespace matchlight
