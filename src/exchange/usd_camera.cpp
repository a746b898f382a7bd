// Written by hand: the text format is stable, and Debian has no USD library.
#include "exchange/usd_camera.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "core/version.h"

namespace matchlight {
namespace {

constexpr double cm_per_m = 100;

/// Inside a string of the format, on one line.
std::string quoted(const std::string& text) {
    std::string safe = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') safe += '\\';
        safe += static_cast<unsigned char>(c) < ' ' ? '?' : c;
    }
    return safe + "\"";
}

/// USD multiplies row vectors from the left: its matrices are the transposes of ours.
std::string matrix_text(const RigidTransform& pose) {
    Eigen::Matrix4d m = pose.matrix();
    m.topRightCorner<3, 1>() *= cm_per_m;
    std::string text = "(";
    for (int c = 0; c < 4; ++c) {
        text += fmt::format("{} ({}, {}, {}, {})", c > 0 ? "," : "", m(0, c), m(1, c), m(2, c), m(3, c));
    }
    return text + " )";
}

using ValueText = std::function<std::optional<std::string>(const SolvedFrame&)>;

/// `type name.timeSamples = {…}` of the frames that have a value; empty where none has.
std::string samples(const CameraTrack& track, const std::string& declaration, const ValueText& value) {
    std::string lines;
    for (const SolvedFrame& frame : track.frames) {
        if (const auto text = value(frame)) lines += fmt::format("            {}: {},\n", frame.frame, *text);
    }
    return lines.empty() ? "" : fmt::format("        {}.timeSamples = {{\n{}        }}\n", declaration, lines);
}

std::optional<std::string> number(const std::optional<double>& value, double scale = 1) {
    if (!value) return std::nullopt;
    return fmt::format("{}", *value * scale);
}

std::string lens_text(const CameraTrack& track) {
    const PinholePicture& p = track.pinhole;
    const double focal = track.focal_mm();
    // Edges of the picture on the plane at distance 1, y up: their mean is what the aperture is shifted by.
    const double shift_x = (p.width / 2.0 - p.cx - 0.5) / p.fx;
    const double shift_y = (p.cy + 0.5 - p.height / 2.0) / p.fy;
    return fmt::format(
        "        token projection = \"perspective\"\n        float focalLength = {}\n        float horizontalAperture "
        "= "
        "{}\n        float verticalAperture = {}\n        float horizontalApertureOffset = {}\n        float "
        "verticalApertureOffset = {}\n        float2 clippingRange = (1, 1000000)\n",
        focal, p.width / p.fx * focal, p.height / p.fy * focal, shift_x * focal, shift_y * focal);
}

std::string optics_text(const CameraTrack& track) {
    // coc_scale_px_m = fx · (opening's width in metres); N = focal length / opening's width.
    const double focal_m = track.focal_mm() / 1000;
    return samples(track, "float focusDistance",
                   [](const SolvedFrame& f) { return number(f.focus_distance_m, cm_per_m); }) +
           samples(track, "float fStop",
                   [&](const SolvedFrame& f) -> std::optional<std::string> {
                       if (!f.coc_scale_px_m || !(*f.coc_scale_px_m > 0)) return std::nullopt;
                       return number(focal_m * track.camera.fx / *f.coc_scale_px_m);
                   }) +
           samples(track, "double shutter:open",
                   [](const SolvedFrame& f) { return number(f.shutter_fraction, -0.5); }) +
           samples(track, "double shutter:close",
                   [](const SolvedFrame& f) { return number(f.shutter_fraction, 0.5); }) +
           samples(track, "float exposure", [](const SolvedFrame& f) { return number(f.exposure_ev); }) +
           samples(track, "custom float3 matchlight:whiteBalance",
                   [](const SolvedFrame& f) -> std::optional<std::string> {
                       if (!f.white_balance) return std::nullopt;
                       const auto& w = *f.white_balance;
                       return fmt::format("({}, {}, {})", w[0], w[1], w[2]);
                   });
}

std::string camera_text(const CameraTrack& track) {
    const auto first = std::ranges::find_if(
        track.frames, [](const SolvedFrame& frame) { return frame.camera_from_world.has_value(); });
    RigidTransform held = *first->camera_from_world;
    std::string text = "    def Camera \"camera\"\n    {\n" + lens_text(track) + optics_text(track);
    text += samples(track, "matrix4d xformOp:transform", [&](const SolvedFrame& frame) {
        if (frame.camera_from_world) held = *frame.camera_from_world;
        return std::optional(matrix_text(world_from_gl_camera(held)));
    });
    text += "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n";
    if (track.posed() < static_cast<std::int64_t>(track.frames.size())) {
        text += samples(track, "token visibility", [](const SolvedFrame& frame) {
            return std::optional<std::string>(frame.camera_from_world ? "\"inherited\"" : "\"invisible\"");
        });
    }
    return text + "    }\n";
}

std::string tag_text(const SolvedTag& tag) {
    const double half = tag.size_m / 2 * cm_per_m;
    // Names must not hold a minus sign.
    const std::string name =
        tag.id < 0 ? fmt::format("tag_minus_{}", -static_cast<std::int64_t>(tag.id)) : fmt::format("tag_{}", tag.id);
    return fmt::format(
        "        def Mesh \"{0}\"\n        {{\n            int[] faceVertexCounts = [4]\n            int[] "
        "faceVertexIndices = [0, 1, 2, 3]\n            point3f[] points = [({1}, {1}, 0), ({2}, {1}, 0), ({2}, {2}, "
        "0), "
        "({1}, {2}, 0)]\n            float3[] extent = [({1}, {1}, 0), ({2}, {2}, 0)]\n            uniform bool "
        "doubleSided = 1\n            uniform token subdivisionScheme = \"none\"\n            matrix4d "
        "xformOp:transform = {3}\n            uniform token[] xformOpOrder = [\"xformOp:transform\"]\n        }}\n",
        name, -half, half, matrix_text(tag.world_from_tag));
}

}  // namespace

std::string usd_camera_text(const CameraTrack& track) {
    std::string text = fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"matchlight\"\n    doc = {}\n    metersPerUnit = {}\n    upAxis = \"Z\"\n    "
        "startTimeCode = {}\n    endTimeCode = {}\n    timeCodesPerSecond = {}\n    framesPerSecond = {}\n)\n\n",
        quoted(fmt::format("matchlight {}: camera of {}", version, track.source)), 1 / cm_per_m,
        track.frames.front().frame, track.frames.back().frame, track.fps, track.fps);
    text += "def Xform \"matchlight\" (\n    kind = \"assembly\"\n)\n{\n" + camera_text(track);
    text += "    def Xform \"rig\"\n    {\n";
    for (const SolvedTag& tag : track.rig) text += tag_text(tag);
    return text + "    }\n}\n";
}

}  // namespace matchlight
