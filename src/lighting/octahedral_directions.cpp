// Edges are halved and their middles pushed out onto the sphere; a probe's pixels go to the nearest corner.
#include "lighting/octahedral_directions.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;
using Face = std::array<Vector3d, 3>;

/// The same bits of both ends in either order, and of their opposites with the other sign.
Vector3d middle(const Vector3d& a, const Vector3d& b) {
    return (a + b).normalized();
}

std::vector<Face> octahedron() {
    std::vector<Face> faces;
    for (const double x : {1.0, -1.0}) {
        for (const double y : {1.0, -1.0}) {
            for (const double z : {1.0, -1.0}) {
                faces.push_back({x * Vector3d::UnitX(), y * Vector3d::UnitY(), z * Vector3d::UnitZ()});
            }
        }
    }
    return faces;
}

std::vector<Face> divided(const std::vector<Face>& faces) {
    std::vector<Face> parts;
    for (const Face& face : faces) {
        const Face middles{middle(face[0], face[1]), middle(face[1], face[2]), middle(face[2], face[0])};
        parts.push_back(middles);
        for (std::size_t i = 0; i < 3; ++i) parts.push_back({face.at(i), middles.at(i), middles.at((i + 2) % 3)});
    }
    return parts;
}

/// Directions from the top downwards, to look for the nearest among those that can be.
class NearestDirection {
public:
    explicit NearestDirection(const std::vector<Vector3d>& directions) : directions_(directions) {
        for (std::size_t i = 0; i < directions.size(); ++i) by_height_.emplace_back(angle_of(directions[i]), i);
        std::ranges::sort(by_height_);
        // The faces' corners are less than 90° / 2ⁿ apart, times what pushing them outwards stretches the middle ones.
        constexpr double stretch = 1.3;
        reach_ = stretch * std::sqrt(4 * 3.2 / static_cast<double>(directions.size()));
    }
    std::size_t of(const Vector3d& direction) const {
        const double angle = angle_of(direction);
        auto at = std::ranges::lower_bound(by_height_, std::pair(angle - reach_, std::size_t{0}));
        std::size_t nearest = 0;
        double most = -2;
        for (; at != by_height_.end() && at->first <= angle + reach_; ++at) {
            const double cosine = direction.dot(directions_[at->second]);
            if (cosine <= most) continue;
            most = cosine;
            nearest = at->second;
        }
        return nearest;
    }

private:
    static double angle_of(const Vector3d& direction) { return std::acos(std::clamp(direction.z(), -1.0, 1.0)); }

    const std::vector<Vector3d>& directions_;
    std::vector<std::pair<double, std::size_t>> by_height_;  // angle from the top, number
    double reach_ = 0;                                       // of a direction, radians
};

}  // namespace

std::vector<Vector3d> octahedral_directions(int divisions) {
    assert(divisions >= 0 && divisions <= most_octahedral_divisions);
    std::vector<Face> faces = octahedron();
    for (int i = 0; i < divisions; ++i) faces = divided(faces);
    using Key = std::tuple<double, double, double>;
    std::vector<Key> half;
    for (const Face& face : faces) {
        for (const Vector3d& corner : face) {
            // Without the zeros' signs. Of two opposite ones the one whose last coordinate other than 0 is positive.
            const Key key{corner.z() + 0.0, corner.y() + 0.0, corner.x() + 0.0};
            if (key > Key{0, 0, 0}) half.push_back(key);
        }
    }
    std::ranges::sort(half);
    half.erase(std::unique(half.begin(), half.end()), half.end());
    std::vector<Vector3d> directions;
    for (const Key& key : half) {
        const Vector3d direction(std::get<2>(key), std::get<1>(key), std::get<0>(key));
        directions.push_back(direction);
        directions.emplace_back(-direction);
    }
    return directions;
}

std::vector<DirectionalSample> sample_octahedrally(const Probe& probe, int divisions) {
    const std::vector<Vector3d> directions = octahedral_directions(divisions);
    const NearestDirection nearest(directions);
    const ImageF& image = probe.latlong;
    // Pixels as large as what a direction stands for are shared between several: by the middles of their parts.
    constexpr double parts_a_direction = 64;
    const double pixels = static_cast<double>(image.width()) * image.height();
    const int parts = std::max(
        static_cast<int>(std::ceil(std::sqrt(parts_a_direction * static_cast<double>(directions.size()) / pixels))), 1);
    const int width = parts * image.width(), height = parts * image.height();
    const LatlongGrid grid(width, height);

    // Blocks of rows, whose sums are added in their order: no thread changes a bit.
    constexpr int blocks = 16;
    std::array<std::vector<DirectionalSample>, blocks> sums;
    parallel_for(blocks, [&](int block) {
        std::vector<DirectionalSample>& sum = sums.at(static_cast<std::size_t>(block));
        sum.resize(directions.size());
        const auto row_of = [&](int of) { return static_cast<int>(std::int64_t{height} * of / blocks); };
        for (int y = row_of(block); y < row_of(block + 1); ++y) {
            const double solid_angle_sr = grid.solid_angle(y);
            for (int x = 0; x < width; ++x) {
                DirectionalSample& sample = sum[nearest.of(latlong_direction(x, y, width, height))];
                sample.solid_angle_sr += solid_angle_sr;
                const float* const radiance = image.pixel(x / parts, y / parts);
                for (int c = 0; c < 3; ++c)
                    sample.radiance_times_solid_angle[c] += solid_angle_sr * static_cast<double>(radiance[c]);
            }
        }
    });
    std::vector<DirectionalSample> samples(directions.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].direction = directions[i];
        for (const std::vector<DirectionalSample>& sum : sums) {
            samples[i].radiance_times_solid_angle += sum[i].radiance_times_solid_angle;
            samples[i].solid_angle_sr += sum[i].solid_angle_sr;
        }
    }
    return samples;
}

}  // namespace matchlight
