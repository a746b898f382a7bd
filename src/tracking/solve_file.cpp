// Reads and writes *.solve.json, version 1.
#include "tracking/solve_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

using nlohmann::json;

constexpr int solve_version = 1;

/// Where in the file a value stands, so that an error can name it.
struct Place {
    const std::filesystem::path& file;
    std::optional<std::int64_t> frame;

    [[noreturn]] void fail(const std::string& cause) const {
        InputErrorParts parts;
        parts.file = file;
        parts.frame = frame;
        parts.cause = cause;
        parts.cure = "run `matchlight track` again";
        throw InputError(std::move(parts));
    }
};

/// nullptr where the key is absent or null: both mean that nothing is known.
const json* find_key(const json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() || found->is_null() ? nullptr : &*found;
}

const json& need_key(const json& object, const char* key, const Place& place) {
    const json* found = find_key(object, key);
    if (found == nullptr) place.fail(std::string("no \"") + key + "\"");
    return *found;
}

double read_number(const json& value, const std::string& key, const Place& place) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) place.fail("\"" + key + "\" is not a finite number");
    return value.get<double>();
}

std::int64_t read_integer(const json& value, const std::string& key, const Place& place) {
    if (!value.is_number_integer()) place.fail("\"" + key + "\" is not a whole number");
    return value.get<std::int64_t>();
}

std::string read_string(const json& value, const std::string& key, const Place& place) {
    if (!value.is_string()) place.fail("\"" + key + "\" is not a text");
    return value.get<std::string>();
}

std::optional<double> find_number(const json& object, const char* key, const Place& place) {
    const json* value = find_key(object, key);
    if (value == nullptr) return std::nullopt;
    return read_number(*value, key, place);
}

template <std::size_t count>
std::array<double, count> read_numbers(const json& value, const char* key, const Place& place) {
    if (!value.is_array() || value.size() != count) {
        place.fail(std::string("\"") + key + "\" is not a list of " + std::to_string(count));
    }
    std::array<double, count> numbers{};
    for (std::size_t i = 0; i < count; ++i) numbers[i] = read_number(value[i], key, place);
    return numbers;
}

template <int rows, int columns>
Eigen::Matrix<double, rows, columns> read_matrix(const json& value, const char* key, const Place& place) {
    const std::string shape = std::to_string(rows) + " × " + std::to_string(columns);
    if (!value.is_array() || value.size() != rows) place.fail(std::string("\"") + key + "\" is not " + shape);
    Eigen::Matrix<double, rows, columns> matrix;
    for (int r = 0; r < rows; ++r) {
        const json& row = value[static_cast<std::size_t>(r)];
        if (!row.is_array() || row.size() != columns) place.fail(std::string("\"") + key + "\" is not " + shape);
        for (int c = 0; c < columns; ++c) matrix(r, c) = read_number(row[static_cast<std::size_t>(c)], key, place);
    }
    return matrix;
}

RigidTransform read_rigid(const json& value, const char* key, const Place& place) {
    const Eigen::Matrix4d matrix = read_matrix<4, 4>(value, key, place);
    if (!is_rigid(matrix)) place.fail(std::string("\"") + key + "\" is no rotation and translation");
    return RigidTransform(matrix);
}

Camera read_lens(const json& lens, const json& footage, const Place& place) {
    Camera camera;
    constexpr std::int64_t largest_side_px = 65535;
    const std::int64_t width = read_integer(need_key(footage, "width", place), "width", place);
    const std::int64_t height = read_integer(need_key(footage, "height", place), "height", place);
    if (width < 1 || height < 1 || width > largest_side_px || height > largest_side_px) {
        place.fail("the footage's size is no picture size");
    }
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);

    const auto k = read_matrix<3, 3>(need_key(lens, "camera_matrix", place), "camera_matrix", place);
    if (!(k(0, 0) > 0 && k(1, 1) > 0)) place.fail("the focal length is zero or negative");
    camera.fx = k(0, 0);
    camera.fy = k(1, 1);
    camera.cx = k(0, 2);
    camera.cy = k(1, 2);

    const json* model = find_key(lens, "model");
    const std::string name = model == nullptr ? "radtan" : read_string(*model, "model", place);
    if (name != "radtan" && name != "fisheye") place.fail("the lens model \"" + printable(name) + "\" is not known");
    camera.lens = name == "fisheye" ? LensModel::fisheye : LensModel::radtan;
    if (const json* distortion = find_key(lens, "distortion")) {
        if (!distortion->is_array()) place.fail("\"distortion\" is not a list");
        for (const json& value : *distortion) {
            camera.distortion.push_back(read_number(value, "distortion", place));
        }
    }
    if (!valid_distortion_count(camera.lens, camera.distortion.size())) {
        place.fail("\"distortion\" has " + std::to_string(camera.distortion.size()) + " coefficients");
    }
    return camera;
}

void read_photometry(Solve& solve, const json& photometry, const Place& place) {
    if (const json* response = find_key(photometry, "response")) {
        solve.response = Response::from_json(*response, place.file);
    }
    if (const json* vignette = find_key(photometry, "vignette")) {
        solve.vignette = read_numbers<2>(*vignette, "vignette", place);
    }
    if (const json* noise = find_key(photometry, "noise")) {
        if (!noise->is_object()) place.fail("\"noise\" is not an object");
        solve.noise = {read_number(need_key(*noise, "read", place), "read", place),
                       read_number(need_key(*noise, "shot", place), "shot", place)};
        if ((*solve.noise)[0] < 0 || (*solve.noise)[1] < 0) place.fail("\"noise\" is negative");
    }
}

SolvedTag read_tag(const json& value, const Place& place) {
    if (!value.is_object()) place.fail("a tag of the rig is not an object");
    SolvedTag tag;
    tag.id = static_cast<int>(read_integer(need_key(value, "id", place), "id", place));
    tag.size_m = read_number(need_key(value, "size_m", place), "size_m", place);
    if (!(tag.size_m > 0)) place.fail("tag " + std::to_string(tag.id) + " has no size");
    tag.world_from_tag = read_rigid(need_key(value, "world_from_tag", place), "world_from_tag", place);
    return tag;
}

SolvedFrame read_frame(const json& value, Place place) {
    if (!value.is_object()) place.fail("a frame is not an object");
    SolvedFrame frame;
    frame.frame = read_integer(need_key(value, "frame", place), "frame", place);
    place.frame = frame.frame;
    if (frame.frame < 0) place.fail("frames count from 0");
    frame.time_s = find_number(value, "time_s", place).value_or(0);
    if (const json* pose = find_key(value, "camera_from_world")) {
        frame.camera_from_world = read_rigid(*pose, "camera_from_world", place);
    }
    if (const json* covariance = find_key(value, "covariance")) {
        frame.covariance = read_matrix<6, 6>(*covariance, "covariance", place);
    }
    if (const json* tags = find_key(value, "tags")) {
        if (!tags->is_array()) place.fail("\"tags\" is not a list");
        for (const json& id : *tags) frame.tags.push_back(static_cast<int>(read_integer(id, "tags", place)));
    }
    if (const json* white_balance = find_key(value, "white_balance")) {
        frame.white_balance = read_numbers<3>(*white_balance, "white_balance", place);
        if (!std::all_of(frame.white_balance->begin(), frame.white_balance->end(), [](double g) { return g > 0; })) {
            place.fail("\"white_balance\" is not positive");
        }
    }
    frame.reprojection_px = find_number(value, "reprojection_px", place);
    frame.exposure_ev = find_number(value, "exposure_ev", place);
    frame.focus_distance_m = find_number(value, "focus_distance_m", place);
    frame.coc_scale_px_m = find_number(value, "coc_scale_px_m", place);
    frame.shutter_fraction = find_number(value, "shutter_fraction", place);
    if (frame.focus_distance_m && !(*frame.focus_distance_m > 0)) place.fail("\"focus_distance_m\" is not positive");
    if (const json* confidence = find_key(value, "confidence")) {
        if (!confidence->is_object()) place.fail("\"confidence\" is not an object");
        frame.pose_confidence = find_number(*confidence, "pose", place);
        frame.exposure_confidence = find_number(*confidence, "exposure", place);
        frame.focus_confidence = find_number(*confidence, "focus", place);
    }
    return frame;
}

Solve read_solve(const json& file, const Place& place) {
    if (!file.is_object() || !file.contains("matchlight_solve")) place.fail("this is no solve file");
    const json& version = file["matchlight_solve"];
    if (!version.is_number_integer() || version.get<std::int64_t>() != solve_version) {
        place.fail("the solve file has version " + printable(version.dump()) + ", not " +
                   std::to_string(solve_version));
    }
    for (const char* key : {"footage", "lens"}) {
        if (!need_key(file, key, place).is_object()) place.fail(std::string("\"") + key + "\" is not an object");
    }
    Solve solve;
    const json& footage = file["footage"];
    if (const json* name = find_key(footage, "file")) solve.footage_file = read_string(*name, "file", place);
    solve.camera = read_lens(file["lens"], footage, place);
    if (const json* rig = find_key(file, "rig")) {
        if (!rig->is_array()) place.fail("\"rig\" is not a list");
        for (const json& tag : *rig) solve.rig.push_back(read_tag(tag, place));
    }
    if (const json* photometry = find_key(file, "photometry")) {
        if (!photometry->is_object()) place.fail("\"photometry\" is not an object");
        read_photometry(solve, *photometry, place);
    }
    const json& frames = need_key(file, "frames", place);
    if (!frames.is_array()) place.fail("\"frames\" is not a list");
    solve.frames.reserve(frames.size());
    for (const json& value : frames) {
        solve.frames.push_back(read_frame(value, place));
        const std::size_t count = solve.frames.size();
        if (count > 1 && solve.frames[count - 1].frame <= solve.frames[count - 2].frame) {
            Place{place.file, solve.frames.back().frame}.fail("the frames are not in ascending order");
        }
    }
    const std::int64_t last = solve.frames.empty() ? 0 : solve.frames.back().frame + 1;
    const json* count = find_key(footage, "frames");
    solve.frame_count = count != nullptr ? read_integer(*count, "frames", place) : last;
    if (solve.frame_count < last) place.fail("the footage is said to have fewer frames than are solved");
    if (const json* provenance = find_key(file, "provenance")) {
        solve.provenance = provenance->is_string() ? provenance->get<std::string>() : provenance->dump();
    }
    return solve;
}

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
    if (!confidence.empty()) value["confidence"] = std::move(confidence);
    return value;
}

json solve_to_json(const Solve& solve) {
    json file{{"matchlight_solve", solve_version}};
    file["footage"] = {{"file", solve.footage_file},
                       {"width", solve.camera.width},
                       {"height", solve.camera.height},
                       {"frames", solve.frame_count}};
    file["lens"] = {{"camera_matrix", matrix_to_json(solve.camera.matrix())},
                    {"distortion", solve.camera.distortion},
                    {"model", solve.camera.lens == LensModel::fisheye ? "fisheye" : "radtan"}};
    file["rig"] = json::array();
    for (const SolvedTag& tag : solve.rig) {
        file["rig"].push_back(
            {{"id", tag.id}, {"size_m", tag.size_m}, {"world_from_tag", matrix_to_json(tag.world_from_tag.matrix())}});
    }
    json& photometry = file["photometry"];
    photometry["response"] = solve.response.to_json();
    put(photometry, "vignette", solve.vignette);
    if (solve.noise) photometry["noise"] = {{"read", (*solve.noise)[0]}, {"shot", (*solve.noise)[1]}};
    if (!solve.provenance.empty()) file["provenance"] = solve.provenance;
    file["frames"] = json::array();
    for (const SolvedFrame& frame : solve.frames) file["frames"].push_back(frame_to_json(frame));
    return file;
}

/// JSON has no infinities: a number that is not finite would be written as null and read back as "not known".
void check_finite(const json& value, const std::string& key, const Place& place) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) place.fail("\"" + key + "\" is not finite");
    if (!value.is_structured()) return;
    for (const auto& item : value.items()) check_finite(item.value(), value.is_object() ? item.key() : key, place);
}

/// One frame a line: readable, and small for clips of thousands of frames.
std::string solve_text(const json& file) {
    std::string text = "{";
    const std::initializer_list<const char*> order{"matchlight_solve", "footage",   "lens", "rig",
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

const SolvedFrame* Solve::find(std::int64_t frame) const {
    const auto found = std::lower_bound(frames.begin(), frames.end(), frame,
                                        [](const SolvedFrame& f, std::int64_t number) { return f.frame < number; });
    return found == frames.end() || found->frame != frame ? nullptr : &*found;
}

const SolvedFrame* Solve::exposed_near(const SolvedFrame& frame) const {
    if (frame.exposure_ev) return &frame;
    const SolvedFrame* nearest = nullptr;
    std::int64_t distance = std::numeric_limits<std::int64_t>::max();
    for (const SolvedFrame& other : frames) {
        if (!other.exposure_ev || std::abs(other.frame - frame.frame) >= distance) continue;
        distance = std::abs(other.frame - frame.frame);
        nearest = &other;
    }
    return nearest;
}

Solve load_solve(const std::filesystem::path& path) {
    constexpr std::size_t limit_bytes = 1u << 30;  // about 2 kB a frame: ten hours at 15 fps
    constexpr int deepest = 64;                    // the format nests to 5; a hostile file must not exhaust the stack
    const Place place{path, std::nullopt};
    const std::string text = read_text_file(path, limit_bytes);
    try {
        return read_solve(json::parse(text,
                                      [&](int depth, json::parse_event_t, json&) {
                                          if (depth > deepest) place.fail("this is no solve file: it nests too deep");
                                          return true;
                                      }),
                          place);
    } catch (const json::exception& error) {
        place.fail(std::string("this is no solve file: ") + error.what());
    }
}

void save_solve(const std::filesystem::path& path, const Solve& solve) {
    const json file = solve_to_json(solve);
    const Place place{path, std::nullopt};
    for (const auto& item : file.items()) check_finite(item.value(), item.key(), place);
    write_text_file(path, solve_text(file));
}

}  // namespace matchlight
