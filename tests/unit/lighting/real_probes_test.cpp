// Other people's probes and their own conversions of them: the mappings are the ones in use.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "core/transfer.h"
#include "lighting/probe_file.h"
#include "lighting/resample.h"

namespace matchlight {
namespace {

namespace fs = std::filesystem;

class ConvertedProbes : public testing::Test {
protected:
    void SetUp() override {
        const char* data = std::getenv("MATCHLIGHT_DATA");
        if (data == nullptr) GTEST_SKIP() << "MATCHLIGHT_DATA does not name the folder of test data";
        folder_ = fs::path(data) / "real/probes";
        warnings_.set_quiet(true);
    }

    using PixelMap = std::function<Eigen::Vector2i(int x, int y)>;

    /// Correlation of log luminance by solid angle; a gain between the two does not matter.
    static double log_correlation(const ImageF& a, const ImageF& b, const PixelMap& pixel_of_b) {
        double n = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
        const auto log_luminance = [](const float* p) {
            return std::log(std::max(1e-5, luminance_rec709(p[0], p[1], p[2])));
        };
        for (int y = 0; y < a.height(); ++y) {
            const double weight = std::sin(std::numbers::pi * (y + 0.5) / a.height());
            for (int x = 0; x < a.width(); ++x) {
                const Eigen::Vector2i other = pixel_of_b(x, y);
                const double la = log_luminance(a.pixel(x, y));
                const double lb = log_luminance(b.pixel(other.x(), other.y()));
                n += weight;
                sum_a += weight * la;
                sum_b += weight * lb;
                sum_aa += weight * la * la;
                sum_bb += weight * lb * lb;
                sum_ab += weight * la * lb;
            }
        }
        return (n * sum_ab - sum_a * sum_b) / std::sqrt((n * sum_aa - sum_a * sum_a) * (n * sum_bb - sum_b * sum_b));
    }

    fs::path folder_;
    Warnings warnings_;
};

TEST_F(ConvertedProbes, GraceAngularMapUnwrapsToItsLatlong) {
    const ProbeImage angular = read_probe_image(folder_ / "debevec_angular/grace_probe.hdr", {}, warnings_);
    ASSERT_EQ(angular.layout.mapping, ProbeMapping::angular);  // in spite of the caption in its corner
    const ImageF latlong = read_linear_rgb(folder_ / "misc/grace_latlong.exr", warnings_);
    const Probe unwrapped_probe = probe_from_image(angular.image, angular.layout, latlong.height());
    // The published one is upside down.
    const double correlation = log_correlation(
        unwrapped_probe.latlong, latlong, [&](int x, int y) { return Eigen::Vector2i(x, latlong.height() - 1 - y); });
    EXPECT_GE(correlation, 0.9995);  // measured 0.99996
}

TEST_F(ConvertedProbes, OpenExrsCubeIsItsLatlong) {
    const ProbeImage cube = read_probe_image(folder_ / "openexr_images/KernerEnvCube.exr", {}, warnings_);
    ASSERT_EQ(cube.layout.cube, CubeLayout::column);
    ASSERT_TRUE(cube.layout.edge_centred);
    const Probe latlong = load_probe(folder_ / "openexr_images/KernerEnvLatLong.exr", {}, warnings_);
    const Probe unwrapped_probe = probe_from_image(cube.image, cube.layout, latlong.latlong.height());
    const auto same = [](int x, int y) { return Eigen::Vector2i(x, y); };
    EXPECT_GE(log_correlation(unwrapped_probe.latlong, latlong.latlong, same), 0.998);  // measured 0.9989
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d expected = irradiance(latlong, up);
    EXPECT_NEAR((irradiance(unwrapped_probe, up) - expected).norm(), 0, 0.01 * expected.norm());
}

TEST_F(ConvertedProbes, AMirrorBallUnwrapsToItsLatlong) {
    // A ball as photographed, so its room is mirrored; its authors unmirror it.
    const Probe ball =
        load_probe(folder_ / "cs445_mirrorball/samples/weighted_hdr.hdr", ProbeMapping::mirrorball, warnings_);
    const Probe theirs = load_probe(folder_ / "cs445_mirrorball/samples/equirectangular.hdr", {}, warnings_);
    const int height = theirs.latlong.height();
    const Probe ours =
        probe_from_image(ball.latlong, layout_of_size(ProbeMapping::latlong, ball.latlong.height()), height);
    const double correlation = log_correlation(ours.latlong, theirs.latlong,
                                               [&](int x, int y) { return Eigen::Vector2i(2 * height - 1 - x, y); });
    EXPECT_GE(correlation, 0.98);  // measured 0.987; theirs has a black cross and other filtering
}

}  // namespace
}  // namespace matchlight
