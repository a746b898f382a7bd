// LDR-FLIP in bands of rows: opponent colours, contrast sensitivity filters, HyAB distance, edges and points.
//
// All filters of the paper are sums of separable ones (Gaussians and their derivatives, on a square support), and are
// applied as such: first along the rows, then along the columns. Constants are those of the authors' tool, version 1.6.
// Section and equation numbers are those of Andersson et al. 2020.
#include "report/flip.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/LU>

#include "core/parallel.h"
#include "core/transfer.h"

namespace matchlight {
namespace {

using Weights = std::vector<float>;
/// Linear Rec.709 and XYZ relative to the D65 white (.3127, .3290), each way.
struct ColorSpace {
    float relative_from_rgb[3][3];
    float rgb_from_relative[3][3];
};

ColorSpace make_color_space() {
    Eigen::Matrix3d xyz_from_rgb;  // exact fractions, from the chromaticities of primaries and white
    xyz_from_rgb << 10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794,  //
        2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897,                //
        1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382;
    const Eigen::Vector3d white = xyz_from_rgb.rowwise().sum();
    const Eigen::Matrix3d relative_from_rgb = white.cwiseInverse().asDiagonal() * xyz_from_rgb;
    const Eigen::Matrix3d rgb_from_relative = relative_from_rgb.inverse();
    ColorSpace space{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            space.relative_from_rgb[row][column] = static_cast<float>(relative_from_rgb(row, column));
            space.rgb_from_relative[row][column] = static_cast<float>(rgb_from_relative(row, column));
        }
    }
    return space;
}

float product(const float (&row)[3], float x, float y, float z) {
    return row[0] * x + row[1] * y + row[2] * z;
}

// §4.2 and §4.3: exponents, the share of the colour distance that maps to most of the error range, and the width of
// the edges that the eye resolves, in degrees.
constexpr double color_exponent = 0.7;     // q_c
constexpr double color_knee = 0.4;         // p_c
constexpr double color_knee_error = 0.95;  // p_t
constexpr double feature_exponent = 0.5;   // q_f
constexpr double feature_width_deg = 0.082;

/// Contrast sensitivity of one opponent channel in space: a·sqrt(π/b)·exp(−π²x²/b), x in degrees (eq. 3, table 1).
struct SensitivityTerm {
    double a, b;
};
constexpr SensitivityTerm achromatic{1, 0.0047};
constexpr SensitivityTerm red_green{1, 0.0053};
constexpr SensitivityTerm blue_yellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

struct Filters {
    int color_radius = 0;
    Weights achromatic, red_green;
    Weights blue_yellow[2];         // along rows, each summing to 1
    Weights blue_yellow_column[2];  // along columns, holding the share of each term
    int feature_radius = 0;
    Weights smooth, edge, point;
    int radius() const { return std::max(color_radius, feature_radius); }
};

std::vector<double> gaussian(int radius, double exponent_factor) {
    std::vector<double> weights;
    for (int i = -radius; i <= radius; ++i) weights.push_back(std::exp(-exponent_factor * i * i));
    return weights;
}

double sum_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum;
}

Weights scaled(const std::vector<double>& values, double scale) {
    Weights weights;
    for (const double value : values) weights.push_back(static_cast<float>(value * scale));
    return weights;
}

/// Positive weights sum to 1, negative ones to −1 (§4.3).
Weights balanced(const std::vector<double>& values) {
    double positive = 0, negative = 0;
    for (const double value : values) (value > 0 ? positive : negative) += std::abs(value);
    Weights weights;
    for (const double value : values) weights.push_back(static_cast<float>(value / (value > 0 ? positive : negative)));
    return weights;
}

Filters make_filters(double pixels_per_degree) {
    constexpr double pi = std::numbers::pi;
    Filters filters;
    // One radius for all channels: three standard deviations of the widest term.
    const double widest = std::sqrt(blue_yellow[0].b / (2 * pi * pi));
    filters.color_radius = static_cast<int>(std::ceil(3 * widest * pixels_per_degree));
    const auto term = [&](const SensitivityTerm& t) {
        return gaussian(filters.color_radius, pi * pi / (t.b * pixels_per_degree * pixels_per_degree));
    };
    const auto normalized = [](const std::vector<double>& values) { return scaled(values, 1 / sum_of(values)); };
    filters.achromatic = normalized(term(achromatic));
    filters.red_green = normalized(term(red_green));

    // The sum of two separable filters, normalised as a whole.
    std::array<double, 2> volume{};
    for (std::size_t i = 0; i < 2; ++i) {
        const double sum = sum_of(term(blue_yellow[i]));
        volume[i] = blue_yellow[i].a * std::sqrt(pi / blue_yellow[i].b) * sum * sum;
    }
    for (std::size_t i = 0; i < 2; ++i) {
        const std::vector<double> values = term(blue_yellow[i]);
        filters.blue_yellow[i] = normalized(values);
        filters.blue_yellow_column[i] = scaled(values, volume[i] / (volume[0] + volume[1]) / sum_of(values));
    }

    const double deviation = 0.5 * feature_width_deg * pixels_per_degree;
    filters.feature_radius = static_cast<int>(std::ceil(3 * deviation));
    const std::vector<double> smooth = gaussian(filters.feature_radius, 1 / (2 * deviation * deviation));
    std::vector<double> edge, point;
    for (int i = -filters.feature_radius; i <= filters.feature_radius; ++i) {
        const double g = std::exp(-i * i / (2 * deviation * deviation));
        edge.push_back(-i * g);
        point.push_back((i * i / (deviation * deviation) - 1) * g);
    }
    filters.smooth = normalized(smooth);
    filters.edge = balanced(edge);
    filters.point = balanced(point);
    return filters;
}

/// CIELAB f; the linear piece near black included.
float lab_curve(float ratio) {
    constexpr float delta = 6.0f / 29;
    return ratio > delta * delta * delta ? std::cbrt(ratio) : ratio / (3 * delta * delta) + 4.0f / 29;
}

struct Lab {
    float l, a, b;
};

/// CIELAB with chroma scaled by lightness (the Hunt effect, eq. 5), from XYZ relative to white.
Lab hunt_lab(float x, float y, float z) {
    const float fx = lab_curve(x), fy = lab_curve(y), fz = lab_curve(z);
    const float l = 116 * fy - 16;
    return {l, 0.01f * l * 500 * (fx - fy), 0.01f * l * 200 * (fy - fz)};
}

/// Abasi, Amani Tehran & Fairchild, "Distance metrics for very large color differences" (2019).
float hyab_distance(const Lab& p, const Lab& q) {
    const float da = p.a - q.a, db = p.b - q.b;
    return std::abs(p.l - q.l) + std::sqrt(da * da + db * db);
}

float raised_distance(float distance) {
    return std::pow(distance, static_cast<float>(color_exponent));
}

/// Between green and blue: the largest distance that two colours of the display have.
float largest_raised_distance(const ColorSpace& space) {
    const auto pure = [&](int channel) {
        const auto& m = space.relative_from_rgb;
        return hunt_lab(m[0][channel], m[1][channel], m[2][channel]);
    };
    return raised_distance(hyab_distance(pure(1), pure(2)));
}

/// Rows of floats that share one width.
class Plane {
public:
    Plane(int width, int rows)
        : width_(width), values_(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows)) {}
    float* row(int y) { return values_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_); }
    const float* row(int y) const {
        return values_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    }

private:
    int width_;
    std::vector<float> values_;
};

/// out[x] = Σ weights[i]·padded[x + i], where `padded` starts the filter's radius left of the row.
void filter_row(const float* padded, const Weights& weights, int width, float* out) {
    std::fill(out, out + width, 0.0f);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const float weight = weights[i];
        const float* source = padded + i;
        for (int x = 0; x < width; ++x) out[x] += weight * source[x];
    }
}

/// Adds the same along a column: rows first_row … of `plane`.
void add_filtered_column(const Plane& plane, int first_row, const Weights& weights, int width, float* out) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const float weight = weights[i];
        const float* source = plane.row(first_row + static_cast<int>(i));
        for (int x = 0; x < width; ++x) out[x] += weight * source[x];
    }
}

/// What is left of one image in a band of rows after filtering.
struct FilteredBand {
    FilteredBand(int width, int rows)
        : l(width, rows), a(width, rows), b(width, rows), edge(width, rows), point(width, rows) {}
    Plane l, a, b;      // Hunt-adjusted CIELAB of the contrast-filtered image
    Plane edge, point;  // magnitude of the features (§4.3)
};

/// An image as FLIP reads it: linear Rec.709 light of a display, 0..1, a row at a time.
struct DisplayedLight {
    int width = 0, height = 0;
    std::function<void(int row, float* rgb)> read_row;
};

class BandFilter {
public:
    BandFilter(const Filters& filters, const ColorSpace& space, int width, int rows)
        : filters_(filters),
          space_(space),
          width_(width),
          radius_(filters.radius()),
          halo_rows_(rows + 2 * radius_),
          planes_(plane_count, Plane(width, halo_rows_)),
          padded_(3, std::vector<float>(static_cast<std::size_t>(width + 2 * radius_))),
          rgb_(3 * static_cast<std::size_t>(width)),
          column_(static_cast<std::size_t>(width)) {}

    void run(const DisplayedLight& image, int first_row, int rows, FilteredBand& result) {
        for (int y = 0; y < rows + 2 * radius_; ++y) {
            // The border repeats.
            filter_along_row(image, std::clamp(first_row + y - radius_, 0, image.height - 1), y);
        }
        for (int y = 0; y < rows; ++y) {
            finish_color(y, result);
            finish_features(y, result);
        }
    }

private:
    /// Intermediate planes: the channels filtered along rows.
    enum PlaneName { luma, rg, by_wide, by_narrow, luma_smooth, luma_edge, luma_point, plane_count };

    void filter_along_row(const DisplayedLight& image, int source_row, int y) {
        // YCxCz: the linear opponent space of Kolpatzik & Bouman (1992), here without the factors 116, 500 and 200 and
        // the offset, which the filters pass through: y = Y/Yn, x = X/Xn − Y/Yn, z = Y/Yn − Z/Zn.
        image.read_row(source_row, rgb_.data());
        const float* source = rgb_.data();
        float* channel[3];
        for (int c = 0; c < 3; ++c) channel[c] = padded_[static_cast<std::size_t>(c)].data();
        for (int x = 0; x < width_; ++x) {
            const float r = source[0], g = source[1], b = source[2];
            source += 3;
            const float relative_y = product(space_.relative_from_rgb[1], r, g, b);
            channel[0][x + radius_] = relative_y;
            channel[1][x + radius_] = product(space_.relative_from_rgb[0], r, g, b) - relative_y;
            channel[2][x + radius_] = relative_y - product(space_.relative_from_rgb[2], r, g, b);
        }
        for (float* row : channel) {
            std::fill(row, row + radius_, row[radius_]);
            float* const end = row + radius_ + width_;
            std::fill(end, end + radius_, end[-1]);
        }
        const int color_start = radius_ - filters_.color_radius;
        const int feature_start = radius_ - filters_.feature_radius;
        filter_row(channel[0] + color_start, filters_.achromatic, width_, planes_[luma].row(y));
        filter_row(channel[1] + color_start, filters_.red_green, width_, planes_[rg].row(y));
        filter_row(channel[2] + color_start, filters_.blue_yellow[0], width_, planes_[by_wide].row(y));
        filter_row(channel[2] + color_start, filters_.blue_yellow[1], width_, planes_[by_narrow].row(y));
        filter_row(channel[0] + feature_start, filters_.smooth, width_, planes_[luma_smooth].row(y));
        filter_row(channel[0] + feature_start, filters_.edge, width_, planes_[luma_edge].row(y));
        filter_row(channel[0] + feature_start, filters_.point, width_, planes_[luma_point].row(y));
    }

    void finish_color(int y, FilteredBand& result) {
        const int first = y + radius_ - filters_.color_radius;
        float* l = result.l.row(y);
        float* a = result.a.row(y);
        float* b = result.b.row(y);
        for (float* row : {l, a, b}) std::fill(row, row + width_, 0.0f);
        add_filtered_column(planes_[luma], first, filters_.achromatic, width_, l);
        add_filtered_column(planes_[rg], first, filters_.red_green, width_, a);
        add_filtered_column(planes_[by_wide], first, filters_.blue_yellow_column[0], width_, b);
        add_filtered_column(planes_[by_narrow], first, filters_.blue_yellow_column[1], width_, b);
        for (int x = 0; x < width_; ++x) {
            const float rx = l[x] + a[x], ry = l[x], rz = l[x] - b[x];
            // Filtered colours may leave the display's gamut: they are brought back to it in linear RGB (§4.1).
            const float red = std::clamp(product(space_.rgb_from_relative[0], rx, ry, rz), 0.0f, 1.0f);
            const float green = std::clamp(product(space_.rgb_from_relative[1], rx, ry, rz), 0.0f, 1.0f);
            const float blue = std::clamp(product(space_.rgb_from_relative[2], rx, ry, rz), 0.0f, 1.0f);
            const Lab lab = hunt_lab(product(space_.relative_from_rgb[0], red, green, blue),
                                     product(space_.relative_from_rgb[1], red, green, blue),
                                     product(space_.relative_from_rgb[2], red, green, blue));
            l[x] = lab.l;
            a[x] = lab.a;
            b[x] = lab.b;
        }
    }

    /// Magnitude of a feature whose kernel lies along x, then along y.
    void finish_feature(PlaneName along_x, const Weights& kernel, int first, float* out) {
        std::fill(out, out + width_, 0.0f);
        std::fill(column_.begin(), column_.end(), 0.0f);
        add_filtered_column(planes_[along_x], first, filters_.smooth, width_, out);
        add_filtered_column(planes_[luma_smooth], first, kernel, width_, column_.data());
        for (int x = 0; x < width_; ++x) {
            const float down = column_[static_cast<std::size_t>(x)];
            out[x] = std::sqrt(out[x] * out[x] + down * down);
        }
    }

    void finish_features(int y, FilteredBand& result) {
        const int first = y + radius_ - filters_.feature_radius;
        finish_feature(luma_edge, filters_.edge, first, result.edge.row(y));
        finish_feature(luma_point, filters_.point, first, result.point.row(y));
    }

    const Filters& filters_;
    const ColorSpace& space_;
    int width_;
    int radius_;
    int halo_rows_;
    std::vector<Plane> planes_;
    std::vector<std::vector<float>> padded_;
    std::vector<float> rgb_;
    std::vector<float> column_;
};

/// Colour and feature differences joined into the error of one pixel (§4.2 to §4.4).
void join_row(const FilteredBand& reference, const FilteredBand& test, int y, int width, float largest, float* error) {
    const float knee = static_cast<float>(color_knee) * largest;
    constexpr auto knee_error = static_cast<float>(color_knee_error);
    constexpr auto half_root = static_cast<float>(1 / std::numbers::sqrt2);
    static_assert(feature_exponent == 0.5);  // a square root below
    for (int x = 0; x < width; ++x) {
        const Lab p{reference.l.row(y)[x], reference.a.row(y)[x], reference.b.row(y)[x]};
        const Lab q{test.l.row(y)[x], test.a.row(y)[x], test.b.row(y)[x]};
        const float distance = raised_distance(hyab_distance(p, q));
        const float color = distance < knee ? distance * (knee_error / knee)
                                            : knee_error + (distance - knee) / (largest - knee) * (1 - knee_error);
        const float edges = std::abs(reference.edge.row(y)[x] - test.edge.row(y)[x]);
        const float points = std::abs(reference.point.row(y)[x] - test.point.row(y)[x]);
        const float feature = std::sqrt(half_root * std::max(edges, points));
        error[x] = std::min(std::pow(color, 1 - feature), 1.0f);
    }
}

ImageF error_map(const DisplayedLight& reference, const DisplayedLight& test, const FlipOptions& options) {
    assert(reference.width == test.width && reference.height == test.height);
    assert(options.pixels_per_degree >= FlipOptions::smallest_pixels_per_degree &&
           options.pixels_per_degree <= FlipOptions::largest_pixels_per_degree);
    const Filters filters = make_filters(options.pixels_per_degree);
    const ColorSpace space = make_color_space();
    const float largest = largest_raised_distance(space);

    const int width = reference.width, height = reference.height;
    // Bands small enough for the caches, yet much taller than the halo of two radii that each filters again.
    const int band_rows = std::clamp(4 * filters.radius(), 48, 256);
    const int bands = (height + band_rows - 1) / band_rows;
    ImageF map(width, height, 1);
    parallel_for(bands, [&](int band) {
        const int first_row = band * band_rows;
        const int rows = std::min(band_rows, height - first_row);
        BandFilter filter(filters, space, width, rows);
        FilteredBand filtered_reference(width, rows), filtered_test(width, rows);
        filter.run(reference, first_row, rows, filtered_reference);
        filter.run(test, first_row, rows, filtered_test);
        for (int y = 0; y < rows; ++y) {
            join_row(filtered_reference, filtered_test, y, width, largest, map.pixel(0, first_row + y));
        }
    });
    return map;
}

}  // namespace

ImageF flip_error_map(const Image8& reference, const Image8& test, const FlipOptions& options) {
    assert(reference.channels() == 3 && test.channels() == 3);
    std::array<float, 256> linear_from_code{};
    for (std::size_t code = 0; code < 256; ++code) {
        linear_from_code[code] = static_cast<float>(linear_from_srgb_code(static_cast<double>(code) / 255));
    }
    const auto displayed = [&](const Image8& image) {
        return DisplayedLight{image.width(), image.height(), [&](int row, float* rgb) {
                                  for (const std::uint8_t code : image.row(row)) *rgb++ = linear_from_code[code];
                              }};
    };
    return error_map(displayed(reference), displayed(test), options);
}

ImageF flip_error_map_of_light(const ImageF& reference, const ImageF& test, const FlipOptions& options) {
    assert(reference.channels() == 3 && test.channels() == 3);
    const auto displayed = [](const ImageF& image) {
        return DisplayedLight{image.width(), image.height(), [&image](int row, float* rgb) {
                                  for (const float light : image.row(row)) *rgb++ = std::clamp(light, 0.0f, 1.0f);
                              }};
    };
    return error_map(displayed(reference), displayed(test), options);
}

}  // namespace matchlight
