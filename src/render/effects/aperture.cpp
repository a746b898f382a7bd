// Draws the opening with exact or finely sampled coverage.
#include "render/effects/aperture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>

#include "core/error.h"
#include "core/parallel.h"
#include "media/image_io.h"

namespace matchlight {
namespace {

using std::numbers::pi;

/// The same numbers from every standard library, unlike its distributions.
class Dice {
public:
    explicit Dice(int seed) : engine_(static_cast<std::uint64_t>(seed)) {}
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
    }

private:
    std::mt19937_64 engine_;
};

/// From texels to radii of the opening, y up.
struct Placement {
    double centre = 0;  // in texels, of which the first's middle is 0.5
    double radius = 1;

    Eigen::Vector2d texels(const Eigen::Vector2d& p) const {
        return {centre + radius * p.x(), centre - radius * p.y()};
    }
};

/// The share of the unit square around a texel's middle that is inside, by 16 × 16 points.
double coverage(double x, double y, const std::function<bool(double, double)>& inside) {
    constexpr int points = 16;
    int hits = 0;
    for (int j = 0; j < points; ++j) {
        for (int i = 0; i < points; ++i) {
            hits += inside(x + (i + 0.5) / points - 0.5, y + (j + 0.5) / points - 0.5) ? 1 : 0;
        }
    }
    return hits / static_cast<double>(points * points);
}

void draw_blades(Image<double>& image, const ApertureSettings& settings, const Placement& placement) {
    const double nearest = aperture_edge(settings, (settings.rotation_deg * pi) / 180) * placement.radius;
    const auto inside = [&](double x, double y) {
        const double right = x - placement.centre;
        const double up = placement.centre - y;
        return std::hypot(right, up) <= placement.radius * aperture_edge(settings, std::atan2(up, right));
    };
    parallel_for(image.height(), [&](int y) {
        for (int x = 0; x < image.width(); ++x) {
            const double distance = std::hypot(x + 0.5 - placement.centre, y + 0.5 - placement.centre);
            if (distance > placement.radius + 1) continue;
            image.at(x, y) = distance < nearest - 1 ? 1 : coverage(x + 0.5, y + 0.5, inside);
        }
    });
}

/// Takes away what an opaque thing covers: `width_at` a distance is its share of a texel there.
void cover(Image<double>& image, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
           const std::function<double(const Eigen::Vector2d&)>& share_at) {
    const int left = std::max(0, static_cast<int>(std::floor(low.x())) - 1);
    const int top = std::max(0, static_cast<int>(std::floor(low.y())) - 1);
    const int right = std::min(image.width() - 1, static_cast<int>(std::ceil(high.x())) + 1);
    const int bottom = std::min(image.height() - 1, static_cast<int>(std::ceil(high.y())) + 1);
    for (int y = top; y <= bottom; ++y) {
        for (int x = left; x <= right; ++x) image.at(x, y) *= 1 - share_at({x + 0.5, y + 0.5});
    }
}

/// A hair from `root` over a bend to its tip, a quadratic Bézier curve that thins out; in texels.
struct Eyelash {
    Eigen::Vector2d root, bend, tip;
    double root_width = 1;

    /// The share of a texel at `p` that it covers: the overlap of two intervals, exact for a straight hair along an
    /// axis.
    double share_at(const Eigen::Vector2d& p) const {
        constexpr int segments = 24;
        double most = 0;
        Eigen::Vector2d from = root;
        for (int i = 1; i <= segments; ++i) {
            const double t = static_cast<double>(i) / segments;
            const Eigen::Vector2d to = (1 - t) * (1 - t) * root + 2 * t * (1 - t) * bend + t * t * tip;
            const Eigen::Vector2d along = to - from;
            const double place = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
            const double distance = (p - from - place * along).norm();
            const double half_width = root_width / 2 * (1 - (i - 1 + place) / segments);
            const double overlap = std::min(distance + 0.5, half_width) - std::max(distance - 0.5, -half_width);
            most = std::max(most, std::min(overlap, 1.0));
            from = to;
        }
        return most;
    }
};

/// Lashes hang from the upper rim: roots over its middle 120°, up to the opening's middle and bent to either side.
void draw_eyelashes(Image<double>& image, const ApertureSettings& settings, const Placement& placement) {
    Dice dice(settings.seed);
    for (int i = 0; i < settings.eyelashes; ++i) {
        const double angle = dice.between(pi / 6, 5 * pi / 6);
        const double lean = angle + pi + dice.between(-0.35, 0.35);
        const double length = dice.between(0.3, 0.8);
        const double bend = dice.between(-0.25, 0.25) * length;
        const Eigen::Vector2d root(1.05 * std::cos(angle), 1.05 * std::sin(angle));
        const Eigen::Vector2d along(std::cos(lean), std::sin(lean));
        const Eigen::Vector2d across(-along.y(), along.x());
        // A lash is a tenth of a millimetre thick, a pupil some millimetres wide.
        const Eyelash lash{placement.texels(root), placement.texels(root + 0.5 * length * along + bend * across),
                           placement.texels(root + length * along), 0.04 * placement.radius};
        const double width = lash.root_width;
        const Eigen::Vector2d low = lash.root.cwiseMin(lash.bend).cwiseMin(lash.tip).array() - width;
        const Eigen::Vector2d high = lash.root.cwiseMax(lash.bend).cwiseMax(lash.tip).array() + width;
        cover(image, low, high, [&](const Eigen::Vector2d& p) { return lash.share_at(p); });
    }
}

/// Round specks of 0.5 to 2 % of the opening's radius, anywhere in it.
void draw_dust(Image<double>& image, const ApertureSettings& settings, const Placement& placement) {
    Dice dice(settings.seed + 1);
    for (int i = 0; i < settings.dust; ++i) {
        const double angle = dice.between(0, 2 * pi);
        const double distance = std::sqrt(dice.between(0, 1));
        const double radius = dice.between(0.005, 0.02) * placement.radius;
        const Eigen::Vector2d middle = placement.texels({distance * std::cos(angle), distance * std::sin(angle)});
        const auto inside = [&](double x, double y) { return std::hypot(x - middle.x(), y - middle.y()) <= radius; };
        cover(image, middle.array() - radius, middle.array() + radius,
              [&](const Eigen::Vector2d& p) { return coverage(p.x(), p.y(), inside); });
    }
}

/// The picture's longer side spans the opening's diameter; each texel takes the mean of what it covers.
void draw_file(Image<double>& image, const std::filesystem::path& path, const Placement& placement) {
    const Image16 picture = read_rgb16(path);
    const double pixels_per_texel = std::max(picture.width(), picture.height()) / (2 * placement.radius);
    bool lets_light_through = false;
    const auto share = [](int pixel, double from, double to) {
        return std::max(0.0, std::min(to, pixel + 1.0) - std::max(from, static_cast<double>(pixel)));
    };
    for (int y = 0; y < image.height(); ++y) {
        const double top = (y - placement.centre) * pixels_per_texel + picture.height() / 2.0;
        const double bottom = top + pixels_per_texel;
        const int first_row = std::max(0, static_cast<int>(std::floor(top)));
        const int last_row = std::min(picture.height() - 1, static_cast<int>(std::ceil(bottom)) - 1);
        for (int x = 0; x < image.width(); ++x) {
            const double left = (x - placement.centre) * pixels_per_texel + picture.width() / 2.0;
            const double right = left + pixels_per_texel;
            const int first_column = std::max(0, static_cast<int>(std::floor(left)));
            const int last_column = std::min(picture.width() - 1, static_cast<int>(std::ceil(right)) - 1);
            double sum = 0;
            for (int v = first_row; v <= last_row; ++v) {
                for (int u = first_column; u <= last_column; ++u) {
                    const std::uint16_t* p = picture.pixel(u, v);
                    sum += share(v, top, bottom) * share(u, left, right) * (p[0] + p[1] + p[2]);
                }
            }
            image.at(x, y) = sum / (3 * 65535.0 * pixels_per_texel * pixels_per_texel);
            lets_light_through = lets_light_through || sum > 0;
        }
    }
    if (!lets_light_through) throw InputError(path, "is black: this aperture lets no light through");
}

}  // namespace

double aperture_edge(const ApertureSettings& settings, double angle_rad) {
    if (settings.blades == 0) return 1;
    const double half_sector = pi / settings.blades;
    const double from_edge = std::remainder(angle_rad - settings.rotation_deg * pi / 180, 2 * half_sector);
    const double straight = std::cos(half_sector) / std::cos(from_edge);
    return straight + settings.roundness * (1 - straight);
}

Image<double> make_aperture_image(const ApertureSettings& settings, int side) {
    assert(side >= 16);
    Image<double> image(side, side, 1);
    const Placement placement{side / 2.0, side / (2.0 * aperture_field)};
    if (settings.image.empty()) {
        draw_blades(image, settings, placement);
    } else {
        draw_file(image, settings.image, placement);
    }
    draw_eyelashes(image, settings, placement);
    draw_dust(image, settings, placement);
    return image;
}

}  // namespace matchlight
