// Pictures as PNG inside SVG, so that lamps are marked over them in the picture's own pixels.
#include "report/probe_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/html_text.h"
#include "core/page_style.h"
#include "core/transfer.h"
#include "core/version.h"
#include "lighting/latlong_grid.h"
#include "lighting/latlong_pyramid.h"
#include "lighting/resample.h"
#include "report/embedded_png.h"

namespace matchlight {
namespace {

using Eigen::Vector3d;

constexpr const char* own_style = R"(
.sphere { width: 100%; max-width: 1024px; height: auto; display: block; background: #000; }
.ball { width: 100%; max-width: 380px; height: auto; display: block; background: #000; }
.ladder { display: grid; grid-template-columns: repeat(2, 1fr); gap: .8rem; max-width: 1024px; }
.ladder img { width: 100%; max-width: none; } .ladder figcaption { max-width: none; }
.lamp { fill: none; stroke: #e0322d; stroke-width: 2; } .cut { fill: #1f7ae0; stroke: #fff; stroke-width: 1; }
.number { font: 700 15px system-ui, sans-serif; fill: #e0322d; stroke: #fff; stroke-width: 3px; paint-order: stroke; }
.bar { fill: #9fb2cc; } .light { fill: none; stroke: #c2571a; stroke-width: 2; }
)";

Image8 shown(const ImageF& light, double exposure_ev) {
    const double gain = std::exp2(exposure_ev);
    Image8 picture(light.width(), light.height(), 3);
    for (int y = 0; y < light.height(); ++y) {
        for (int x = 0; x < light.width(); ++x) {
            for (int c = 0; c < 3; ++c) {
                const double code = srgb_code_from_linear(std::min(1.0, light.at(x, y, c) * gain));
                picture.at(x, y, c) = static_cast<std::uint8_t>(std::lround(255 * std::max(0.0, code)));
            }
        }
    }
    return picture;
}

/// Half of the sphere is darker than 18 % of white, as in a photograph exposed for what is there to be seen.
double exposure_for(const ProbeStatistics& statistics) {
    const double middle = statistics.median_luminance > 0 ? statistics.median_luminance : statistics.mean_luminance;
    return middle > 0 ? std::log2(0.18 / middle) : 0;
}

/// At most 1024 wide: what a page shows.
ImageF page_sized(const ImageF& latlong) {
    if (latlong.width() <= 1024) return latlong;
    return shrunk_latlong(latlong, 1024, std::max(1, 1024 * latlong.height() / latlong.width()));
}

std::string image_tag(const Image8& picture, int width, int height) {
    return fmt::format("<image width=\"{}\" height=\"{}\" href=\"{}\"/>", width, height,
                       embedded_png(picture, picture.width()));
}

/// The lat-long picture with the lamps of both methods over it.
std::string marked_sphere(const ProbePageInput& input, const ImageF& light, double exposure_ev) {
    // Circles keep their size whatever the probe's.
    constexpr int width = 1024, height = 512;
    std::string svg = fmt::format("<svg class=\"sphere\" viewBox=\"0 0 {} {}\">", width, height) +
                      image_tag(shown(light, exposure_ev), width, height);
    for (const DirectionalSample& sample : input.median_cut) {
        const Eigen::Vector2d at = latlong_pixel(sample.direction, width, height);
        svg += fmt::format("<circle class=\"cut\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>", at.x() + 0.5, at.y() + 0.5);
    }
    for (std::size_t i = 0; i < input.lights.size(); ++i) {
        const Eigen::Vector2d at = latlong_pixel(input.lights[i].direction, width, height);
        const double radius = std::sqrt(input.lights[i].solid_angle_sr / std::numbers::pi) * height / std::numbers::pi;
        svg += fmt::format(
            "<circle class=\"lamp\" cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"{2:.1f}\"/>"
            "<text class=\"number\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5}</text>",
            at.x() + 0.5, at.y() + 0.5, radius + 7, std::min(at.x() + radius + 10, width - 14.0), at.y() - 4, i + 1);
    }
    return svg + "</svg>";
}

std::string marked_ball(const ProbePageInput& input, const ImageF& ball, double exposure_ev) {
    const int size = ball.width();
    const ProbeLayout layout = layout_of_size(ProbeMapping::mirrorball, size);
    std::string svg = fmt::format("<svg class=\"ball\" viewBox=\"0 0 {0} {0}\">", size) +
                      image_tag(shown(ball, exposure_ev), size, size);
    for (std::size_t i = 0; i < input.lights.size(); ++i) {
        const Eigen::Vector2d at = pixel_from_direction(layout, input.lights[i].direction);
        svg += fmt::format(
            "<circle class=\"lamp\" cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"9\"/>"
            "<text class=\"number\" x=\"{2:.1f}\" y=\"{3:.1f}\">{4}</text>",
            at.x() + 0.5, at.y() + 0.5, std::min(at.x() + 11, size - 12.0), at.y() - 4, i + 1);
    }
    return svg + "</svg>";
}

std::string ladder(const ImageF& light, double exposure_ev) {
    std::string html = "<div class=\"ladder\">";
    for (const double step : {-8.0, -4.0, 0.0, 4.0}) {
        html +=
            fmt::format("<figure><img alt=\"at {0:+.0f} EV\" src=\"{1}\"><figcaption>{0:+.0f} EV</figcaption></figure>",
                        step, embedded_png(shown(light, exposure_ev + step), 512));
    }
    return html + "</div>";
}

/// What a surface facing each direction receives, as the radiance of a white one.
ImageF irradiance_map(const Probe& probe) {
    constexpr int height = 32;  // irradiance has no detail finer than some ten degrees
    Probe small = probe;
    if (probe.latlong.height() > 64) small.latlong = shrunk_latlong(probe.latlong, 128, 64);
    ImageF map(2 * height, height, 3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < 2 * height; ++x) {
            const Vector3d radiance = irradiance(small, latlong_direction(x, y, 2 * height, height)) / std::numbers::pi;
            for (int c = 0; c < 3; ++c) map.at(x, y, c) = static_cast<float>(radiance[c]);
        }
    }
    return map;
}

/// Share of the sphere (bars) and of its light (line) by luminance in steps of one EV.
std::string histogram_svg(const ProbePageInput& input) {
    const ImageF& image = input.probe.latlong;
    const ProbeStatistics& statistics = input.statistics;
    if (statistics.largest_luminance <= 0) return "<p>All black.</p>";
    const LatlongGrid grid(image.width(), image.height());
    const double top = std::ceil(std::log2(statistics.largest_luminance));
    // What lies more than 40 EV under the brightest pixel is in the first bar.
    const int bins =
        static_cast<int>(std::clamp(top - std::floor(std::log2(statistics.least_positive_luminance)), 1.0, 40.0));
    std::vector<double> sphere(static_cast<std::size_t>(bins), 0.0), light(static_cast<std::size_t>(bins), 0.0);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const float* p = image.pixel(x, y);
            const double luminance = luminance_rec709(p[0], p[1], p[2]);
            if (luminance <= 0) continue;
            const auto bin = static_cast<std::size_t>(
                std::clamp(static_cast<int>(std::floor(std::log2(luminance) - top + bins)), 0, bins - 1));
            sphere[bin] += grid.solid_angle(y);
            light[bin] += grid.solid_angle(y) * luminance;
        }
    }
    constexpr double width = 760, height = 240, left = 40, bottom = 24, ceiling = 10;
    const double most =
        std::max(*std::max_element(sphere.begin(), sphere.end()) / (4 * std::numbers::pi),
                 *std::max_element(light.begin(), light.end()) / (4 * std::numbers::pi * statistics.mean_luminance));
    const double step = (width - left) / bins;
    const auto y_of = [&](double share) { return ceiling + (height - bottom - ceiling) * (1 - share / most); };
    std::string svg = fmt::format("<svg class=\"plot\" viewBox=\"0 0 {} {}\">", width, height);
    std::string line;
    for (int i = 0; i < bins; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double x = left + i * step;
        const double y = y_of(sphere[at] / (4 * std::numbers::pi));
        svg += fmt::format("<rect class=\"bar\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
                           x + 0.5, y, step - 1, height - bottom - y);
        line += fmt::format("{:.1f},{:.1f} ", x + step / 2,
                            y_of(light[at] / (4 * std::numbers::pi * statistics.mean_luminance)));
        if (i % (bins > 16 ? 4 : 2) == 0) {
            svg +=
                fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\">{:+.0f}</text>", x, height - 8, top - bins + i);
        }
    }
    svg += fmt::format("<polyline class=\"light\" points=\"{}\"/>", line);
    for (const double share : {0.0, most / 2, most}) {
        svg += fmt::format("<text class=\"tick\" x=\"0\" y=\"{:.1f}\">{:.0f} %</text>", y_of(share) + 4, 100 * share);
    }
    return svg + "</svg>";
}

std::string rgb_cells(const Vector3d& rgb) {
    return fmt::format("<td>{:.4g}</td><td>{:.4g}</td><td>{:.4g}</td>", rgb.x(), rgb.y(), rgb.z());
}

std::string direction_cells(const Vector3d& d) {
    constexpr double degrees = 180 / std::numbers::pi;
    return fmt::format("<td>{:.2f}°</td><td>{:.2f}°</td>", std::atan2(d.y(), d.x()) * degrees,
                       std::atan2(d.z(), std::hypot(d.x(), d.y())) * degrees);
}

std::string light_tables(const ProbePageInput& input) {
    const double whole = 4 * std::numbers::pi * input.statistics.mean_luminance;
    std::string html;
    if (input.lights.empty()) {
        html += "<p>No lamp stands out.</p>";
    } else {
        html +=
            "<table><tr><th>lamp</th><th>azimuth</th><th>elevation</th><th>solid angle, sr</th><th>of all light</th>"
            "<th>r</th><th>g</th><th>b</th></tr>";
        for (std::size_t i = 0; i < input.lights.size(); ++i) {
            const DominantLight& light = input.lights[i];
            html += fmt::format("<tr><td>{}</td>{}<td>{:.3g}</td><td>{:.1f} %</td>{}</tr>", i + 1,
                                direction_cells(light.direction), light.solid_angle_sr, 100 * light.power_share,
                                rgb_cells(light.power));
        }
        html += "</table>";
    }
    html += "<p>Median cut: the whole sphere in parts that one direction each stands for (blue dots).</p>";
    html +=
        "<table><tr><th>azimuth</th><th>elevation</th><th>solid angle, sr</th><th>of all light</th><th>r</th><th>g</th>"
        "<th>b</th></tr>";
    for (const DirectionalSample& sample : input.median_cut) {
        const Vector3d& power = sample.radiance_times_solid_angle;
        html += fmt::format(
            "<tr>{}<td>{:.3g}</td><td>{:.1f} %</td>{}</tr>", direction_cells(sample.direction), sample.solid_angle_sr,
            whole > 0 ? 100 * luminance_rec709(power.x(), power.y(), power.z()) / whole : 0.0, rgb_cells(power));
    }
    return html + "</table>";
}

std::string irradiance_table(const Probe& probe) {
    constexpr std::array<std::pair<const char*, std::array<double, 3>>, 6> faces = {{{"+x, right", {1, 0, 0}},
                                                                                     {"−x, left", {-1, 0, 0}},
                                                                                     {"+y, forward", {0, 1, 0}},
                                                                                     {"−y, back", {0, -1, 0}},
                                                                                     {"+z, up", {0, 0, 1}},
                                                                                     {"−z, down", {0, 0, -1}}}};
    std::string html = "<table><tr><th class=\"word\">a surface that faces</th><th>r</th><th>g</th><th>b</th></tr>";
    for (const auto& [name, axis] : faces) {
        html += fmt::format("<tr><td class=\"word\">{}</td>{}</tr>", name,
                            rgb_cells(irradiance(probe, {axis[0], axis[1], axis[2]})));
    }
    html += "</table><table><tr><th class=\"word\">spherical harmonic (l, m)</th><th>r</th><th>g</th><th>b</th></tr>";
    constexpr std::array<const char*, 9> names = {"0, 0",  "1, −1", "1, 0", "1, 1", "2, −2",
                                                  "2, −1", "2, 0",  "2, 1", "2, 2"};
    const SphericalHarmonics9 sh = project_to_sh(probe);
    for (std::size_t i = 0; i < names.size(); ++i) {
        html += fmt::format("<tr><td class=\"word\">{}</td>{}</tr>", names.at(i), rgb_cells(sh.at(i)));
    }
    return html + "</table>";
}

/// Grey as sure as it is (white: exactly known, black: to a factor of two or worse), blue filled in, red clipped.
Image8 coverage_picture(const ProbePageInput& input) {
    const ImageF clipped = clipped_map(input.record, input.probe.latlong);
    Image8 picture(clipped.width(), clipped.height(), 3);
    for (int y = 0; y < clipped.height(); ++y) {
        for (int x = 0; x < clipped.width(); ++x) {
            const double sigma = input.record.sigma ? input.record.sigma->at(x, y) : 0.0;
            const double seen = input.record.seen ? std::min(1.0f, input.record.seen->at(x, y)) : 1.0;
            // From 1 % to 100 % on a scale of logarithms.
            const double sureness = 1 - std::clamp(1 + std::log10(std::max(sigma, 1e-9)) / 2, 0.0, 1.0);
            const double known = (60 + 160 * sureness) * seen;
            Vector3d color(known + 40 * (1 - seen), known + 90 * (1 - seen), known + 200 * (1 - seen));
            const double lost = std::min(1.0f, clipped.at(x, y));
            color = (1 - lost) * color + lost * Vector3d(224, 40, 40);
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<std::uint8_t>(std::lround(color[c]));
        }
    }
    return picture;
}

std::string coverage_section(const ProbePageInput& input) {
    std::string html = "<h2>What it does not know</h2><p>";
    html +=
        fmt::format("{:.3g} % of the sphere is clipped: its light is a lower bound. ", 100 * input.coverage.clipped);
    if (input.coverage.unseen) {
        html += fmt::format("{:.3g} % was seen by no photograph and is filled in. ", 100 * *input.coverage.unseen);
    } else {
        html += "The file does not say what was seen. ";
    }
    if (input.coverage.median_sigma) {
        html += fmt::format("Half of the rest is known to {:.2g} % or better. ", 100 * *input.coverage.median_sigma);
    }
    html += fmt::format(
        "Samples that were no light and were repaired: {}. Red: clipped{}; blue: filled in; grey: the brighter, the "
        "surer.</p>",
        input.repaired_samples, input.record.clipped ? "" : " (flat tops)");
    html +=
        fmt::format("<img class=\"sphere\" alt=\"coverage\" src=\"{}\">", embedded_png(coverage_picture(input), 1024));
    return html;
}

std::string record_section(const ImageMetadata& metadata) {
    if (metadata.empty()) return {};
    std::string html = "<h2>What the file says of itself</h2><table>";
    for (const auto& [name, value] : metadata) {
        html += fmt::format("<tr><td class=\"word\">{}</td><td class=\"word long\">{}</td></tr>", html_text(name),
                            html_text(value));
    }
    return html + "</table>";
}

}  // namespace

std::string probe_page(const ProbePageInput& input) {
    const ProbeStatistics& statistics = input.statistics;
    const double exposure_ev = exposure_for(statistics);
    const ImageF light = page_sized(input.probe.latlong);
    const ImageF ball = image_from_probe({light}, layout_of_size(ProbeMapping::mirrorball, 380));
    std::string html = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Matchlight: {0}</title>"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{1}{2}</style></head><body>"
        "<h1>Light probe {0}</h1><p>{3}. Matchlight {4}.</p>",
        html_text(input.name), page_style, own_style, html_text(input.description), version);
    html += fmt::format(
        "<p>Luminance: mean <strong>{:.4g}</strong>, median {:.4g}, largest {:.4g}, least above black {:.4g}: "
        "<strong>{:.1f} EV</strong>. Mean radiance {:.4g} {:.4g} {:.4g}. {:.2g} % of the sphere is black.</p>",
        statistics.mean_luminance, statistics.median_luminance, statistics.largest_luminance,
        statistics.least_positive_luminance, statistics.dynamic_range_ev(), statistics.mean_radiance.x(),
        statistics.mean_radiance.y(), statistics.mean_radiance.z(), 100 * statistics.black_share);
    html += fmt::format(
        "<h2>All directions</h2><p class=\"note\">The middle looks forward, world +y; right of it lies +x, the top is "
        "+z. Exposed by {:+.2f} EV: half of the sphere is darker than 18 % of white. Red: lamps, by their power.</p>{}",
        exposure_ev, marked_sphere(input, light, exposure_ev));
    html += fmt::format(
        "<h2>As a mirror ball</h2><p class=\"note\">Seen from behind the photographer's shoulder: the "
        "middle looks forward, the rim back.</p>{}",
        marked_ball(input, ball, exposure_ev));
    html += "<h2>Lamps</h2>" + light_tables(input);
    html += "<h2>Exposures</h2>" + ladder(light, exposure_ev);
    const ImageF lit = irradiance_map(input.probe);
    double brightest = 0;
    for (const float value : lit.samples()) brightest = std::max(brightest, static_cast<double>(value));
    html += fmt::format(
        "<h2>Irradiance</h2><p class=\"note\">What a matte white surface looks like that faces each direction; the "
        "brightest is white.</p><img class=\"sphere\" alt=\"irradiance\" src=\"{}\">{}",
        embedded_png(shown(lit, brightest > 0 ? -std::log2(brightest) : 0), 1024), irradiance_table(input.probe));
    html +=
        "<h2>Luminance</h2><p class=\"note\">In steps of one EV, 0 at luminance 1. Bars: share of the sphere; line: "
        "share of its light.</p>" +
        histogram_svg(input);
    html += coverage_section(input) + record_section(input.record.metadata);
    return html + "</body></html>\n";
}

}  // namespace matchlight
