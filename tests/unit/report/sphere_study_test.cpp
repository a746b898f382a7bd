// What a report says of sphere sets, and the cameras it says it of.
#include "report/sphere_study.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/report.h"
#include "report/sphere_orbit.h"

namespace matchlight {
namespace {

SphereStudy small_study() {
    SphereStudy study;
    study.rows.push_back({.set = "C2",
                          .spheres = 2463048,
                          .orbit = "whole",
                          .part = "visibility",
                          .way = "no tests",
                          .frames = 6,
                          .time = {20, 10, 30},
                          .speedup = {},
                          .beside = {}});
    study.rows.push_back(study.rows.front());
    study.rows.back().way = "all \"tests\", <really>";
    study.rows.back().speedup = 4;
    study.rows.back().beside = {{"cells", 17}};
    study.checks.push_back({.set = "C2", .orbit = "whole", .frames = 1, .pixels = 100, .edge_pixels = 40});
    return study;
}

TEST(SphereStudy, IsWrittenAsJsonCsvAndHtml) {
    Report report;
    report.scene = "C2";
    report.sphere_study = small_study();
    const nlohmann::json json = nlohmann::json::parse(report_json(report));
    ASSERT_EQ(json["sphere_study"]["ways"].size(), 2U);
    const nlohmann::json& way = json["sphere_study"]["ways"][1];
    EXPECT_EQ(way["spheres"], 2463048);
    EXPECT_EQ(way["speedup"], 4.0);
    EXPECT_EQ(way["beside"]["cells"], 17.0);
    EXPECT_TRUE(json["sphere_study"]["ways"][0]["speedup"].is_null());
    EXPECT_EQ(json["sphere_study"]["checks"][0]["edge_pixels"], 40);

    const std::string csv = report_csv(report);
    EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
    EXPECT_NE(csv.find("\"all \"\"tests\"\", <really>\""), std::string::npos);

    const std::string html = report_html(report);
    EXPECT_NE(html.find("all &quot;tests&quot;, &lt;really&gt;"), std::string::npos);
    EXPECT_NE(html.find("Sphere sets: C2"), std::string::npos);
    EXPECT_EQ(html.find("<really>"), std::string::npos);
    EXPECT_NE(sphere_study_lines(report.sphere_study).find("(0 of 60 pixels over 1)"), std::string::npos);
}

TEST(SphereOrbit, SeesTheMiddleOfTheBoxAndAllOfIt) {
    const Eigen::AlignedBox3d box(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(2, 4, 7));
    const double reach = box.diagonal().norm() / 2;
    for (const double turn : {0.0, 0.3, 0.75}) {
        const ReferenceView view = orbit_view(box, {"whole", 3}, turn, 1024);
        const Eigen::Vector3d middle = view.camera_from_world * box.center();
        EXPECT_LT((middle - Eigen::Vector3d(0, 0, 3 * reach)).norm(), 1e-12 * reach);
        for (int i = 0; i < 8; ++i) {
            const Eigen::Vector3d corner =
                view.camera_from_world * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
            const double x = view.pinhole.fx * corner.x() / corner.z() + view.pinhole.cx;
            const double y = view.pinhole.fy * corner.y() / corner.z() + view.pinhole.cy;
            EXPECT_TRUE(x > 0 && x < 1023 && y > 0 && y < 1023) << x << " " << y;
        }
        // Twenty degrees up.
        const double height = (view.camera_from_world.inverse().translation() - box.center()).z();
        EXPECT_NEAR(height, 3 * reach * std::sin(20 * std::numbers::pi / 180), 1e-12 * reach);
    }
}

TEST(SphereOrbit, OfOnePointAndOfNothingHasACamera) {
    for (const Eigen::AlignedBox3d& box : {Eigen::AlignedBox3d(Eigen::Vector3d(1, 1, 1)), Eigen::AlignedBox3d()}) {
        const ReferenceView view = orbit_view(box, {"whole", 3}, 0.1, 64);
        EXPECT_TRUE(view.camera_from_world.matrix().allFinite());
        EXPECT_GT(view.pinhole.near_m, 0);
    }
}

}  // namespace
}  // namespace matchlight
