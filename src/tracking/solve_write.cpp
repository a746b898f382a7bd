// Writes *.solve.json, version 1.
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "tracking/solve_file.h"

namespace matchlight {
namespace {

using nlohmann::json;

template <class Matrix>
json matrix_to_json(const Matrix& matrix) {
    json rows = json::array();
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
        json row = json::array();
        for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
        rows.push_back(std::move(row));
    }
    return rows;
}

template <class Value>
void put(json& object, const char* key, const std::optional<Value>& value) {
    if (value) object[key] = *value;
}

json frame_to_json(const SolvedFrame& frame) {
    json value{{"frame", frame.frame}, {"time_s", frame.time_s}};
    value["camera_from_world"] =
        frame.camera_from_world ? matrix_to_json(frame.camera_from_world->matrix()) : json(nullptr);
    if (frame.covariance) value["covariance"] = matrix_to_json(*frame.covariance);
    put(value, "reprojection_px", frame.reprojection_px);
    if (frame.bridged) value["bridged"] = true;
    if (!frame.tags.empty()) value["tags"] = frame.tags;
    put(value, "exposure_ev", frame.exposure_ev);
    put(value, "white_balance", frame.white_balance);
    put(value, "focus_distance_m", frame.focus_distance_m);
    put(value, "coc_scale_px_m", frame.coc_scale_px_m);
    put(value, "shutter_fraction", frame.shutter_fraction);
    json confidence = json::object();
    put(confidence, "pose", frame.pose_confidence);
    put(confidence, "exposure", frame.exposure_confidence);
    put(confidence, "focus", frame.focus_confidence);
    put(confidence, "shutter", frame.shutter_confidence);
    if (!confidence.empty()) value["confidence"] = std::move(confidence);
    return value;
}

json solve_to_json(const Solve& solve) {
    json file{{"matchlight_solve", solve_file_version}};
    file["footage"] = {{"file", solve.footage_file},
                       {"width", solve.camera.width},
                       {"height", solve.camera.height},
                       {"frames", solve.frame_count}};
    file["lens"] = {{"camera_matrix", matrix_to_json(solve.camera.matrix())},
                    {"distortion", solve.camera.distortion},
                    {"model", solve.camera.lens == LensModel::fisheye ? "fisheye" : "radtan"}};
    for (const LensParameter& parameter : solve.lens_parameters) {
        file["lens"]["parameters"].push_back(
            {{"name", parameter.name}, {"sigma", parameter.sigma}, {"refined", parameter.refined}});
    }
    if (solve.readout_s) file["shutter"] = {{"readout_s", *solve.readout_s}};
    file["rig"] = json::array();
    for (const SolvedTag& tag : solve.rig) {
        file["rig"].push_back(
            {{"id", tag.id}, {"size_m", tag.size_m}, {"world_from_tag", matrix_to_json(tag.world_from_tag.matrix())}});
    }
    json& photometry = file["photometry"];
    photometry["response"] = solve.response.to_json();
    put(photometry, "vignette", solve.vignette);
    put(photometry, "softness_px", solve.softness_px);
    if (solve.light_gradient_ev_per_m) {
        const Eigen::Vector3d& gradient = *solve.light_gradient_ev_per_m;
        photometry["light_gradient_ev_per_m"] = {gradient.x(), gradient.y(), gradient.z()};
    }
    if (solve.noise) {
        photometry["noise"] = {{"read", (*solve.noise)[0]}, {"shot", (*solve.noise)[1]}};
        put(photometry["noise"], "neighbour_correlation", solve.noise_neighbour_correlation);
    }
    if (!solve.provenance.empty()) file["provenance"] = solve.provenance;
    file["frames"] = json::array();
    for (const SolvedFrame& frame : solve.frames) file["frames"].push_back(frame_to_json(frame));
    return file;
}

/// JSON has no infinities: a number that is not finite would be written as null and read back as "not known".
void check_finite(const json& value, const std::string& key, const std::filesystem::path& path) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) {
        throw InputError(path, "\"" + key + "\" is not finite", "run `matchlight track` again");
    }
    if (!value.is_structured()) return;
    for (const auto& item : value.items()) check_finite(item.value(), value.is_object() ? item.key() : key, path);
}

/// One frame a line: readable, and small for clips of thousands of frames.
std::string solve_text(const json& file) {
    std::string text = "{";
    const std::initializer_list<const char*> order{"matchlight_solve", "footage",   "lens", "shutter", "rig",
                                                   "photometry",       "provenance"};
    for (const char* key : order) {
        if (file.contains(key))
            text += (text.size() > 1 ? ",\n \"" : "\"") + std::string(key) + "\": " + file[key].dump();
    }
    text += ",\n \"frames\": [";
    for (std::size_t i = 0; i < file["frames"].size(); ++i)
        text += (i > 0 ? ",\n   " : "\n   ") + file["frames"][i].dump();
    return text + "\n ]}\n";
}

}  // namespace

void save_solve(const std::filesystem::path& path, const Solve& solve) {
    const json file = solve_to_json(solve);
    for (const auto& item : file.items()) check_finite(item.value(), item.key(), path);
    write_text_file(path, solve_text(file));
}

}  // namespace matchlight
