// What lies on the tags' plane under a mirror ball, as it is seen from the probe's place without the ball.
#include "lighting/ball_table.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "lighting/latlong_pyramid.h"

namespace matchlight {
namespace {

constexpr int shadow_rows = 64;

/// Light of one ink or of the paper of a sheet, as its pixels in the map tell it.
struct Ink {
    struct Sample {
        Eigen::Vector3f light;
        float weight = 0;
    };
    std::vector<Sample> samples;

    /// The weighted median, channel by channel: pixels that hold some of the other ink, which lie along every edge and
    /// are many where the ball shows the sheet small, do not move it. nullopt without samples.
    std::optional<Eigen::Vector3d> light() const {
        if (samples.empty()) return std::nullopt;
        double whole = 0;
        for (const Sample& sample : samples) whole += sample.weight;
        Eigen::Vector3d result;
        std::vector<std::pair<float, float>> sorted(samples.size());
        for (int c = 0; c < 3; ++c) {
            std::ranges::transform(samples, sorted.begin(),
                                   [c](const Sample& sample) { return std::pair(sample.light[c], sample.weight); });
            std::ranges::sort(sorted);
            double below = 0;
            for (const auto& [value, weight] : sorted) {
                below += weight;
                result[c] = value;
                if (below >= whole / 2) break;
            }
        }
        return result;
    }
};

}  // namespace

BallTable::BallTable(const BallScene& scene, const BallProbeOptions& options, const BallUnwrap& unwrap,
                     const ImageF& first)
    : scene_(scene),
      options_(options),
      unwrap_(unwrap),
      grid_(first.width(), first.height()),
      shadow_(Probe{first}, *scene.plane, scene.ball, scene.reflectance) {
    // Shadows of lamps are as soft as the directions are far apart that BallShadow takes.
    const int rows = std::min(first.height(), shadow_rows);
    gains_.latlong = ImageF(2 * rows, rows, 3, 1.F);
    find_gains({});
}

void BallTable::find_gains(const BallShadow::GroundLight& ground) {
    ImageF gains = gains_.latlong;
    parallel_for(gains.height(), [&](int y) {
        for (int x = 0; x < gains.width(); ++x) {
            const auto place_m = place(latlong_direction(x, y, gains.width(), gains.height()));
            if (!place_m) continue;
            const Eigen::Vector3d gain = shadow_.unshadowed_over_seen(*place_m, ground);
            for (int c = 0; c < 3; ++c) gains.at(x, y, c) = static_cast<float>(gain[c]);
        }
    });
    gains_.latlong = std::move(gains);
}

void BallTable::follow_reflections(const ImageF& found) {
    const Probe table{shrunk_latlong(found, gains_.latlong.width(), gains_.latlong.height())};
    // Each round adds light that went once more between plane and ball, of which the paper sends back most.
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        find_gains([&](const Eigen::Vector3d& place_m) -> Eigen::Vector3d {
            const Eigen::Vector3d towards = (place_m - options_.place_m).normalized();
            return table.radiance(towards).cwiseQuotient(gains_.radiance(towards));
        });
    }
}

std::optional<Eigen::Vector3d> BallTable::place(const Eigen::Vector3d& towards) const {
    // Farther than a hundred radii the plane is as good as at infinity.
    const double farthest_m = 100 * scene_.ball.radius_m;
    auto place_m = scene_.plane->meets(options_.place_m, towards);
    if (place_m && (*place_m - options_.place_m).norm() > farthest_m) place_m.reset();
    return place_m;
}

Gathered BallTable::light(const Eigen::Vector3d& towards, const Eigen::Vector3d& place_m, int y) const {
    return unwrap_.plane_light(place_m, grid_.solid_angle(y), gains_.radiance(towards));
}

void BallTable::draw_print(BallProbe& probe) const {
    if (scene_.rig == nullptr || scene_.rig->sheets.empty()) return;
    const int width = probe.radiance.width(), height = probe.radiance.height();
    // Of each sheet: ink, then paper.
    std::vector<std::array<Ink, 2>> inks(scene_.rig->sheets.size());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (probe.seen.at(x, y) < 1) continue;
            const Eigen::Vector3d towards = latlong_direction(x, y, width, height);
            const auto place_m = place(towards);
            const auto print = place_m ? print_at(*scene_.rig, *place_m) : std::nullopt;
            if (!print) continue;
            const Eigen::Vector3f light = Eigen::Map<const Eigen::Vector3f>(probe.radiance.pixel(x, y));
            // What was hardly shadowed tells more.
            const auto weight = static_cast<float>(grid_.solid_angle(y) / gains_.radiance(towards).squaredNorm());
            inks[print->sheet][print->paper ? 1 : 0].samples.push_back({light, weight});
        }
    }
    const MapSamples samples = map_samples(options_.samples_a_side);
    std::vector<std::array<std::optional<Eigen::Vector3d>, 2>> lights;
    for (const auto& sheet : inks) lights.push_back({sheet[0].light(), sheet[1].light()});

    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double seen = probe.seen.at(x, y);
            if (seen >= 1) continue;
            Eigen::Vector3d drawn = Eigen::Vector3d::Zero();
            double share = 0;
            for (const auto& [across, down] : samples) {
                const auto place_m = place(latlong_direction(x + across, y + down, width, height));
                const auto print = place_m ? print_at(*scene_.rig, *place_m) : std::nullopt;
                if (!print) continue;
                const auto& light = lights[print->sheet][print->paper ? 1 : 0];
                if (!light) continue;
                drawn += *light / samples.size();
                share += 1.0 / samples.size();
            }
            if (share <= 0 || share < 1 - seen - 0.01) continue;
            for (int c = 0; c < 3; ++c) {
                const double before = probe.radiance.at(x, y, c);
                probe.radiance.at(x, y, c) = static_cast<float>(seen * before + (1 - seen) * drawn[c] / share);
            }
            // Drawn, not filled in from around: a hair above 0 keeps it from being filled.
            if (seen <= 0) probe.seen.at(x, y) = 1e-3F;
        }
    }
}

}  // namespace matchlight
