// Reads lights and the nodes that hold them, key by key.
#include "scene/gltf_lights.h"

#include <array>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "core/transforms.h"

namespace matchlight {
namespace {

using nlohmann::json;

constexpr const char* extension_name = "KHR_lights_punctual";

/// The extension's object in an object of the file; an empty one where it is absent.
json extension_of(const GltfDocument& document, const json& object, const std::string& where) {
    const json extensions = object.value("extensions", json::object());
    if (!extensions.is_object()) document.fail(where + ".extensions is no object");
    const json extension = extensions.value(extension_name, json::object());
    if (!extension.is_object()) document.fail(fmt::format("{}.extensions.{} is no object", where, extension_name));
    return extension;
}

double within(const GltfDocument& document, double value, double least, double most, const std::string& where) {
    if (!(value >= least && value <= most))
        document.fail(fmt::format("{} is {:g}, not from {:g} to {:g}", where, value, least, most));
    return value;
}

LampSettings read_light(const GltfDocument& document, const json& light, const std::string& where) {
    if (!light.is_object()) document.fail(where + " is no object");
    LampSettings lamp;
    const std::string type = document.text_of(light, "type", where);
    if (type != "point" && type != "directional" && type != "spot")
        document.fail(fmt::format("{}.type is '{}'", where, type), "the extension has point, directional and spot");
    if (type == "directional") lamp.type = LampType::directional;
    if (type == "spot") lamp.type = LampType::spot;
    constexpr double most_light = 1e12;
    if (const json color = document.numbers_of(light, "color", 3, where); !color.is_null()) {
        for (int c = 0; c < 3; ++c)
            lamp.color[c] =
                within(document, color[static_cast<std::size_t>(c)].get<double>(), 0, most_light, where + ".color");
    }
    lamp.intensity =
        within(document, document.number_of(light, "intensity", 1, where), 0, most_light, where + ".intensity");
    if (light.contains("range")) {
        constexpr double least_m = 1e-9, most_m = 1e9;
        lamp.range_m =
            within(document, document.number_of(light, "range", 0, where), least_m, most_m, where + ".range");
    }
    if (lamp.type == LampType::spot) {
        const json spot = light.value("spot", json::object());
        if (!spot.is_object()) document.fail(where + ".spot is no object");
        constexpr double degrees = 180 / std::numbers::pi, right_angle = std::numbers::pi / 2;
        constexpr double rounding = 1e-6;  // files have floats
        const double outer = within(document, document.number_of(spot, "outerConeAngle", right_angle / 2, where), 0,
                                    right_angle + rounding, where + ".spot.outerConeAngle");
        lamp.outer_cone_deg = std::min(outer, right_angle) * degrees;
        lamp.inner_cone_deg = within(document, document.number_of(spot, "innerConeAngle", 0, where), 0, outer,
                                     where + ".spot.innerConeAngle") *
                              degrees;
        lamp.inner_cone_deg = std::min(lamp.inner_cone_deg, lamp.outer_cone_deg);
    }
    return lamp;
}

Eigen::Matrix4d parent_from_node(const GltfDocument& document, std::size_t number) {
    const std::string where = place_in("nodes", number);
    const json& node = document.item("nodes", number);
    const auto numbers = [&](const char* key, std::size_t size, const std::vector<double>& fallback) {
        const json given = document.numbers_of(node, key, size, where);
        return given.is_null() ? fallback : given.get<std::vector<double>>();
    };
    if (const std::vector<double> matrix = numbers("matrix", 16, {}); !matrix.empty())
        return Eigen::Matrix4d(matrix.data());
    const std::vector<double> t = numbers("translation", 3, {0, 0, 0}), r = numbers("rotation", 4, {0, 0, 0, 1}),
                              s = numbers("scale", 3, {1, 1, 1});
    Eigen::Quaterniond rotation(r[3], r[0], r[1], r[2]);
    if (!(rotation.norm() > 0)) rotation.setIdentity();
    const Eigen::Affine3d parts =
        Eigen::Translation3d(t[0], t[1], t[2]) * rotation.normalized() * Eigen::Scaling(s[0], s[1], s[2]);
    return parts.matrix();
}

}  // namespace

std::vector<ModelLamp> read_gltf_lights(const GltfDocument& document) {
    const json extension = extension_of(document, document.root(), "the file");
    const json lights = extension.value("lights", json::array());
    if (!lights.is_array()) document.fail(fmt::format("extensions.{}.lights is no array", extension_name));
    std::vector<LampSettings> read;
    for (std::size_t i = 0; i < lights.size(); ++i)
        read.push_back(read_light(document, lights[i], fmt::format("extensions.{}.lights[{}]", extension_name, i)));
    const std::size_t nodes = document.list("nodes").size();
    std::vector<std::optional<std::size_t>> parents(nodes);
    for (std::size_t i = 0; i < nodes; ++i) {
        for (const json& child : document.item("nodes", i).value("children", json::array()))
            parents[child.get<std::size_t>()] = i;
    }
    std::vector<ModelLamp> lamps;
    for (std::size_t i = 0; i < nodes; ++i) {
        const std::string where = place_in("nodes", i);
        const json held = extension_of(document, document.item("nodes", i), where);
        if (!held.contains("light")) continue;
        const std::uint64_t number = document.unsigned_of(held, "light", where);
        if (number >= read.size())
            document.fail(fmt::format("{} holds light {}, and there are {}", where, number, read.size()));
        ModelLamp lamp{.lamp = read[number], .node = i};
        Eigen::Matrix4d file_from_node = parent_from_node(document, i);
        for (std::optional<std::size_t> parent = parents[i]; parent; parent = parents[*parent])
            file_from_node = parent_from_node(document, *parent) * file_from_node;
        lamp.model_from_node.topLeftCorner<3, 3>() = world_from_model_axes();
        lamp.model_from_node = lamp.model_from_node * file_from_node;
        lamps.push_back(lamp);
    }
    return lamps;
}

}  // namespace matchlight
