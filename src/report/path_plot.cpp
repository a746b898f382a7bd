// Projects along a world axis and fits what is left into a box.
#include "report/path_plot.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "report/curve_plot.h"

namespace matchlight {
namespace {

constexpr double width_px = 470, height_px = 400, edge_px = 44;

class PlanView {
public:
    PlanView(const Solve& solve, bool from_above) : up_axis_(from_above ? 1 : 2) {
        for (const SolvedFrame& frame : solve.frames) {
            if (frame.camera_from_world) bounds_.extend(plan(frame.camera_from_world->inverse().translation()));
        }
        for (const SolvedTag& tag : solve.rig) {
            const Eigen::Matrix<double, 3, 4> corners = tag.world_from_tag * tag_corners_m(tag.size_m);
            for (int i = 0; i < 4; ++i) bounds_.extend(plan(corners.col(i)));
        }
        const Eigen::Vector2d size = bounds_.sizes().cwiseMax(1e-3);  // a millimetre: one pose over no tag
        px_per_m_ = std::min((width_px - 2 * edge_px) / size.x(), (height_px - 2 * edge_px) / size.y());
    }

    Eigen::Vector2d plan(const Eigen::Vector3d& world) const { return {world.x(), world[up_axis_]}; }
    Eigen::Vector2d px(const Eigen::Vector3d& world) const {
        const Eigen::Vector2d from_middle = (plan(world) - bounds_.center()) * px_per_m_;
        return {width_px / 2 + from_middle.x(), height_px / 2 - from_middle.y()};
    }
    std::string point(const Eigen::Vector3d& world) const {
        const Eigen::Vector2d at = px(world);
        return fmt::format("{:.1f},{:.1f} ", at.x(), at.y());
    }

    std::string grid() const {
        const Eigen::Vector2d half(width_px / 2 / px_per_m_, height_px / 2 / px_per_m_);
        const Eigen::Vector2d low = bounds_.center() - half, high = bounds_.center() + half;
        std::string svg;
        for (const double tick : axis_ticks(low.x(), high.x())) {
            const double x = width_px / 2 + (tick - bounds_.center().x()) * px_per_m_;
            if (x < edge_px || x > width_px) continue;
            svg += fmt::format(
                "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"0\" x2=\"{0:.1f}\" y2=\"{1:.0f}\"/><text class=\"tick\" "
                "x=\"{0:.1f}\" y=\"{2:.0f}\" text-anchor=\"middle\">{3:.6g}</text>",
                x, height_px - 20, height_px - 6, std::abs(tick) < 1e-12 ? 0.0 : tick);
        }
        for (const double tick : axis_ticks(low.y(), high.y())) {
            const double y = height_px / 2 - (tick - bounds_.center().y()) * px_per_m_;
            if (y < 10 || y > height_px - 20) continue;
            svg += fmt::format(
                "<line class=\"grid\" x1=\"{0:.0f}\" y1=\"{1:.1f}\" x2=\"{2:.0f}\" y2=\"{1:.1f}\"/><text "
                "class=\"tick\" x=\"{3:.0f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.6g}</text>",
                edge_px, y, width_px, edge_px - 6, y + 4, std::abs(tick) < 1e-12 ? 0.0 : tick);
        }
        return svg;
    }

    double metres(double length_px) const { return length_px / px_per_m_; }

private:
    int up_axis_;
    Eigen::AlignedBox2d bounds_;
    double px_per_m_ = 1;
};

std::string tags_svg(const Solve& solve, const PlanView& view) {
    std::string svg;
    for (const SolvedTag& tag : solve.rig) {
        const Eigen::Matrix<double, 3, 4> corners = tag.world_from_tag * tag_corners_m(tag.size_m);
        std::string points;
        for (int i = 0; i < 4; ++i) points += view.point(corners.col(i));
        const Eigen::Vector2d middle = view.px(tag.world_from_tag.translation());
        svg += fmt::format(
            "<polygon class=\"tag\" points=\"{}\"/><text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" "
            "text-anchor=\"middle\">{}</text>",
            points, middle.x(), middle.y() + 4, tag.id);
    }
    return svg;
}

std::string path_svg(const Solve& solve, const PlanView& view) {
    std::string svg, points, marks;
    const auto flush = [&] {
        if (!points.empty()) svg += fmt::format("<polyline class=\"c0\" points=\"{}\"/>", points);
        points.clear();
    };
    constexpr std::size_t looks = 12;  // enough to follow, few enough to see the path
    const std::size_t every = std::max<std::size_t>(1, solve.frames.size() / looks);
    constexpr double look_px = 24;
    const SolvedFrame* last = nullptr;
    for (std::size_t i = 0; i < solve.frames.size(); ++i) {
        const SolvedFrame& frame = solve.frames[i];
        if (!frame.camera_from_world) {
            flush();
            continue;
        }
        const RigidTransform pose = frame.camera_from_world->inverse();
        points += view.point(pose.translation());
        const Eigen::Vector2d at = view.px(pose.translation());
        if (frame.bridged) {
            marks +=
                fmt::format("<circle class=\"bridged-mark\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"/>", at.x(), at.y());
        }
        if (i % every == 0) {
            const Eigen::Vector2d to =
                view.px(pose.translation() + view.metres(look_px) * Eigen::Vector3d(pose.linear().col(2)));
            marks += fmt::format("<line class=\"look\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>",
                                 at.x(), at.y(), to.x(), to.y());
        }
        if (last == nullptr) {
            marks += fmt::format("<circle class=\"start\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>", at.x(), at.y());
        }
        last = &frame;
    }
    flush();
    if (last != nullptr) {
        const Eigen::Vector2d at = view.px(last->camera_from_world->inverse().translation());
        marks += fmt::format("<circle class=\"end\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/>", at.x(), at.y());
    }
    return svg + marks;
}

}  // namespace

std::string path_plot_svg(const Solve& solve, bool from_above) {
    const bool drawn = !solve.rig.empty() || std::ranges::any_of(solve.frames, [](const SolvedFrame& frame) {
        return frame.camera_from_world.has_value();
    });
    if (!drawn) return {};
    const PlanView view(solve, from_above);
    return fmt::format("<svg class=\"plan\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"path {}\">",
                       width_px, height_px, from_above ? "from above" : "from the side") +
           view.grid() + tags_svg(solve, view) + path_svg(solve, view) +
           fmt::format("<text class=\"axis\" x=\"{:.0f}\" y=\"15\">{}, m</text></svg>", edge_px,
                       from_above ? "from above: x, y" : "from the side: x, z");
}

}  // namespace matchlight
