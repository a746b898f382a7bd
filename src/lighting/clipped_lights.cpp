// The energy of lamps that no photograph could hold, from the paper that they light.
#include "lighting/clipped_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <Eigen/Dense>

#include "lighting/ball_shadow.h"
#include "lighting/latlong_grid.h"

namespace matchlight {
namespace {

struct LampPixel {
    int x = 0, y = 0;
    Eigen::Vector3d towards;
    Eigen::Vector3d light;  // radiance × solid angle
};

struct Lamp {
    ClippedLight result;
    std::vector<LampPixel> pixels;
};

/// Parts of the map where a tenth of a pixel or more is a lower bound, joined across the seam.
std::vector<Lamp> clipped_parts(const BallProbe& probe, const LatlongGrid& grid) {
    const int width = grid.width(), height = grid.height();
    Image8 taken(width, height, 1);
    std::vector<Lamp> lamps;
    for (int start = 0; start < width * height; ++start) {
        std::vector<std::pair<int, int>> queue = {{start % width, start / width}};
        Lamp lamp;
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        while (!queue.empty()) {
            const auto [x, y] = queue.back();
            queue.pop_back();
            if (taken.at(x, y) != 0 || probe.clipped.at(x, y) < 0.1F) continue;
            taken.at(x, y) = 1;
            LampPixel pixel{x, y, latlong_direction(x, y, width, height), Eigen::Vector3d::Zero()};
            pixel.light =
                Eigen::Map<const Eigen::Vector3f>(probe.radiance.pixel(x, y)).cast<double>() * grid.solid_angle(y);
            middle += pixel.towards * pixel.light.sum();
            lamp.result.solid_angle_sr += grid.solid_angle(y);
            lamp.pixels.push_back(pixel);
            for (int dy = -1; dy <= 1; ++dy) {
                for (int dx = -1; dx <= 1; ++dx) {
                    if (y + dy >= 0 && y + dy < height) queue.emplace_back((x + dx + width) % width, y + dy);
                }
            }
        }
        if (lamp.pixels.empty() || middle.norm() <= 0) continue;
        lamp.result.direction = middle.normalized();
        lamps.push_back(std::move(lamp));
    }
    return lamps;
}

/// Irradiance of a lamp on the plane at a place: what the ball does not block, and what it reflects down.
Eigen::Vector3d lamp_irradiance(const Lamp& lamp, const BallScene& scene, const Eigen::Vector3d& place_m) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const LampPixel& pixel : lamp.pixels) {
        const double cosine = pixel.towards.dot(scene.plane->normal);
        if (cosine > 0 && !hit_ball(scene.ball, place_m, pixel.towards)) sum += cosine * pixel.light;
    }
    const auto hit = hit_reflecting_direction(scene.ball, place_m, lamp.result.direction);
    if (!hit) return sum;
    const Eigen::Vector3d way = hit->point_m - place_m;
    const double cosine = way.normalized().dot(scene.plane->normal);
    if (cosine <= 0) return sum;
    const double shrunk = reflected_solid_angle_ratio(scene.ball, way.norm(), hit->cosine);
    for (const LampPixel& pixel : lamp.pixels) {
        for (int c = 0; c < 3; ++c) {
            sum[c] += fresnel_reflectance(scene.reflectance[c], hit->cosine) * pixel.light[c] * cosine / shrunk;
        }
    }
    return sum;
}

/// One white cell: its light and what lights it.
struct Paper {
    Eigen::Vector3d radiance;
    Eigen::Vector3d rest;                // irradiance / π
    std::vector<Eigen::Vector3d> lamps;  // the same, of each
    Eigen::Vector3d unshadowed;          // of all without the ball
};

/// Least squares over (albedo, albedo · gain of each lamp), relative errors, Huber's weights; gains below 1 are held
/// at 1 and the rest solved again.
struct Solution {
    Eigen::VectorXd gain, sigma;
};
Solution solve_channel(const std::vector<Paper>& papers, int channel, double albedo) {
    const auto lamps = static_cast<Eigen::Index>(papers.front().lamps.size());
    // Neighbouring cells share most of their errors: they count as one in five.
    constexpr double alike = 5;
    std::vector<char> held(static_cast<std::size_t>(lamps), 0);
    Solution solution{Eigen::VectorXd::Ones(lamps), Eigen::VectorXd::Ones(lamps)};
    for (Eigen::Index round = 0; round <= lamps; ++round) {
        Eigen::VectorXd x = Eigen::VectorXd::Zero(lamps + 1);
        Eigen::MatrixXd information;
        for (int step = 0; step < 12; ++step) {
            information = Eigen::MatrixXd::Zero(lamps + 1, lamps + 1);
            Eigen::VectorXd right = Eigen::VectorXd::Zero(lamps + 1);
            // The scene's white_albedo, as well as paper keeps to one.
            constexpr double albedo_sigma = 0.05;
            const double prior = 1 / (albedo_sigma * albedo * albedo_sigma * albedo);
            information(0, 0) += prior;
            right[0] += prior * albedo;
            for (const Paper& paper : papers) {
                Eigen::VectorXd row = Eigen::VectorXd::Zero(lamps + 1);
                row[0] = paper.rest[channel];
                double whole = paper.rest[channel];
                for (Eigen::Index j = 0; j < lamps; ++j) {
                    const double lit = paper.lamps[static_cast<std::size_t>(j)][channel];
                    row[held[static_cast<std::size_t>(j)] != 0 ? 0 : j + 1] += lit;
                    whole += lit;
                }
                // Print, gloss and what is near the table make paper uneven by a twentieth. In a shadow what the ball
                // and things close by throw back, of which only a part is known, makes up more of the light.
                const double sigma = std::hypot(0.05, 0.5 * (1 - whole / paper.unshadowed[channel])) *
                                     paper.radiance[channel] * std::sqrt(alike);
                const double off = step == 0 ? 0 : std::abs(row.dot(x) - paper.radiance[channel]) / sigma;
                const double weight = (off < 1.345 ? 1 : 1.345 / off) / (sigma * sigma);
                information += weight * row * row.transpose();
                right += weight * paper.radiance[channel] * row;
            }
            for (Eigen::Index j = 0; j < lamps; ++j) {
                if (held[static_cast<std::size_t>(j)] != 0) information(j + 1, j + 1) = 1, right[j + 1] = 0;
            }
            x = information.ldlt().solve(right);
        }
        const Eigen::MatrixXd covariance = information.inverse();
        bool moved = false;
        for (Eigen::Index j = 0; j < lamps; ++j) {
            if (held[static_cast<std::size_t>(j)] != 0) {
                solution.gain[j] = 1;
                continue;
            }
            solution.gain[j] = x[j + 1] / x[0];
            solution.sigma[j] =
                std::min(1.0, std::sqrt(covariance(j + 1, j + 1)) / std::max(std::abs(x[j + 1]), 1e-12));
            if (solution.gain[j] < 1) held[static_cast<std::size_t>(j)] = 1, moved = true;
        }
        if (!moved) break;
    }
    return solution;
}

}  // namespace

std::vector<ClippedLight> solve_clipped_lights(BallProbe& probe, const BallScene& scene, double white_albedo) {
    const LatlongGrid grid(probe.radiance.width(), probe.radiance.height());
    std::vector<Lamp> lamps = clipped_parts(probe, grid);
    if (lamps.empty()) return {};
    Probe rest{probe.radiance};
    for (const Lamp& lamp : lamps) {
        for (const LampPixel& pixel : lamp.pixels) std::fill_n(rest.latlong.pixel(pixel.x, pixel.y), 3, 0.F);
    }
    const BallShadow shadow(rest, *scene.plane, scene.ball, scene.reflectance);
    const auto bound = [](const Lamp& lamp) {
        double sum = 0;
        for (const LampPixel& pixel : lamp.pixels) sum += pixel.light.sum();
        return sum;
    };
    std::ranges::stable_sort(lamps, std::greater<>(), bound);
    std::erase_if(lamps, [&](const Lamp& lamp) { return bound(lamp) < 1e-4 * shadow.irradiance_without_ball().sum(); });
    if (lamps.empty()) return {};

    Eigen::Vector3d unshadowed = shadow.irradiance_without_ball() / std::numbers::pi;
    for (const Lamp& lamp : lamps) {
        for (const LampPixel& pixel : lamp.pixels) {
            unshadowed += std::max(0.0, pixel.towards.dot(scene.plane->normal)) * pixel.light / std::numbers::pi;
        }
    }
    std::vector<Paper> papers;
    for (const PlacedSheet& sheet : scene.rig->sheets) {
        for (int i = 0; i < sheet.printed.cells * sheet.printed.cells; ++i) {
            const int x = i % sheet.printed.cells, y = i / sheet.printed.cells;
            if (sheet.printed.at(x, y) != TagPattern::white) continue;
            const Eigen::Vector3d place_m = sheet.world_from_tag * sheet.sheet_from_grid({x + 0.5, y + 0.5});
            const auto radiance = direct_radiance(scene.views, scene.ball, place_m);
            if (!radiance || radiance->minCoeff() <= 0) continue;
            const Eigen::Vector3d gain = shadow.unshadowed_over_seen(place_m);
            if (gain.maxCoeff() > 3) continue;  // under the ball
            Paper paper;
            paper.radiance = *radiance;
            paper.rest = shadow.irradiance_without_ball().cwiseQuotient(gain) / std::numbers::pi;
            for (const Lamp& lamp : lamps) {
                paper.lamps.push_back(lamp_irradiance(lamp, scene, place_m) / std::numbers::pi);
            }
            paper.unshadowed = unshadowed;
            papers.push_back(std::move(paper));
        }
    }
    std::vector<ClippedLight> result;
    if (papers.size() >= 8) {
        for (int c = 0; c < 3; ++c) {
            const Solution solution = solve_channel(papers, c, white_albedo);
            for (std::size_t j = 0; j < lamps.size(); ++j) {
                lamps[j].result.gain[c] = solution.gain[static_cast<Eigen::Index>(j)];
                lamps[j].result.sigma[c] = solution.sigma[static_cast<Eigen::Index>(j)];
            }
        }
    } else {
        for (Lamp& lamp : lamps) lamp.result.sigma.setOnes();
    }
    for (const Lamp& lamp : lamps) {
        for (const LampPixel& pixel : lamp.pixels) {
            for (int c = 0; c < 3; ++c) {
                probe.radiance.at(pixel.x, pixel.y, c) *= static_cast<float>(lamp.result.gain[c]);
            }
            probe.sigma.at(pixel.x, pixel.y) =
                std::max(probe.sigma.at(pixel.x, pixel.y), static_cast<float>(lamp.result.sigma.y()));
        }
        result.push_back(lamp.result);
    }
    return result;
}

}  // namespace matchlight
