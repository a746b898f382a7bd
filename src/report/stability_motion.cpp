// Cases of motion blur that is gathered from one picture: bright points, long ways, none.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "gl/objects.h"
#include "render/effects/motion_blur.h"
#include "render/graph.h"
#include "report/stability_cases.h"

namespace matchlight {
namespace {

struct MovingPicture {
    ImageF light;  // premultiplied RGBA
    ImageF ways;   // way in pixels, body, 1/m
};

/// A square of one body in the middle of an empty frame, its light `radiance`.
MovingPicture moving_square(int frame_px, int side_px, double radiance, const Eigen::Vector2d& way_px) {
    MovingPicture picture{ImageF(frame_px, frame_px, 4), ImageF(frame_px, frame_px, 4)};
    const int first = (frame_px - side_px) / 2;
    for (int y = first; y < first + side_px; ++y) {
        for (int x = first; x < first + side_px; ++x) {
            for (int c = 0; c < 3; ++c) picture.light.at(x, y, c) = static_cast<float>(radiance);
            picture.light.at(x, y, 3) = 1;
            picture.ways.at(x, y, 0) = static_cast<float>(way_px.x());
            picture.ways.at(x, y, 1) = static_cast<float>(way_px.y());
            picture.ways.at(x, y, 2) = 1;
            picture.ways.at(x, y, 3) = 1;
        }
    }
    return picture;
}

ImageF smeared(const MovingPicture& picture, double longest_way_px, QualityLevel level) {
    const int width = picture.light.width(), height = picture.light.height();
    const Region region{0, 0, width, height};
    const auto upload = [&](const ImageF& image) {
        Texture2D texture({.format = GL_RGBA32F, .width = width, .height = height});
        texture.upload(region, image.samples());
        return texture;
    };
    const Texture2D light = upload(picture.light), ways = upload(picture.ways);
    ShaderLibrary shaders;
    RenderGraph graph;
    graph.begin_frame(width, height);
    const GraphShape shape{GL_RGBA32F, region};
    const GraphTexture blurred = add_motion_blur(
        graph, shaders,
        {.light = graph.import(&light, shape), .ways = graph.import(&ways, shape), .way_px = longest_way_px},
        motion_blur_knobs(level));
    graph.output(blurred);
    graph.run();
    return read_runs(graph.texture(blurred), region, {region}, 4);
}

/// Largest value, infinite where one is no number; and the light that comes out over what went in.
StabilityOutcome outcome_of(const MovingPicture& before, const ImageF& after) {
    double sum_before = 0, sum_after = 0, largest = 0;
    for (const float value : before.light.samples()) sum_before += value;
    for (const float value : after.samples()) {
        const bool fits = std::isfinite(value) && value >= 0;
        largest = fits ? std::max(largest, static_cast<double>(value)) : std::numeric_limits<double>::infinity();
        sum_after += value;
    }
    return {largest, sum_after / sum_before};
}

}  // namespace

std::vector<StabilityCase> motion_blur_cases() {
    constexpr int frame_px = 192;
    std::vector<StabilityCase> cases;
    for (const QualityLevel level : {QualityLevel::final_, QualityLevel::draft}) {
        const char* const name = level == QualityLevel::final_ ? "final" : "draft";
        for (const Eigen::Vector2d& way : {Eigen::Vector2d(20, 0), {-9, 33}, {64, 64}}) {
            const double radiance = 1e5, length = way.norm();
            // A pixel gives each pixel of its trail no more than one over its length; draft's wide steps gather it into
            // fewer.
            const double stride = std::max(1.0, std::ceil(length / 2 / motion_blur_knobs(level).most_taps));
            cases.push_back({"motion blur",
                             fmt::format("one pixel of 1e5 on a way of ({:g}, {:g}) px, {}", way.x(), way.y(), name),
                             "largest light",
                             {0, radiance * std::sqrt(2.0) * stride / length * 1.001},
                             // A slanted way passes between pixels: each tap is shared by two.
                             level == QualityLevel::final_ ? std::optional(Bound{0.999, 1.001}) : std::nullopt,
                             [=] {
                                 const MovingPicture picture = moving_square(frame_px, 1, radiance, way);
                                 return outcome_of(picture, smeared(picture, length, level));
                             }});
        }
    }
    for (const double length : {300.0, 1e4, 1e6}) {
        // A step more or less of what the square gives.
        const double stride = std::ceil((length / 2 + 0.5) / motion_blur_knobs(QualityLevel::final_).most_taps);
        cases.push_back({"motion blur",
                         fmt::format("a square of 40 px on a way of {:g} px in {} px", length, frame_px),
                         "largest light",
                         {0, (40 + stride) / length * 1.001},
                         {},
                         [=] {
                             const MovingPicture picture = moving_square(frame_px, 40, 1, {length, 0});
                             StabilityOutcome outcome =
                                 outcome_of(picture, smeared(picture, length, QualityLevel::final_));
                             outcome.energy_kept.reset();  // most of it has left the frame
                             return outcome;
                         }});
    }
    cases.push_back({"motion blur", "nothing moves", "largest difference", {0, 0}, {}, [] {
                         const MovingPicture picture = moving_square(frame_px, 40, 1e5, {0, 0});
                         const ImageF after = smeared(picture, 0, QualityLevel::final_);
                         double largest = 0;
                         for (std::size_t i = 0; i < after.samples().size(); ++i) {
                             const double difference =
                                 std::abs(static_cast<double>(after.samples()[i]) - picture.light.samples()[i]);
                             largest = std::max(largest, difference);
                         }
                         return StabilityOutcome{largest, {}};
                     }});
    return cases;
}

}  // namespace matchlight
