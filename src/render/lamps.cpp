// One face of a map for a lamp that stands apart from the casters, six for one among them.
#include "render/lamps.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "gl/framebuffer.h"

namespace matchlight {

namespace {

constexpr double degree = std::numbers::pi / 180;
constexpr double least_distance_m = 1e-3;  // as common/lamps.glsl has it
constexpr GLuint uniform_block = 1;        // as it names it

/// As std140 lays out the block of common/lamps.glsl.
using Float4 = std::array<float, 4>;
struct LampOnGpu {
    Float4 place_kind, axis_range, light_size, cone_shadow;
};
struct LampsOnGpu {
    std::array<LampOnGpu, most_lamps> lamps{};
    std::array<std::array<float, 16>, 6 * most_lamps> faces{};
};
static_assert(sizeof(LampsOnGpu) <= 16384, "the smallest uniform block that OpenGL 4.5 promises");

Float4 four(const Eigen::Vector3d& v, double w) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), static_cast<float>(w)};
}

bool is_placed(const LampSettings& lamp) {
    return lamp.type != LampType::directional;
}

/// Scale and offset of the cosine to a spot's axis, whose square the light goes with: KHR_lights_punctual.
std::array<double, 2> cone_of(const LampSettings& lamp) {
    if (lamp.type != LampType::spot) return {0, 1};
    const double outer = std::cos(lamp.outer_cone_deg * degree);
    constexpr double least_width = 1e-3;  // of cosines, as the extension says
    const double scale = 1 / std::max(std::cos(lamp.inner_cone_deg * degree) - outer, least_width);
    return {scale, -outer * scale};
}

/// A spot that is closed sends out nothing: its offset alone would leave a thousandth's width of cosines.
Eigen::Vector3d light_of(const LampSettings& lamp) {
    const bool is_closed = lamp.type == LampType::spot && lamp.outer_cone_deg == 0;
    return is_closed ? Eigen::Vector3d::Zero() : Eigen::Vector3d(lamp.intensity * lamp.color);
}

/// Of a directional light the tangent of half its angle.
double size_of(const LampSettings& lamp) {
    return is_placed(lamp) ? lamp.radius_m : std::tan(lamp.angle_deg / 2 * degree);
}

struct Aim {
    Eigen::Vector3d from_m, forward;
    double tangent = 1, near_m = least_distance_m;
};

/// Reversed z, clip w = metres along `forward`; row 0 holds the most negative y of clip space's turned axis.
Eigen::Matrix4d perspective(const Aim& aim) {
    const Eigen::Vector3d right = aim.forward.unitOrthogonal(), up = right.cross(aim.forward);
    Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
    const auto set_row = [&](int row, const Eigen::Vector3d& axis) {
        clip.row(row).head<3>() = axis.transpose();
        clip(row, 3) = -axis.dot(aim.from_m);
    };
    set_row(0, right / aim.tangent);
    set_row(1, up / aim.tangent);
    clip(2, 3) = aim.near_m;
    set_row(3, aim.forward);
    return clip;
}

}  // namespace

void LampQuality::check() const {
    const auto require = [](bool holds, const char* what, int value) {
        if (!holds) throw std::invalid_argument(fmt::format("lamps: {}, not {}", what, value));
    };
    require(resolution >= 16 && resolution <= 4096, "resolution must be 16..4096", resolution);
    require(taps >= 1 && taps <= 256, "taps must be 1..256", taps);
    require(rays >= 0 && rays <= 1024, "rays must be 0..1024", rays);
    require(surface_points >= 1 && surface_points <= 4096, "surface_points must be 1..4096", surface_points);
}

LampArrival lamp_arrival(const LampSettings& lamp, const Eigen::Vector3d& world_position_m) {
    const Eigen::Vector3d axis = lamp.direction.normalized();
    const Eigen::Vector3d light = light_of(lamp);
    if (!is_placed(lamp)) return {-axis, light};
    const Eigen::Vector3d way = lamp.position_m - world_position_m;
    const double distance_m = way.norm();
    const Eigen::Vector3d to_lamp =
        distance_m > 0 ? Eigen::Vector3d(way / distance_m) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
    const double from_m = std::max({distance_m, lamp.radius_m, least_distance_m});
    const double window = lamp.range_m ? std::clamp(1 - std::pow(from_m / *lamp.range_m, 4), 0.0, 1.0) : 1;
    const auto [scale, offset] = cone_of(lamp);
    const double cone = std::clamp(-axis.dot(to_lamp) * scale + offset, 0.0, 1.0);
    return {to_lamp, light * (window * cone * cone / (from_m * from_m))};
}

Lamps::Lamps(std::span<const LampSettings> lamps) : lamps_(lamps.begin(), lamps.end()) {
    assert(lamps_.size() <= most_lamps);
    faces_.resize(lamps_.size());
    depth_ = Texture2D({.format = GL_DEPTH_COMPONENT32F, .width = 2, .height = 2, .layers = 1});
    uniforms_ = Buffer(sizeof(LampsOnGpu));
    upload();
}

std::vector<Eigen::Matrix4d> Lamps::faces_of(const LampSettings& lamp, const Eigen::AlignedBox3d& casters_m) const {
    if (casters_m.isEmpty()) return {};
    const Eigen::Vector3d centre_m = casters_m.center();
    const double radius_m = casters_m.diagonal().norm() / 2;
    if (!(radius_m > 0) || !lamp.casts_shadow || light_of(lamp).isZero(0)) return {};
    if (!is_placed(lamp)) {
        const Eigen::Vector3d to_lamp = -lamp.direction.normalized();
        const Eigen::Vector3d right = to_lamp.unitOrthogonal(), up = to_lamp.cross(right);
        Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();
        const auto set_row = [&](int row, const Eigen::Vector3d& axis, double offset) {
            clip.row(row).head<3>() = axis.transpose() / radius_m;
            clip(row, 3) = offset - axis.dot(centre_m) / radius_m;
        };
        set_row(0, right, 0);
        set_row(1, up, 0);
        set_row(2, to_lamp / 2, 0.5);
        return {clip};
    }
    const Eigen::Vector3d way_m = centre_m - lamp.position_m;
    const double distance_m = way_m.norm();
    constexpr double widest_sine = 0.7;  // beyond it six faces see more finely than one
    if (radius_m < widest_sine * distance_m) {
        const double sine = radius_m / distance_m;
        return {perspective({.from_m = lamp.position_m,
                             .forward = way_m / distance_m,
                             .tangent = sine / std::sqrt(1 - sine * sine),
                             .near_m = std::max(distance_m - radius_m, least_distance_m)})};
    }
    std::vector<Eigen::Matrix4d> faces;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            constexpr double overlap = 1.02;  // for what is filtered across their edges
            faces.push_back(perspective({.from_m = lamp.position_m,
                                         .forward = sign * Eigen::Vector3d::Unit(axis),
                                         .tangent = overlap,
                                         .near_m = std::max(lamp.radius_m, least_distance_m)}));
        }
    }
    return faces;
}

void Lamps::draw_maps(ShaderLibrary& shaders, const ShadowCasters& casters, const LampQuality& quality, bool meshes) {
    quality.check();
    taps_ = quality.taps;
    rays_ = meshes ? 0 : quality.rays;
    const bool spheres = static_cast<bool>(casters.cast_spheres);
    int layers = 0;
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
        faces_[i] = meshes || spheres ? faces_of(lamps_[i], casters.bounds_m) : std::vector<Eigen::Matrix4d>();
        layers += static_cast<int>(faces_[i].size());
    }
    upload();
    if (layers == 0) return;
    int resolution = quality.resolution;
    constexpr std::int64_t most_texels = std::int64_t{1} << 25;  // 128 MiB
    while (resolution > 16 && std::int64_t{resolution} * resolution * layers > most_texels) resolution /= 2;
    const TextureShape shape{
        .format = GL_DEPTH_COMPONENT32F, .width = resolution, .height = resolution, .layers = layers};
    if (depth_.width() != resolution || depth_.shape().layers != layers) depth_ = Texture2D(shape);
    depth_.set_wrap(Wrap::clamp_to_edge, Wrap::clamp_to_edge);
    Program& program = shaders.program({{GL_VERTEX_SHADER, "effects/lamp_shadow/depth.vert"},
                                        {GL_FRAGMENT_SHADER, "effects/object_shadow/depth.frag"}});
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    // Which spheres are hidden is found in a map that is no array.
    Texture2D one;
    if (spheres) one = Texture2D({.format = GL_DEPTH_COMPONENT32F, .width = resolution, .height = resolution});
    int layer = 0;
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
        for (const Eigen::Matrix4d& clip_from_world : faces_[i]) {
            const Framebuffer target({}, spheres ? Attachment(one) : Attachment(depth_, 0, layer));
            target.bind();
            target.clear_depth(0);
            program.use();
            program.set("clip_from_world", Eigen::Matrix4f(clip_from_world.cast<float>()));
            if (meshes) casters.draw(program);
            if (spheres) {
                casters.cast_spheres({.view = {.clip_from_world = clip_from_world,
                                               .width = resolution,
                                               .height = resolution,
                                               .is_parallel = !is_placed(lamps_[i])},
                                      .fragment = "spheres/depth.frag",
                                      .set_up = {},
                                      .depth = &one});
                glCopyImageSubData(one.name(), GL_TEXTURE_2D, 0, 0, 0, 0, depth_.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0,
                                   layer, resolution, resolution, 1);
            }
            ++layer;
        }
    }
    glDisable(GL_DEPTH_TEST);
}

void Lamps::upload() {
    LampsOnGpu block;
    int first_face = 0;
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
        const LampSettings& lamp = lamps_[i];
        const Eigen::Vector3d axis = lamp.direction.normalized();
        const int kind =
            (is_placed(lamp) ? 1 : 0) + (lamp.in_footage.value_or(false) ? 2 : 0) + (lamp.of_probe ? 4 : 0);
        const auto [scale, offset] = cone_of(lamp);
        const auto face_count = static_cast<double>(faces_[i].size());
        block.lamps[i] = {
            .place_kind = four(is_placed(lamp) ? lamp.position_m : Eigen::Vector3d(-axis), kind),
            .axis_range = four(axis, lamp.range_m ? 1 / *lamp.range_m : 0),
            .light_size = four(light_of(lamp), size_of(lamp)),
            .cone_shadow = {static_cast<float>(scale), static_cast<float>(offset),
                            static_cast<float>(lamp.casts_shadow ? first_face : -1), static_cast<float>(face_count)}};
        for (const Eigen::Matrix4d& face : faces_[i]) {
            Eigen::Map<Eigen::Matrix4f>(block.faces[static_cast<std::size_t>(first_face)].data()) = face.cast<float>();
            ++first_face;
        }
    }
    uniforms_.upload(std::span<const LampsOnGpu>(&block, 1));
}

void Lamps::bind(Program& program) const {
    uniforms_.bind(GL_UNIFORM_BUFFER, uniform_block);
    program.set("lamp_count", static_cast<int>(lamps_.size()));
    program.set("lamp_taps", taps_);
    program.set("lamp_rays", rays_);
    program.bind_texture("lamp_depth", map_unit, depth_);
}

}  // namespace matchlight
