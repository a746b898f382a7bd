// Lists of indirect draws, a pyramid of depths, and rounds that grow.
#include "render/sphere_culling.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace matchlight {

namespace {

/// Shares of the cells that are drawn by the end of the first round, and how that grows from round to round: the first
/// hide most of the rest.
constexpr double first_round = 1.0 / 16, round_growth = 1.5;
/// A pyramid costs as much as drawing a sphere for so many pixels of the picture.
constexpr double pixels_per_sphere = 16;
/// With fewer spheres the tests cost more than what they save.
constexpr std::uint32_t fewest_to_cull = 100'000;
/// Fewer do not stand for the others.
constexpr std::uint32_t fewest_in_cell = 8;

/// Pixels along a side of a texel of the pyramid's first level: fine enough for cells of any size to be hidden, coarse
/// enough for the picture to be read once and little to be written.
constexpr int pyramid_side = 8;

int groups_of(int size, int group) {
    return (size + group - 1) / group;
}

/// How many times the spheres of a cell are halved.
int detail_level(const SphereCulling::Drawn& drawn, const SphereCell& cell) {
    if (drawn.detail.radius_px <= 0) return 0;
    const double radius_px = drawn.rays.largest_radius_px(cell);
    int level = 0;
    while (level < most_detail_level && cell.count >> (level + 1) >= fewest_in_cell &&
           radius_scale(level + 1) * radius_px <= drawn.detail.radius_px)
        ++level;
    return level;
}

}  // namespace

void DepthPyramid::build(ShaderLibrary& shaders, const Texture2D& depth, int width, int height) {
    width_ = groups_of(width, pyramid_side);
    height_ = groups_of(height, pyramid_side);
    const auto power = [](int size) { return static_cast<int>(std::bit_ceil(static_cast<unsigned>(size))); };
    if (!levels_ || levels_.width() < width_ || levels_.height() < height_) {
        levels_ = Texture2D({.format = GL_R32F, .width = power(width_), .height = power(height_), .levels = 0});
    }
    Program& program = shaders.compute("spheres/pyramid.comp",
                                       holds_ == Holds::nearest ? ShaderDefines{{"NEAREST", "1"}} : ShaderDefines{});
    program.use();
    used_levels_ = 0;
    int finer_width = width, finer_height = height;
    while (used_levels_ == 0 || finer_width > 1 || finer_height > 1) {
        program.bind_texture("finer", sphere_geometry_unit, used_levels_ == 0 ? depth : levels_);
        program.set("finer_size", Eigen::Vector2i(finer_width, finer_height));
        program.set("finer_level", std::max(used_levels_ - 1, 0));
        levels_.bind_image(0, GL_WRITE_ONLY, used_levels_);
        const int side = used_levels_ == 0 ? pyramid_side : 2;
        program.set("side", side);
        finer_width = groups_of(finer_width, side);
        finer_height = groups_of(finer_height, side);
        constexpr int group = 8;
        glDispatchCompute(static_cast<GLuint>(groups_of(finer_width, group)),
                          static_cast<GLuint>(groups_of(finer_height, group)), 1);
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
        ++used_levels_;
    }
}

void DepthPyramid::bind(Program& program, GLuint unit) const {
    program.bind_texture("pyramid", unit, levels_);
    program.set("levels", used_levels_);
    program.set("side", pyramid_side);
    program.set("level_0_size", Eigen::Vector2i(width_, height_));
}

void SphereCulling::List::clear() {
    commands.clear();
    boxes.clear();
}

void SphereCulling::List::add(const SphereCell& cell, int level) {
    constexpr std::uint32_t corners = 6;
    const std::uint32_t count = cell.count >> level;
    commands.push_back(
        is_points ? Command{.count = count, .first = cell.first, .base_instance = static_cast<std::uint32_t>(level)}
                  : Command{.count = count * corners, .first = cell.first * corners});
    const float wider_m = static_cast<float>(radius_scale(level) - 1) * cell.largest_radius_m;
    boxes.push_back({cell.low_m[0] - wider_m, cell.low_m[1] - wider_m, cell.low_m[2] - wider_m, 0});
    boxes.push_back({cell.high_m[0] + wider_m, cell.high_m[1] + wider_m, cell.high_m[2] + wider_m, 0});
}

void SphereCulling::List::upload() {
    if (commands.empty()) return;
    if (commands.size() > capacity) {
        capacity = commands.size() + commands.size() / 2;
        draws = Buffer(capacity * sizeof(Command));
        bounds = Buffer(capacity * 2 * sizeof(Float4));
    }
    draws.upload(std::span<const Command>(commands));
    bounds.upload(std::span<const Float4>(boxes));
}

std::vector<SphereCulling::Round> SphereCulling::rounds_of(const Drawn& drawn, const SphereVisibility& visibility,
                                                           bool culls) {
    struct Sorted {
        const SphereCell* cell;
        double depth;
        SphereRays::Place place;
    };
    std::vector<Sorted> sorted;
    sorted.reserve(drawn.geometry.cells().size());
    for (const SphereCell& cell : drawn.geometry.cells()) {
        const SphereRays::Place place = drawn.rays.place(cell);
        if (visibility.frustum && place == SphereRays::Place::outside) continue;
        sorted.push_back({&cell, drawn.rays.nearest_depth(cell), place});
    }
    // Of equal depths the first stays: with or without tests the order is the same.
    std::ranges::stable_sort(sorted, std::greater<>(), &Sorted::depth);
    const double fewest_hidden = static_cast<double>(drawn.width) * drawn.height / pixels_per_sphere;
    SphereCover cover(drawn.width, drawn.height);
    std::vector<Round> rounds;
    std::size_t done = 0;
    for (double share = first_round; done < sorted.size(); share *= round_growth) {
        const auto end =
            std::min(sorted.size(), static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()))));
        std::vector<CellInPicture> seen;
        double may_be_hidden = 0;
        for (; done < end; ++done) {
            const Sorted& next = sorted[done];
            List& list = next.place == SphereRays::Place::small ? points_ : triangles_;
            list.add(*next.cell, next.place == SphereRays::Place::small ? detail_level(drawn, *next.cell) : 0);
            if (!culls || next.place == SphereRays::Place::outside) continue;
            seen.push_back(drawn.rays.in_picture(*next.cell));
            may_be_hidden += cover.may_hide(seen.back()) ? next.cell->count : 0;
        }
        for (const CellInPicture& cell : seen) cover.add(cell);
        const bool is_behind_others = !drawn.depth_is_cleared && rounds.size() == 1;
        rounds.push_back({points_.commands.size(), triangles_.commands.size(),
                          culls && (is_behind_others || may_be_hidden > fewest_hidden)});
    }
    return rounds;
}

void SphereCulling::draw(const Drawn& drawn, const SphereVisibility& visibility) {
    points_.clear();
    triangles_.clear();
    const bool culls = visibility.occlusion && drawn.depth != nullptr && drawn.geometry.size() >= fewest_to_cull;
    const std::vector<Round> rounds = rounds_of(drawn, visibility, culls);
    points_.upload();
    triangles_.upload();
    if (culls && drawn.peeled != nullptr) {
        peeled_.build(shaders_, *drawn.peeled, drawn.width, drawn.height);
        cull(drawn, peeled_, points_, 0, points_.commands.size());
        cull(drawn, peeled_, triangles_, 0, triangles_.commands.size());
        glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    }
    Round begin;
    for (const Round& round : rounds) {
        if (round.asks) {
            pyramid_.build(shaders_, *drawn.depth, drawn.width, drawn.height);
            cull(drawn, pyramid_, points_, begin.points_end, round.points_end);
            cull(drawn, pyramid_, triangles_, begin.triangles_end, round.triangles_end);
            glMemoryBarrier(GL_COMMAND_BARRIER_BIT);
        }
        draw_round(drawn, points_, begin.points_end, round.points_end);
        draw_round(drawn, triangles_, begin.triangles_end, round.triangles_end);
        begin = round;
    }
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
    glDisable(GL_PROGRAM_POINT_SIZE);
}

void SphereCulling::draw_round(const Drawn& drawn, const List& list, std::size_t first, std::size_t end) const {
    if (first == end) return;
    Program& program = list.is_points ? drawn.points : drawn.triangles;
    program.use();
    drawn.geometry.bind(program);
    list.is_points ? drawn.geometry.bind_points() : drawn.geometry.bind_triangles();
    glEnable(GL_PROGRAM_POINT_SIZE);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, list.draws.name());
    // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL's own way of passing an offset
    const auto* offset = reinterpret_cast<const void*>(first * sizeof(Command));
    glMultiDrawArraysIndirect(list.is_points ? GL_POINTS : GL_TRIANGLES, offset, static_cast<GLsizei>(end - first),
                              sizeof(Command));
}

void SphereCulling::cull(const Drawn& drawn, const DepthPyramid& pyramid, const List& list, std::size_t first,
                         std::size_t end) {
    if (first == end) return;
    ShaderDefines defines;
    if (pyramid.holds() == DepthPyramid::Holds::nearest) defines["PEELED"] = "1";
    if (drawn.rays.is_long_lens()) defines["LONG_LENS"] = "1";
    Program& program = shaders_.compute("spheres/cull.comp", defines);
    program.use();
    drawn.rays.set(program);
    pyramid.bind(program, sphere_geometry_unit);
    program.set("first_draw", static_cast<int>(first));
    program.set("draw_count", static_cast<int>(end - first));
    list.draws.bind(GL_SHADER_STORAGE_BUFFER, 0);
    list.bounds.bind(GL_SHADER_STORAGE_BUFFER, 1);
    constexpr int group = 64;
    glDispatchCompute(static_cast<GLuint>(groups_of(static_cast<int>(end - first), group)), 1, 1);
}

std::vector<SphereCulling::Command> SphereCulling::List::left() const {
    std::vector<Command> after(commands);
    if (!after.empty()) draws.read(std::span<Command>(after));
    std::erase_if(after, [](const Command& one) { return one.count == 0; });
    return after;
}

std::size_t SphereCulling::cells_drawn() const {
    return points_.left().size() + triangles_.left().size();
}

std::size_t SphereCulling::spheres_drawn() const {
    constexpr std::size_t corners = 6;
    std::size_t spheres = 0;
    for (const Command& command : points_.left()) spheres += command.count;
    for (const Command& command : triangles_.left()) spheres += command.count / corners;
    return spheres;
}

}  // namespace matchlight
