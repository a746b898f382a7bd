// The parts of a probe that no photograph could hold, and their energy from surfaces that they light.
#include "lighting/clipped_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <Eigen/Dense>

#include "lighting/latlong_grid.h"
#include "lighting/latlong_regions.h"

namespace matchlight {
namespace {

/// A channel's gains and their relative standard deviations.
struct ChannelGains {
    Eigen::VectorXd gain, sigma;
};

/// The equations of one channel; held parts have a gain of 1.
class ChannelEquations {
public:
    ChannelEquations(std::span<const LitPatch> patches, int channel, double alike)
        : patches_(patches), channel_(channel), alike_(alike) {}

    void set_prior(double albedo, double relative_sigma) {
        prior_albedo_ = albedo;
        prior_weight_ = 1 / (relative_sigma * albedo * relative_sigma * albedo);
    }

    /// Albedo, then albedo · gain of each part; the inverse of their covariance in `information`.
    Eigen::VectorXd solve(const std::vector<bool>& held, Eigen::MatrixXd& information) const {
        const auto unknowns = static_cast<Eigen::Index>(held.size()) + 1;
        Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
        for (int step = 0; step < 12; ++step) {
            information = Eigen::MatrixXd::Zero(unknowns, unknowns);
            Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
            information(0, 0) = prior_weight_;
            right[0] = prior_weight_ * prior_albedo_;
            for (const LitPatch& patch : patches_) {
                const Eigen::VectorXd row = row_of(patch, held);
                const double sigma = patch.relative_sigma[channel_] * patch.radiance[channel_] * std::sqrt(alike_);
                const double off = step == 0 ? 0 : std::abs(row.dot(x) - patch.radiance[channel_]) / sigma;
                const double weight = (off < 1.345 ? 1 : 1.345 / off) / (sigma * sigma);
                information += weight * row * row.transpose();
                right += weight * patch.radiance[channel_] * row;
            }
            for (std::size_t j = 0; j < held.size(); ++j) {
                const auto at = static_cast<Eigen::Index>(j) + 1;
                if (held[j]) information(at, at) = 1, right[at] = 0;
            }
            x = information.ldlt().solve(right);
        }
        return x;
    }

private:
    Eigen::VectorXd row_of(const LitPatch& patch, const std::vector<bool>& held) const {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()) + 1);
        row[0] = patch.rest[channel_];
        for (std::size_t j = 0; j < held.size(); ++j) {
            row[held[j] ? 0 : static_cast<Eigen::Index>(j) + 1] += patch.parts[j][channel_];
        }
        return row;
    }

    std::span<const LitPatch> patches_;
    int channel_;
    double alike_, prior_albedo_ = 0, prior_weight_ = 0;
};

ChannelGains gains_of(const ChannelEquations& equations, std::size_t parts) {
    const auto count = static_cast<Eigen::Index>(parts);
    ChannelGains solved{Eigen::VectorXd::Ones(count), Eigen::VectorXd::Ones(count)};
    std::vector<bool> held(parts, false);
    for (std::size_t round = 0; round <= parts; ++round) {
        Eigen::MatrixXd information;
        const Eigen::VectorXd x = equations.solve(held, information);
        const Eigen::MatrixXd covariance = information.inverse();
        bool moved = false;
        for (Eigen::Index j = 0; j < count; ++j) {
            const auto part = static_cast<std::size_t>(j);
            if (held[part]) {
                solved.gain[j] = 1;
                continue;
            }
            solved.gain[j] = x[j + 1] / x[0];
            const double sigma = std::sqrt(covariance(j + 1, j + 1)) / std::max(std::abs(x[j + 1]), 1e-12);
            solved.sigma[j] = std::isfinite(sigma) ? std::min(1.0, sigma) : 1;
            // NaN too: patches that tell the part and the rest apart by nothing.
            if (!(solved.gain[j] >= 1)) held[part] = true, moved = true;
        }
        if (!moved) break;
    }
    return solved;
}

}  // namespace

double ClippedPart::bound() const {
    double sum = 0;
    for (const Pixel& pixel : pixels) sum += pixel.light.sum();
    return sum;
}

std::vector<ClippedPart> clipped_parts(const BallProbe& probe) {
    const LatlongGrid grid(probe.radiance.width(), probe.radiance.height());
    const int width = grid.width(), height = grid.height();
    const auto regions = latlong_regions(width, height, [&](int x, int y) { return probe.clipped.at(x, y) >= 0.1F; });
    std::vector<ClippedPart> parts;
    for (const LatlongRegion& region : regions) {
        ClippedPart part;
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (const auto& [x, y] : region) {
            ClippedPart::Pixel pixel{x, y, latlong_direction(x, y, width, height), Eigen::Vector3d::Zero()};
            pixel.light =
                Eigen::Map<const Eigen::Vector3f>(probe.radiance.pixel(x, y)).cast<double>() * grid.solid_angle(y);
            middle += pixel.towards * pixel.light.sum();
            part.light.solid_angle_sr += grid.solid_angle(y);
            part.pixels.push_back(pixel);
        }
        if (middle.norm() <= 0) continue;
        part.light.direction = middle.normalized();
        parts.push_back(std::move(part));
    }
    std::ranges::stable_sort(parts, std::greater<>(), &ClippedPart::bound);
    return parts;
}

Probe light_without(const BallProbe& probe, std::span<const ClippedPart> parts) {
    Probe rest{probe.radiance};
    for (const ClippedPart& part : parts) {
        for (const ClippedPart::Pixel& pixel : part.pixels) std::fill_n(rest.latlong.pixel(pixel.x, pixel.y), 3, 0.F);
    }
    return rest;
}

void solve_gains(std::vector<ClippedPart>& parts, std::span<const LitPatch> patches,
                 const std::optional<AlbedoPrior>& prior, double alike) {
    for (int c = 0; c < 3; ++c) {
        ChannelEquations equations(patches, c, alike);
        if (prior) equations.set_prior(prior->albedo[c], prior->relative_sigma);
        const ChannelGains solved = gains_of(equations, parts.size());
        for (std::size_t j = 0; j < parts.size(); ++j) {
            parts[j].light.gain[c] = solved.gain[static_cast<Eigen::Index>(j)];
            parts[j].light.sigma[c] = solved.sigma[static_cast<Eigen::Index>(j)];
        }
    }
}

std::vector<ClippedLight> apply_gains(BallProbe& probe, const std::vector<ClippedPart>& parts) {
    std::vector<ClippedLight> lights;
    for (const ClippedPart& part : parts) {
        for (const ClippedPart::Pixel& pixel : part.pixels) {
            for (int c = 0; c < 3; ++c) {
                probe.radiance.at(pixel.x, pixel.y, c) *= static_cast<float>(part.light.gain[c]);
            }
            probe.sigma.at(pixel.x, pixel.y) =
                std::max(probe.sigma.at(pixel.x, pixel.y), static_cast<float>(part.light.sigma.y()));
        }
        lights.push_back(part.light);
    }
    return lights;
}

}  // namespace matchlight
