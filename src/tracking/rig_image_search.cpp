// Correlation of the rig's expected picture with the plate over shifts.
#include "tracking/rig_image_search.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace matchlight {

namespace {

constexpr double search_blur_px = 3;  // bridges the steps between shifts
constexpr int step_px = 3;
constexpr int lattice = 16;  // points along a sheet's side

/// A point of a sheet: where its middle of exposure lies in the light, and the share of paper expected there.
struct ExpectedPoint {
    int x = 0, y = 0;
    float paper = 0;
};

using ExpectedSheet = std::vector<ExpectedPoint>;

std::vector<ExpectedSheet> expect(const FitSource& source, const std::vector<PlacedSheet>& sheets,
                                  const MovingCamera& camera) {
    const Camera& lens = source.lens.camera();
    std::vector<ExpectedSheet> expected;
    for (const PlacedSheet& sheet : sheets) {
        const SheetImage image(sheet, camera, lens);
        if (!image.in_view()) continue;
        ExpectedSheet points;
        for (int j = 0; j < lattice; ++j) {
            for (int i = 0; i < lattice; ++i) {
                const Eigen::Vector2d grid = Eigen::Vector2d(i + 0.5, j + 0.5) * sheet.printed.cells / lattice;
                const Eigen::Vector3d in_camera =
                    camera.camera_from_world * (sheet.world_from_tag * sheet.sheet_from_grid(grid));
                SheetPixel pixel;
                pixel.normalized = in_camera.hnormalized();
                if (!image.sees_only_cells(pixel.normalized)) continue;
                const Eigen::Vector2d px = lens.pixel_from_normalized(pixel.normalized);
                // Far outside the frame lens models fold.
                if (!(px.cwiseAbs().maxCoeff() < 4.0 * (lens.width + lens.height))) continue;
                image.locate(pixel);
                SheetSample sample;
                if (!image.at(pixel, sample)) continue;
                points.push_back({static_cast<int>(std::lround(px.x())) - source.x,
                                  static_cast<int>(std::lround(px.y())) - source.y, static_cast<float>(sample.paper)});
            }
        }
        if (!points.empty()) expected.push_back(std::move(points));
    }
    return expected;
}

/// Share of the variance that flat paper and ink on each sheet leave unexplained; 1 where too little is in the picture.
double unexplained(const std::vector<ExpectedSheet>& sheets, const cv::Mat& light, int right, int down) {
    double left = 0, total = 0;
    std::size_t counted = 0, all = 0;
    for (const ExpectedSheet& sheet : sheets) {
        double n = 0, s = 0, ss = 0, l = 0, ll = 0, sl = 0;
        for (const ExpectedPoint& point : sheet) {
            const int x = point.x + right, y = point.y + down;
            if (x < 0 || y < 0 || x >= light.cols || y >= light.rows) continue;
            const double value = light.at<float>(y, x), paper = point.paper;
            n += 1, s += paper, ss += paper * paper, l += value, ll += value * value, sl += paper * value;
        }
        all += sheet.size();
        constexpr double fewest_points = 24;
        if (n < fewest_points) continue;
        counted += static_cast<std::size_t>(n);
        const double variance = ll - l * l / n, paper_variance = ss - s * s / n, shared = sl - s * l / n;
        total += variance;
        left += shared > 0 && paper_variance > 0 ? variance - shared * shared / paper_variance : variance;
    }
    return total > 0 && 3 * counted > all ? left / total : 1;
}

MovingCamera turned(const MovingCamera& camera, const Camera& lens, int right, int down) {
    MovingCamera result = camera;
    const Eigen::Vector3d turn(-down / lens.fy, right / lens.fx, 0);
    result.camera_from_world =
        Eigen::AngleAxisd(turn.norm(), turn.norm() > 0 ? turn.normalized() : Eigen::Vector3d::UnitX()) *
        camera.camera_from_world;
    return result;
}

}  // namespace

std::vector<RigPlace> search_rig(const FitSource& source, const std::vector<PlacedSheet>& sheets,
                                 const MovingCamera& start, double reach_px) {
    cv::Mat light;
    const cv::Mat sharp(source.light.height(), source.light.width(), CV_32F,
                        const_cast<float*>(source.light.samples().data()));
    cv::GaussianBlur(sharp, light, cv::Size(), search_blur_px);
    const int reach = static_cast<int>(std::ceil(reach_px / step_px));
    std::vector<RigPlace> places;
    struct Candidate {
        int right = 0, down = 0;
        double scale = 1, left = 1;
    };
    std::vector<Candidate> candidates;
    // The start's motion is a guess, its length may be off by a factor. Never none: what follows could not tell which
    // way to lengthen it, and would take it for blur.
    std::vector<double> scales{0.2, 0.5, 0.75, 1.0, 1.33, 1.8};
    if (start.motion.norm() < 1e-6) scales = {1.0};
    for (const double scale : scales) {
        MovingCamera camera = start;
        camera.motion *= scale;
        camera.blur_px = std::hypot(start.blur_px, search_blur_px);
        const std::vector<ExpectedSheet> expected = expect(source, sheets, camera);
        for (int v = -reach; v <= reach; ++v) {
            for (int u = -reach; u <= reach; ++u) {
                const double left = unexplained(expected, light, u * step_px, v * step_px);
                constexpr double hopeless = 0.7;
                if (left < hopeless) candidates.push_back({u * step_px, v * step_px, scale, left});
            }
        }
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::left);
    std::vector<Candidate> kept;
    constexpr std::size_t most_places = 3;
    constexpr double apart_px = 8;
    for (const Candidate& candidate : candidates) {
        if (kept.size() >= most_places) break;
        if (std::ranges::any_of(kept, [&](const Candidate& other) {
                return std::hypot(other.right - candidate.right, other.down - candidate.down) < apart_px;
            })) {
            continue;
        }
        kept.push_back(candidate);
        MovingCamera camera = turned(start, source.lens.camera(), candidate.right, candidate.down);
        camera.motion *= candidate.scale;
        places.push_back({camera, candidate.left});
    }
    return places;
}

}  // namespace matchlight
