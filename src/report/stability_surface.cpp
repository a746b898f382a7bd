// Stiff cases of the picture of the real surface: grazing and far cameras, clipped frames, frames of unlike weight.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compositor/plane_grid.h"
#include "compositor/surface_texel.h"
#include "report/stability_cases.h"

namespace matchlight {

namespace {

constexpr int most_texels = 2048;

/// The longer side of the grid in texels; infinite where a number of it is not finite.
double grid_side(double height_m, double tilt_deg) {
    Solve solve;
    solve.camera.width = 1920;
    solve.camera.height = 1080;
    solve.camera.fx = solve.camera.fy = 1500;
    solve.camera.cx = 959.5;
    solve.camera.cy = 539.5;
    SolvedTag tag;
    tag.size_m = 0.08;
    solve.rig.push_back(tag);
    const double tilt = tilt_deg * EIGEN_PI / 180;
    const RigidTransform camera = camera_looking_along(Eigen::Vector3d(0, -height_m / std::tan(tilt), height_m),
                                                       Eigen::Vector3d(0, std::cos(tilt), -std::sin(tilt)));
    const PlaneGrid grid = plan_plane_grid({camera}, solve, make_lens_map(solve.camera), 0, most_texels);
    if (grid.columns == 0) return 0;
    const bool finite = grid.rectangle_m.min().allFinite() && grid.rectangle_m.max().allFinite() && grid.texel_m > 0;
    return finite ? std::max(grid.columns, grid.rows) : std::numeric_limits<double>::infinity();
}

SurfaceSample sample_of(double light, bool clipped, double weight) {
    return {.radiance = {light, light, light},
            .deviation = {0.05 * light, 0.05 * light, 0.05 * light},
            .clipped = {clipped, clipped, clipped},
            .weight = weight};
}

StabilityCase texel_case(const char* name, std::array<SurfaceSample, 3> samples, double light) {
    return {"surface picture", name, "relative error of the light", {0, 1e-12}, {}, [samples, light] {
                const SurfaceTexel texel = agreed_texel(samples);
                return StabilityOutcome{std::abs(texel.radiance[0] - light) / light,
                                        {},
                                        {},
                                        {{"knowledge", texel.knowledge}, {"clipped", texel.clipped ? 1.0 : 0.0}}};
            }};
}

}  // namespace

std::vector<StabilityCase> surface_picture_cases() {
    std::vector<StabilityCase> cases;
    for (const auto& [height_m, tilt_deg] : {std::pair{0.5, 90.0}, {0.5, 1.0}, {1e-3, 0.05}, {1e3, 90.0}}) {
        cases.push_back(
            {"surface picture",
             fmt::format("camera {:g} m up, {:g}° down", height_m, tilt_deg),
             "texels along the longer side",
             {0, most_texels},
             {},
             [height_m = height_m, tilt_deg = tilt_deg] { return StabilityOutcome{grid_side(height_m, tilt_deg)}; }});
    }
    cases.push_back(texel_case("every frame clips, bounds of 1 to 1e6",
                               {sample_of(1, true, 1), sample_of(1e6, true, 1), sample_of(1, true, 1)}, 1e6));
    cases.push_back(texel_case("weights of 1e-30 to 1e30",
                               {sample_of(0.2, false, 1e-30), sample_of(0.5, false, 1e30), sample_of(0.9, false, 1)},
                               0.5));
    return cases;
}

}  // namespace matchlight
