// The shelf of ready probes: each loads without a warning and is what its provenance says.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "core/transfer.h"
#include "lighting/dominant_lights.h"
#include "lighting/probe_file.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

const fs::path shelf = fs::path(MATCHLIGHT_SOURCE_DIR) / "probes";

std::vector<std::string> shelf_names() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(shelf)) {
        if (entry.is_directory()) names.push_back(entry.path().filename().string());
    }
    std::ranges::sort(names);
    return names;
}

Vector3d rgb_of(const toml::node_view<toml::node>& node) {
    return {node[0].value_or(std::nan("")), node[1].value_or(std::nan("")), node[2].value_or(std::nan(""))};
}

/// Facts are written with four digits.
void expect_near(const Vector3d& found, const Vector3d& fact) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], fact[c], 1e-3 * std::abs(fact[c]));
}

Vector3d brightest_direction(const ImageF& latlong) {
    double largest = -1;
    Vector3d direction = Vector3d::Zero();
    for (int y = 0; y < latlong.height(); ++y) {
        for (int x = 0; x < latlong.width(); ++x) {
            const float* p = latlong.pixel(x, y);
            const double luminance = luminance_rec709(p[0], p[1], p[2]);
            if (luminance <= largest) continue;
            largest = luminance;
            direction = latlong_direction(x, y, latlong.width(), latlong.height());
        }
    }
    return direction;
}

class ShelfProbe : public testing::TestWithParam<std::string> {};

TEST_P(ShelfProbe, IsWhatItsProvenanceSays) {
    toml::table about = toml::parse_file((shelf / GetParam() / "provenance.toml").string());
    for (const char* key : {"picture", "source", "author", "made_by"}) {
        EXPECT_FALSE(about[key].value_or(std::string()).empty()) << key;
    }
    EXPECT_EQ(about["licence"].value_or(std::string()), "CC0-1.0");

    Warnings warnings;
    const ProbeImage file = read_probe_image(shelf / GetParam() / "probe.exr", {}, warnings);
    EXPECT_TRUE(warnings.empty());
    EXPECT_EQ(file.layout.mapping, ProbeMapping::latlong);
    toml::node_view<toml::node> facts = about["facts"];
    EXPECT_EQ(file.image.width(), facts["width"].value_or(0));
    EXPECT_EQ(file.image.height(), facts["height"].value_or(0));

    const Probe probe{file.image};
    const ProbeStatistics statistics = probe_statistics(probe);
    expect_near(statistics.mean_radiance, rgb_of(facts["mean_radiance"]));
    const double largest = facts["largest_luminance"].value_or(0.0);
    EXPECT_NEAR(statistics.largest_luminance, largest, 1e-3 * largest);
    const struct {
        const char* name;
        Vector3d normal;
    } sides[] = {{"+x", {1, 0, 0}},  {"-x", {-1, 0, 0}}, {"+y", {0, 1, 0}},
                 {"-y", {0, -1, 0}}, {"+z", {0, 0, 1}},  {"-z", {0, 0, -1}}};
    for (const auto& side : sides) {
        SCOPED_TRACE(side.name);
        expect_near(irradiance(probe, side.normal), rgb_of(facts["irradiance"][side.name]));
    }
    const double degree = std::numbers::pi / 180;
    const double azimuth = degree * facts["brightest"]["azimuth_deg"].value_or(1e9);
    const double elevation = degree * facts["brightest"]["elevation_deg"].value_or(1e9);
    const Vector3d brightest(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                             std::sin(elevation));
    EXPECT_GT(brightest.dot(brightest_direction(file.image)), std::cos(0.1 * degree));
}

INSTANTIATE_TEST_SUITE_P(Shelf, ShelfProbe, testing::ValuesIn(shelf_names()),
                         [](const auto& test) { return test.param; });

TEST(ProbeShelf, IsSmallAndListed) {
    std::uintmax_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(shelf)) {
        if (entry.is_regular_file()) bytes += entry.file_size();
    }
    EXPECT_LT(bytes, 2u << 20);
    std::ifstream stream(shelf / "README.md");
    const std::string readme((std::istreambuf_iterator<char>(stream)), {});
    EXPECT_GE(shelf_names().size(), 3u);
    for (const std::string& name : shelf_names()) EXPECT_NE(readme.find("[`" + name + "`]"), std::string::npos) << name;
}

}  // namespace
}  // namespace matchlight
