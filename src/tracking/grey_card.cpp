// Sampling of paper and ink, cell by cell.
#include "tracking/grey_card.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/median.h"
#include "tracking/robust_plane.h"
#include "tracking/tag_pixels.h"

namespace matchlight {

namespace {

struct PurePixel {
    std::array<float, 3> code{};
    int x = 0, y = 0;
    double a = 0, b = 0;   // on the tag's grid
    double margin_px = 0;  // distance to the nearest edge
};

/// The pure pixels of one cell, row by row.
struct PureCell {
    bool paper = false;
    std::vector<PurePixel> pixels;
};

/// By place in the grid. Of large tags some rows do for every cell.
std::vector<PureCell> pure_cells(const PlateFrame& frame, const LensGrid& lens, const BlurredPattern& pattern,
                                 const TagPattern& tag, const TagImageFit& fit) {
    const Region frame_bounds{0, 0, frame.format().width, frame.format().height};
    const Region box =
        region_of_grid(fit.grid_from_normalized, pattern.cells(), lens.camera()).intersected(frame_bounds);
    if (box.empty()) return {};
    const double cell_px = std::min(fit.cell_px[0], fit.cell_px[1]);
    const double blur_px = std::max(fit.observation.blur_px[0], fit.observation.blur_px[1]);
    const double least_margin_px = std::max(1.0, 2.5 * blur_px);
    constexpr double rows_per_cell = 8;
    const int row_step = std::max(1, static_cast<int>(cell_px / rows_per_cell));
    std::vector<PureCell> cells(static_cast<std::size_t>(tag.cells) * static_cast<std::size_t>(tag.cells));
    for (int y = 0; y < tag.cells; ++y) {
        for (int x = 0; x < tag.cells; ++x) {
            cells[static_cast<std::size_t>(y * tag.cells + x)].paper = tag.at(x, y) == TagPattern::white;
        }
    }
    for (int y = 0; y < box.height; y += row_step) {
        const ImageF code = frame.rgb_code({box.x, box.y + y, box.width, 1});
        for (int x = 0; x < box.width; ++x) {
            const Eigen::Vector2d normalized = lens.normalized_from_pixel(box.x + x, box.y + y);
            const Eigen::Vector3d grid = fit.grid_from_normalized * normalized.homogeneous();
            const double a = grid.x() / grid.z(), b = grid.y() / grid.z();
            if (!(a >= 0 && b >= 0 && a < tag.cells && b < tag.cells)) continue;
            const int column = static_cast<int>(a), row = static_cast<int>(b);
            if (tag.at(column, row) == TagPattern::unknown || !pattern.is_known(a, b)) continue;
            const double margin_px = pattern.distance_to_edge(a, b) * cell_px;
            if (margin_px < least_margin_px) continue;
            const float* sample = code.pixel(x, 0);
            cells[static_cast<std::size_t>(row * tag.cells + column)].pixels.push_back(
                {{sample[0], sample[1], sample[2]}, x, y, a, b, margin_px});
        }
    }
    return cells;
}

/// Mean of the values within three standard deviations of the median, which has no bias towards single codes as a
/// trimmed mean of few levels has.
double mean_near_median(const std::vector<double>& values, double step) {
    const double median = upper_median(values);
    std::vector<double> away;
    away.reserve(values.size());
    for (const double value : values) away.push_back(std::abs(value - median));
    const double reach = 3 * std::max(1.4826 * upper_median(away), step);
    double sum = 0;
    int count = 0;
    for (const double value : values) {
        if (std::abs(value - median) > reach) continue;
        sum += value;
        ++count;
    }
    return sum / count;
}

/// One channel of a cell.
struct CellCode {
    double code = 0;
    double noise_variance = 0;   // about a plane of its own
    double neighbour_share = 0;  // covariance of horizontal neighbours
};

struct Cell {
    double a = 0, b = 0;  // mean place from the tag's centre, in half sides
    double count = 0;
    std::array<CellCode, 3> channels;
    std::array<double, 3> shared{};  // covariance of red and green, green and blue, blue and red
    int freedom = 0;                 // of the variances; 0: too few pixels
};

void measure_noise(const std::vector<PurePixel>& pixels, Cell& cell) {
    // A plane takes three degrees of freedom; what is left must be worth a variance.
    constexpr std::size_t enough = 12;
    if (pixels.size() < enough) return;
    const auto count = static_cast<double>(pixels.size());
    double x0 = 0, y0 = 0;
    for (const PurePixel& pixel : pixels) {
        x0 += pixel.x / count;
        y0 += pixel.y / count;
    }
    const auto codes = [](const PurePixel& pixel) {
        return Eigen::RowVector3d(pixel.code[0], pixel.code[1], pixel.code[2]);
    };
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero(), right = Eigen::Matrix3d::Zero();
    for (const PurePixel& pixel : pixels) {
        const Eigen::Vector3d row(1, pixel.x - x0, pixel.y - y0);
        normal += row * row.transpose();
        right += row * codes(pixel);
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    if (!(solver.vectorD().minCoeff() > 0.1)) return;  // pixels in one line
    const Eigen::Matrix3d planes = solver.solve(right);
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    Eigen::RowVector3d neighbours = Eigen::RowVector3d::Zero(), before = Eigen::RowVector3d::Zero();
    int pairs = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const PurePixel& pixel = pixels[i];
        const Eigen::RowVector3d residual = codes(pixel) - Eigen::RowVector3d(1, pixel.x - x0, pixel.y - y0) * planes;
        products += residual.transpose() * residual;
        if (i > 0 && pixels[i - 1].y == pixel.y && pixels[i - 1].x + 1 == pixel.x) {
            neighbours += residual.cwiseProduct(before);
            ++pairs;
        }
        before = residual;
    }
    cell.freedom = static_cast<int>(pixels.size()) - 3;
    products /= cell.freedom;
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        cell.channels[channel].noise_variance = products(c, c);
        cell.shared[channel] = products(c, (c + 1) % 3);
        // The plane takes about three of `count` parts of the variance from every product of residuals.
        if (pairs > 0) cell.channels[channel].neighbour_share = neighbours[c] / pairs + 3 / count * products(c, c);
    }
}

/// Paper or ink of a tag.
struct Surface {
    std::array<CardCode, 3> channels;
    std::array<double, 3> shared{};
};

/// Noise of all cells together, without those that show more than noise: a smudge, an edge.
void pool_noise(const std::vector<Cell>& cells, Surface& surface) {
    std::vector<double> variances;
    const auto variance_of = [](const Cell& cell) {
        return cell.channels[0].noise_variance + cell.channels[1].noise_variance + cell.channels[2].noise_variance;
    };
    for (const Cell& cell : cells) {
        if (cell.freedom > 0) variances.push_back(variance_of(cell));
    }
    if (variances.empty()) return;
    // A variance of nine degrees of freedom, the fewest, exceeds 3 times its median once in several hundred cells.
    const double most = 3 * upper_median(std::move(variances));
    std::array<double, 3> squares{}, products{};
    int freedom = 0;
    for (const Cell& cell : cells) {
        if (cell.freedom == 0 || variance_of(cell) > most) continue;
        freedom += cell.freedom;
        for (std::size_t c = 0; c < 3; ++c) {
            squares[c] += cell.channels[c].noise_variance * cell.freedom;
            products[c] += cell.channels[c].neighbour_share * cell.freedom;
            surface.shared[c] += cell.shared[c] * cell.freedom;
        }
    }
    for (std::size_t c = 0; c < 3; ++c) {
        CardCode& card = surface.channels[c];
        card.noise_freedom = freedom;
        card.noise = std::sqrt(squares[c] / freedom);
        card.neighbour_correlation = squares[c] > 0 ? products[c] / squares[c] : 0;
        surface.shared[c] /= freedom;
    }
}

Surface read_surface(const std::vector<PureCell>& pure, bool paper, int grid_cells, double step) {
    std::array<std::size_t, 3> clipped{};
    std::size_t count = 0;
    std::vector<Cell> cells;
    const double centre = 0.5 * grid_cells;
    for (const PureCell& members : pure) {
        if (members.paper != paper || members.pixels.empty()) continue;
        Cell& cell = cells.emplace_back();
        std::array<std::vector<double>, 3> codes;
        for (const PurePixel& pixel : members.pixels) {
            cell.a += (pixel.a - centre) / centre;
            cell.b += (pixel.b - centre) / centre;
            for (std::size_t c = 0; c < 3; ++c) {
                codes[c].push_back(pixel.code[c]);
                clipped[c] += pixel.code[c] >= PlateLight::clipped_code;
            }
        }
        count += members.pixels.size();
        cell.count = static_cast<double>(members.pixels.size());
        cell.a /= cell.count;
        cell.b /= cell.count;
        for (std::size_t c = 0; c < 3; ++c) cell.channels[c].code = mean_near_median(codes[c], step);
        measure_noise(members.pixels, cell);
    }
    Surface surface;
    pool_noise(cells, surface);
    for (std::size_t c = 0; c < 3; ++c) {
        CardCode& card = surface.channels[c];
        std::vector<PlaneSample> samples;
        for (const Cell& cell : cells) samples.push_back({cell.a, cell.b, cell.channels[c].code, cell.count});
        const PlaneFit plane = fit_robust_plane(samples, 0.25 * step);
        card.code = plane.value;
        // A few clipped pixels are noise or a glint, and left out; more, and the mean is only a lower bound.
        card.clipped = clipped[c] * 10 >= count || card.code >= PlateLight::clipped_code;
        // Rounding shifts the mean of all pixels alike by up to half a step unless noise dithers it: the shift's first
        // harmonic falls as exp(−2π²σ²) of the noise in steps (Widrow, "Statistical analysis of amplitude-quantized
        // sampled-data systems", 1961).
        const double dither = card.noise / step;
        const double rounding =
            step / std::sqrt(12.0) * std::exp(-2 * std::numbers::pi * std::numbers::pi * dither * dither);
        card.standard_error = std::hypot(plane.standard_error, rounding);
    }
    return surface;
}

struct LightOfCode {
    double light = 0, error = 0;
    bool clipped = false;
};

LightOfCode light_of(const CardCode& card, const PlateLight& plate_light, int channel) {
    // The mean light of noisy codes lies above the light of their mean by half the curvature times the variance.
    const auto at = [&](double code) { return plate_light.light_from_code(static_cast<float>(code), channel); };
    const double spread = std::max(card.noise, 1e-3);
    const double above = at(card.code + spread), below = at(card.code - spread);
    const double middle = at(card.code);
    return {card.noise > 0 ? 0.5 * (above + below) : middle, (above - below) / (2 * spread) * card.standard_error,
            card.clipped};
}

/// Light of Rec.709's primaries. Where the footage has others, a channel of it is made of all of the footage's.
std::array<LightOfCode, 3> lights_of(const std::array<CardCode, 3>& cards, const PlateLight& plate_light,
                                     const Primaries& primaries) {
    std::array<LightOfCode, 3> footage, lights;
    for (int c = 0; c < 3; ++c) {
        const auto channel = static_cast<std::size_t>(c);
        footage[channel] = light_of(cards[channel], plate_light, c);
    }
    if (primaries == Primaries::rec709) return footage;
    for (std::size_t to = 0; to < 3; ++to) {
        for (std::size_t from = 0; from < 3; ++from) {
            const double share = rec709_from(primaries)(static_cast<int>(to), static_cast<int>(from));
            lights[to].light += share * footage[from].light;
            lights[to].error = std::hypot(lights[to].error, share * footage[from].error);
            lights[to].clipped = lights[to].clipped || footage[from].clipped;
        }
    }
    return lights;
}

}  // namespace

std::optional<CardReading> read_card(const PlateFrame& frame, const PlateLight& plate_light, const LensGrid& lens,
                                     const TagPattern& tag, const TagImageFit& fit) {
    const BlurredPattern pattern(tag);
    std::vector<PureCell> cells = pure_cells(frame, lens, pattern, tag, fit);
    constexpr double chroma_margin_px = 2.5;
    constexpr std::ptrdiff_t enough_pixels = 40, fewest_pixels = 12;
    const auto count_of = [&](bool paper, double margin_px) {
        std::ptrdiff_t count = 0;
        for (const PureCell& cell : cells) {
            if (cell.paper != paper) continue;
            count += std::ranges::count_if(cell.pixels, [&](const PurePixel& p) { return p.margin_px >= margin_px; });
        }
        return count;
    };
    if (count_of(true, chroma_margin_px) >= enough_pixels && count_of(false, chroma_margin_px) >= enough_pixels) {
        for (PureCell& cell : cells) {
            std::erase_if(cell.pixels, [&](const PurePixel& p) { return p.margin_px < chroma_margin_px; });
        }
    }
    if (count_of(true, 0) < fewest_pixels || count_of(false, 0) < fewest_pixels) return std::nullopt;

    const PlateFormat& format = frame.format();
    CardReading reading;
    reading.id = fit.observation.id;
    const double full_scale = std::exp2(format.bit_depth) - 1;
    const double limited_share = format.range == ColorRange::limited && format.matrix != ColorMatrix::rgb
                                     ? 219.0 / 255
                                     : 1.0;  // ITU-R BT.709: 219 of 255 codes from black to white
    reading.code_step = 1 / (full_scale * limited_share);
    const Eigen::Vector2d middle((format.width - 1) / 2.0, (format.height - 1) / 2.0);
    reading.radius =
        (fit.observation.corners_px.rowwise().mean() - middle).norm() / (0.5 * std::hypot(format.width, format.height));
    const Surface paper_surface = read_surface(cells, true, pattern.cells(), reading.code_step);
    const Surface ink_surface = read_surface(cells, false, pattern.cells(), reading.code_step);
    reading.paper_code = paper_surface.channels;
    reading.ink_code = ink_surface.channels;
    reading.paper_shared = paper_surface.shared;
    reading.ink_shared = ink_surface.shared;
    reading.chroma_shared = format.chroma_block_width > 1 || format.chroma_block_height > 1;
    const std::array<LightOfCode, 3> whites = lights_of(reading.paper_code, plate_light, format.primaries);
    const std::array<LightOfCode, 3> blacks = lights_of(reading.ink_code, plate_light, format.primaries);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const LightOfCode &white = whites[channel], &black = blacks[channel];
        constexpr double darkest = 1e-4;  // below a fortieth of an 8-bit code nothing is known
        const double difference = white.light - black.light;
        reading.difference[channel] = {difference, std::hypot(white.error, black.error) / std::max(difference, darkest),
                                       !white.clipped && difference > darkest};
        reading.ink[channel] = {black.light, black.error / std::max(black.light, darkest),
                                !black.clipped && black.light > darkest};
    }
    return reading;
}

}  // namespace matchlight
