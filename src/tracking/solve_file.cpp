// Reads *.solve.json, version 1.
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

bool read_flag(const json& value, const std::string& key, const Place& place) {
    if (!value.is_boolean()) place.fail("\"" + key + "\" is neither true nor false");
    return value.get<bool>();
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

std::vector<LensParameter> read_lens_parameters(const json& lens, const Place& place) {
    std::vector<LensParameter> parameters;
    const json* list = find_key(lens, "parameters");
    if (list == nullptr) return parameters;
    if (!list->is_array()) place.fail("\"parameters\" of the lens is not a list");
    for (const json& value : *list) {
        if (!value.is_object()) place.fail("a parameter of the lens is not an object");
        LensParameter& parameter = parameters.emplace_back();
        parameter.name = read_string(need_key(value, "name", place), "name", place);
        parameter.sigma = read_number(need_key(value, "sigma", place), "sigma", place);
        if (const json* refined = find_key(value, "refined")) parameter.refined = read_flag(*refined, "refined", place);
        if (parameter.sigma < 0) place.fail("\"sigma\" of a lens parameter is negative");
    }
    return parameters;
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
        solve.noise_neighbour_correlation = find_number(*noise, "neighbour_correlation", place);
        if (std::abs(solve.noise_neighbour_correlation.value_or(0)) > 1) {
            place.fail("\"neighbour_correlation\" is not from -1 to 1");
        }
    }
    solve.softness_px = find_number(photometry, "softness_px", place);
    if (solve.softness_px && *solve.softness_px < 0) place.fail("\"softness_px\" is negative");
    if (const json* gradient = find_key(photometry, "light_gradient_ev_per_m")) {
        const auto numbers = read_numbers<3>(*gradient, "light_gradient_ev_per_m", place);
        solve.light_gradient_ev_per_m = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
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
    if (const json* bridged = find_key(value, "bridged")) frame.bridged = read_flag(*bridged, "bridged", place);
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
        frame.shutter_confidence = find_number(*confidence, "shutter", place);
    }
    return frame;
}

Solve read_solve(const json& file, const Place& place) {
    if (!file.is_object() || !file.contains("matchlight_solve")) place.fail("this is no solve file");
    const json& version = file["matchlight_solve"];
    if (!version.is_number_integer() || version.get<std::int64_t>() != solve_file_version) {
        place.fail("the solve file has version " + printable(version.dump()) + ", not " +
                   std::to_string(solve_file_version));
    }
    for (const char* key : {"footage", "lens"}) {
        if (!need_key(file, key, place).is_object()) place.fail(std::string("\"") + key + "\" is not an object");
    }
    Solve solve;
    const json& footage = file["footage"];
    if (const json* name = find_key(footage, "file")) solve.footage_file = read_string(*name, "file", place);
    solve.camera = read_lens(file["lens"], footage, place);
    solve.lens_parameters = read_lens_parameters(file["lens"], place);
    if (const json* shutter = find_key(file, "shutter")) {
        if (!shutter->is_object()) place.fail("\"shutter\" is not an object");
        solve.readout_s = find_number(*shutter, "readout_s", place);
    }
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

}  // namespace matchlight
