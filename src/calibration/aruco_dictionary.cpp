// OpenCV's names of ArUco dictionaries, and how many markers each has.
#include "calibration/aruco_dictionary.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "core/error.h"

namespace matchlight {
namespace {

constexpr std::array<ArucoDictionary, 21> dictionaries = {{
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50, 50},
    {"DICT_4X4_100", cv::aruco::DICT_4X4_100, 100},
    {"DICT_4X4_250", cv::aruco::DICT_4X4_250, 250},
    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000, 1000},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50, 50},
    {"DICT_5X5_100", cv::aruco::DICT_5X5_100, 100},
    {"DICT_5X5_250", cv::aruco::DICT_5X5_250, 250},
    {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000, 1000},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50, 50},
    {"DICT_6X6_100", cv::aruco::DICT_6X6_100, 100},
    {"DICT_6X6_250", cv::aruco::DICT_6X6_250, 250},
    {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000, 1000},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50, 50},
    {"DICT_7X7_100", cv::aruco::DICT_7X7_100, 100},
    {"DICT_7X7_250", cv::aruco::DICT_7X7_250, 250},
    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000, 1000},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL, 1024},
    {"DICT_APRILTAG_16H5", cv::aruco::DICT_APRILTAG_16h5, 30},
    {"DICT_APRILTAG_25H9", cv::aruco::DICT_APRILTAG_25h9, 35},
    {"DICT_APRILTAG_36H10", cv::aruco::DICT_APRILTAG_36h10, 2320},
    {"DICT_APRILTAG_36H11", cv::aruco::DICT_APRILTAG_36h11, 587},
}};

}  // namespace

std::span<const ArucoDictionary> aruco_dictionaries() {
    return dictionaries;
}

const ArucoDictionary& aruco_dictionary_of(const BoardSpec& board) {
    std::string name = board.dictionary;
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    const int markers = board.columns * board.rows / 2;
    for (const ArucoDictionary& known : dictionaries) {
        const std::string_view known_name = known.name;
        const bool same = known_name == name;
        const bool family = known_name.starts_with(name + "_") && known.markers >= markers;
        if (!same && !family) continue;
        if (known.markers < markers) {
            throw InputError({}, fmt::format("the board has {} markers, {} only {}", markers, name, known.markers),
                             "name a larger dictionary");
        }
        return known;
    }
    throw InputError({}, "the dictionary \"" + printable(board.dictionary) + "\" is not known",
                     "OpenCV's names, such as DICT_5X5_100 or DICT_APRILTAG_36h11");
}

}  // namespace matchlight
