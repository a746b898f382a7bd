// Reads camera files: OpenCV's YAML, XML and JSON, the YAML of ROS, which differs by its missing header or, printed
// from a topic, by its keys, and Kalibr's, whose cameras stand under names of their own.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/persistence.hpp>

#include "calibration/camera.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace matchlight {
namespace {

/// Larger pictures are not video; the limit keeps a damaged file from asking for absurd buffers.
constexpr double largest_side_px = 65535;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& cause) {
    throw InputError(path, cause, "write it with `matchlight calibrate` or OpenCV's calibration");
}

cv::FileNode find_key(const cv::FileStorage& file, std::initializer_list<const char*> spellings) {
    for (const char* key : spellings) {
        if (const cv::FileNode node = file[key]; !node.empty()) return node;
    }
    return {};
}

struct NumberTable {
    int rows = 0;
    int columns = 0;
    std::vector<double> values;
};

void append_numbers(const cv::FileNode& node, std::vector<double>& values, const std::filesystem::path& path,
                    const char* key) {
    for (const cv::FileNode element : node) {
        if (element.isSeq()) {
            append_numbers(element, values, path, key);
        } else if (element.isInt() || element.isReal()) {
            values.push_back(static_cast<double>(element));
        } else {
            fail(path, std::string(key) + " holds something that is not a number");
        }
    }
}

/// A matrix as OpenCV and ROS write it (rows, cols, data), or a plain list, also of lists.
NumberTable read_table(const cv::FileNode& node, const std::filesystem::path& path, const char* key) {
    NumberTable table;
    if (node.isSeq()) {
        append_numbers(node, table.values, path, key);
        table.rows = static_cast<int>(node.size());
        table.columns = table.rows > 0 ? static_cast<int>(table.values.size()) / table.rows : 0;
    } else if (node.isMap() && !node["data"].empty()) {
        append_numbers(node["data"], table.values, path, key);
        table.rows = node["rows"].isInt() ? static_cast<int>(node["rows"]) : 0;
        table.columns = node["cols"].isInt() ? static_cast<int>(node["cols"]) : 0;
        if (static_cast<long long>(table.rows) * table.columns != static_cast<long long>(table.values.size())) {
            fail(path, std::string(key) + " does not hold rows × cols numbers");
        }
    } else if (node.isMap()) {
        return table;  // OpenCV writes an empty matrix without data
    } else {
        fail(path, std::string(key) + " is not a matrix");
    }
    for (const double value : table.values) {
        if (!std::isfinite(value)) fail(path, std::string(key) + " holds a number that is not finite");
    }
    return table;
}

int picture_size(double value, const std::filesystem::path& path, const char* key) {
    if (!(value >= 1 && value <= largest_side_px) || value != std::floor(value)) {
        fail(path, std::string(key) + " is not a picture size");
    }
    return static_cast<int>(value);
}

int read_size(const cv::FileStorage& file, const std::filesystem::path& path,
              std::initializer_list<const char*> spellings) {
    const char* key = *spellings.begin();
    const cv::FileNode node = find_key(file, spellings);
    if (node.empty()) fail(path, std::string("no ") + key);
    return picture_size(node.isInt() || node.isReal() ? static_cast<double>(node) : 0, path, key);
}

LensModel read_lens(const cv::FileStorage& file, const std::filesystem::path& path) {
    const cv::FileNode node = find_key(file, {"distortion_model", "camera_model"});
    if (node.empty()) return LensModel::radtan;
    const std::string name = node.isString() ? node.string() : std::string();
    for (const char* fisheye : {"fisheye", "equidistant", "kannala_brandt", "kannala-brandt"}) {
        if (name == fisheye) return LensModel::fisheye;
    }
    for (const char* radtan : {"radtan", "plumb_bob", "rational_polynomial", "thin_prism", "pinhole", "opencv", ""}) {
        if (name == radtan) return LensModel::radtan;
    }
    fail(path, "the distortion model \"" + printable(name) + "\" is not known (fisheye or radtan)");
}

void read_matrix(Camera& camera, const cv::FileStorage& file, const std::filesystem::path& path) {
    const cv::FileNode node = find_key(file, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "k"});
    if (node.empty()) fail(path, "no camera_matrix");
    const NumberTable k = read_table(node, path, "camera_matrix");
    const bool square = k.values.size() == 9 && (k.rows == 3 || k.rows == 9 || k.rows == 1);
    if (!square) fail(path, "camera_matrix is not 3 × 3");
    const auto& v = k.values;
    if (!(v[0] > 0 && v[4] > 0)) fail(path, "the focal length is zero or negative");
    if (v[3] != 0 || v[6] != 0 || v[7] != 0 || v[8] != 1) fail(path, "camera_matrix is not [fx 0 cx; 0 fy cy; 0 0 1]");
    if (std::abs(v[1]) > 1e-6 * v[0]) fail(path, "camera_matrix has a skew, which the lens models do not know");
    camera.fx = v[0];
    camera.fy = v[4];
    camera.cx = v[2];
    camera.cy = v[5];
}

void read_distortion(Camera& camera, const cv::FileStorage& file, const std::filesystem::path& path) {
    const cv::FileNode node =
        find_key(file, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs", "D", "d"});
    if (node.empty()) return;  // a pinhole
    camera.distortion = read_table(node, path, "distortion_coefficients").values;
    const std::size_t count = camera.distortion.size();
    if (!valid_distortion_count(camera.lens, count)) {
        fail(path, std::to_string(count) + " distortion_coefficients; the lens model takes " +
                       (camera.lens == LensModel::fisheye ? "0 or 4" : "0, 4, 5, 8, 12 or 14"));
    }
}

void read_sigmas(Camera& camera, const cv::FileStorage& file, const std::filesystem::path& path) {
    const cv::FileNode node = file["parameter_sigmas"];
    if (node.empty()) return;
    const std::vector<double> values = read_table(node, path, "parameter_sigmas").values;
    constexpr std::size_t of_matrix = 4;
    if (values.size() != of_matrix + camera.distortion.size()) {
        fail(path, "parameter_sigmas does not hold one number for each of fx fy cx cy and distortion_coefficients");
    }
    for (const double value : values) {
        if (value < 0) fail(path, "parameter_sigmas holds a negative number");
    }
    camera.sigmas = {values[0], values[1], values[2], values[3], {values.begin() + of_matrix, values.end()}};
}

/// Kalibr's camchain: the first camera of the file; or one camera's keys alone.
cv::FileNode kalibr_camera(const cv::FileStorage& file) {
    if (const cv::FileNode first = file["cam0"]; first.isMap()) return first;
    return file["intrinsics"].isSeq() && !file["resolution"].empty() ? file.root() : cv::FileNode();
}

Camera read_kalibr(const cv::FileNode& node, const std::filesystem::path& path) {
    const auto word = [&](const char* key) { return node[key].isString() ? node[key].string() : std::string(); };
    const std::string model = word("camera_model"), distortion = word("distortion_model");
    if (model != "pinhole" || (distortion != "radtan" && distortion != "equidistant" && distortion != "none")) {
        fail(path, "Kalibr's camera model \"" + printable(model + "-" + distortion) +
                       "\" is not known (pinhole-radtan, pinhole-equi)");
    }
    const auto numbers = [&](const char* key, std::size_t count) {
        if (node[key].empty()) fail(path, std::string("no ") + key);
        std::vector<double> values = read_table(node[key], path, key).values;
        if (values.size() != count)
            fail(path, std::string(key) + " does not hold " + std::to_string(count) + " numbers");
        return values;
    };
    Camera camera;
    const std::vector<double> size = numbers("resolution", 2), k = numbers("intrinsics", 4);
    camera.width = picture_size(size[0], path, "resolution");
    camera.height = picture_size(size[1], path, "resolution");
    if (!(k[0] > 0 && k[1] > 0)) fail(path, "the focal length is zero or negative");
    camera.fx = k[0];
    camera.fy = k[1];
    camera.cx = k[2];
    camera.cy = k[3];
    camera.lens = distortion == "equidistant" ? LensModel::fisheye : LensModel::radtan;
    if (distortion != "none") camera.distortion = numbers("distortion_coeffs", 4);
    return camera;
}

/// Moves the items of lists, which Kalibr and ROS write in the column of the list's key, to the right of it: there
/// OpenCV's reader looks for them.
std::string with_indented_lists(const std::string& text) {
    std::string indented;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        const std::size_t first = text.find_first_not_of(' ', begin);
        if (first + 1 < end && text[first] == '-' && text[first + 1] == ' ') indented += "  ";
        indented.append(text, begin, end - begin);
        begin = end;
    }
    return indented;
}

std::string with_yaml_header(std::string text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool has_format = first != std::string::npos &&
                            (text.compare(first, 5, "%YAML") == 0 || text[first] == '{' || text[first] == '<');
    if (has_format) return text.substr(first);
    text = with_indented_lists(text);
    const bool has_start = first != std::string::npos && text.compare(first, 3, "---") == 0;
    return "%YAML:1.0\n" + std::string(has_start ? "" : "---\n") + text;
}

}  // namespace

Camera load_camera(const std::filesystem::path& path) {
    constexpr std::size_t limit_bytes = 4u << 20;  // a camera file is a page
    const std::string text = with_yaml_header(read_text_file(path, limit_bytes));
    try {
        const cv::FileStorage file(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
        if (!file.isOpened()) fail(path, "this is no camera file");
        if (const cv::FileNode node = kalibr_camera(file); !node.empty()) return read_kalibr(node, path);
        Camera camera;
        camera.width = read_size(file, path, {"image_width", "image_Width", "width"});
        camera.height = read_size(file, path, {"image_height", "image_Height", "height"});
        camera.lens = read_lens(file, path);
        read_matrix(camera, file, path);
        read_distortion(camera, file, path);
        read_sigmas(camera, file, path);
        return camera;
    } catch (const cv::Exception& error) {
        fail(path, "this is no camera file (" + printable(error.err) + ")");
    }
}

}  // namespace matchlight
